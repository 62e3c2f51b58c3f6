"""The casting triangles as Mitsuba holds them, and the proof that they are all of them.

Coordinates are divided by a power of two that brings the scene to about 1, which rounds nothing: Mitsuba's tolerances
are absolute, gnomon's scenes have any scale.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

FNV_BASIS = 0xCBF2_9CE4_8422_2325
FNV_PRIME = 0x0000_0100_0000_01B3
_WORD = (1 << 64) - 1


@dataclass(frozen=True)
class Geometry:
    """A Mitsuba scene of bare triangles, in units of ``unit_m`` metres."""

    mi: Any
    scene: Any
    mesh: Any
    unit_m: float

    @classmethod
    def build(cls, mi: Any, corners: NDArray[np.float32], unit_m: float) -> "Geometry":
        """Make it from the corners in metres, three points a triangle."""
        if not (np.isfinite(corners).all() and unit_m > 0 and np.log2(unit_m).is_integer()):
            raise ValueError("corners must be finite and the unit a power of two")
        mesh = triangle_mesh(mi, "casters", (corners.astype(np.float64) / unit_m).astype(np.float32))
        scene = mi.load_dict({"type": "scene", "embree_use_robust_intersections": True, "casters": mesh})
        return cls(mi, scene, mesh, unit_m)

    def proof(self) -> dict[str, Any]:
        """Count, bounds and content of what Mitsuba holds, read back from it, in metres."""
        parameters = self.mi.traverse(self.mesh)
        vertices = np.array(parameters["vertex_positions"], dtype=np.float32).reshape(-1, 3)
        faces = np.array(parameters["faces"], dtype=np.uint32).reshape(-1, 3)
        corners = (vertices[faces].astype(np.float64) * self.unit_m).astype(np.float32)
        points = corners.reshape(-1, 3).astype(np.float64)
        return {
            "triangles": len(faces),
            "min": points.min(axis=0).tolist(),
            "max": points.max(axis=0).tolist(),
            "hash": f"{content_hash(corners):016x}",
        }


def triangle_mesh(mi: Any, name: str, corners: NDArray[np.float32], bsdf: Any = None) -> Any:
    """Return a mesh whose i-th face is the i-th triangle, without shared vertices."""
    properties = mi.Properties()
    if bsdf is not None:
        properties["bsdf"] = bsdf
    count = len(corners)
    mesh = mi.Mesh(name, 3 * count, count, props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ascontiguousarray(corners.reshape(-1))
    parameters["faces"] = np.arange(3 * count, dtype=np.uint32)
    parameters.update()
    return mesh


def content_hash(corners: NDArray[np.float32]) -> int:
    """FNV-1a (64 bit) over the corners' coordinates as little-endian f32, −0 written as +0."""
    value = FNV_BASIS
    for byte in (corners + np.float32(0)).astype("<f4").tobytes():
        value = ((value ^ byte) * FNV_PRIME) & _WORD
    return value
