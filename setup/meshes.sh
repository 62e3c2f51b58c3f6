#!/bin/sh
# Takes two meshes that are too large to commit out of packages that carry them and puts them into scenes/: the kitchen
# (crate obvhs) and the bunny (Debian package glmark2-data). What is there and intact is left alone, without network.
set -eu

setup=$(cd "$(dirname "$0")" && pwd)
cd "$setup/.."

# intact FILE [PATH]: whether FILE is there and holds what meshes.sha256 says PATH (by default FILE itself) holds.
intact() {
    expected=$(awk -v path="${2:-$1}" '$2 == path { print $1 }' "$setup/meshes.sha256")
    [ -f "$1" ] && [ "$(sha256sum <"$1")" = "$expected  -" ]
}

# place FILE PATH TRIANGLES: moves a checked FILE to PATH in one step, so that nobody sees half a mesh.
place() {
    faces=$(grep -c '^f ' "$1" || true)
    if [ "$faces" -ne "$3" ] || ! intact "$1" "$2"; then
        echo "the package's $2 is not the mesh these scenes were made for: $faces faces, expected $3;" >&2
        echo "its SHA-256 stands in setup/meshes.sha256" >&2
        exit 4
    fi
    mv "$1" "$2"
    echo "==> $2"
}

# crate_folder NAME: the folder of the source of a crate that gnomon depends on; downloads it if need be.
crate_folder() {
    host=$(rustc -vV | awk '/^host:/ { print $2 }')
    "${CARGO:-cargo}" metadata --format-version 1 --locked --filter-platform "$host" >"$work/metadata.json"
    python3 -c '
import json, os, sys
for package in json.load(open(sys.argv[1]))["packages"]:
    if package["name"] == sys.argv[2]:
        print(os.path.dirname(package["manifest_path"]))' "$work/metadata.json" "$1"
}

# download PACKAGE: its .deb into the work folder. apt's sandbox user could not write there.
download() {
    (cd "$work" && apt-get download -qq -o APT::Sandbox::User=root "$1")
}

# The bunny as the installed package has it, or out of the package alone: glmark2 itself is not needed.
bunny() {
    model=usr/share/glmark2/models/bunny.obj
    if [ -f "/$model" ]; then
        cp "/$model" "$work/bunny.obj"
        return
    fi
    if ! command -v apt-get >/dev/null; then
        echo "no apt-get here: please put Debian's glmark2-data in place, so that /$model exists" >&2
        exit 3
    fi
    if ! download glmark2-data 2>/dev/null; then # package lists missing or out of date
        "$setup/apt.sh"
        download glmark2-data
    fi
    dpkg-deb --extract "$work"/glmark2-data_*.deb "$work/glmark2-data"
    mv "$work/glmark2-data/$model" "$work/bunny.obj"
}

kitchen() {
    command -v zstd >/dev/null || "$setup/apt.sh" zstd
    assets=$(crate_folder obvhs)/assets
    zstd --decompress --quiet --stdout "$assets/kitchen.obj.zst" >"$work/kitchen.obj"
    cp "$assets/kitchen.mtl" "$work/kitchen.mtl"
}

mkdir -p out
work=$(mktemp -d out/meshes.XXXXXX)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

if ! intact scenes/kitchen/kitchen.obj || ! intact scenes/kitchen/kitchen.mtl; then
    kitchen
    place "$work/kitchen.mtl" scenes/kitchen/kitchen.mtl 0
    place "$work/kitchen.obj" scenes/kitchen/kitchen.obj 56939
fi
if ! intact scenes/bunny/bunny.obj; then
    bunny
    place "$work/bunny.obj" scenes/bunny/bunny.obj 69666
fi
