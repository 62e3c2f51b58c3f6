"""Whole images by Mitsuba's own camera, emitters and direct integrator: one light, diffuse surfaces, pixel centres.

The scene is scaled to about 1 by a power of two first, because Mitsuba moves the starts of its own shadow rays by an
absolute distance. Radiance does not change with scale if a point's or spot's intensity shrinks with its square.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .blocks import BlockError
from .geometry import triangle_mesh
from .variant import is_scalar

# Rays a call: 16 million take about 2 GB.
RAYS_AT_ONCE = 1 << 22


@dataclass(frozen=True)
class View:
    """A pinhole camera: metres, degrees."""

    eye: list[float]
    target: list[float]
    up: list[float]
    fov_y_deg: float
    near_m: float
    size: tuple[int, int]


def emitter(light: dict[str, Any], mi: Any, unit_m: float) -> dict[str, Any]:
    """Return Mitsuba's description of one of gnomon's lights, in units of ``unit_m`` metres."""
    intensity = np.asarray(light["intensity"], dtype=np.float64)

    def spectrum(scale: float = 1.0) -> dict[str, Any]:
        return {"type": "rgb", "value": (intensity * scale).tolist()}

    def scaled(key: str) -> list[float]:
        return (np.asarray(light[key], dtype=np.float64) / unit_m).tolist()  # type: ignore[no-any-return]

    match light["kind"]:
        case "point":
            return {"type": "point", "position": scaled("position"), "intensity": spectrum(unit_m**-2)}
        case "directional":
            return {"type": "directional", "direction": light["direction"], "irradiance": spectrum()}
        case "spot":
            origin, axis = np.asarray(scaled("position")), np.asarray(light["axis"])
            up = [0.0, 0.0, 1.0] if abs(axis[1]) > 0.9 else [0.0, 1.0, 0.0]  # noqa: PLR2004
            return {
                "type": "spot",
                "to_world": mi.ScalarTransform4f().look_at(origin.tolist(), (origin + axis).tolist(), up),
                "intensity": spectrum(unit_m**-2),
                "cutoff_angle": light["outer_deg"],
                "beam_width": light["inner_deg"],
            }
        case "rectangle":
            # Mitsuba's unit rectangle spans −1 … 1 in x and y and shines along +z.
            right, above = np.asarray(scaled("half_width")), np.asarray(scaled("half_height"))
            normal = np.cross(above, right)
            columns = [-right, above, normal / np.linalg.norm(normal), np.asarray(scaled("position"))]
            matrix = np.vstack([np.column_stack(columns), [0, 0, 0, 1]])
            return {
                "type": "rectangle",
                "to_world": mi.ScalarTransform4f(matrix.tolist()),
                "emitter": {"type": "area", "radiance": spectrum()},
            }
        case "sphere":
            return {
                "type": "sphere",
                "center": scaled("position"),
                "radius": light["radius_m"] / unit_m,
                "emitter": {"type": "area", "radiance": spectrum()},
            }
        case "sun":
            # A disc so far away that it is the same from everywhere, with the radiance that gives the irradiance.
            origin, axis = np.asarray(scaled("position")), np.asarray(light["direction"])
            up = [0.0, 0.0, 1.0] if abs(axis[1]) > 0.9 else [0.0, 1.0, 0.0]  # noqa: PLR2004
            facing = mi.ScalarTransform4f().look_at(
                origin.tolist(), (origin + np.linalg.norm(origin) * axis).tolist(), up
            )
            radius = light["radius_m"] / unit_m
            return {
                "type": "disk",
                "to_world": facing @ mi.ScalarTransform4f().scale([radius, radius, 1.0]),
                "emitter": {"type": "area", "radiance": spectrum(1 / (np.pi * light["sine"] ** 2))},
            }
        case kind:
            raise BlockError(f"no such light as '{kind}'")


def scene(
    mi: Any,
    corners: NDArray[np.float32],
    material: NDArray[np.uint32],
    diffuse: NDArray[np.float32],
    light: dict[str, Any],
    unit_m: float,
) -> Any:
    """Build the Mitsuba scene: a mesh for each material, without shading normals."""
    scaled = (corners.astype(np.float64) / unit_m).astype(np.float32)
    described: dict[str, Any] = {
        "type": "scene",
        "embree_use_robust_intersections": True,
        "light": emitter(light, mi, unit_m),
    }
    for index in np.unique(material):
        colour = {"type": "rgb", "value": diffuse[index].astype(np.float64).tolist()}
        bsdf = mi.load_dict({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": colour}})
        described[f"material-{index}"] = triangle_mesh(mi, f"material-{index}", scaled[material == index], bsdf)
    return mi.load_dict(described)


def render(mi: Any, of: Any, view: View, unit_m: float, *, draws: int, seed: int) -> NDArray[np.float64]:
    """Return radiance per pixel as [mean, variance of the mean]; NaN where the camera looks into the light."""
    if is_scalar(mi):
        raise BlockError("whole images need a libLLVM of version 17 or later (Debian: libllvm19)")
    sensor = mi.load_dict(
        {
            "type": "perspective",
            "to_world": mi.ScalarTransform4f().look_at(
                *[(np.asarray(point) / unit_m).tolist() for point in (view.eye, view.target)], view.up
            ),
            "fov": view.fov_y_deg,
            "fov_axis": "y",
            "near_clip": view.near_m / unit_m,
            "far_clip": 1e6,
            "film": {
                "type": "hdrfilm",
                "width": view.size[0],
                "height": view.size[1],
                "rfilter": {"type": "box"},
            },
        }
    )
    integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
    width, height = view.size
    total, squares = np.zeros((height * width, 3)), np.zeros((height * width, 3))
    rows = max(RAYS_AT_ONCE // width, 1)
    for top in range(0, height, rows):
        y, x = np.divmod(np.arange(top * width, min(top + rows, height) * width), width)
        place = mi.Point2f(((x + 0.5) / width).astype(np.float32), ((y + 0.5) / height).astype(np.float32))
        ray, _ = sensor.sample_ray(0.0, 0.0, place, mi.Point2f(0.5))
        sees_light = _sees_light(of, ray)
        slot = slice(top * width, top * width + len(x))
        for draw in range(draws):
            sampler = mi.load_dict({"type": "independent", "sample_count": 1})
            sampler.seed(seed + draw * height + top, len(x))
            colour, _, _ = integrator.sample(of, sampler, mi.RayDifferential3f(ray))
            radiance = np.array(colour, dtype=np.float64).T.reshape(-1, 3)
            total[slot] += radiance
            squares[slot] += radiance**2
        total[slot][sees_light] = np.nan
    mean = total / draws
    variance = np.maximum(squares / draws - mean**2, 0.0) / max(draws - 1, 1)
    return np.stack([mean, variance]).reshape(2, height, width, 3)


def _sees_light(of: Any, ray: Any) -> NDArray[np.bool_]:
    hit = of.ray_intersect(ray)
    return np.array(hit.is_valid() & hit.shape.is_emitter(), dtype=bool).reshape(-1)


def write_exr(mi: Any, path: Path, pixels: NDArray[np.float64]) -> None:
    """Write an image of linear RGB, 32-bit floats, whole or not at all."""
    part = path.with_name(path.name + ".part")
    bitmap = mi.Bitmap(np.ascontiguousarray(pixels.astype(np.float32)), mi.Bitmap.PixelFormat.RGB)
    bitmap.write(str(part), mi.Bitmap.FileFormat.OpenEXR, 0)
    part.replace(path)
