"""Mitsuba in each variant that loads here, and a small scene."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gnomon_oracle import variant


@pytest.fixture(scope="session")
def mi() -> Any:
    """The variant that gnomon uses on this machine."""
    return variant.start()


@pytest.fixture
def floor_and_plate() -> NDArray[np.float32]:
    """A floor from −2 to 2 in triangles 0 and 1, a unit plate at height 1 in triangles 2 and 3."""

    def square(half: float, y: float) -> list[list[list[float]]]:
        a, b, c, d = [-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]
        return [[a, b, c], [a, c, d]]

    return np.array(square(2.0, 0.0) + square(0.5, 1.0), dtype=np.float32)
