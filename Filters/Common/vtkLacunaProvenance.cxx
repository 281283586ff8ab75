// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaProvenance.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"

#include <algorithm>
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

std::string HashOfScalars(vtkDataObject* data)
{
  auto* set = vtkDataSet::SafeDownCast(data);
  vtkDataArray* scalars = set ? set->GetPointData()->GetScalars() : nullptr;
  if (!scalars || !scalars->HasStandardMemoryLayout())
  {
    return "-";
  }
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0')
       << Hash(scalars->GetVoidPointer(0),
            static_cast<std::size_t>(scalars->GetNumberOfValues()) * scalars->GetDataTypeSize());
  return text.str();
}
}

namespace vtkLacunaProvenance
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
  std::vector<std::string> steps;
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
    step << " input:" << HashOfScalars(input);
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
