// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// VTK's data types as the number types of the kernels, and back.
#ifndef lacunaArrayScalarType_h
#define lacunaArrayScalarType_h

#include "lacunaScalarType.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkDataArray;

namespace lacuna::ArrayScalarType
{
/// The type of an array's numbers, by their size and sign. Throws std::runtime_error naming the
/// array and its type when they are no whole bytes (VTK_BIT) or no real numbers.
VTKLACUNAFILTERSCOMMON_EXPORT ScalarType Get(vtkDataArray* array);

/// The VTK data type of arrays with numbers of a type (VTK_UNSIGNED_CHAR, ...).
VTKLACUNAFILTERSCOMMON_EXPORT int ToVTK(ScalarType type);
}
#endif
