#!/bin/sh
# Measures the cost table of docs/volume.md again and puts it there: one run of every way of counting on every scene.
# Usage: docs/volume-costs.sh [path to gnomon]; run from anywhere.
set -eu
cd "$(dirname "$0")/.."
gnomon=${1:-target/release/gnomon}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for scene in torus room pipe bunny kitchen; do
    [ -f "scenes/$scene/$scene.obj" ] || [ -f "scenes/$scene/shell.obj" ] || continue
    "$gnomon" check "scenes/$scene" --light lamp --size 512x384 --format csv --out "$work/$scene" \
        -t volume:count=z-fail -t volume:count=z-pass -t volume:count=mixed -t volume:count=zp-plus \
        -t volume:extrude=gpu -t volume:extrude=degenerate-quads -t volume:caster_sides=all -t volume:shape=per-triangle >"$work/log" 2>&1 || [ $? -eq 1 ]
done

python3 - "$work" docs/volume.md <<'PYTHON'
import csv, pathlib, sys

work, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
rows = ["| scene | `volume:` | wrong px | vertices | primitives | Mfragments | ms |", "|---|---|---|---|---|---|---|"]
for scene in ["torus", "room", "pipe", "bunny", "kitchen"]:
    file = work / scene / "report.csv"
    for run in csv.DictReader(file.open()) if file.exists() else []:
        count = lambda key: f"{int(run[key]):,}".replace(",", " ")
        spec = run["typed"].removeprefix("volume:") if ":" in run["typed"] else "count=z-fail"
        cells = [scene, f"`{spec}`", count("wrong"), count("vertices"), count("primitives"),
                 f"{int(run['fragments']) / 1e6:.3g}", f"{float(run['gpu_ms_median']):.3g}"]
        rows.append("| " + " | ".join(cells) + " |")
start, end = "<!-- costs: written by docs/volume-costs.sh -->\n", "<!-- end of costs -->\n"
head, rest = page.read_text().split(start)
page.write_text(head + start + "\n".join(rows) + "\n" + end + rest.split(end)[1])
PYTHON
