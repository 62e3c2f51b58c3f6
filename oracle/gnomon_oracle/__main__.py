"""Answer jobs: each line of standard input names a block file, each line of standard output tells what came of it.

The answer to ``x.job`` is ``x.answer``, and images stand beside it. The first line out says which Mitsuba answers. The
end of standard input ends the process.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from . import blocks, estimate, flip, rays, render, variant
from .blocks import BlockError, Blocks
from .geometry import Geometry


class Oracle:
    """Mitsuba and the geometry that it was given."""

    def __init__(self, mi: Any) -> None:
        """Start without geometry."""
        self.mi = mi
        self.geometry: Geometry | None = None
        self.surface_of = np.zeros(0, dtype=np.uint32)

    def answer(self, job: Blocks, path: Path) -> bytes:
        """Return the bytes of the answer to one job."""
        match job.about.get("task"):
            case "geometry":
                return self._geometry(job)
            case "rays":
                return self._rays(job)
            case "estimate":
                return self._estimate(job)
            case "render":
                return self._render(job, path)
            case "flip":
                return self._flip(job)
            case task:
                raise BlockError(f"no such task as {task!r}")

    def _geometry(self, job: Blocks) -> bytes:
        corners = job.array("corners", "f32", None, 3, 3)
        self.surface_of = job.array("surface", "u32", len(corners))
        self.geometry = Geometry.build(self.mi, corners, float(job.about["unit_m"]))
        return blocks.encode(self.geometry.proof(), {})

    def _placed(self) -> Geometry:
        if self.geometry is None:
            raise BlockError("no geometry yet")
        return self.geometry

    def _rays(self, job: Blocks) -> bytes:
        starts = job.array("starts", "f64", None, 3)
        receivers = job.array("receivers", "f64", len(starts), 3)
        own = job.array("own", "u32", len(starts))
        verdict, met = rays.verdicts(self._placed(), starts, receivers, own, self.surface_of)
        return blocks.encode({}, {"verdict": verdict, "met": met})

    def _estimate(self, job: Blocks) -> bytes:
        about = job.about
        receivers = job.array("receivers", "f64", None, 3)
        share = job.array("share", "f64", len(receivers))
        half_sides = job.array("half_sides", "f64", None, 3)
        emitter = estimate.Emitter(
            np.asarray(about["centre"], dtype=np.float64),
            half_sides if len(half_sides) else None,
            float(about["radius_m"]),
            bool(about["is_from_receiver"]),
        )
        mean, variance = estimate.estimate(
            self._placed(),
            emitter,
            receivers,
            job.array("normals", "f64", len(receivers), 3),
            job.array("own", "u32", len(receivers)),
            self.surface_of,
            draws=int(about["draws"]),
            seed=int(about["seed"]),
        )
        rejected = estimate.rejected(
            share, mean, variance, discrepancy=float(about["discrepancy"]), alpha=float(about["alpha"])
        )
        return blocks.encode({}, {"mean": mean, "variance": variance, "rejected": rejected.astype(np.uint8)})

    @staticmethod
    def _flip(job: Blocks) -> bytes:
        theirs = job.array("theirs", "f32", None, None, 3)
        return blocks.encode(flip.flip(job.array("ours", "f32", *theirs.shape), theirs), {})

    def _render(self, job: Blocks, path: Path) -> bytes:
        about = job.about
        corners = job.array("corners", "f32", None, 3, 3)
        material = job.array("material", "u32", len(corners))
        diffuse = job.array("diffuse", "f32", None, 3)
        view = render.View(**{**about["view"], "size": tuple(about["view"]["size"])})
        unit_m = float(about["unit_m"])
        scene = render.scene(self.mi, corners, material, diffuse, about["light"], unit_m)
        image = render.render(self.mi, scene, view, unit_m, draws=int(about["draws"]), seed=int(about["seed"]))
        files = {name: path.with_suffix(f".{name}.exr") for name in ("mean", "variance")}
        for file, pixels in zip(files.values(), image, strict=True):
            render.write_exr(self.mi, file, pixels)
        return blocks.encode({name: str(file) for name, file in files.items()}, {})


def main() -> int:
    """Answer jobs until standard input ends."""
    mi = variant.start(scalar="--scalar" in sys.argv[1:])
    oracle = Oracle(mi)
    _say({"oracle": "mitsuba", "version": mi.__version__, "variant": mi.variant()})
    for line in sys.stdin:
        path = Path(line.rstrip("\n"))
        answer = path.with_suffix(".answer")
        try:
            blocks.write(answer, oracle.answer(blocks.decode(path.read_bytes()), path))
            _say({"ok": str(answer)})
        except (BlockError, ValueError, KeyError, TypeError, OSError, RuntimeError) as error:
            _say({"error": f"{type(error).__name__}: {error}"})
    return 0


def _say(what: dict[str, Any]) -> None:
    print(json.dumps(what), flush=True)


if __name__ == "__main__":
    sys.exit(main())
