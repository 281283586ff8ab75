#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tries the project on a machine that has nothing: a minimal Debian in a folder (root only).
#   Testing/Tools/chroot.sh FOLDER fresh           ./demo.sh twice (how long each takes), then all tests but
#                                                  soak, in a clean clone, as a newcomer runs them
#   Testing/Tools/chroot.sh FOLDER demo            only ./demo.sh, twice
#   Testing/Tools/chroot.sh FOLDER vtk [SUITE]     modules only, against the VTK of that Debian:
#                                                  bookworm (9.1, the default), trixie (9.3), sid
#   Testing/Tools/chroot.sh FOLDER package         installs, uses and purges build/package/lacuna*.deb
#                                                  (Testing/Tools/package.sh makes them)
# FOLDER is made by debootstrap (package debootstrap; DEBIAN_MIRROR) when it does not exist: about
# 0.4 GB, 3 GB when all is installed. Options of the configuration: LACUNA_CMAKE_OPTIONS. When
# CCACHE_DIR is set, the compiler's results are kept there.
# Debian's VTK and ParaView's Python cannot share a system: use one folder for each, and for each SUITE.
set -euo pipefail
[[ ${2:-} =~ ^(demo|fresh|vtk|package)$ ]] || { sed -n '3,15s/^# \?//p' "$0" >&2; exit 2; }
folder=$1
what=$2
suite=${3:-bookworm}
source=$(cd "$(dirname "$0")/../.." && pwd)
data=$(realpath -m "${LACUNA_TEST_DATA:-$source/../shared/data}")

if [ ! -x "$folder/bin/bash" ]; then
  debootstrap --variant=minbase "$suite" "$folder" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}"
fi
if [ "$what" = vtk ] && ! grep -qw "$suite" "$folder/etc/os-release"; then
  echo "$0: $folder is another Debian than $suite" >&2
  exit 2
fi
cp /etc/resolv.conf "$folder/etc/resolv.conf"
# a mirror may lag behind, and a folder to try things in need not survive a power failure
printf '%s\n' 'Acquire::Check-Valid-Until "false";' 'DPkg::Options { "--force-unsafe-io"; };' \
  >"$folder/etc/apt/apt.conf.d/80-tried"

bind() { mkdir -p "$folder/$2"; mountpoint -q "$folder/$2" || mount --bind "$1" "$folder/$2"; }
release() {
  for target in proc sys dev/pts dev ccache; do
    if mountpoint -q "$folder/$target"; then umount -l "$folder/$target"; fi
  done
}
trap release EXIT
bind /proc proc
bind /sys sys # libserialport looks for ports there
bind /dev dev
bind /dev/pts dev/pts # tests make pseudo-terminals
variables=(PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root
  DEBIAN_FRONTEND=noninteractive LACUNA_TEST_DATA=/data)
launcher=
if [ -n "${CCACHE_DIR:-}" ] && [ "$what" != package ]; then
  bind "$CCACHE_DIR" ccache
  launcher=ccache
  variables+=(CCACHE_DIR=/ccache CCACHE_BASEDIR=/lacuna CCACHE_NOHASHDIR=1
    CCACHE_SLOPPINESS=pch_defines,time_macros
    CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
inside() { chroot "$folder" env -i "${variables[@]}" bash -ec "$1"; }
inside 'dpkg --configure -a' # where an earlier run was interrupted
if [ "$what" != package ]; then
  rm -rf "$folder/lacuna"
  git clone -q "$source" "$folder/lacuna"
  mkdir -p "$folder/data"
  if [ -d "$data" ]; then cp -r "$data/." "$folder/data/"; fi
fi

case $what in
  demo)
    inside 'cd /lacuna && time ./demo.sh && time ./demo.sh'
    ;;
  fresh)
    inside 'cd /lacuna && time ./demo.sh && time ./demo.sh && ./test.sh && ./test.sh -L "system|example"'
    ;;
  vtk)
    inside 'apt-get -qq update'
    packages=$launcher
    for package in $(grep -hv -e '^#' -e paraview -e openmpi -e occt "$source"/Testing/Tools/packages-{debian,tests}.txt); do
      if inside "apt-cache show $package >/dev/null 2>&1"; then
        packages+=" $package"
      else
        echo "not in $suite: $package"
      fi
    done
    # without precompiled headers: those of another VTK may include less
    inside "apt-get -y -qq install --no-install-recommends libvtk9-dev $packages >/dev/null
      cd /lacuna
      cmake --preset vtk -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON ${LACUNA_CMAKE_OPTIONS:-}
      cmake --build --preset vtk -- -k 0
      xvfb-run -a -s -noreset ctest --preset vtk --no-tests=error -LE soak"
    ;;
  package)
    version=$(sed -n 's/^project(Lacuna VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
    rm -rf "$folder/packages"
    cp -r "$source/Testing/Package" "$folder/packages"
    cp -r "$source/Documentation/Examples/18-embedding" "$source/Testing/Embedding/kernels" \
      "$source/build/package"/lacuna*.deb "$folder/packages"
    inside "/packages/check.sh $version"
    ;;
esac
