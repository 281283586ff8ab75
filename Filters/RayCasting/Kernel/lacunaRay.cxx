// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRay.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
bool ClipAxis(const Ray& ray, int axis, double size, double tolerance, RaySpan& span)
{
  const double low = -tolerance - ray.A[axis];
  const double high = size - 1 + tolerance - ray.A[axis];
  if (ray.B[axis] == 0)
  {
    return low <= 0 && high >= 0;
  }
  const double inverse = 1 / ray.B[axis];
  const double u = low * inverse;
  const double v = high * inverse;
  span.First = std::max(span.First, std::min(u, v));
  span.Last = std::min(span.Last, std::max(u, v));
  return span.First < span.Last;
}
}

bool ClipToVolume(const Ray& ray, const std::array<int, 3>& size, RaySpan& span)
{
  span = {};
  for (int a = 0; a < 3; ++a)
  {
    if (!ClipAxis(ray, a, size[a], FaceTolerance, span))
    {
      return false;
    }
  }
  const double length = span.Last - span.First;
  for (int a = 0; a < 3; ++a)
  {
    if (std::abs(ray.B[a]) * length > NoMove && !ClipAxis(ray, a, size[a], 0, span))
    {
      return false;
    }
  }
  return true;
}
}
