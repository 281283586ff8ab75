#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs, uses and purges the Debian packages beside this script (Testing/Tools/chroot.sh FOLDER
# package runs it in a clean Debian, as root).
#   check.sh VERSION      beside it: lacuna*.deb, installed.py, in_window.py, 18-embedding/, kernels/, and, to be
#                         tried as well, the unpacked archive in archive/, and README.md, of which the script is run
set -euo pipefail
cd "$(dirname "$0")"
version=$1
tools="cmake g++ make xvfb xauth libgl1-mesa-dri"
install() { apt-get -y -qq install --no-install-recommends "$@" >/dev/null; }
installed() { dpkg-query -W -f '${Package} ${db:Status-Abbrev}\n' "$@" 2>/dev/null | sed -n '/ un *$/!s/ .*//p'; }
purge() {
  mapfile -t there < <(installed lacuna lacuna-dev lacuna-doc)
  [ ${#there[@]} = 0 ] || apt-get -y -qq purge "${there[@]}" >/dev/null
}
# nor what came with them, though something that stays may recommend it
drop() {
  mapfile -t there < <(installed "$@")
  [ ${#there[@]} = 0 ] || apt-mark auto "${there[@]}" >/dev/null
  apt-get -y -qq -o APT::AutoRemove::RecommendsImportant=false -o APT::AutoRemove::SuggestsImportant=false autoremove --purge >/dev/null
}
# as it was, so that the next run sees what is missing among the dependencies; also when this one failed
needed=()
clean() {
  purge
  drop $tools "${needed[@]}"
}
files() {
  find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /var/tmp -o -path /run -o -path /root \
    -o -path /home -o -path /var/lib/apt -o -path /var/lib/dpkg/info -o -path /var/cache -o -path /var/log \
    -o -path "$PWD" -o -path /ccache \) -prune -o -print | sort
}
as_user() { (cd "$work" && setpriv --reuid=nobody --regid=nogroup --clear-groups env HOME="$work" "$@"); }
# ParaView draws off screen, too, on a display
on_display() { as_user timeout 300 xvfb-run -a -s -noreset "$@"; }
clean
work=$(mktemp -d)
trap 'clean; rm -rf "$work"' EXIT
cp -r 18-embedding kernels installed.py in_window.py "$work"
chown -R nobody "$work"
apt-get -qq update

archive=
if [ -d archive ]; then
  echo "== the archive, without ParaView and with another"
  cp -r archive/lacuna-* "$work"
  archive=$(cd "$work" && echo lacuna-*/)
  refused() { # what it says begins with the ParaView that it fits
    if as_user bash -c "$2 . ./${archive}lacuna-env.sh" 2>"$work/refused"; then
      echo "it was not refused. Is a ParaView left here by an interrupted run? Then make the folder anew"
      exit 1
    fi
    cat "$work/refused"
    grep -q "^This Lacuna $version fits ParaView .*$1" "$work/refused"
  }
  refused "There is no pvpython here" ""
  mkdir "$work/other"
  printf '#!/bin/sh\necho paraview version 9.9.9\n' >"$work/other/pvpython"
  chmod +x "$work/other/pvpython"
  refused "Here is ParaView 9.9.9: get the archive for this version" "export PATH=\$PWD/other:\$PATH;"
fi

echo "== what lacuna depends on, without it"
mapfile -t needed < <(apt-get -s install --no-install-recommends ./lacuna*_"$version"-*.deb | sed -n 's/^Inst \([^ ]*\).*/\1/p' | grep -v '^lacuna')
[ ${#needed[@]} = 0 ] || install "${needed[@]}"
files >"$work/alone"
if [ -n "$archive" ]; then
  echo "== the archive, with the packages that its README names"
  install $(sed -n 's/.*`apt install \(.*\)`.*/\1/p' "$work/$archive/README.md")
  awk '/^```python/ { inside = 1; next } /^```/ && inside { exit } inside' README.md >"$work/readme.py"
  as_user bash -c ". ./${archive}lacuna-env.sh && pvpython --force-offscreen-rendering readme.py && python3 -c 'import lacuna; lacuna.vtkLacunaSkullPhantom().Update()'"
  test "$(stat -c %s "$work/implant.igs")" -gt 10000
  rm "$work/implant.igs"
  files | diff "$work/alone" -
fi

echo "== lacuna alone, with what it depends on"
install ./lacuna_"$version"-*.deb
as_user pvpython --force-offscreen-rendering installed.py "$version" "$work"
as_user python3 -c "import lacuna; lacuna.vtkLacunaSkullPhantom().Update(); print('installed: python3 works')"
as_user lacuna-fastrak-emulator --help >/dev/null
if find / -xdev -name '*.conffiles' -name 'lacuna*' | grep .; then exit 1; fi

echo "== lacuna-dev: find_package(Lacuna)"
install ./lacuna-dev_"$version"-*.deb $tools
as_user cmake -S 18-embedding -B embedding >"$work/cmake.log" || { cat "$work/cmake.log"; exit 1; }
as_user cmake --build embedding >"$work/build.log" || { cat "$work/build.log"; exit 1; }
as_user embedding/Embedding "$work"
test "$(stat -c %s "$work/embedding.igs")" -gt 10000
as_user cmake -S kernels -B of-kernels >"$work/cmake.log" || { cat "$work/cmake.log"; exit 1; }
as_user cmake --build of-kernels >"$work/build.log" || { cat "$work/build.log"; exit 1; }
as_user of-kernels/Kernels "$work/calibration.xml"

echo "== both jobs, from slices and from CT"
on_display pvpython --force-offscreen-rendering -- -m lacuna.demo --output demo >"$work/demo.log" 2>&1 || { cat "$work/demo.log"; exit 1; }
for file in surface.stl implant.igs report.md; do test -s "$work/demo/$file"; done

echo "== in ParaView's window"
# --dr: without the window of welcome, which ParaView 6.1 opens while the script works, and waits for an answer
on_display paraview --dr --script=in_window.py >"$work/window.log" 2>&1 || cat "$work/window.log"
grep -x works "$work/in_window.txt"

echo "== removal"
purge
files >"$work/before"
install ./lacuna*_"$version"-*.deb
examples=/usr/share/doc/lacuna-doc/examples
test -e $examples/README.md
for script in 15-occluded-angle-2d/occluded_angle_2d 04-calibration/error_budget; do
  on_display pvpython --force-offscreen-rendering $examples/$script.py >"$work/example.log" 2>&1 || { cat "$work/example.log"; exit 1; }
done
if [ -e $examples/../html ]; then
  for page in $examples/README.md $examples/*/README.md; do
    for target in $(grep -o '](\.\.[^)#]*' "$page" | cut -c3-); do
      test -e "$(dirname "$page")/$target" || { echo "$page: nothing at $target"; exit 1; }
    done
  done
fi
python3 -m compileall -q $examples/04-calibration # as root's runs of examples with modules of their own
python3 -c 'import lacuna.plugin, lacuna.pictures' # as root, who may write beside the modules
pvpython --force-offscreen-rendering installed.py "$version" "$work" >/dev/null
changed=$(dpkg --verify lacuna lacuna-dev lacuna-doc)
test -z "$changed" || { echo "$changed"; exit 1; }
purge
files >"$work/after"
diff "$work/before" "$work/after"
if grep -i -e lacuna -e '/usr/bin/paraview\.conf$' "$work/after"; then exit 1; fi
if find /var/cache /var/log /var/lib/dpkg/info -iname '*lacuna*' | grep .; then exit 1; fi
drop $tools
files | diff "$work/alone" -

echo "packages: installed, used and removed without a trace"
