"""The process as gnomon runs it."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gnomon_oracle import blocks


def conversation(options: list[str], jobs: list[Path]) -> list[dict[str, Any]]:
    command = [sys.executable, "-I", "-m", "gnomon_oracle", *options]
    lines = "".join(f"{job}\n" for job in jobs)
    done = subprocess.run(command, input=lines, capture_output=True, text=True, check=True, timeout=120)
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize("options", [[], ["--scalar"]])
def test_jobs_are_answered_in_order_and_errors_are_told(
    tmp_path: Path, floor_and_plate: NDArray[np.float32], options: list[str]
) -> None:
    rays = {
        "starts": np.array([[0.0, 3.0, 0.0], [0.0, 3.0, 0.0]]),
        "receivers": np.array([[0.1, 0.0, 0.2], [1.5, 0.0, 1.0]]),
        "own": np.array([0, 1], dtype="<u4"),
    }
    geometry = {"corners": floor_and_plate, "surface": np.arange(4, dtype="<u4")}
    files = {
        "early": blocks.encode({"task": "rays"}, rays),
        "geometry": blocks.encode({"task": "geometry", "unit_m": 2.0}, geometry),
        "rays": blocks.encode({"task": "rays"}, rays),
        "odd": blocks.encode({"task": "__import__('os')"}, {}),
        "broken": b"nothing of ours",
    }
    jobs = []
    for name, data in files.items():
        jobs.append(tmp_path / f"{name}.job")
        jobs[-1].write_bytes(data)
    hello, early, geometry_told, rays_told, odd, broken = conversation(options, jobs)
    assert hello["oracle"] == "mitsuba"
    assert "no geometry yet" in early["error"]
    assert blocks.decode(Path(geometry_told["ok"]).read_bytes()).about["triangles"] == 4
    answer = blocks.decode(Path(rays_told["ok"]).read_bytes())
    assert answer.arrays["verdict"].tolist() == [0, 1]
    assert "no such task" in odd["error"]
    assert "not a gnomon block file" in broken["error"]
    assert not list(tmp_path.glob("*.part"))
