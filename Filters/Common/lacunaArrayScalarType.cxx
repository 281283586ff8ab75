// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaArrayScalarType.h"

#include "vtkDataArray.h"
#include "vtkTypeTraits.h"

#include <stdexcept>
#include <string>

namespace lacuna::ArrayScalarType
{
lacuna::ScalarType Get(vtkDataArray* array)
{
  switch (array->GetDataType())
  {
    vtkTemplateMacro(return lacuna::GetScalarType<VTK_TT>());
    default:
      break;
  }
  const char* name = array->GetName();
  throw std::runtime_error(std::string("array '") + (name ? name : "") + "' has values of type " +
    array->GetDataTypeAsString() +
    ", which is not supported: convert it to unsigned char or another type of whole bytes");
}

int ToVTK(lacuna::ScalarType type)
{
  return lacuna::DispatchScalarType(
    type, [](auto zero) { return vtkTypeTraits<decltype(zero)>::VTKTypeID(); });
}
}
