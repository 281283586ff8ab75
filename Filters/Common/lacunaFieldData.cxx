// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFieldData.h"

#include "lacunaArrays.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"

#include <sstream>
#include <stdexcept>

namespace lacuna::FieldData
{
//------------------------------------------------------------------------------
vtkDataArray* Find(vtkDataObject* data, const std::string& name, int components, vtkIdType tuples)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name.c_str());
  if (!array)
  {
    return nullptr;
  }
  if (array->GetNumberOfComponents() != components ||
    (tuples >= 0 && array->GetNumberOfTuples() != tuples))
  {
    std::ostringstream message;
    message << "field data array '" << name << "' has " << array->GetNumberOfTuples()
            << " tuples of " << array->GetNumberOfComponents() << " components; expected ";
    if (tuples >= 0)
    {
      message << tuples << " tuples of ";
    }
    message << components << " components";
    throw std::runtime_error(message.str());
  }
  return array;
}

//------------------------------------------------------------------------------
vtkDataArray* Get(vtkDataObject* data, const std::string& name, int components, vtkIdType tuples)
{
  vtkDataArray* array = Find(data, name, components, tuples);
  if (!array)
  {
    throw std::runtime_error("field data array '" + name +
      "' is missing; a filter in between may have dropped the field data");
  }
  return array;
}

//------------------------------------------------------------------------------
lacuna::Matrix4 GetMatrix(vtkDataArray* array, vtkIdType i)
{
  double elements[16];
  array->GetTuple(i, elements);
  return lacuna::Matrix4(elements);
}

//------------------------------------------------------------------------------
void Set(
  vtkDataObject* data, const std::string& name, const std::vector<double>& values, int components)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(values.size()) / components);
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
  {
    array->SetValue(i, values[i]);
  }
  data->GetFieldData()->AddArray(array);
}

//------------------------------------------------------------------------------
void SetMatrices(
  vtkDataObject* data, const std::string& name, const std::vector<lacuna::Matrix4>& matrices)
{
  std::vector<double> values;
  values.reserve(16 * matrices.size());
  for (const lacuna::Matrix4& m : matrices)
  {
    values.insert(values.end(), m.Data(), m.Data() + 16);
  }
  Set(data, name, values, 16);
}
}
