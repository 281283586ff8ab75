// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaArrayScalarType.h"
#include "lacunaCheck.h"
#include "vtkBitArray.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <limits>

int TestScalarTypes(int, char*[])
{
  using lacuna::ScalarType;
  const auto get = [](int type)
  {
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    return lacuna::ArrayScalarType::Get(array);
  };
  // what a kernel sees has the size, the sign and the fractions of what VTK stores
  for (const int type : { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,
         VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG,
         VTK_UNSIGNED_LONG_LONG, VTK_ID_TYPE, VTK_FLOAT, VTK_DOUBLE })
  {
    const ScalarType scalar = get(type);
    LACUNA_CHECK(lacuna::GetScalarSize(scalar) ==
      static_cast<std::size_t>(vtkDataArray::GetDataTypeSize(type)));
    lacuna::DispatchScalarType(scalar,
      [&](auto zero)
      {
        using Limits = std::numeric_limits<decltype(zero)>;
        LACUNA_CHECK(Limits::is_signed == (vtkDataArray::GetDataTypeMin(type) < 0));
        LACUNA_CHECK(Limits::is_integer == (type != VTK_FLOAT && type != VTK_DOUBLE));
      });
    LACUNA_CHECK(get(lacuna::ArrayScalarType::ToVTK(scalar)) == scalar);
  }
  LACUNA_CHECK(lacuna::ArrayScalarType::ToVTK(ScalarType::UInt8) == VTK_UNSIGNED_CHAR);
  LACUNA_CHECK(lacuna::ArrayScalarType::ToVTK(ScalarType::Int16) == VTK_SHORT);
  LACUNA_CHECK(lacuna::ArrayScalarType::ToVTK(ScalarType::Float64) == VTK_DOUBLE);

  vtkNew<vtkBitArray> bits;
  LACUNA_CHECK_THROWS(lacuna::ArrayScalarType::Get(bits), "values of type bit");
  bits->SetName("Stencil");
  LACUNA_CHECK_THROWS(lacuna::ArrayScalarType::Get(bits), "'Stencil'");
  return lacunaCheck::Result();
}
