// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWaterBath.h"

#include "lacunaSmoothStep.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double Water = 6;
constexpr double Echo = 230;
constexpr double EdgeWidth = 0.8; // mm
constexpr double Fading = 2.5;    // mm
}

void WaterBath::SampleRow(
  const Vec3& start, const Vec3& step, int first, int count, double* values) const
{
  for (int i = 0; i < count; ++i)
  {
    const double depth = start[1] + (first + i) * step[1] - FloorDepth;
    const double behind = std::max(depth - 0.5 * EdgeWidth, 0.0);
    values[i] = Water + (Echo - Water) * SmoothStep(depth, EdgeWidth) * std::exp(-behind / Fading);
  }
}

double WaterBath::IsoValue() const
{
  return 0.5 * (Water + Echo);
}
}
