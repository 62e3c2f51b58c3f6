"""FLIP sees what differs and nothing else."""

import numpy as np

from gnomon_oracle.flip import flip


def test_a_picture_equals_itself_and_differs_from_one_with_a_hole() -> None:
    picture = np.full((32, 32, 3), 0.5, dtype=np.float32)
    assert flip(picture, picture) == {"mean": 0.0, "max": 0.0, "above_a_tenth": 0}
    holed = picture.copy()
    holed[10:14, 10:14] = 0.0
    found = flip(holed, picture)
    assert found["max"] > 0.3
    assert 16 <= found["above_a_tenth"] < 400
