// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The arrays of an image as the speckle kernel takes them.
#ifndef lacunaSpeckleInput_h
#define lacunaSpeckleInput_h

#include "lacunaImageView.h"
#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <string>

class vtkImageData;

namespace lacuna::SpeckleInput
{
/// The point array of that name, or the active scalars when the name is empty. Throws
/// std::runtime_error when there is none, or when it has not one value for each point.
vtkDataArray* FindArray(vtkImageData* image, const std::string& name);

/// The array itself, or a copy of it when its numbers are not contiguous in memory.
vtkSmartPointer<vtkDataArray> MakeContiguous(vtkDataArray* array);

/// "array 'Intensity'", for messages.
std::string Name(vtkDataArray* array);

Extent GetExtent(const int extent[6]);
}
#endif
