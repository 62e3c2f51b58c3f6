#!/bin/sh
# Makes sure that rustfmt and clippy are there: a minimal Rust installation leaves them out.
set -eu

cargo=${CARGO:-cargo}
missing=
"$cargo" fmt --version >/dev/null 2>&1 || missing="rustfmt"
"$cargo" clippy --version >/dev/null 2>&1 || missing="$missing clippy"
[ -n "$missing" ] || exit 0

if ! command -v rustup >/dev/null; then
    echo "please install these Rust components: $missing" >&2
    exit 3
fi
echo "==> installing the Rust components $missing"
# shellcheck disable=SC2086 # one word per component
exec rustup component add $missing
