#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tries the project on a machine that has nothing: a minimal Debian in a folder (root only).
#   Testing/Tools/chroot.sh FOLDER fresh           ./demo.sh twice (how long each takes), then all tests but
#                                                  soak, in a clean clone, as a newcomer runs them
#   Testing/Tools/chroot.sh FOLDER demo            only ./demo.sh, twice
#   Testing/Tools/chroot.sh FOLDER paraview SUITE [OPTION...]
#                                                  builds what users need against the ParaView of that Debian:
#                                                  bookworm (5.11), trixie (5.13), sid; runs the demo and the
#                                                  script of README. Then ./test.sh OPTION..., for instance --all.
#                                                  Writes build/compatibility/SUITE.json (compatibility.py).
#   Testing/Tools/chroot.sh FOLDER vtk [SUITE]     modules only, against the VTK of that Debian:
#                                                  bookworm (9.1, the default), trixie (9.3), sid
#   Testing/Tools/chroot.sh FOLDER make SUITE      makes the packages and the archive of that Debian, into
#                                                  build/packages/SUITE (package.sh, archive.sh)
#   Testing/Tools/chroot.sh FOLDER package [SUITE] installs, uses and purges them; without SUITE those of
#                                                  build/package, which Testing/Tools/package.sh makes
# FOLDER is made by debootstrap (package debootstrap; DEBIAN_MIRROR) when it does not exist: about
# 0.4 GB, 3 GB when all is installed. Options of the configuration: LACUNA_CMAKE_OPTIONS. When
# CCACHE_DIR is set, the compiler's results are kept there.
# Debian's VTK and ParaView's Python cannot share a system: use one folder for each, and for each SUITE.
set -euo pipefail
[[ ${2:-} =~ ^(demo|fresh|paraview|vtk|make|package)$ ]] || { sed -n '3,24s/^# \?//p' "$0" >&2; exit 2; }
folder=$1
what=$2
suite=${3:-bookworm}
tests=("${@:4}")
source=$(cd "$(dirname "$0")/../.." && pwd)
data=$(realpath -m "${LACUNA_TEST_DATA:-$source/../shared/data}")

if [ ! -x "$folder/bin/bash" ]; then
  debootstrap --variant=minbase "$suite" "$folder" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}"
fi
if ! grep -qw "$suite" "$folder/etc/os-release"; then
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
  if [[ ! $what =~ ^(paraview|make)$ ]]; then rm -rf "$folder/lacuna"; fi
  if [ ! -d "$folder/lacuna" ]; then git clone -q "$source" "$folder/lacuna"; fi
  git -C "$folder/lacuna" fetch -q "$source" HEAD
  git -C "$folder/lacuna" reset -q --hard FETCH_HEAD
  # of "make", when it was interrupted: without tests
  if grep -qs '^LACUNA_DEBIAN:BOOL=ON' "$folder/lacuna/build/release/CMakeCache.txt"; then
    rm "$folder/lacuna/build/release/CMakeCache.txt"
  fi
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
  paraview)
    record="python3 Testing/Tools/compatibility.py record --suite $suite"
    inside "apt-get -qq update && apt-get -y -qq install --no-install-recommends git $launcher >/dev/null
      cd /lacuna
      rm -rf demo-output build/compatibility
      [ -e build/release/CMakeCache.txt ] || rm -f build/release/build.ninja
      ./demo.sh
      awk '/^\`\`\`python/ { inside = 1; next } /^\`\`\`/ && inside { exit } inside' README.md >build/readme.py
      . build/release/lacuna-env.sh
      cd build && xvfb-run -a pvpython --force-offscreen-rendering readme.py && test -s implant.igs
      cd .. && $record --demo"
    failed=0
    if [ ${#tests[@]} != 0 ]; then
      inside "cd /lacuna && ./test.sh ${tests[*]@Q} --output-junit ../compatibility/tests.xml" || failed=1
      inside "cd /lacuna && $record --demo --tests ${tests[*]@Q}"
    fi
    mkdir -p "$source/build/compatibility"
    cp "$folder/lacuna/build/compatibility/$suite.json" "$source/build/compatibility"
    exit $failed
    ;;
  vtk)
    inside 'apt-get -qq update'
    packages=$launcher
    . "$source/Testing/Tools/setup.sh"
    codename=$(sed -n 's/^VERSION_CODENAME=//p' "$folder/etc/os-release")
    for package in $(lacuna_packages "$codename" "$source"/Testing/Tools/packages-{debian,tests}.txt | grep -v -e paraview -e openmpi -e occt); do
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
  make)
    if [ ! -d "$source/build/site/html" ]; then
      echo "$0: lacuna-doc needs the site: run Documentation/build-site.sh first" >&2
      exit 2
    fi
    mkdir -p "$folder/lacuna/build/site"
    rm -rf "$folder/lacuna/build/site/html"
    cp -r "$source/build/site/html" "$folder/lacuna/build/site/html"
    inside "cd /lacuna && Testing/Tools/archive.sh && Testing/Tools/package.sh --no-site --in build/release"
    rm "$folder/lacuna/build/release/CMakeCache.txt" # the next run configures it anew
    packages=$source/build/packages/$suite
    rm -rf "$packages"
    mkdir -p "$packages"
    cp "$folder"/lacuna/build/package/lacuna*.deb "$folder"/lacuna/build/archive/lacuna*.tar.xz "$packages"
    ;;
  package)
    packages=$source/build/package
    shopt -s nullglob # there may be no archive
    if [ -n "${3:-}" ]; then packages=$source/build/packages/$suite; fi
    version=$(sed -n 's/^project(Lacuna VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
    rm -rf "$folder/packages"
    cp -r "$source/Testing/Package" "$folder/packages"
    cp -r "$source/Documentation/Examples/18-embedding" "$source/Testing/Embedding/kernels" \
      "$packages"/lacuna*.deb "$source/README.md" "$folder/packages"
    for archive in "$packages"/lacuna*.tar.xz; do
      mkdir "$folder/packages/archive"
      tar -C "$folder/packages/archive" -xJf "$archive"
    done
    inside "/packages/check.sh $version"
    ;;
esac
