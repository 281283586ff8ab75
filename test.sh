#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up everything on a Debian 12 machine, builds and runs the tests: all but the examples of the
# documentation, and those that take long (label soak); or what ctest's options select.
#   ./test.sh [--preset NAME] [--target NAME] [ctest options]
#   ./test.sh -L example                               the examples
# Presets: release debug asan tsan vtk kernels; the target is what to build, if not all.
set -euo pipefail
cd "$(dirname "$0")"
. Testing/Tools/setup.sh
preset=release target=all
if [ "${1:-}" = --preset ]; then preset=$2; shift 2; fi
if [ "${1:-}" = --target ]; then target=$2; shift 2; fi
excluded=soak
if [ $# = 0 ]; then excluded='soak|example'; fi
lacuna_install_packages
lacuna_build "$preset" --target "$target"
lacuna_display ctest --preset "$preset" -j2 -LE "$excluded" "$@"
