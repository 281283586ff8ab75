// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeCovariance.h"

#include <algorithm>

namespace lacuna
{
namespace
{
constexpr double KnotDistance = 0.05; // mm

// Derivative of the correlation by the distance.
double MaternSlope(double distance, double length)
{
  const double a = std::sqrt(5.0) * distance / length;
  return -std::sqrt(5.0) / length * a * (1 + a) / 3 * std::exp(-a);
}
}

ShapeCovariance::ShapeCovariance(const ShapeVariances& variances, double reach)
  : KnotsPerMillimetre(1 / KnotDistance)
{
  const auto count = static_cast<std::size_t>(std::ceil(reach / KnotDistance)) + 2;
  this->Direct.resize(count);
  this->Across.resize(count);
  for (std::size_t k = 0; k < count; ++k)
  {
    const double distance = static_cast<double>(k) * KnotDistance;
    Knot direct{ 0, 0, 0, 0 };
    Knot across{ 0, 0, 0, 0 };
    for (std::size_t i = 0; i < ShapeLengths.size(); ++i)
    {
      const double correlation = MaternCorrelation(distance, ShapeLengths[i]);
      const double change = KnotDistance * MaternSlope(distance, ShapeLengths[i]);
      const auto add = [&](Knot& knot, double variance)
      {
        (i < RoughLengths ? knot.RoughValue : knot.Value) += variance * correlation;
        (i < RoughLengths ? knot.RoughSlope : knot.Slope) += variance * change;
      };
      add(direct, variances.Common[i] + variances.Own[i]);
      add(across, variances.Common[i]);
    }
    this->Direct[k] = direct;
    this->Across[k] = across;
  }
}
}
