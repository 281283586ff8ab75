#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the Debian packages, build/package/lacuna*.deb, and lets lintian judge them.
#   Testing/Tools/package.sh             with the site of the documentation in lacuna-doc
#   Testing/Tools/package.sh --no-site   without, as long as Documentation/build-site.sh was not run
#   Testing/Tools/package.sh … --in build/release   uses what is compiled there, and leaves it configured for packages
# Testing/Tools/chroot.sh FOLDER package then tries them in a clean Debian.
set -euo pipefail
cd "$(dirname "$0")/../.."
. Testing/Tools/setup.sh
site=yes folder=build/package
while [ $# -gt 0 ]; do
  case $1 in
    --no-site) site=no ;;
    --in) folder=${2:?folder}; shift ;;
    *) sed -n '3,7s/^# \?//p' "$0" >&2; exit 2 ;;
  esac
  shift
done
lacuna_install_packages packages-debian.txt packages-packaging.txt
if [ $site = yes ]; then
  rm -rf build/site # pages that are no more
  Documentation/build-site.sh
fi
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
mkdir -p build/package # configured anew: the changelog's date, and whether there is a site
cmake --preset package -B "$folder" >build/package.log 2>&1 || { cat build/package.log; exit 1; }
cmake --build "$folder" >>build/package.log 2>&1 || { tail -n 30 build/package.log; exit 1; }
rm -f build/package/*.deb "$folder"/*.deb
(umask 022 && cpack --config "$folder/CPackConfig.cmake" -B "$PWD/build/package") >build/cpack.log 2>&1 || { cat build/cpack.log; exit 1; }
[ "$folder" -ef build/package ] || mv "$folder"/*.deb build/package
lintian --allow-root --fail-on error,warning --tag-display-limit 0 build/package/*.deb
ls -l build/package/*.deb
