// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCoordinates.h"

#include "lacunaFieldData.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <initializer_list>

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

void CopyArrays(
  vtkDataObject* input, vtkDataObject* output, std::initializer_list<const char*> names)
{
  for (const char* name : names)
  {
    if (vtkAbstractArray* array = input->GetFieldData()->GetAbstractArray(name))
    {
      output->GetFieldData()->AddArray(array);
    }
  }
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
void MarkMirrored(vtkDataObject* data, const lacuna::Vec3& origin, const lacuna::Vec3& normal)
{
  lacuna::FieldData::Set(data, MirroredName, { 1 }, 1);
  lacuna::FieldData::Set(data, MirrorOriginName, { origin[0], origin[1], origin[2] }, 3);
  lacuna::FieldData::Set(data, MirrorNormalName, { normal[0], normal[1], normal[2] }, 3);
}

//------------------------------------------------------------------------------
bool IsMirrored(vtkDataObject* data)
{
  vtkDataArray* mark = data->GetFieldData()->GetArray(MirroredName);
  return mark && mark->GetNumberOfTuples() > 0 && mark->GetComponent(0, 0) != 0;
}

//------------------------------------------------------------------------------
void Pass(vtkDataObject* input, vtkDataObject* output)
{
  if (!output->GetFieldData()->HasArray(ArrayName))
  {
    CopyArrays(input, output, { ArrayName, BeforePressName });
  }
  if (IsMirrored(input))
  {
    CopyArrays(input, output, { MirroredName, MirrorOriginName, MirrorNormalName });
  }
}
}
