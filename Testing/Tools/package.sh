#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the Debian packages, build/package/lacuna*.deb, and lets lintian judge them.
#   Testing/Tools/package.sh             with the site of the documentation in lacuna-doc
#   Testing/Tools/package.sh --no-site   without, as long as Documentation/build-site.sh was not run
# Testing/Tools/chroot.sh FOLDER package then tries them in a clean Debian.
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
lacuna_install_packages packages-debian.txt packages-packaging.txt
if [ "${1:-}" != --no-site ]; then
  rm -rf build/site # pages that are no more
  Documentation/build-site.sh
fi
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
mkdir -p build # configured anew: the changelog's date, and whether there is a site
cmake --preset package >build/package.log 2>&1 || { cat build/package.log; exit 1; }
lacuna_build package
rm -f build/package/*.deb
(umask 022 && cpack --config build/package/CPackConfig.cmake -B build/package) >build/cpack.log 2>&1 || { cat build/cpack.log; exit 1; }
lintian --allow-root --fail-on error,warning --tag-display-limit 0 build/package/*.deb
ls -l build/package/*.deb
