// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSliceImages.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaScalarType.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkMatrix3x3.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace
{
// Pixels of an axis that are used: indices relative to the stack's extent.
struct Range
{
  int First, Last;
};

// Cuts one axis of a stack to a part of the clip rectangle; size 0 reaches to the edge.
Range Clip(vtkImageData* stack, int axis, int start, int size)
{
  const int* extent = stack->GetExtent() + (axis == 0 ? 0 : 2);
  const double origin = stack->GetOrigin()[axis];
  const double spacing = stack->GetSpacing()[axis];
  Range range{ extent[0], extent[1] };
  const double first = origin + spacing * range.First;
  const double last = origin + spacing * range.Last;
  // compared as numbers of columns or rows: far-off requests do not overflow
  const double wantedLast = size > 0 ? start + static_cast<double>(size) - 1 : last;
  range.First = start > last ? range.Last + 1
    : start > first          ? static_cast<int>(std::ceil((start - origin) / spacing - 1e-6))
                             : range.First;
  range.Last = wantedLast < first ? range.First - 1
    : wantedLast < last ? static_cast<int>(std::floor((wantedLast - origin) / spacing + 1e-6))
                        : range.Last;
  if (range.Last - range.First + 1 < 2)
  {
    std::ostringstream message;
    message << "ClipRectangle leaves " << std::max(0, range.Last - range.First + 1)
            << (axis == 0 ? " columns" : " rows") << " of " << first << " to " << last
            << "; at least 2 are needed";
    throw std::runtime_error(message.str());
  }
  return range;
}

void CheckStack(vtkImageData* stack)
{
  if (!stack->GetDirectionMatrix()->IsIdentity())
  {
    throw std::runtime_error(
      "the stack of slices has a direction matrix; the coordinates of tracked slices are (column, "
      "row, slice), where they lie in space is in the field data array 'ImageToReference'");
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(stack->GetSpacing()[a] > 0))
    {
      throw std::runtime_error("the stack of slices has a spacing that is not positive; the "
                               "coordinates of tracked slices are (column, row, slice)");
    }
  }
}
}

//------------------------------------------------------------------------------
vtkLacunaSliceImages::vtkLacunaSliceImages(
  vtkImageData* stack, const int clip[4], const std::string& suffix)
  : Stack(stack)
{
  const vtkLacunaTrackedSlices tracked(stack);
  CheckStack(stack);
  this->GreyLevels = tracked.GetGreyLevels();
  if (!this->GreyLevels->HasStandardMemoryLayout())
  {
    this->GreyLevels.TakeReference(
      vtkDataArray::CreateDataArray(tracked.GetGreyLevels()->GetDataType()));
    this->GreyLevels->DeepCopy(tracked.GetGreyLevels());
  }
  const lacuna::ScalarType type = vtkLacunaScalarType::Get(this->GreyLevels);
  const auto* pixels = static_cast<const unsigned char*>(this->GreyLevels->GetVoidPointer(0));
  const Range columns = Clip(stack, 0, clip[0], clip[2]);
  const Range rows = Clip(stack, 1, clip[1], clip[3]);
  const double* origin = stack->GetOrigin();
  const double* spacing = stack->GetSpacing();
  const lacuna::Matrix4 windowToImage =
    lacuna::Matrix4::Translation(
      { origin[0] + spacing[0] * columns.First, origin[1] + spacing[1] * rows.First, 0 }) *
    lacuna::Matrix4::Scaling({ spacing[0], spacing[1], 1 });

  const int* extent = stack->GetExtent();
  const std::int64_t width = extent[1] - extent[0] + 1;
  const std::int64_t height = extent[3] - extent[2] + 1;
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    const vtkIdType number = tracked.GetSliceNumber(k);
    if (tracked.GetStatus(number) != vtkLacunaTrackedSlices::Valid)
    {
      continue;
    }
    lacuna::SliceImage slice;
    slice.Type = type;
    slice.Pixels = pixels +
      ((k - extent[4]) * height * width + (rows.First - extent[2]) * width + columns.First -
        extent[0]) *
        static_cast<std::int64_t>(lacuna::GetScalarSize(type));
    slice.RowStride = width;
    slice.Width = columns.Last - columns.First + 1;
    slice.Height = rows.Last - rows.First + 1;
    slice.PixelToReference = tracked.GetImageToReference(number) * windowToImage;
    slice.Label = "slice " + std::to_string(number) + suffix;
    lacuna::CheckSlice(slice);
    this->Slices.push_back(slice);
  }
}
