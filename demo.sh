#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up everything on a Debian machine, builds, and makes both surfaces: one from freehand
# ultrasound slices, one that fills the hole in a skull; --live acquires from emulated devices.
# ./demo.sh --help says all.
set -euo pipefail
top=$(cd "$(dirname "$0")" && pwd)
for argument in "$@"; do
  if [[ $argument = --help || $argument = -h ]] && command -v python3 >/dev/null; then
    exec python3 "$top/Plugins/Python/lacuna/demo.py" --help
  fi
done
(cd "$top" && . Testing/Tools/setup.sh && lacuna_install_packages packages-debian.txt &&
  lacuna_build release --target LacunaForUsers)
. "$top/Testing/Tools/setup.sh"
. "$top/build/release/lacuna-env.sh"
case " $* " in
  *" --live "*) ;;
  *)
    lacuna_display pvpython --force-offscreen-rendering -- -m lacuna.demo "$@"
    exit
    ;;
esac
offscreen=""
case "${DISPLAY:-none} $* " in
  none\ * | *" --offscreen "*) offscreen=--force-offscreen-rendering ;;
esac
# for the emulated serial port (Documentation/UserGuide/emulated-devices.md); found in LD_LIBRARY_PATH, as
# LD_PRELOAD takes no folders with blanks
lacuna_display env LD_PRELOAD="libLacunaPseudoTerminalPorts.so${LD_PRELOAD:+:$LD_PRELOAD}" \
  pvpython $offscreen -- -m lacuna.demo "$@"
