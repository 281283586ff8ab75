#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs all fuzz targets for SECONDS altogether, one on each core at a time:
#   Testing/Fuzz/run.sh SECONDS [TARGET...]        e.g. Testing/Fuzz/run.sh 3600
# New inputs are collected in build/fuzz/corpus, those that break something in build/fuzz/findings
# (and the script fails). Put a finding, made small by -minimize_crash=1, into Testing/Fuzz/Corpus.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:?seconds}
shift
[ "$seconds" -gt 0 ] || { echo "$0: SECONDS must be positive" >&2; exit 2; } # to libFuzzer 0 is for ever
. Testing/Tools/setup.sh
lacuna_install_packages
lacuna_install_packages packages-fuzzing.txt
lacuna_build fuzz --target LacunaFuzzTargets
targets=("$@")
if [ ${#targets[@]} = 0 ]; then
  for program in build/fuzz/bin/Fuzz*; do targets+=("${program#build/fuzz/bin/Fuzz}"); done
fi
cores=$(nproc)
export each=$(((seconds * cores + ${#targets[@]} - 1) / ${#targets[@]}))
mkdir -p build/fuzz/findings
fuzz() {
  local log=build/fuzz/$1.log options
  options=(-max_total_time="$each" -timeout=60 -rss_limit_mb=2048 -max_len=16384 -print_final_stats=1)
  mkdir -p "build/fuzz/corpus/$1"
  if "build/fuzz/bin/Fuzz$1" "${options[@]}" -artifact_prefix="$PWD/build/fuzz/findings/$1-" \
    "build/fuzz/corpus/$1" "Testing/Fuzz/Corpus/$1" >"$log" 2>&1; then
    echo "$1: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs in $each s," \
      "$(grep -o ' cov: [0-9]*' "$log" | tail -n 1 | tr -dc 0-9) edges, nothing broken"
  else
    tail -n 30 "$log"
    echo "$1: broken, see $log and build/fuzz/findings"
    return 1
  fi
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P "$cores" -n 1 bash -c 'fuzz "$1"' fuzz
