#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Counts the production sources that a slice passes on its way from the file to a volume, and a CT on its way to IGES:
# those of which gcov says that lines ran. Builds the modules without optimisation for it (build/walk).
#   Testing/Tools/walk.sh [--list]     --list: names the sources, too
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-ci.txt
cmake -S . -B build/walk -G Ninja -DCMAKE_BUILD_TYPE=Debug -DLACUNA_COVERAGE=ON -DBUILD_TESTING=OFF \
  -DLACUNA_WITH_PARAVIEW=OFF -DLACUNA_WRAP_PYTHON=OFF >/dev/null
cmake --build build/walk --target LacunaWalk
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
walk=$(find build/walk -name LacunaWalk -type f)
"$walk" files "$work"
for way in slice CT; do
  find build/walk -name '*.gcda' -delete
  "$walk" "$way" "$work"
  gcovr --root . --object-directory build/walk --gcov-ignore-parse-errors -j "$(nproc)" \
    --filter '(Filters|Readers|Sources)/' --exclude '.*/Testing/.*' --json-summary "$work/$way.json" build/walk
  python3 - "$work/$way.json" "$way" "$@" <<'END'
import json
import sys
with open(sys.argv[1], encoding="utf-8") as file:
    files = json.load(file)["files"]
ran = sorted(entry["filename"] for entry in files if entry["line_covered"])
lines = sum(entry["line_covered"] for entry in files)
print(f"{sys.argv[2]}: {len(ran)} sources with lines that ran, {lines} lines")
if "--list" in sys.argv:
    print(*ran, sep="\n")
END
done
