// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The slices of a tracked stack as the kernel takes them.
#ifndef vtkLacunaSliceImages_h
#define vtkLacunaSliceImages_h

#include "lacunaSliceImage.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;

/// The valid slices of one stack (SliceStatus 0), in the order of the stack. Not a part of the
/// module's interface.
struct vtkLacunaSliceImages
{
  /// clip: first column, first row, width and height of the part to use, in pixels of the original
  /// slices; a width or height of 0 reaches to the edge. suffix ends the name of a slice in errors.
  /// Refers to the pixels of stack, which must outlive this object. Throws std::exception with a
  /// text for the user when stack is not what vtkLacunaTrackedSlices.h wants, when a valid slice
  /// has an unusable pose, and when clip leaves less than 2 x 2 pixels.
  vtkLacunaSliceImages(vtkImageData* stack, const int clip[4], const std::string& suffix);

  vtkImageData* Stack;
  vtkSmartPointer<vtkDataArray> GreyLevels; ///< in one piece of memory
  std::vector<lacuna::SliceImage> Slices;
};
#endif
