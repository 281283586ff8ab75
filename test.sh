#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up everything on a Debian 12 machine, builds and runs all tests.
#   ./test.sh [--preset NAME] [ctest options]      presets: release debug asan tsan vtk
set -euo pipefail
cd "$(dirname "$0")"
. Testing/Tools/setup.sh
preset=release
if [ "${1:-}" = --preset ]; then preset=$2; shift 2; fi
lacuna_install_packages
lacuna_build "$preset"
lacuna_display ctest --preset "$preset" -LE soak "$@"
