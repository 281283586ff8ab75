#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Begins a filter of images: class, first test, proxy, icon and place in the menu. It builds and runs at once,
# and copies its input times Factor. Its first test fails until it is written.
#   Testing/Tools/new-filter.sh NAME MODULE      for instance EdgeStrength Speckle (a folder of Filters)
# Then "A new filter" in Documentation/DeveloperGuide/architecture.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
name=${1:-} module=${2:-}
if ! [[ $name =~ ^[A-Z][A-Za-z0-9]+$ ]] || [ ! -f "Filters/$module/vtk.module" ]; then
  sed -n '3,6s/^# \?//p' "$0" >&2
  echo "modules: $(cd Filters && ls -d */ | tr -d / | xargs)" >&2
  exit 2
fi
class=vtkLacuna$name
folder=Filters/$module
if [ "$module" = Common ]; then echo "$0: Common has the bases; take the folder of a subject" >&2; exit 2; fi
for file in $(compgen -G "*/*/$class.h") "$folder/Testing/Cxx/Test$name.cxx" "Plugins/Lacuna/Filters/$name.xml" \
  "Plugins/Lacuna/Resources/Icons/$name.svg"; do
  if [ -e "$file" ]; then echo "$0: there is a $file" >&2; exit 2; fi
done
label=$(sed -E 's/([a-z0-9])([A-Z])/\1 \2/g' <<<"$name")
export=VTKLACUNAFILTERS${module^^}_EXPORT

cat >"$folder/$class.h" <<END
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class $class
 * @brief one line: what a user gets of it
 *
 * Input: vtkImageData with active scalars. Output: what it is, its arrays with units, and the source of the method.
 */
#ifndef ${class}_h
#define ${class}_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFilters${module}Module.h" // for export macro

class $export $class : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static $class* New();
  vtkTypeMacro($class, vtkImageAlgorithm);

  ///@{
  /// What values are multiplied by: a finite number. Default: 1.
  vtkSetMacro(Factor, double);
  vtkGetMacro(Factor, double);
  ///@}

protected:
  $class();
  ~$class() override = default;

  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  $class(const $class&) = delete;
  void operator=(const $class&) = delete;

  double Factor = 1;
};
#endif
END

cat >"$folder/$class.cxx" <<END
// SPDX-License-Identifier: BSD-3-Clause
#include "$class.h"

#include "lacunaArrays.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <cstdint>
#include <stdexcept>

vtkStandardNewMacro($class);

//------------------------------------------------------------------------------
$class::$class()
{
  this->Sharing = lacuna::Share::EachRank;
}

//------------------------------------------------------------------------------
void $class::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkImageData>();
  lacuna::VolumeDirection::Check(input);
  vtkDataArray* from = input->GetPointData()->GetScalars();
  if (!from || from->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("input 0 has no active scalars of one component: choose an array");
  }
  output->CopyStructure(input);
  vtkDataArray* to = lacuna::Arrays::AddScalars(output, from->GetDataType(), from->GetName());
  execution.For(to->GetNumberOfTuples(), 4096, // by all threads, with progress; stops when the user does
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        to->SetComponent(i, 0, this->Factor * from->GetComponent(i, 0));
      }
    });
}

//------------------------------------------------------------------------------
void $class::Describe(lacuna::Properties& properties) const
{
  properties.Add("Factor", this->Factor, lacuna::ValueRange::Any());
}
END

cat >"$folder/Testing/Cxx/Test$name.cxx" <<END
// SPDX-License-Identifier: BSD-3-Clause
#include "$class.h"
#include "vtkImageData.h"
#include "vtkNew.h"

#include <cstdlib>
#include <iostream>

int Test$name(int, char*[])
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 3, 2);
  image->AllocateScalars(VTK_DOUBLE, 1);
  image->SetScalarComponentFromDouble(1, 2, 1, 0, 5);
  vtkNew<$class> filter;
  filter->SetInputData(image);
  filter->SetFactor(2);
  filter->Update();
  std::cerr << "write this test: values that are known, not those that the filter makes ("
            << filter->GetOutput()->GetScalarComponentAsDouble(1, 2, 1, 0) << ")\n";
  return EXIT_FAILURE;
}
END

