"""Shadow rays by Mitsuba's ray casting.

Mitsuba can neither skip a triangle nor start a ray behind its origin, so a ray goes from the light to the receiver and
asks what comes first: the receiver's own surface, or nothing, and the receiver is lit. A long ray's direction is
rounded coarsely, so the last stretch before the receiver, where most shadows begin, is a ray of its own. What is met
within ``CONTACT`` of the receiver cannot be told from it in f32; the receiver is called lit, and the ray a contact.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry import Geometry
from .variant import is_scalar

BLOCKED, CLEAR, CONTACT_CLEAR = 0, 1, 2
NOTHING = 0xFFFF_FFFF
# In units of the scene: 16 units in the last place of f32 below 1.
CONTACT = 16 * 2.0**-24
# In units of the scene: rounding the direction moves a ray of this length by less than rounding the receiver does.
LAST_STRETCH = 1 / 16


def verdicts(
    geometry: Geometry,
    starts_m: NDArray[np.float64],
    receivers_m: NDArray[np.float64],
    own: NDArray[np.uint32],
    surface_of: NDArray[np.uint32],
) -> tuple[NDArray[np.uint8], NDArray[np.uint32]]:
    """Return, per ray, the verdict and the triangle that was met first.

    ``own`` is the receiver's surface; ``surface_of`` names for each triangle the surface that it lies on, because
    triangles in the same place count as one.
    """
    starts, ends = starts_m / geometry.unit_m, receivers_m / geometry.unit_m
    length = np.linalg.norm(ends - starts, axis=1)
    share = np.minimum(LAST_STRETCH / np.maximum(length, LAST_STRETCH), 1.0)
    between = ends + (starts - ends) * share[:, None]
    far_met, _, _ = _ways(geometry, starts, between)
    near_met, t, way = _ways(geometry, between, ends)
    surface = np.append(surface_of, np.uint32(NOTHING))
    far_blocks = _is_other(far_met, own, surface) & (share < 1.0)
    near_blocks = _is_other(near_met, own, surface)
    is_contact = near_blocks & ((1.0 - t) * way <= CONTACT)
    clear = np.where(is_contact, CONTACT_CLEAR, CLEAR)
    verdict = np.where(far_blocks | (near_blocks & ~is_contact), BLOCKED, clear).astype(np.uint8)
    return verdict, np.where(far_blocks, far_met, near_met).astype(np.uint32)


def _ways(
    geometry: Geometry, starts: NDArray[np.float64], ends: NDArray[np.float64]
) -> tuple[NDArray[np.uint32], NDArray[np.float64], NDArray[np.float64]]:
    """Return what is met first on each way, at which share of it, and its length."""
    origins = starts.astype(np.float32)
    # From the rounded start: the ray then passes the end as closely as f32 can tell.
    directions = (ends - origins).astype(np.float32)
    met, t = first_hits(geometry, origins, directions)
    return met, t, np.linalg.norm(directions, axis=1)


def _is_other(met: NDArray[np.uint32], own: NDArray[np.uint32], surface: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Where something was met that is not the receiver's own surface; the last of ``surface`` stands for nothing."""
    is_hit = met != NOTHING
    is_other: NDArray[np.bool_] = is_hit & (surface[np.where(is_hit, met, len(surface) - 1)] != own)
    return is_other


def first_hits(
    geometry: Geometry, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
    """Return what each ray meets first up to one length of its direction, and where; ``NOTHING`` and 1 if nothing."""
    if is_scalar(geometry.mi):
        return _one_by_one(geometry, origins, directions)
    mi = geometry.mi
    ray = mi.Ray3f(mi.Point3f(np.ascontiguousarray(origins.T)), mi.Vector3f(np.ascontiguousarray(directions.T)))
    ray.maxt = 1.0
    hit = geometry.scene.ray_intersect_preliminary(ray, coherent=False)
    valid = np.array(hit.is_valid(), dtype=bool).reshape(-1)
    met = np.where(valid, np.array(hit.prim_index, dtype=np.uint32).reshape(-1), NOTHING).astype(np.uint32)
    return met, np.where(valid, np.array(hit.t, dtype=np.float64).reshape(-1), 1.0)


def _one_by_one(
    geometry: Geometry, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
    mi: Any = geometry.mi
    met = np.full(len(origins), NOTHING, dtype=np.uint32)
    t = np.ones(len(origins))
    for i, (origin, direction) in enumerate(zip(origins.tolist(), directions.tolist(), strict=True)):
        ray = mi.Ray3f(origin, direction)
        ray.maxt = 1.0
        hit = geometry.scene.ray_intersect_preliminary(ray, coherent=False)
        if hit.is_valid():
            met[i], t[i] = hit.prim_index, hit.t
    return met, t
