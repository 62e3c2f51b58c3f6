#!/bin/sh
# Makes sure that there is a Vulkan driver: installs Mesa's, whose llvmpipe renders without a graphics card, when no
# driver is registered with the Vulkan loader. A driver that is there, of whatever kind, is left alone.
set -eu

[ "$(uname -s)" = Linux ] || exit 0 # elsewhere wgpu has Metal or Direct3D
[ -z "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ] || exit 0

for folder in /usr/share /usr/local/share /etc "${XDG_DATA_HOME:-${HOME:-}/.local/share}"; do
    for driver in "$folder"/vulkan/icd.d/*.json; do
        [ ! -e "$driver" ] || exit 0
    done
done

echo "==> no Vulkan driver: installing Mesa's software driver"
exec "$(dirname "$0")/apt.sh" mesa-vulkan-drivers
