"""An independent estimate of how much of an area light each receiver sees, and the test of counted shares against it.

Points are drawn uniformly in area, without a cosine: the measure of gnomon's count, but none of its points. A share and
an estimate disagree where they differ by more than the count's own discrepancy can explain and by more standard errors
than one pixel in all would with the chance ``alpha`` (Z. Šidák, "Rectangular Confidence Regions for the Means of
Multivariate Normal Distributions", 1967).
"""

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from .geometry import Geometry
from .rays import BLOCKED, verdicts

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Emitter:
    """A rectangle (two half sides) or, where there are none, a sphere seen as the disc that faces the receiver.

    With ``is_from_receiver`` the centre is a vector from each receiver: the light is the same from everywhere.
    """

    centre: Points
    half_sides: Points | None
    radius_m: float
    is_from_receiver: bool = False

    def draw(self, receivers_m: Points, random: np.random.Generator) -> Points:
        """Return one point for each receiver, uniform in area."""
        count = len(receivers_m)
        if self.half_sides is not None:
            at = random.uniform(-1.0, 1.0, (count, 2))
            on_rectangle: Points = self.centre + at @ self.half_sides
            return on_rectangle
        centre = receivers_m + self.centre if self.is_from_receiver else self.centre
        towards = centre - receivers_m
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        # Any direction that is not along `towards` spans the disc with it.
        helper = np.where(np.abs(towards[:, :1]) < 0.5, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])  # noqa: PLR2004
        right = np.cross(towards, helper)
        right /= np.linalg.norm(right, axis=1, keepdims=True)
        radius = self.radius_m * np.sqrt(random.random(count))[:, None]
        angle = random.uniform(0.0, 2 * np.pi, count)[:, None]
        on_disc: Points = np.cos(angle) * right + np.sin(angle) * np.cross(towards, right)
        return centre + radius * on_disc


def estimate(
    geometry: Geometry,
    emitter: Emitter,
    receivers_m: Points,
    normals: Points,
    own: NDArray[np.uint32],
    surface_of: NDArray[np.uint32],
    *,
    draws: int,
    seed: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and variance of the mean per receiver. Points behind the receiver's surface are not seen."""
    random = np.random.default_rng(seed)
    seen = np.zeros(len(receivers_m))
    for _ in range(draws):
        points = emitter.draw(receivers_m, random)
        is_before = np.einsum("ij,ij->i", points - receivers_m, normals) > 0
        verdict, _ = verdicts(geometry, points, receivers_m, own, surface_of)
        seen += is_before & (verdict != BLOCKED)
    mean = seen / draws
    # Laplace's rule keeps the variance of what was seen always or never above zero.
    smoothed = (seen + 1) / (draws + 2)
    return mean, smoothed * (1 - smoothed) / draws


def rejected(
    share: NDArray[np.float64],
    mean: NDArray[np.float64],
    variance: NDArray[np.float64],
    *,
    discrepancy: float,
    alpha: float,
) -> NDArray[np.bool_]:
    """Return where a counted share and an estimate cannot both be right."""
    of_one = 1 - (1 - alpha) ** (1 / max(len(share), 1))
    critical = NormalDist().inv_cdf(1 - of_one / 2)
    excess = np.maximum(np.abs(share - mean) - discrepancy, 0.0)
    return excess > critical * np.sqrt(variance)
