// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Typed access to the field data arrays of Lacuna's data contracts. Readers throw
/// std::runtime_error naming the array, what is wrong with it and what would be right.
#ifndef lacunaFieldData_h
#define lacunaFieldData_h

#include "lacunaMatrix4.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataArray;
class vtkDataObject;

namespace lacuna::FieldData
{
/// The array, or nullptr when it is absent. Throws unless it has the given number of components
/// and, when tuples >= 0, of tuples.
VTKLACUNAFILTERSCOMMON_EXPORT vtkDataArray* Find(
  vtkDataObject* data, const std::string& name, int components, vtkIdType tuples);
/// As Find, but throws when the array is absent.
VTKLACUNAFILTERSCOMMON_EXPORT vtkDataArray* Get(
  vtkDataObject* data, const std::string& name, int components, vtkIdType tuples);

/// Tuple i of a 16-component array as a 4x4 row-major matrix.
VTKLACUNAFILTERSCOMMON_EXPORT Matrix4 GetMatrix(vtkDataArray* array, vtkIdType i);

/// Adds or replaces a double array of values in tuples of the given number of components.
VTKLACUNAFILTERSCOMMON_EXPORT void Set(
  vtkDataObject* data, const std::string& name, const std::vector<double>& values, int components);
/// Adds or replaces an array of one 16-component tuple per matrix.
VTKLACUNAFILTERSCOMMON_EXPORT void SetMatrices(
  vtkDataObject* data, const std::string& name, const std::vector<Matrix4>& matrices);
}
#endif
