"""FLIP: how two pictures look side by side.

P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020.
"""

from typing import Any

import numpy as np
from flip_evaluator import evaluate
from numpy.typing import NDArray

# From here on a difference is plain to see.
PLAIN = 0.1


def flip(ours: NDArray[np.float32], theirs: NDArray[np.float32]) -> dict[str, Any]:
    """Return mean, maximum and number of plain differences of two pictures of linear RGB."""
    pictures = [srgb(np.clip(picture, 0.0, 1.0)) for picture in (theirs, ours)]
    error, mean, _ = evaluate(*pictures, "LDR", inputsRGB=True, applyMagma=False)
    return {"mean": float(mean), "max": float(error.max()), "above_a_tenth": int((error > PLAIN).sum())}


def srgb(linear: NDArray[np.float32]) -> NDArray[np.float32]:
    """Apply the curve of IEC 61966-2-1."""
    low, high = 12.92 * linear, 1.055 * np.power(np.maximum(linear, 1e-9), 1 / 2.4) - 0.055
    return np.ascontiguousarray(np.where(linear <= 0.0031308, low, high), dtype=np.float32)  # noqa: PLR2004
