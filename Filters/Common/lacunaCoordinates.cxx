// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCoordinates.h"

#include "vtkAbstractArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

namespace
{
void SetText(vtkDataObject* data, const char* name, const std::string& text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  data->GetFieldData()->AddArray(array);
}

std::string GetText(vtkDataObject* data, const char* name)
{
  auto* array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name));
  return array && array->GetNumberOfValues() == 1 ? std::string(array->GetValue(0)) : std::string();
}
}

namespace lacuna::Coordinates
{
//------------------------------------------------------------------------------
void Mark(vtkDataObject* data, const char* coordinates)
{
  Clear(data);
  SetText(data, ArrayName, coordinates);
}

//------------------------------------------------------------------------------
void MarkPress(vtkDataObject* input, vtkDataObject* output)
{
  const std::string before = Get(input);
  Mark(output, Press);
  if (!before.empty())
  {
    SetText(output, BeforePressName, before);
  }
}

//------------------------------------------------------------------------------
std::string Get(vtkDataObject* data)
{
  return GetText(data, ArrayName);
}

//------------------------------------------------------------------------------
std::string GetBeforePress(vtkDataObject* data)
{
  return GetText(data, BeforePressName);
}

//------------------------------------------------------------------------------
void Clear(vtkDataObject* data)
{
  data->GetFieldData()->RemoveArray(ArrayName);
  data->GetFieldData()->RemoveArray(BeforePressName);
}

//------------------------------------------------------------------------------
void Pass(vtkDataObject* input, vtkDataObject* output)
{
  if (output->GetFieldData()->HasArray(ArrayName))
  {
    return;
  }
  for (const char* name : { ArrayName, BeforePressName })
  {
    if (vtkAbstractArray* array = input->GetFieldData()->GetAbstractArray(name))
    {
      output->GetFieldData()->AddArray(array);
    }
  }
}
}
