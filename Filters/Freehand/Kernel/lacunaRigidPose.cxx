// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRigidPose.h"

#include <cmath>

namespace lacuna
{
std::string DescribeNotRigid(const Matrix4& pose)
{
  constexpr double tolerance = 1e-3;
  if (!pose.IsFinite())
  {
    return "has numbers that are not finite";
  }
  if (!pose.IsAffine())
  {
    return "has a last row other than 0 0 0 1";
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      if (std::abs(Dot(pose.Column(a), pose.Column(b)) - (a == b)) > tolerance)
      {
        return "is not a rotation and a translation";
      }
    }
  }
  return pose.Determinant3() < 0 ? "mirrors" : "";
}
}
