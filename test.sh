#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up everything on a Debian 12 machine, builds and runs the tests: all but those of several processes,
# demo.sh and the examples of the documentation, and those that take long (label soak), unless options of ctest
# (-L, -R) select them.
#   ./test.sh [--preset NAME] [--target NAME] [ctest options]
#   ./test.sh -L 'system|example'     ranks, servers and ParaView's windows; demo.sh and the examples
# Presets: release debug asan[-paraview] tsan[-paraview] vtk kernels clang fuzz; the target is what to build, if not all.
set -euo pipefail
cd "$(dirname "$0")"
. Testing/Tools/setup.sh
preset=release target=all
soak=soak apart='|example|system' others='' options=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) sed -n '3,8s/^# \?//p' "$0"; exit ;;
    --preset) preset=${2:?preset}; shift 2; continue ;;
    --target) target=${2:?target}; shift 2; continue ;;
    -LE) others+="|$2"; shift 2; continue ;; # ctest excludes only what all of several -LE match
    -L | -R)
      apart=''
      if [[ ${2:-} = *[sS]oak* ]]; then soak='^$'; fi # matches no label
      ;;
  esac
  options+=("$1")
  shift
done
lacuna_install_packages
if [[ $preset = clang || $preset = fuzz ]]; then lacuna_install_packages packages-fuzzing.txt; fi
lacuna_build "$preset" --target "$target"
lacuna_display ctest --preset "$preset" -j2 -LE "$soak$apart$others" --no-tests=error "${options[@]}"
