#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes build/archive/lacuna-VERSION-paraviewVERSION-SYSTEM-ARCHITECTURE.tar.xz of build/release: plugins, Python
# package, macros, examples and pages in a folder that can be anywhere. Its lacuna-env.sh refuses another ParaView.
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages packages-debian.txt packages-packaging.txt
lacuna_build release --target LacunaForUsers
version=$(sed -n 's/^project(Lacuna VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
paraview=$(pvpython --version | sed 's/.* //')
system=$(. /etc/os-release && echo "$PRETTY_NAME")
short=$(. /etc/os-release && echo "$ID${VERSION_ID:-$VERSION_CODENAME}")
name=lacuna-$version-paraview$paraview-$short-$(dpkg --print-architecture)
folder=$PWD/build/archive/$name
rm -rf build/archive
for component in runtime python Unspecified; do
  cmake --install build/release --prefix "$folder" --component "$component" --strip >/dev/null
done
find "$folder" -name '*.a' -delete # wrappings that the plugin has linked
pages=$folder/share/doc/lacuna
cp -r Documentation/Examples "$pages/examples"
if [ -d build/site/html ]; then cp -r build/site/html "$pages"; else cp -r Documentation/UserGuide "$pages"; fi

# what its libraries need of Debian beside ParaView
mapfile -t libraries < <(find "$folder/lib" "$folder/bin" -type f \( -name '*.so*' -o -perm -u+x \))
mapfile -t packages < <(ldd "${libraries[@]}" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | grep -v "^$folder/" | sort -u |
  xargs realpath | sort -u | sed -e 'p;s/^\/usr//' | xargs dpkg -S 2>/dev/null | sed 's/:.*//' | sort -u |
  grep -vx -e paraview -e libc6 -e libgcc-s1 -e 'libstdc++6' | grep -Fxf <(objdump -p "${libraries[@]}" | awk '$1 == "NEEDED" { print $2 }' | sort -u |
    while read -r needed; do dpkg -S "*/$needed" 2>/dev/null | sed 's/:.*//'; done | sort -u))
python=$(python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
modules=$(cd "$folder" && echo lib/python3*/*-packages)
plugins=$(cd "$folder" && echo lib/paraview-*/plugins)

cat >"$folder/lacuna-env.sh" <<END
# . lacuna-env.sh: makes paraview, pvpython and python3 of this terminal see Lacuna, in bash.
lacuna_check() {
  local fits="This Lacuna $version fits ParaView $paraview with Python $python on $system, \$(uname -m)"
  local found
  if ! found=\$(pvpython --version 2>/dev/null); then
    echo "\$fits. There is no pvpython here: install the packages paraview and python3-paraview." >&2
    return 1
  fi
  if [ "\${found##* }" != $paraview ]; then
    echo "\$fits. Here is ParaView \${found##* }: get the archive for this version." >&2
    return 1
  fi
  found=\$(ldd "\$1"/lib/*.so* | sed -n 's/ => not found//p' | sort -u | tr -d '\t' | tr '\n' ' ')
  if [ -n "\$found" ]; then
    echo "\$fits. Libraries are missing: \$found- README.md has the packages." >&2
    return 1
  fi
}
lacuna_folder=\$(cd "\$(dirname "\${BASH_SOURCE[0]}")" && pwd)
if lacuna_check "\$lacuna_folder"; then
  export PYTHONPATH="\$lacuna_folder/$modules\${PYTHONPATH:+:\$PYTHONPATH}"
  export PATH="\$lacuna_folder/bin:\$PATH"
  export LD_LIBRARY_PATH="\$lacuna_folder/lib\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
  export PV_PLUGIN_CONFIG_FILE="\$lacuna_folder/$plugins/lacuna.plugins.xml"
  export LACUNA_PLUGIN="\$lacuna_folder/$plugins/LacunaPlugin/LacunaPlugin.so"
else
  false
fi
END
cat >"$folder/README.md" <<END
# Lacuna $version for ParaView $paraview

This folder fits **ParaView $paraview with Python $python on $system**, $(uname -m), and no other. It can be anywhere.

Once, as root: \`apt install paraview python3-paraview python3-numpy ${packages[*]}\`

In each terminal (bash): \`. lacuna-env.sh\`. Then \`paraview\`, \`pvpython\` and \`python3\` there have Lacuna.
With another ParaView it says so and changes nothing.

Pages and examples are in \`share/doc/lacuna\`. Lacuna is research software, not a medical device.
END
tar -C build/archive --owner=0 --group=0 --sort=name -cJf "build/archive/$name.tar.xz" "$name"
rm -rf "$folder"
ls -l build/archive
