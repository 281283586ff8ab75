// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProvenance.h"

#include "lacunaCoordinates.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iomanip>
#include <sstream>

namespace
{
// FNV-1a over 8-byte words: quick, and no need to resist an adversary.
std::uint64_t Hash(const void* bytes, std::size_t size)
{
  std::uint64_t hash = 14695981039346656037ull;
  const auto* p = static_cast<const unsigned char*>(bytes);
  for (; size >= 8; size -= 8, p += 8)
  {
    std::uint64_t word;
    std::memcpy(&word, p, 8);
    hash = (hash ^ word) * 1099511628211ull;
    hash ^= hash >> 29; // the product alone never carries high bits down
  }
  for (; size > 0; --size, ++p)
  {
    hash = (hash ^ *p) * 1099511628211ull;
  }
  return hash;
}

// Of the active point scalars of a data set, of the points of a mesh without, of the numbers of a
// table.
std::string HashOfNumbers(vtkDataObject* data)
{
  std::vector<vtkDataArray*> arrays;
  if (auto* set = vtkDataSet::SafeDownCast(data))
  {
    arrays.push_back(set->GetPointData()->GetScalars());
    auto* mesh = vtkPointSet::SafeDownCast(data);
    if (!arrays.back() && mesh && mesh->GetPoints())
    {
      arrays.back() = mesh->GetPoints()->GetData();
    }
  }
  else if (auto* table = vtkTable::SafeDownCast(data))
  {
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
    {
      arrays.push_back(vtkDataArray::SafeDownCast(table->GetColumn(c)));
    }
  }
  std::uint64_t hash = 0;
  bool any = false;
  for (vtkDataArray* array : arrays)
  {
    if (array && array->HasStandardMemoryLayout())
    {
      const std::uint64_t own = Hash(array->GetVoidPointer(0),
        static_cast<std::size_t>(array->GetNumberOfValues()) * array->GetDataTypeSize());
      const std::array<std::uint64_t, 2> both{ hash, own };
      hash = any ? Hash(both.data(), sizeof(both)) : own;
      any = true;
    }
  }
  if (!any)
  {
    return "-";
  }
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << hash;
  return text.str();
}
}

namespace lacuna::Provenance
{
//------------------------------------------------------------------------------
const char* GetVersion()
{
  return LACUNA_VERSION;
}

//------------------------------------------------------------------------------
void Record(vtkDataObject* output, vtkObjectBase* algorithm,
  const std::vector<vtkDataObject*>& inputs, const std::string& parameters)
{
  std::vector<std::string> steps = inputs.empty() ? Get(output) : std::vector<std::string>();
  std::ostringstream step;
  step << "Lacuna " << GetVersion() << " " << algorithm->GetClassName();
  for (vtkDataObject* input : inputs)
  {
    for (const std::string& earlier : Get(input))
    {
      if (std::find(steps.begin(), steps.end(), earlier) == steps.end())
      {
        steps.push_back(earlier);
      }
    }
    step << " input:" << HashOfNumbers(input);
  }
  if (!parameters.empty())
  {
    step << " " << parameters;
  }
  steps.push_back(step.str());

  vtkNew<vtkStringArray> array;
  array->SetName(ArrayName);
  for (const std::string& s : steps)
  {
    array->InsertNextValue(s);
  }
  output->GetFieldData()->AddArray(array);
  lacuna::VolumeDirection::Update(output);
  if (!inputs.empty() && inputs.front() != output)
  {
    lacuna::Coordinates::Pass(inputs.front(), output);
  }
}

//------------------------------------------------------------------------------
std::vector<std::string> Get(vtkDataObject* data)
{
  std::vector<std::string> steps;
  auto* array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(ArrayName));
  for (vtkIdType i = 0; array && i < array->GetNumberOfValues(); ++i)
  {
    steps.push_back(array->GetValue(i));
  }
  return steps;
}
}
