"""The estimate of area lights against a half plane's share, and the test that it is put to."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gnomon_oracle.estimate import Emitter, estimate, rejected
from gnomon_oracle.geometry import Geometry

DRAWS = 400


def half_plane(mi: Any) -> Geometry:
    """The half plane x > 0 at height 1, large enough."""
    far = 50.0
    corners = [[[0, 1, -far], [0, 1, far], [far, 1, far]], [[0, 1, -far], [far, 1, far], [far, 1, -far]]]
    return Geometry.build(mi, np.array(corners, dtype=np.float32), 64.0)


def row() -> NDArray[np.float64]:
    x = np.linspace(-0.4, 0.4, 41)
    return np.column_stack([x, np.zeros_like(x), np.zeros_like(x)])


EMITTERS = {
    "rectangle": Emitter(np.array([0.0, 4.0, 0.0]), np.array([[0.5, 0.0, 0.0], [0.0, 0.0, -0.5]]), 0.0),
    "sphere": Emitter(np.array([0.0, 4.0, 0.0]), None, 0.5),
    "sun": Emitter(np.array([0.0, 400.0, 0.0]), None, 100.0, is_from_receiver=True),
}


def share(kind: str, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the edge leaves of the light as seen from the floor."""
    if kind == "rectangle":
        return np.clip(0.5 - 3 * x, 0, 1)
    if kind == "sun":
        # The disc of tangents up to 1/4, cut where the edge is seen.
        t = np.clip(-4 * x, -1, 1)
        circle: NDArray[np.float64] = (np.arccos(-t) + t * np.sqrt(1 - t * t)) / np.pi
        return circle
    # The plane through receiver and edge, and the disc that faces the receiver.
    normal = np.column_stack([np.ones_like(x), x]) / np.hypot(1, x)[:, None]
    towards = np.column_stack([-x, np.full_like(x, 4.0)])
    unit = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    in_disc = np.abs(normal[:, 0] * unit[:, 1] - normal[:, 1] * unit[:, 0])
    t = np.clip(-(normal * towards).sum(axis=1) / (0.5 * in_disc), -1, 1)
    segment: NDArray[np.float64] = (np.arccos(-t) + t * np.sqrt(1 - t * t)) / np.pi
    return segment


@pytest.mark.parametrize("kind", EMITTERS)
def test_the_estimate_accepts_the_truth_and_rejects_a_light_moved_by_a_centimetre(mi: Any, kind: str) -> None:
    receivers = row()
    normals = np.tile([[0.0, 1.0, 0.0]], (len(receivers), 1))
    own = np.full(len(receivers), 99, dtype=np.uint32)
    surface = np.arange(2, dtype=np.uint32)
    mean, variance = estimate(half_plane(mi), EMITTERS[kind], receivers, normals, own, surface, draws=DRAWS, seed=7)
    truth = share(kind, receivers[:, 0])
    assert not rejected(truth, mean, variance, discrepancy=0.0, alpha=0.01).any()
    # An edge that moves by as much as the shadow of a light 3 m above it moved by 10 cm.
    moved = share(kind, receivers[:, 0] - 0.1 / 3)
    assert rejected(moved, mean, variance, discrepancy=0.0, alpha=0.01).any()
    # The set's own discrepancy is granted, and no more.
    assert not rejected(truth + 0.05, mean, variance, discrepancy=0.05, alpha=0.01).any()
    assert rejected(truth + 0.25, mean, variance, discrepancy=0.05, alpha=0.01).any()


def test_points_behind_the_receiver_are_not_seen(mi: Any) -> None:
    receivers = np.array([[-9.0, 0.0, 0.0]])
    emitter = Emitter(np.array([-12.0, 0.25, 0.0]), np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), 0.0)
    mean, _ = estimate(
        half_plane(mi),
        emitter,
        receivers,
        np.array([[0.0, 1.0, 0.0]]),
        np.array([99], dtype=np.uint32),
        np.arange(2, dtype=np.uint32),
        draws=2000,
        seed=1,
    )
    assert mean[0] == pytest.approx(1.25 / 2, abs=0.05)
