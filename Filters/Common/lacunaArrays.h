// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sizes of arrays. Where there is no memory for one, VTK's arrays end the program; these functions
/// throw std::runtime_error with the bytes instead.
#ifndef lacunaArrays_h
#define lacunaArrays_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <vector>

class vtkAbstractArray;
class vtkCellArray;
class vtkDataArray;
class vtkImageData;
class vtkPoints;
class vtkPolyData;
class vtkTypeInt64Array;

namespace lacuna::Arrays
{
/// Gives array memory for so many tuples, whose values are not set. What it had is lost.
VTKLACUNAFILTERSCOMMON_EXPORT void SetNumberOfTuples(vtkAbstractArray* array, vtkIdType tuples);

/// The same for the coordinates of points.
VTKLACUNAFILTERSCOMMON_EXPORT void SetNumberOfPoints(vtkPoints* points, vtkIdType count);

///@{
/// Empties what then takes so many tuples, points, or cells with so many points in all, one by one.
VTKLACUNAFILTERSCOMMON_EXPORT void Reserve(vtkAbstractArray* array, vtkIdType tuples);
VTKLACUNAFILTERSCOMMON_EXPORT void Reserve(vtkPoints* points, vtkIdType count);
VTKLACUNAFILTERSCOMMON_EXPORT void Reserve(vtkCellArray* cells, vtkIdType count, vtkIdType points);
///@}

/// Copies name, components and values; the types may differ.
VTKLACUNAFILTERSCOMMON_EXPORT void Copy(vtkAbstractArray* from, vtkAbstractArray* to);

///@{
/// Makes triangles the polygons of output. corners: the three point numbers of one after those of the other.
VTKLACUNAFILTERSCOMMON_EXPORT void SetTriangles(vtkPolyData* output, vtkTypeInt64Array* corners);
VTKLACUNAFILTERSCOMMON_EXPORT void SetTriangles(
  vtkPolyData* output, const std::vector<std::array<std::int32_t, 3>>& triangles);
///@}

/// Gives an image scalars of one component, one for each of its points, whose values are not set.
VTKLACUNAFILTERSCOMMON_EXPORT vtkDataArray* AddScalars(
  vtkImageData* image, int type, const char* name);
}
#endif
