// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirrored.h"

#include "lacunaFieldData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"

namespace lacuna::Mirrored
{
//------------------------------------------------------------------------------
void Mark(vtkDataObject* data, const lacuna::Vec3& origin, const lacuna::Vec3& normal)
{
  lacuna::FieldData::Set(data, ArrayName, { 1 }, 1);
  lacuna::FieldData::Set(data, OriginName, { origin[0], origin[1], origin[2] }, 3);
  lacuna::FieldData::Set(data, NormalName, { normal[0], normal[1], normal[2] }, 3);
}

//------------------------------------------------------------------------------
bool IsMarked(vtkDataObject* data)
{
  vtkDataArray* mark = data->GetFieldData()->GetArray(ArrayName);
  return mark && mark->GetNumberOfTuples() > 0 && mark->GetComponent(0, 0) != 0;
}

//------------------------------------------------------------------------------
void Pass(vtkDataObject* input, vtkDataObject* output)
{
  if (IsMarked(input))
  {
    for (const char* name : { ArrayName, OriginName, NormalName })
    {
      if (vtkDataArray* array = input->GetFieldData()->GetArray(name))
      {
        output->GetFieldData()->AddArray(array);
      }
    }
  }
}
}
