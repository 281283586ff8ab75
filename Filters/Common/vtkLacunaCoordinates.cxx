// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaCoordinates.h"

#include "vtkAbstractArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

namespace vtkLacunaCoordinates
{
//------------------------------------------------------------------------------
void Mark(vtkDataObject* data, const char* coordinates)
{
  vtkNew<vtkStringArray> array;
  array->SetName(ArrayName);
  array->InsertNextValue(coordinates);
  data->GetFieldData()->AddArray(array);
}

//------------------------------------------------------------------------------
void Clear(vtkDataObject* data)
{
  data->GetFieldData()->RemoveArray(ArrayName);
}

//------------------------------------------------------------------------------
void Pass(vtkDataObject* input, vtkDataObject* output)
{
  vtkAbstractArray* array = input->GetFieldData()->GetAbstractArray(ArrayName);
  if (array && !output->GetFieldData()->HasArray(ArrayName))
  {
    output->GetFieldData()->AddArray(array);
  }
}
}
