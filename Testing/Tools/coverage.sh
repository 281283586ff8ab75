#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the kernels and their tests without VTK, counting which lines run, runs the tests and says
# how many lines of each kernel they reached. Fails below 90 % of all.
#   Testing/Tools/coverage.sh [ctest options]
# build/coverage/report/index.html shows each line.
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-ci.txt
lacuna_build coverage
find build/coverage -name '*.gcda' -delete # counts of earlier runs
lacuna_display ctest --preset coverage -j2 -LE soak "$@"
mkdir -p build/coverage/report
gcovr --root . --object-directory build/coverage --gcov-ignore-parse-errors -j "$(nproc)" \
  --filter '.*/Kernel/lacuna[A-Za-z0-9]*\.(h|cxx)$' --json build/coverage/coverage.json \
  --html-details build/coverage/report/index.html build/coverage
Testing/Tools/coverage.py build/coverage/coverage.json 90
