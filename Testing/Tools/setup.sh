# SPDX-License-Identifier: BSD-3-Clause
# Shared by the scripts of the project (sourced from the top folder): installs what is missing, configures
# and builds. Each function says what failed and returns non-zero. They need the option pipefail.

lacuna_fail() {
  echo "error: $1 failed: $2" >&2
  return 1
}

# lacuna_say <text>: how far something is. On a terminal it rewrites one line, elsewhere (a log) it writes a
# line at most every 30 seconds.
lacuna_said=-30
lacuna_say() {
  if [ -t 1 ]; then
    printf '\r\033[K   %s' "$1"
  elif [ $((SECONDS - lacuna_said)) -ge 30 ]; then
    lacuna_said=$SECONDS
    printf '   %s\n' "$1"
  fi
}
lacuna_said_all() { if [ -t 1 ]; then printf '\r\033[K'; fi; }

# Reads what apt-get writes with APT::Status-Fd, and shows its percentages; the rest goes into a log.
lacuna_show_installing() {
  local log=$1 line
  while IFS= read -r line; do
    if [[ $line =~ ^(dl|pm)status:.*:([0-9]+)[.,][0-9]+:(.*) ]]; then
      case ${BASH_REMATCH[1]} in
        dl) lacuna_say "downloading, ${BASH_REMATCH[2]} %" ;;
        pm) lacuna_say "installing, ${BASH_REMATCH[2]} %: ${BASH_REMATCH[3]}" ;;
      esac
    else
      printf '%s\n' "$line" >>"$log"
    fi
  done
  lacuna_said_all
}

# lacuna_packages <suite> <list>...: the packages of lists that are for this version of Debian.
lacuna_packages() {
  local suite=$1
  shift
  sed -e '/^#/d' -e "s/ \[$suite\]\$//" -e "/ \[!$suite\]\$/d" -e 's/ \[!.*\]$//' -e '/ \[.*\]$/d' "$@"
}

# lacuna_install_packages [list...]: Debian packages of lists beside this file that are not there yet.
# Without a list: what users and tests need.
lacuna_install_packages() {
  local wanted missing="" package as_root="" log="build/packages.log" suite
  if [ $# = 0 ]; then set -- packages-debian.txt packages-tests.txt; fi
  suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
  wanted=$(lacuna_packages "$suite" "${@/#/Testing/Tools/}")
  for package in $wanted; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed ||
      missing="$missing $package"
  done
  [ -z "$missing" ] && return 0
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null ||
      { lacuna_fail "installing packages" "as root, run: apt-get install$missing"; return 1; }
    as_root=sudo
  fi
  echo "== installing$missing"
  mkdir -p build
  : >"$log"
  if ! { $as_root apt-get -qq update &&
    $as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get -y -q -o APT::Status-Fd=1 install --no-install-recommends $missing; } 2>&1 |
    lacuna_show_installing "$log"; then
    tail -n 15 "$log" >&2
    lacuna_fail "installing packages" "apt-get could not install$missing; see $log"
  fi
}

# lacuna_configure <preset>: into build/<preset>; does nothing when that is there, and newer than the presets and
# than the last change of the machine's packages (what was not found before may be there now).
lacuna_configure() {
  local preset=$1 log="build/$1.log" made="build/$1/build.ninja"
  mkdir -p build
  if [ ! -f "$made" ] || [ CMakePresets.json -nt "$made" ] || [ /var/lib/dpkg/status -nt "$made" ]; then
    echo "== configuring ($preset)"
    cmake --preset "$preset" >"$log" 2>&1 ||
      { tail -n 30 "$log" >&2; lacuna_fail "configuring" "see $log"; return 1; }
    touch "$made"
  fi
}

# Reads what ninja writes, keeps it in a log, and shows the steps and the minutes left. Sources of C++ take
# nearly all the time: the estimate counts only these, of which the second argument says how many there are.
lacuna_show_building() {
  local log=$1 sources=$2 start=$SECONDS compiled=0 line text elapsed left
  : >"$log"
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (.*) ]] || continue
    text="step ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}"
    if [[ ${BASH_REMATCH[3]} = Building\ C* ]]; then compiled=$((compiled + 1)); fi
    elapsed=$((SECONDS - start))
    if [ "$elapsed" -ge 20 ] && [ "$compiled" -ge 10 ] && [ "$sources" -ge "$compiled" ]; then
      left=$((elapsed * (sources - compiled) / compiled))
      if [ "$left" -ge 60 ]; then
        text+=", about $(((left + 59) / 60)) min left"
      else
        text+=", less than a minute left"
      fi
    fi
    lacuna_say "$text"
  done
  lacuna_said_all
}

# lacuna_build <preset> [options of cmake --build]: configures and builds into build/<preset>; does
# nothing when up to date.
lacuna_build() {
  local preset=$1 log="build/$1.log" sources
  shift
  lacuna_configure "$preset" || return 1
  echo "== building ($preset)"
  # a dry run: ninja says what it would do
  sources=$(cmake --build --preset "$preset" "$@" -- -n 2>/dev/null | grep -c '\] Building C') || true
  if ! cmake --build --preset "$preset" "$@" 2>&1 | lacuna_show_building "$log" "$sources"; then
    grep -E -A8 -m 8 'error|FAILED' "$log" >&2 || tail -n 30 "$log" >&2
    lacuna_fail "building" "see $log"
  fi
}

# Debian 12's OpenBLAS takes processors that came after it for ones of 2004: equations are solved at a third of the
# speed, and those at the limit of round-off worse. What this process starts uses the kernels of 2013 then.
lacuna_choose_blas() {
  if [ -z "${OPENBLAS_CORETYPE:-}" ] && grep -qw avx2 /proc/cpuinfo 2>/dev/null && python3 - <<'END' 2>/dev/null; then
import ctypes
blas = ctypes.CDLL("libopenblas.so.0")
blas.openblas_get_corename.restype = ctypes.c_char_p
raise SystemExit(blas.openblas_get_corename() != b"Prescott")
END
    export OPENBLAS_CORETYPE=Haswell
  fi
}

# lacuna_display <command>...: runs it with a display, a virtual one if there is none. -noreset: the
# server would otherwise restart whenever its last client leaves, and refuse one that comes just then.
lacuna_display() {
  lacuna_choose_blas
  if [ -n "${DISPLAY:-}" ]; then "$@"; else xvfb-run -a -s "-screen 0 1600x1200x24 -noreset" "$@"; fi
}
