// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressFrame.h"

#include <cmath>
#include <stdexcept>

namespace lacuna
{
//------------------------------------------------------------------------------
PressFrame MakePressFrame(const Vec3& normal, PressSide side)
{
  if (!IsFinite(normal) || !(std::abs(normal[2]) > 1e-6 * Norm(normal)))
  {
    throw std::invalid_argument("the plane of the fit stands on edge in the depth map (its normal "
                                "is not a number or perpendicular to the view)");
  }
  const double c1 = -normal[0] / normal[2];
  const double c2 = -normal[1] / normal[2];
  PressFrame frame;
  frame.Theta = std::atan(-c2 / std::sqrt(1 + c1 * c1));
  frame.Psi = std::atan(c1);
  frame.Rotation =
    Matrix4::Rotation({ 1, 0, 0 }, frame.Theta) * Matrix4::Rotation({ 0, 1, 0 }, frame.Psi);
  frame.Inwards = Normalized({ -c1, -c2, 1 });
  if (side == PressSide::TowardsViewer)
  {
    frame.Rotation =
      Matrix4::FromColumns({ 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 0, 0, 0 }) * frame.Rotation;
  }
  return frame;
}

//------------------------------------------------------------------------------
Vec3 FitPlaneNormal(GridSize size, const std::vector<double>& depths, const Vec2& spacing)
{
  // on a regular grid the two slopes do not depend on each other
  const double middle[2] = { 0.5 * static_cast<double>(size.Columns - 1),
    0.5 * static_cast<double>(size.Rows - 1) };
  double moments[2] = { 0, 0 };
  double squares[2] = { 0, 0 };
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < size.Columns; ++i)
    {
      const double at[2] = { static_cast<double>(i) - middle[0],
        static_cast<double>(j) - middle[1] };
      for (int k = 0; k < 2; ++k)
      {
        moments[k] += at[k] * depths[i + size.Columns * j];
        squares[k] += at[k] * at[k];
      }
    }
  }
  return Normalized(
    { moments[0] / squares[0] / spacing[0], moments[1] / squares[1] / spacing[1], -1 });
}
}
