#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up everything on a Debian 12 machine, builds, and makes both surfaces: one from freehand
# ultrasound slices, one that fills the hole in a skull. ./demo.sh --help says all.
set -euo pipefail
top=$(cd "$(dirname "$0")" && pwd)
for argument in "$@"; do
  if [ "$argument" = --help ] && command -v python3 >/dev/null; then
    exec python3 "$top/Plugins/Python/lacuna/demo.py" --help
  fi
done
(cd "$top" && . Testing/Tools/setup.sh && lacuna_install_packages && lacuna_build release)
. "$top/Testing/Tools/setup.sh"
. "$top/build/release/lacuna-env.sh"
lacuna_display pvpython --force-offscreen-rendering -- -m lacuna.demo "$@"
