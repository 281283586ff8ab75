#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes build/repository, a folder that apt can read, also from a web server, of the packages in build/packages/SUITE
# (Testing/Tools/chroot.sh FOLDER make SUITE makes them), and copies the archives beside them.
#   Testing/Tools/repository.sh [KEY]      KEY: of gpg, which signs it; without, apt needs [trusted=yes]
# Then, in /etc/apt/sources.list: deb [trusted=yes] file:/…/build/repository bookworm main
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages packages-packaging.txt
rm -rf build/repository
for packages in build/packages/*/; do
  suite=$(basename "$packages")
  pool=build/repository/pool/$suite
  mkdir -p "$pool"
  cp "$packages"lacuna*.deb "$pool"
  cp "$packages"lacuna*.tar.xz build/repository
  for architecture in $(dpkg-deb -f "$pool"/lacuna_*.deb Architecture); do
    index=build/repository/dists/$suite/main/binary-$architecture
    mkdir -p "$index"
    (cd build/repository && apt-ftparchive packages "pool/$suite") >"$index/Packages"
    gzip -9nk "$index/Packages"
  done
  release=build/repository/dists/$suite
  apt-ftparchive -o "APT::FTPArchive::Release::Suite=$suite" -o "APT::FTPArchive::Release::Codename=$suite" \
    -o APT::FTPArchive::Release::Components=main -o APT::FTPArchive::Release::Label=Lacuna \
    -o "APT::FTPArchive::Release::Architectures=$(cd "$release/main" && echo binary-* | sed 's/binary-//g')" \
    release "$release" >"$release/../$suite.new"
  mv "$release/../$suite.new" "$release/Release"
  if [ -n "${1:-}" ]; then gpg --batch --yes -u "$1" --clearsign -o "$release/InRelease" "$release/Release"; fi
done
find build/repository -type f | sort
