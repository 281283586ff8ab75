#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up a Debian machine, builds, and runs the default tests. These leave out the labels system (several
# processes and ParaView's windows), example (demo.sh and the examples of the documentation) and soak (long).
#   ./test.sh [--preset NAME] [--target NAME] [--all] [ctest options]
#   ./test.sh --all                   everything but soak
#   ./test.sh -L system               what ctest's options -L and -R select, of all labels but soak
#   ./test.sh -L soak                 the long tests
# Presets: release debug asan[-paraview] tsan[-paraview] vtk kernels clang fuzz. Target: build this only.
set -euo pipefail
cd "$(dirname "$0")"
. Testing/Tools/setup.sh
preset=release target=all
soak=soak apart='|example|system' others='' options=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) sed -n '3,9s/^# \?//p' "$0"; exit ;;
    --preset) preset=${2:?preset}; shift 2; continue ;;
    --target) target=${2:?target}; shift 2; continue ;;
    --all) apart=''; shift; continue ;;
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
# one for each core, and one that mostly waits (lacuna_tests_in_real_time)
lacuna_display ctest --preset "$preset" -j3 -LE "$soak$apart$others" --no-tests=error "${options[@]}"
