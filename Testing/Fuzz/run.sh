#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs all fuzz targets, one after the other, for SECONDS altogether:
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
each=$(((seconds + ${#targets[@]} - 1) / ${#targets[@]}))
findings=$PWD/build/fuzz/findings
mkdir -p "$findings"
failed=0
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target
  mkdir -p "$corpus"
  options=(-max_total_time="$each" -timeout=60 -rss_limit_mb=2048 -max_len=16384 -print_final_stats=1)
  if "build/fuzz/bin/Fuzz$target" "${options[@]}" -artifact_prefix="$findings/$target-" \
    "$corpus" "Testing/Fuzz/Corpus/$target" >"build/fuzz/$target.log" 2>&1; then
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "build/fuzz/$target.log")
    covered=$(grep -o ' cov: [0-9]*' "build/fuzz/$target.log" | tail -n 1)
    echo "$target: $runs inputs in $each s,$covered edges, nothing broken"
  else
    failed=1
    echo "$target: broken, see build/fuzz/$target.log and $findings"
    tail -n 30 "build/fuzz/$target.log"
  fi
done
exit $failed
