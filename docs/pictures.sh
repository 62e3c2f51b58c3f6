#!/bin/sh
# Redraws every picture of the documentation with gnomon itself, so that none can show what the program does not do.
# Usage: docs/pictures.sh [path to gnomon]; run from anywhere.
set -eu
cd "$(dirname "$0")/.."
gnomon=${1:-target/release/gnomon}
pictures=docs/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pictures"

# cause NAME SCENE LIGHT SPEC: the cause map of one run in which that cause stands out.
cause() {
    "$gnomon" check "scenes/$2" --light "$3" -t "$4" --size 480x360 --out "$work/$1" >"$work/$1.txt" || [ $? -eq 1 ]
    mv "$work/$1/"*.causes.png "$pictures/cause-$1.png"
    echo "==> $pictures/cause-$1.png"
}

cause edge-aliasing        torus       lamp map:size=4096
cause perspective-aliasing posts       sun  map:size=1024
cause projective-aliasing  grazing     sun  map:size=256
cause acne                 triangle    sun  map:size=256,bias=none
cause curvature            bunny       sun  map:size=512,fit=receivers
cause peter-panning        contact     sun  map:size=4096,bias_depth_m=0.15
cause clipping-near        torus       sun  map:near_m=6
cause clipping-far         triangle    sun  map:far_m=4
cause clipping-frustum     torus       sun  map:width_m=1
cause filter-width         polygons-32 lamp map:filter=pcf-box16
cause precision            triangle    sun  map:format=depth16unorm,bias=none,far_m=1000000

"$gnomon" check scenes/room --light spot -t map:size=512,bias=slope --out "$work/readme" >"$work/readme.txt" || [ $? -eq 1 ]
mv "$work/readme/"*.error.png "$pictures/error-map.png"
mv "$work/readme/"*.causes.png "$pictures/cause-map.png"
mv "$work/readme/"*.m.png "$pictures/m-map.png"
"$gnomon" render scenes/room -o "$pictures/room.png"
cat "$work"/*.txt
