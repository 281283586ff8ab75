// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthDiscontinuity.h"

#include <cmath>

namespace lacuna
{
namespace
{
constexpr double RadiansPerDegree = 3.14159265358979323846 / 180;
}

void DiscontinuityLimits::Describe(Properties& properties) const
{
  properties.Add("MaximumAngle", this->MaximumAngle, ValueRange::Between(0, 90, "degrees"))
    .Add("MaximumAngleChange", this->MaximumAngleChange, ValueRange::Between(0, 180, "degrees"));
}

void DiscontinuityLimits::Check() const
{
  Properties properties;
  this->Describe(properties);
  properties.Check();
}

SlopeRule::SlopeRule(const DiscontinuityLimits& limits)
{
  limits.Check();
  // nothing is steeper than 90 degrees, not even by a rounded cosine
  this->SineOfAngle = std::sin(limits.MaximumAngle * RadiansPerDegree);
  this->CosineOfAngle =
    limits.MaximumAngle < 90 ? std::cos(limits.MaximumAngle * RadiansPerDegree) : 0;
  this->SineOfChange = std::sin(limits.MaximumAngleChange * RadiansPerDegree);
  this->CosineOfChange = std::cos(limits.MaximumAngleChange * RadiansPerDegree);
}
}
