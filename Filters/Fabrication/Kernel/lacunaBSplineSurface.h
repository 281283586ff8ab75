// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bicubic B-spline surfaces.
#ifndef lacunaBSplineSurface_h
#define lacunaBSplineSurface_h

#include "lacunaCubicSpline.h"
#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
/// A C2 surface S(u, v) of polynomial bicubic patches.
class BSplineSurface
{
public:
  CubicSplineSpace U;
  CubicSplineSpace V;
  /// U.GetSize() x V.GetSize() control points, u fastest, mm.
  std::vector<Vec3> ControlPoints;

  /// The partial derivative of the given orders (0 to 2; 0, 0 is the point itself). u and v are
  /// clamped to their intervals.
  Vec3 Evaluate(double u, double v, int orderU = 0, int orderV = 0) const;

  /// Unit vector along dS/du x dS/dv; zero where the surface is singular.
  Vec3 Normal(double u, double v) const;

  /// True when the first and last curve along u (v) are the same, as on a tube.
  bool IsClosedU() const;
  bool IsClosedV() const;
};
}
#endif
