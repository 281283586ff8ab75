// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The plane nearest to depths.
#ifndef lacunaDepthPlane_h
#define lacunaDepthPlane_h

#include "lacunaVector.h"

#include <array>

namespace lacuna
{
/// z = c0 + c1 x + c2 y
struct DepthPlane
{
  std::array<double, 3> Coefficients{}; ///< c0 (mm), c1, c2
  /// False when points lie on a line, above the xy plane, or there are none: then c0 is their mean depth, or
  /// 0, and the plane is level.
  bool IsUnique = false;
};

/// The plane nearest to points (x, y, z), which are finite, along z, in the sense of least squares.
/// forEach(body) calls body(const Vec3&) with each of them, in the same order whenever it is called.
template <typename ForEach>
DepthPlane FitDepthPlane(const ForEach& forEach)
{
  double count = 0;
  Vec3 mean{};
  forEach(
    [&](const Vec3& p)
    {
      mean = mean + p;
      ++count;
    });
  if (count == 0)
  {
    return {};
  }
  mean = 1 / count * mean;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  double xz = 0;
  double yz = 0;
  forEach(
    [&](const Vec3& p)
    {
      const Vec3 d = p - mean;
      xx += d[0] * d[0];
      xy += d[0] * d[1];
      yy += d[1] * d[1];
      xz += d[0] * d[2];
      yz += d[1] * d[2];
    });
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-12 * xx * yy))
  {
    return { { mean[2], 0, 0 }, false };
  }
  const double c1 = (yy * xz - xy * yz) / determinant;
  const double c2 = (xx * yz - xy * xz) / determinant;
  return { { mean[2] - (c1 * mean[0] + c2 * mean[1]), c1, c2 }, true };
}
}
#endif
