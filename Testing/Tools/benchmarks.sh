#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what the benchmarks and their peers need, builds, and runs all of them, on a machine that is
# left alone: Testing/Benchmarks/run.py, whose options follow.
#   Testing/Tools/benchmarks.sh [--quick] [--only NAME] ...
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-benchmarks.txt
mkdir -p build
cmake --preset release -DLACUNA_BENCHMARK_CGAL=ON >build/release.log # also looks for peers that are new
lacuna_build release
exec /usr/bin/python3 Testing/Benchmarks/run.py "$@" # the Python of the packages
