#!/bin/sh
# Installs Mitsuba and what checks the oracle into oracle/.venv, exactly as locked in oracle/requirements.txt. What is
# there and matches the lock is left alone, without network. A libLLVM makes Mitsuba fast; without one it runs as well.
set -eu

setup=$(cd "$(dirname "$0")" && pwd)
cd "$setup/.."
venv=oracle/.venv
lock=$venv/installed-requirements.txt

# The newest libLLVM of 17 or later: older ones abort Mitsuba. Where apt has none, the scalar variant does.
has_llvm() {
    ldconfig -p 2>/dev/null | grep -Eq 'libLLVM(-|\.so\.)(1[7-9]|2[0-9])'
}
if ! has_llvm && command -v apt-cache >/dev/null; then
    [ -n "$(apt-cache search --names-only '^libllvm19$')" ] || "$setup/apt.sh" || true
    if [ -n "$(apt-cache search --names-only '^libllvm19$')" ]; then
        "$setup/apt.sh" libllvm19 || echo "no libLLVM: Mitsuba will run in its slow scalar variant" >&2
    fi
fi

if [ ! -x "$venv/bin/python" ] || ! cmp -s oracle/requirements.txt "$lock"; then
    echo "==> installing Mitsuba into $venv"
    if ! python3 -c 'import ensurepip' 2>/dev/null; then
        "$setup/apt.sh" python3-venv
    fi
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --require-hashes --only-binary :all: \
        -r oracle/requirements.txt
    # The package itself is used where it lies.
    site=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
    (cd oracle && pwd) >"$site/gnomon_oracle.pth"
    cp oracle/requirements.txt "$lock"
fi