cat >"Plugins/Lacuna/Filters/$name.xml" <<END
<!-- SPDX-License-Identifier: BSD-3-Clause -->
<ServerManagerConfiguration>
  <ProxyGroup name="filters">
    <SourceProxy name="Lacuna$name" class="$class" label="$label">
      <Documentation short_help="One line: what a user gets of it."
                     long_help="Two sentences: what it does, and when to use it.">
What it does, with **Factor** and its unit.
      </Documentation>

      <InputProperty name="Input" command="SetInputConnection">
        <ProxyGroupDomain name="groups">
          <Group name="sources"/>
          <Group name="filters"/>
        </ProxyGroupDomain>
        <DataTypeDomain name="input_type" composite_data_supported="0">
          <DataType value="vtkImageData"/>
        </DataTypeDomain>
        <Documentation>An image or a volume.</Documentation>
      </InputProperty>

      <DoubleVectorProperty name="Factor" command="SetFactor" number_of_elements="1" default_values="1">
        <Documentation>What values are multiplied by.</Documentation>
      </DoubleVectorProperty>

      <Hints>
        <ShowInMenu icon=":/Lacuna/Icons/$name.svg"/>
      </Hints>
    </SourceProxy>
  </ProxyGroup>
</ServerManagerConfiguration>
END

cat >"Plugins/Lacuna/Resources/Icons/$name.svg" <<END
<svg xmlns="http://www.w3.org/2000/svg" width="16" height="16" viewBox="0 0 16 16">
<!-- SPDX-License-Identifier: BSD-3-Clause -->
<g fill="none" stroke="#2f7fc4" stroke-width="1.5" stroke-linecap="round" stroke-linejoin="round">
<path d="M2 2 h12 v12 h-12 z" fill="#accce7"/>
</g>
</svg>
END

# Puts a line into a file: before the first line that matches the pattern and sorts after it, otherwise after the last one.
insert() { # file line pattern
  awk -v line="$2" -v pattern="$3" '
    { lines[NR] = $0 }
    $0 ~ pattern { last = NR; if (!at && $0 > line) at = NR }
    END {
      if (!at && last) at = last + 1
      for (i = 1; i <= NR + 1; ++i) {
        if (i == at) print line
        if (i <= NR) print lines[i]
      }
    }' "$1" >"$1.new" && cat "$1.new" >"$1"
  rm "$1.new"
}
insert "$folder/CMakeLists.txt" "    $class" '^    vtkLacuna[A-Za-z0-9]+$'
insert "$folder/Testing/Cxx/CMakeLists.txt" "  Test$name.cxx" '^  Test[A-Za-z0-9]+[.]cxx$'
sed -i "s|^lacuna_add_proxies(Filters$module \+|&Filters/$name.xml |" Plugins/Lacuna/CMakeLists.txt
insert Plugins/Lacuna/Resources/lacuna.qrc "    <file>Icons/$name.svg</file>" '^    <file>Icons/'
last=$(grep -n '^    </Category>' Plugins/Lacuna/LacunaMenus.xml | sed -n '2s/:.*//p') # that of filters
sed -i "${last}i\\      <Proxy group=\"filters\" name=\"Lacuna$name\" icon=\":/Lacuna/Icons/$name.svg\"/>" Plugins/Lacuna/LacunaMenus.xml
if command -v clang-format-14 >/dev/null; then
  clang-format-14 -i "$folder/$class".{h,cxx} "$folder/Testing/Cxx/Test$name.cxx"
fi

for list in "$folder/CMakeLists.txt" "$folder/Testing/Cxx/CMakeLists.txt" Plugins/Lacuna/{CMakeLists.txt,LacunaMenus.xml,Resources/lacuna.qrc}; do
  grep -q "$name" "$list" || { echo "$0: $list does not name it: do it by hand" >&2; exit 1; }
done
git status --short
cat <<END
next: cmake --build build/release, then ctest --test-dir build/release -R Test$name (it fails until it is written).
What else a filter has: "A new filter" in Documentation/DeveloperGuide/architecture.md. The lists are those that have
another filter of its kind, for instance: git grep -l GateSlices. ctest -R 'ProxyConventions|WindowMenus|MemoryTable'
says what is missing in most of them.
END
