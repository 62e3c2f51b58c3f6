"""Shadow rays against the shadow of a square plate, worked out on paper."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gnomon_oracle.geometry import Geometry, content_hash, triangle_mesh
from gnomon_oracle.rays import BLOCKED, CLEAR, CONTACT_CLEAR, NOTHING, first_hits, verdicts

LAMP = np.array([0.1, 3.0, 0.2])


def grid(count: int) -> NDArray[np.float64]:
    """Receivers on the floor, none on an edge."""
    side = np.linspace(-1.9, 1.9, count)
    x, z = np.meshgrid(side + 1e-3, side + 2e-3)
    return np.column_stack([x.ravel(), np.zeros(x.size), z.ravel()])


def in_shadow(receivers: NDArray[np.float64], lamp: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where the way from the lamp passes height 1 inside the plate."""
    at = receivers + (lamp - receivers) / lamp[1]
    shadowed: NDArray[np.bool_] = (np.abs(at[:, 0]) < 0.5) & (np.abs(at[:, 2]) < 0.5)
    return shadowed


def asked(
    mi: Any,
    corners: NDArray[np.float32],
    scale: float,
    count: int = 101,
    lamp: NDArray[np.float64] = LAMP,
) -> NDArray[np.uint8]:
    geometry = Geometry.build(mi, (corners * np.float32(scale)), float(2.0 ** np.round(np.log2(scale))))
    receivers = grid(count)
    own = np.where(receivers[:, 2] > receivers[:, 0], 0, 1).astype(np.uint32)
    starts = np.broadcast_to(lamp * scale, receivers.shape)
    surface = np.arange(len(corners), dtype=np.uint32)
    verdict, _ = verdicts(geometry, starts, receivers * scale, own, surface)
    return verdict


@pytest.mark.parametrize("scale", [2.0**-20, 1e-3, 1.0, 1e3, 2.0**20])
def test_the_plate_shadows_its_projection_at_every_scale(
    mi: Any,
    floor_and_plate: NDArray[np.float32],
    scale: float,
) -> None:
    expected = in_shadow(grid(101), LAMP)
    assert 0.1 < expected.mean() < 0.9
    assert (asked(mi, floor_and_plate, scale) == np.where(expected, BLOCKED, CLEAR)).all()


def test_a_lamp_moved_by_a_centimetre_is_noticed(mi: Any, floor_and_plate: NDArray[np.float32]) -> None:
    expected = in_shadow(grid(801), LAMP)
    moved = asked(mi, floor_and_plate, 1.0, 801, LAMP + np.array([0.01, 0.0, 0.0]))
    assert ((moved == BLOCKED) != expected).any()


def test_another_mesh_is_noticed(mi: Any, floor_and_plate: NDArray[np.float32]) -> None:
    proofs = [Geometry.build(mi, corners, 1.0).proof() for corners in (floor_and_plate, floor_and_plate[:3])]
    assert proofs[0]["triangles"] == 4
    assert proofs[0]["min"] == [-2.0, 0.0, -2.0]
    assert proofs[0]["hash"] == f"{content_hash(floor_and_plate):016x}"
    assert proofs[0] != proofs[1]


def test_the_proof_is_in_metres_whatever_the_unit(mi: Any, floor_and_plate: NDArray[np.float32]) -> None:
    proofs = [Geometry.build(mi, floor_and_plate, unit).proof() for unit in (0.25, 1.0, 1024.0)]
    assert proofs[0] == proofs[1] == proofs[2]


def test_a_negative_zero_is_hashed_as_zero() -> None:
    zero = np.zeros((1, 3, 3), dtype=np.float32)
    assert content_hash(zero) == content_hash(-zero)
    assert content_hash(zero) != content_hash(zero + np.float32(1e-45))


def test_a_surface_next_to_the_receiver_is_a_contact(mi: Any, floor_and_plate: NDArray[np.float32]) -> None:
    geometry = Geometry.build(mi, floor_and_plate, 1.0)
    surface = np.arange(4, dtype=np.uint32)
    # The receiver lies on the floor's triangle 1, but is said to lie on the plate.
    receiver = np.array([[1.5, 0.0, -1.0]])
    verdict, met = verdicts(geometry, LAMP[None], receiver, np.array([2], dtype=np.uint32), surface)
    assert verdict[0] == CONTACT_CLEAR
    assert met[0] == 1


def test_coinciding_triangles_are_one_surface(mi: Any, floor_and_plate: NDArray[np.float32]) -> None:
    doubled = np.concatenate([floor_and_plate[:2], floor_and_plate[:2]])
    geometry = Geometry.build(mi, doubled, 1.0)
    receivers = grid(21)
    own = np.where(receivers[:, 2] > receivers[:, 0], 0, 1).astype(np.uint32)
    starts = np.broadcast_to(LAMP, receivers.shape)
    verdict, _ = verdicts(geometry, starts, receivers, own, np.array([0, 1, 0, 1], dtype=np.uint32))
    assert (verdict == CLEAR).all()


@pytest.mark.parametrize(("robust", "least", "most"), [(True, 0, 2), (False, 20, 450)])
def test_rays_at_edges_and_vertices_hardly_leak(mi: Any, robust: bool, least: int, most: int) -> None:
    """Embree's robust mode loses a ray at one vertex of 225; without it every tenth ray is lost."""
    n = 16
    heights = np.random.default_rng(1).uniform(-0.1, 0.1, (n + 1, n + 1))
    point = {(i, j): [2 * i / n - 1, heights[i, j], 2 * j / n - 1] for i in range(n + 1) for j in range(n + 1)}
    corners = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = point[i, j], point[i, j + 1], point[i + 1, j + 1], point[i + 1, j]
            corners += [[a, b, c], [a, c, d]]
    mesh = triangle_mesh(mi, "sheet", np.array(corners, dtype=np.float32))
    scene = mi.load_dict({"type": "scene", "embree_use_robust_intersections": robust, "sheet": mesh})
    inner = [(i, j) for i in range(1, n) for j in range(1, n)]
    targets = [point[key] for key in inner]
    targets += [np.mean([point[i, j], point[i + 1, j + 1]], axis=0).tolist() for i, j in inner]
    origins = np.tile(np.array([[0.3, 2.0, 0.1]], dtype=np.float32), (len(targets), 1))
    directions = (np.array(targets) - origins) * 1.5
    met, _ = first_hits(Geometry(mi, scene, mesh, 1.0), origins, directions.astype(np.float32))
    assert least <= (met == NOTHING).sum() <= most
