#!/bin/sh
# Makes sure that there is a Chromium, in which the tests open report.html: installs Debian's where none answers.
set -eu

for browser in chromium chromium-browser google-chrome; do
    if command -v "$browser" >/dev/null; then
        exit 0
    fi
done

echo "==> no Chromium: installing Debian's, for the tests of report.html"
exec "$(dirname "$0")/apt.sh" chromium
