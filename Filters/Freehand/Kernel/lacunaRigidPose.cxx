// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRigidPose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lacuna
{
std::string DescribeNotRigid(const Matrix4& pose)
{
  constexpr double tolerance = 1e-3;
  // Numbers of two decimals are off by up to 0.005, the products of axes of them by 0.017.
  constexpr double rounding = 0.0175;
  if (!pose.IsFinite())
  {
    return "has numbers that are not finite";
  }
  if (!pose.IsAffine())
  {
    return "has a last row other than 0 0 0 1";
  }
  double worst = 0;
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      worst = std::max(worst, std::abs(Dot(pose.Column(a), pose.Column(b)) - (a == b)));
    }
  }
  if (worst > rounding)
  {
    return "is not a rotation and a translation";
  }
  if (worst > tolerance)
  {
    char text[160];
    std::snprintf(text, sizeof text,
      "is not a rotation and a translation by %.4f, as of numbers with 2 or 3 decimals: record 5 "
      "and more",
      worst);
    return text;
  }
  return pose.Determinant3() < 0 ? "mirrors" : "";
}
}
