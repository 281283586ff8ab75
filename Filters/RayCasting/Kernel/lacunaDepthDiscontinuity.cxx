// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthDiscontinuity.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
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

SlopeCase ClassifySlopes(double backward, double forward, const DiscontinuityLimits& limits)
{
  if (std::isnan(backward))
  {
    return std::isnan(forward) ? SlopeCase::Alone : SlopeCase::ForwardOnly;
  }
  if (std::isnan(forward))
  {
    return SlopeCase::BackwardOnly;
  }
  if (std::abs(backward - forward) < limits.MaximumAngleChange)
  {
    return SlopeCase::Smooth;
  }
  const bool steepForward = std::abs(forward) > limits.MaximumAngle;
  const bool steepBackward = std::abs(backward) > limits.MaximumAngle;
  if (steepForward && steepBackward)
  {
    return (forward < 0) != (backward < 0) ? SlopeCase::Spike : SlopeCase::Steep;
  }
  if (steepForward)
  {
    return SlopeCase::TornForward;
  }
  return steepBackward ? SlopeCase::TornBackward : SlopeCase::Crease;
}
}
