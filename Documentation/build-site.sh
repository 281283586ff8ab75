#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the documentation's site, to be read from disk or put on any web server.
#   Documentation/build-site.sh [folder]     default: build/site; start at its html/index.html
# Warnings of Sphinx and Doxygen are errors, and so are links that lead nowhere.
set -euo pipefail
site=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")/.."
. Testing/Tools/setup.sh
case $PWD in
  *[[:blank:]]*) lacuna_fail "building the site" "Doxygen needs a folder without blanks in its path, not $PWD" ;;
esac
site=${site:-$PWD/build/site}
lacuna_install_packages packages-documentation.txt
version=$(sed -n 's/^project(Lacuna VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
mkdir -p "$site"
python3 -B Documentation/Site/stage.py "$site/source"
sphinx-build -q -W --keep-going -j auto -c Documentation/Site -D "release=$version" -d "$site/doctrees" "$site/source" "$site/html"
(cat Documentation/Site/Doxyfile; printf 'OUTPUT_DIRECTORY = "%s/html"\nPROJECT_NUMBER = %s\n' "$site" "$version") | doxygen -
python3 Testing/Tools/check-site.py "$site/html"
echo "$site/html/index.html"
