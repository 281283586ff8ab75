#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy, with the rules of .clang-tidy, on all kernels and filters or on the sources named.
#   Testing/Tools/tidy.sh [SOURCE...]
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-ci.txt
# configured is enough: no header of these sources is made by the build
lacuna_configure release
sources=("$@")
if [ ${#sources[@]} = 0 ]; then
  mapfile -t sources < <(git ls-files 'Filters/*.cxx' 'Readers/*.cxx' 'Sources/*.cxx' | grep -v /Testing/)
fi
failed=0
# warnings of the compiler are GCC's, which knows attributes that clang does not
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -n 4 clang-tidy-14 --quiet -p build/release --extra-arg=-Wno-error 2>&1 |
  grep -v ' warnings\? generated' || failed=${PIPESTATUS[1]}
echo "clang-tidy: ${#sources[@]} sources"
[ "$failed" = 0 ] || { echo "clang-tidy: findings, see above" >&2; exit 1; }
