#!/bin/sh
# Usage: setup/apt.sh [PACKAGE...]
# Installs Debian packages as root or through sudo; without any package it only refreshes the package lists.
# Where it may not, it names what a person has to do and exits 3.
set -eu

if ! command -v apt-get >/dev/null; then
    echo "no apt-get here: please install the equivalent of these Debian packages: $*" >&2
    exit 3
fi

root=
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "this needs root, please run: apt-get update${1:+ && apt-get install -y --no-install-recommends $*}" >&2
        exit 3
    fi
    root=sudo
fi

$root apt-get update -qq
[ $# -eq 0 ] || $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"
