// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthDiscontinuity.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double RadiansPerDegree = 3.14159265358979323846 / 180;

void CheckAngle(const char* name, double degrees, double limit)
{
  if (!(degrees >= 0 && degrees <= limit))
  {
    std::ostringstream message;
    message << name << " is " << degrees << " degrees; it must lie within 0 and " << limit;
    throw std::invalid_argument(message.str());
  }
}
}

void DiscontinuityLimits::Check() const
{
  CheckAngle("MaximumAngle", this->MaximumAngle, 90);
  CheckAngle("MaximumAngleChange", this->MaximumAngleChange, 180);
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
