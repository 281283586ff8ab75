// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceImage.h"

#include <stdexcept>

namespace lacuna
{
void CheckSlice(const SliceImage& slice)
{
  if (slice.Width < 2 || slice.Height < 2)
  {
    throw std::invalid_argument(slice.Label + " has " + std::to_string(slice.Width) + " x " +
      std::to_string(slice.Height) + " usable pixels; at least 2 x 2 are needed");
  }
  if (slice.Fan && (slice.Fan->GetWidth() != slice.Width || slice.Fan->GetHeight() != slice.Height))
  {
    throw std::invalid_argument(slice.Label + " has " + std::to_string(slice.Width) + " x " +
      std::to_string(slice.Height) + " pixels, its fan was made for " +
      std::to_string(slice.Fan->GetWidth()) + " x " + std::to_string(slice.Fan->GetHeight()));
  }
  const char* const advice =
    "; mark the slice invalid (SliceStatus 1) to leave it out, or mend its transform";
  const Matrix4& pose = slice.PixelToReference;
  if (!pose.IsFinite())
  {
    throw std::invalid_argument(
      slice.Label + ": its pose has elements that are not finite" + advice);
  }
  if (!pose.IsAffine())
  {
    throw std::invalid_argument(
      slice.Label + ": its pose is not affine (the last row is not 0 0 0 1)" + advice);
  }
  const Vec3 x = pose.Column(0);
  const Vec3 y = pose.Column(1);
  if (!(Norm(x) > 0) || !(Norm(y) > 0))
  {
    throw std::invalid_argument(slice.Label + ": its pose is singular, the pixel spacing along " +
      (Norm(x) > 0 ? "rows" : "columns") + " is 0 mm" + advice);
  }
  // A right angle between rows and columns is usual, a millionth of it is no plane.
  if (!(Norm(Cross(x, y)) > 1e-6 * Norm(x) * Norm(y)))
  {
    throw std::invalid_argument(
      slice.Label + ": its pose is singular, rows and columns are parallel" + advice);
  }
}

void CutSlice(SliceImage& slice, int column, int row, int width, int height)
{
  if (slice.Pixels)
  {
    slice.Pixels = static_cast<const unsigned char*>(slice.Pixels) +
      (slice.RowStride * row + column) * static_cast<std::int64_t>(GetScalarSize(slice.Type));
  }
  slice.Width = width;
  slice.Height = height;
}

std::array<Vec3, 4> GetCorners(const SliceImage& slice)
{
  const double right = slice.Width - 1;
  const double bottom = slice.Height - 1;
  const Matrix4& pose = slice.PixelToReference;
  return { pose.Point({ 0, 0, 0 }), pose.Point({ right, 0, 0 }), pose.Point({ 0, bottom, 0 }),
    pose.Point({ right, bottom, 0 }) };
}
}
