#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tries the project on a machine that has nothing: a minimal Debian 12 in a folder (root only).
#   Testing/Tools/chroot.sh FOLDER fresh     ./test.sh in a clean clone, as a newcomer runs it
#   Testing/Tools/chroot.sh FOLDER vtk       modules only, against Debian's own VTK 9.1
# FOLDER is made by debootstrap (package debootstrap; DEBIAN_MIRROR) when it does not exist: about
# 0.4 GB, 3 GB when all is installed.
# Debian's VTK and ParaView's Python cannot share a system: use one folder for each.
set -euo pipefail
folder=$1
what=$2
source=$(cd "$(dirname "$0")/../.." && pwd)
data=$(realpath -m "${LACUNA_TEST_DATA:-$source/../shared/data}")

if [ ! -x "$folder/bin/bash" ]; then
  debootstrap --variant=minbase bookworm "$folder" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}"
fi
cp /etc/resolv.conf "$folder/etc/resolv.conf"

bind() { mkdir -p "$folder/$2"; mountpoint -q "$folder/$2" || mount --bind "$1" "$folder/$2"; }
release() {
  for target in proc sys dev/pts dev; do
    if mountpoint -q "$folder/$target"; then umount -l "$folder/$target"; fi
  done
}
trap release EXIT
bind /proc proc
bind /sys sys # libserialport looks for ports there
bind /dev dev
bind /dev/pts dev/pts # tests make pseudo-terminals
rm -rf "$folder/lacuna"
git clone -q "$source" "$folder/lacuna"
mkdir -p "$folder/data"
if [ -d "$data" ]; then cp -r "$data/." "$folder/data/"; fi

case $what in
  fresh)
    chroot "$folder" env -i PATH="$PATH" HOME=/root LACUNA_TEST_DATA=/data \
      bash -ec 'cd /lacuna && ./test.sh && ./demo.sh'
    ;;
  vtk)
    packages=$(grep -v -e '^#' -e paraview -e openmpi -e occt "$source/Testing/Tools/packages-debian.txt" | tr '\n' ' ')
    chroot "$folder" env -i PATH="$PATH" HOME=/root DEBIAN_FRONTEND=noninteractive bash -ec "
      apt-get -qq update && apt-get -y -qq install --no-install-recommends libvtk9-dev $packages >/dev/null
      cd /lacuna && cmake --preset vtk -DLACUNA_TEST_DATA=/data && cmake --build --preset vtk
      xvfb-run -a -s -noreset ctest --preset vtk"
    ;;
  *)
    echo "usage: $0 FOLDER fresh|vtk" >&2
    exit 2
    ;;
esac
