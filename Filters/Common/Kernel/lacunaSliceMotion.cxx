// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceMotion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lacuna
{
std::vector<double> GetSliceSpeeds(const std::vector<Matrix4>& poses,
  const std::vector<char>& usable, const std::vector<double>& times,
  const std::array<Vec3, 4>& corners)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> speeds(poses.size(), none);
  const auto speed = [&](std::size_t a, std::size_t b)
  {
    double way = 0;
    for (const Vec3& corner : corners)
    {
      way = std::max(way, Norm(poses[b].Point(corner) - poses[a].Point(corner)));
    }
    const double time = times[b] - times[a];
    return time > 0 ? way / time : none;
  };
  std::size_t first = poses.size();
  std::size_t last = poses.size();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    if (!usable[i] || !std::isfinite(times[i]))
    {
      continue;
    }
    if (first == poses.size())
    {
      first = i;
    }
    else
    {
      speeds[i] = speed(last, i);
      if (last == first)
      {
        speeds[first] = speeds[i];
      }
    }
    last = i;
  }
  return speeds;
}

double GetRegistrationError(const TrackerAccuracy& accuracy, double distance)
{
  const double radians = accuracy.Angle * std::acos(-1.0) / 180;
  return std::hypot(accuracy.Translation, 2 * distance * std::sin(radians / 2));
}
}
