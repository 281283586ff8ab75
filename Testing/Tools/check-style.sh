#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Rules that a tool can check: format, license tags, kernels without VTK, links of the pages, that the
# pages say what the plugin's XML says, and that the commands behind their figures are there.
set -euo pipefail
cd "$(dirname "$0")/../.."
sources=$(git ls-files '*.h' '*.cxx')
failed=0
complain() { echo "style: $1" >&2; failed=1; }

if command -v clang-format-14 >/dev/null || command -v clang-format >/dev/null; then
  format=$(command -v clang-format-14 || command -v clang-format)
  # shellcheck disable=SC2086
  $format --dry-run -Werror $sources || complain "run clang-format -i on the files above"
else
  complain "clang-format is not installed (Debian: clang-format-14; .ci/run installs it)"
fi
for file in $sources $(git ls-files '*.py' '*.sh' '*.cmake' '*CMakeLists.txt'); do
  head -n 3 "$file" | grep -q 'SPDX-License-Identifier: BSD-3-Clause' ||
    complain "$file has no SPDX license tag"
done
bad=$(git ls-files '*/Kernel/*' | xargs grep -lE '#include *[<"]vtk' || true)
[ -z "$bad" ] || complain "kernels must not include VTK: $bad"
bad=$(git ls-files 'Filters/*.cxx' 'Readers/*.cxx' 'Sources/*.cxx' 'Filters/*.h' 'Readers/*.h' 'Sources/*.h' | grep -vE '/(Kernel|Testing)/|(lacunaArrays|vtkLacunaSplineLoop)' |
  xargs grep -nE -- '->(SetNumberOf(Tuples|Points)|AllocateScalars|AllocateExact|CopyAllocate|DeepCopy)\(' || true)
[ -z "$bad" ] || complain "VTK ends the program where there is no memory; use lacuna::Arrays: $bad"
for file in Plugins/Lacuna/{Sources,Readers,Filters}/*.xml; do
  name=$(basename "$file" .xml)
  case $name in PolhemusVideoSource | SplineLoop) continue ;; esac # of devices; a part of RBF Hole Filler's
  grep -q "\"$name\", NewOf" Testing/Properties/lacuna*Subjects.cxx || complain "$name is in no property test (Testing/Properties)"
done
bad=$(git ls-files 'Filters/*.h' 'Readers/*.h' 'Sources/*.h' | grep -v /Testing/ | xargs -n 1 basename | sort | uniq -d)
[ -z "$bad" ] || complain "all headers are installed in one folder; two are called $bad"
bad=$(grep -nP '[^\x00-\x7F]' $sources | head -n 5 || true)
[ -z "$bad" ] || complain "non-ASCII characters in C++: $bad"

version=$(sed -n 's/^project(Lacuna VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
grep -qx "version: $version" CITATION.cff || complain "CITATION.cff is not of version $version"
grep -m 1 '^## ' CHANGELOG.md | grep -qE "^## ${version//./\\.} \\(" ||
  complain "the top of CHANGELOG.md is not of version $version"
python3 Testing/Tools/check-docs.py || complain "links or pictures of the documentation, see above"
python3 Testing/Tools/compatibility.py check || complain "a table is not that of its records, see above"
python3 Testing/Tools/check-benchmarks.py || complain "commands behind figures of the pages, see above"
python3 Testing/Tools/check-parameters.py || complain "pages and the plugin's XML disagree, see above"

exit $failed
