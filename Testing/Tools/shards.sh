#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a GoogleTest program several times at once, each time a part of its tests.
#   Testing/Tools/shards.sh NUMBER PROGRAM [ARGUMENT...]
set -uo pipefail
number=$1
shift
parts=()
folder=$(mktemp -d) || exit 1
trap 'kill "${parts[@]}" 2>/dev/null; rm -rf "$folder"' EXIT
trap 'exit 130' INT TERM
for ((i = 0; i < number; ++i)); do
  GTEST_TOTAL_SHARDS=$number GTEST_SHARD_INDEX=$i "$@" >"$folder/$i" 2>&1 &
  parts+=($!)
done
failed=0
for ((i = 0; i < number; ++i)); do
  wait "${parts[i]}" || failed=1
  cat "$folder/$i"
done
parts=() # none is left
exit $failed
