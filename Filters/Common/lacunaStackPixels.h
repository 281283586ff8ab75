// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grey levels of pictures as slices of a stack.
#ifndef lacunaStackPixels_h
#define lacunaStackPixels_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkSmartPointer.h"

#include <array>

class vtkDataArray;
class vtkImageData;

namespace lacuna
{
/// The grey levels of a part of a stack.
namespace StackPixels
{
/// The pixels of an image: its active point scalars, or its only point array. Throws
/// std::runtime_error when there is none, or with more than 4 components.
VTKLACUNAFILTERSCOMMON_EXPORT vtkDataArray* Find(vtkImageData* image);

/// True when the array's name is that of a VTK reader that puts the bottom row of a picture first.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsBottomRowFirst(vtkDataArray* pixels);

/// A new array of the pixels' type for a stack of this extent. Throws std::runtime_error when
/// there is not enough memory.
VTKLACUNAFILTERSCOMMON_EXPORT vtkSmartPointer<vtkDataArray> Allocate(
  vtkDataArray* pixels, const std::array<int, 6>& extent);

/// Fills slices toSlice ... toSlice + count - 1 of grey, which is of that extent, with those of
/// image from fromSlice on. rows are the first and the last row of a picture: with flip, row r of
/// image becomes rows[0] + rows[1] - r. Throws std::runtime_error when image lacks any of it.
VTKLACUNAFILTERSCOMMON_EXPORT void Copy(vtkImageData* image, int fromSlice, int count, bool flip,
  const std::array<int, 2>& rows, vtkDataArray* grey, const std::array<int, 6>& extent,
  int toSlice);
}
}
#endif
