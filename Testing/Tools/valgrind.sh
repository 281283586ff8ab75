#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a sample of the tests under Valgrind's memcheck: what the sanitizers cannot see, memory that was
# never written, also where VTK reads it.
#   Testing/Tools/valgrind.sh [--preset NAME] [CASES]      default: release, 20 cases, fewer of dear filters
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
preset=release
if [ "${1:-}" = --preset ]; then preset=$2; shift 2; fi
lacuna_install_packages
lacuna_install_packages packages-valgrind.txt
lacuna_build "$preset" --target LacunaProperties
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
check() {
  echo "== $*"
  valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite \
    --errors-for-leak-kinds=definite --track-origins=yes --num-callers=25 "$@"
}
bin=build/$preset/bin
check "$bin/LacunaProperties" outcome --count "${1:-20}" --output "$work"
check "$bin/LacunaProperties" abort --count "${1:-20}" --output "$work"
