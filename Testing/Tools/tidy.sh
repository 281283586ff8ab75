#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy, with the rules of .clang-tidy, on all kernels and filters, on the sources named, or on what
# the last COMMITS changed: sources, and of each header one source that includes it.
#   Testing/Tools/tidy.sh [--last COMMITS | SOURCE...]
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-ci.txt
# configured is enough: no header of these sources is made by the build
lacuna_configure tidy
ninja -C build/tidy build.ninja >build/tidy.log # again where sources came or went
all=$(git ls-files 'Filters/*.cxx' 'Readers/*.cxx' 'Sources/*.cxx' | grep -v /Testing/) # ends here without git
mapfile -t all <<<"$all"
changed() {
  git log --max-count="$1" --name-only --pretty= -- '*.cxx' '*.h' | sort -u | while read -r file; do
    case $file in
      *.cxx) echo "$file" ;;
      *.h) grep -lF "#include \"${file##*/}\"" "${all[@]}" | head -n 1 || true ;;
    esac
  done
}
case ${1:-} in
  '') sources=("${all[@]}") ;;
  --last)
    found=$(changed "${2:?commits}")
    mapfile -t sources < <(sort -u <<<"$found" | grep -xFf <(printf '%s\n' "${all[@]}"))
    ;;
  *) sources=("$@") ;;
esac
if [ ${#sources[@]} = 0 ]; then echo "clang-tidy: nothing changed"; exit 0; fi
failed=0
# warnings of the compiler are GCC's, which knows attributes that clang does not
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -n 4 clang-tidy-14 --quiet -p build/tidy --extra-arg=-Wno-error 2>&1 |
  grep -v ' warnings\? generated' || failed=${PIPESTATUS[1]}
echo "clang-tidy: ${#sources[@]} sources"
[ "$failed" = 0 ] || { echo "clang-tidy: findings, see above" >&2; exit 1; }
