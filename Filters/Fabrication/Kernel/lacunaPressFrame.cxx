// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressFrame.h"

#include "lacunaDepthPlane.h"

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
Vec3 FitPlaneNormal(GridSize size, const std::vector<double>& depths, const Vec2& spacing,
  const std::vector<unsigned char>& mask)
{
  const auto forEach = [&](auto&& body)
  {
    for (std::int64_t j = 0; j < size.Rows; ++j)
    {
      for (std::int64_t i = 0; i < size.Columns; ++i)
      {
        const std::int64_t k = i + size.Columns * j;
        if (mask.empty() || mask[k])
        {
          body(Vec3{
            static_cast<double>(i) * spacing[0], static_cast<double>(j) * spacing[1], depths[k] });
        }
      }
    }
  };
  const DepthPlane plane = FitDepthPlane(forEach);
  if (!plane.IsUnique)
  {
    throw std::invalid_argument("the pixels of the defect lie on a line; there is no plane through "
                                "them");
  }
  return Normalized({ plane.Coefficients[1], plane.Coefficients[2], -1 });
}
}
