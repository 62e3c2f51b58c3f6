"""Radiometry of every light against closed forms, and the camera against a pinhole."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gnomon_oracle import variant
from gnomon_oracle.render import View, render, scene

ALBEDO = 0.5
INTENSITY = 3.0
HEIGHT = 2.0
# f32 through a few dozen operations.
RELATIVE = 1e-5

LIGHTS: dict[str, tuple[dict[str, Any], float]] = {
    "point": ({"kind": "point", "position": [0, HEIGHT, 0]}, INTENSITY / HEIGHT**2),
    "directional": ({"kind": "directional", "direction": [0, -1, 0]}, INTENSITY),
    "spot": (
        {"kind": "spot", "position": [0, HEIGHT, 0], "axis": [0, -1, 0], "outer_deg": 30.0, "inner_deg": 20.0},
        INTENSITY / HEIGHT**2,
    ),
    "sphere": ({"kind": "sphere", "position": [0, HEIGHT, 0], "radius_m": 0.25}, np.pi * INTENSITY * (0.25 / 2) ** 2),
    "sun": (
        {
            "kind": "sun",
            "direction": [0, -1, 0],
            "position": [0, 1e6, 0],
            "radius_m": 1e6 * np.tan(0.05),
            "sine": np.sin(0.05),
        },
        INTENSITY,
    ),
    "rectangle": (
        {"kind": "rectangle", "position": [0, HEIGHT, 0], "half_width": [0.1, 0, 0], "half_height": [0, 0, -0.2]},
        INTENSITY * 0.08 / HEIGHT**2,
    ),
}


def floor(mi: Any, light: dict[str, Any], unit_m: float, scale: float) -> Any:
    half = 5.0 * scale
    a, b, c, d = [-half, 0, -half], [-half, 0, half], [half, 0, half], [half, 0, -half]
    corners = np.array([[a, b, c], [a, c, d]], dtype=np.float32)
    diffuse = np.full((1, 3), ALBEDO, dtype=np.float32)
    lit = {**light, "intensity": [INTENSITY * scale**2 if light["kind"] in ("point", "spot") else INTENSITY] * 3}
    for key in ("position", "half_width", "half_height"):
        if key in lit:
            lit[key] = (np.asarray(lit[key]) * scale).tolist()
    if "radius_m" in lit:
        lit["radius_m"] *= scale
    return scene(mi, corners, np.zeros(2, dtype=np.uint32), diffuse, lit, unit_m)


def centre(mi: Any, kind: str, draws: int, scale: float = 1.0) -> float:
    """Radiance of the floor straight below the light, seen from the side."""
    unit_m = float(2.0 ** np.round(np.log2(scale * 8)))
    eye = (np.array([3.0, 1.5, 0.0]) * scale).tolist()
    view = View(eye, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 40.0, 0.01 * scale, (5, 5))
    image: NDArray[np.float64] = render(
        mi, floor(mi, LIGHTS[kind][0], unit_m, scale), view, unit_m, draws=draws, seed=1
    )
    return float(image[0, 2, 2, 0])


@pytest.mark.parametrize("scale", [2.0**-20, 1.0, 2.0**20])
@pytest.mark.parametrize("kind", ["point", "directional", "spot"])
def test_lights_without_extent_have_their_closed_form_at_every_scale(mi: Any, kind: str, scale: float) -> None:
    if variant.is_scalar(mi):
        pytest.skip("whole images need a libLLVM")
    expected = ALBEDO / np.pi * LIGHTS[kind][1]
    assert centre(mi, kind, 1, scale) == pytest.approx(expected, rel=RELATIVE)
    # Radiometry wrong by 2 % is noticed.
    assert centre(mi, kind, 1, scale) != pytest.approx(1.02 * expected, rel=RELATIVE)


@pytest.mark.parametrize("kind", ["sphere", "rectangle", "sun"])
def test_area_lights_have_theirs_but_for_noise(mi: Any, kind: str) -> None:
    if variant.is_scalar(mi):
        pytest.skip("whole images need a libLLVM")
    # The rectangle's closed form here is that of a small one.
    assert centre(mi, kind, 256) == pytest.approx(ALBEDO / np.pi * LIGHTS[kind][1], rel=1e-2)


def test_the_light_itself_is_left_out(mi: Any) -> None:
    if variant.is_scalar(mi):
        pytest.skip("whole images need a libLLVM")
    view = View([3.0, 0.5, 0.0], [0.0, HEIGHT, 0.0], [0.0, 1.0, 0.0], 5.0, 0.01, (3, 3))
    image = render(mi, floor(mi, LIGHTS["sphere"][0], 8.0, 1.0), view, 8.0, draws=1, seed=1)
    assert np.isnan(image[0, 1, 1]).all()
