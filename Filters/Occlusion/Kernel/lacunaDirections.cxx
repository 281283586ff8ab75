// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDirections.h"

namespace lacuna
{
namespace
{
const double Pi = 3.14159265358979323846;
}

std::vector<Vec3> EqualAngleLines(int count)
{
  std::vector<Vec3> lines;
  lines.reserve(count);
  for (int i = 0; i < count; ++i)
  {
    const double angle = (i + 0.5) * Pi / count;
    lines.push_back({ std::cos(angle), std::sin(angle), 0 });
  }
  return lines;
}

std::vector<Vec3> EqualAreaLines(int count)
{
  const double turn = 2 * Pi * (std::sqrt(5.0) - 1) / 2;
  std::vector<Vec3> lines;
  lines.reserve(count);
  for (int i = 0; i < count; ++i)
  {
    const double z = (i + 0.5) / count; // slices of equal height have equal area
    const double r = std::sqrt(1 - z * z);
    lines.push_back({ r * std::cos(i * turn), r * std::sin(i * turn), z });
  }
  return lines;
}
}
