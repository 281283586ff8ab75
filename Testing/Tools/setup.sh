# SPDX-License-Identifier: BSD-3-Clause
# Shared by the scripts of the project (sourced from the top folder): installs what is missing, configures
# and builds. Each function says what failed and returns non-zero.

lacuna_fail() {
  echo "error: $1 failed: $2" >&2
  return 1
}

# Debian packages of a list beside this file (default: packages-debian.txt) that are not there yet.
lacuna_install_packages() {
  local wanted missing="" package as_root=""
  wanted=$(grep -v '^#' "Testing/Tools/${1:-packages-debian.txt}")
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
  $as_root apt-get -qq update &&
    $as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get -y -qq install --no-install-recommends $missing >/dev/null ||
    lacuna_fail "installing packages" "apt-get could not install$missing"
}

# lacuna_configure <preset>: into build/<preset>; does nothing when that is there, and not older than the presets.
lacuna_configure() {
  local preset=$1 log="build/$1.log"
  mkdir -p build
  if [ ! -f "build/$preset/build.ninja" ] || [ CMakePresets.json -nt "build/$preset/build.ninja" ]; then
    echo "== configuring ($preset)"
    cmake --preset "$preset" >"$log" 2>&1 ||
      { tail -n 30 "$log" >&2; lacuna_fail "configuring" "see $log"; return 1; }
  fi
}

# lacuna_build <preset> [options of cmake --build]: configures and builds into build/<preset>; does
# nothing when up to date.
lacuna_build() {
  local preset=$1 log="build/$1.log"
  shift
  lacuna_configure "$preset" || return 1
  echo "== building ($preset)"
  cmake --build --preset "$preset" "$@" >"$log" 2>&1 ||
    { grep -E -A8 -m 8 'error|FAILED' "$log" >&2 || tail -n 30 "$log" >&2; lacuna_fail "building" "see $log"; }
}

# lacuna_display <command>...: runs it with a display, a virtual one if there is none. -noreset: the
# server would otherwise restart whenever its last client leaves, and refuse one that comes just then.
lacuna_display() {
  if [ -n "${DISPLAY:-}" ]; then "$@"; else xvfb-run -a -s "-screen 0 1600x1200x24 -noreset" "$@"; fi
}
