// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeCovariance.h"

#include <cmath>

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
  : Variances(variances)
  , KnotsPerMillimetre(1 / KnotDistance)
{
  const auto count = static_cast<std::size_t>(std::ceil(reach / KnotDistance)) + 2;
  this->Knots.resize(count);
  for (std::size_t k = 0; k < count; ++k)
  {
    const double distance = static_cast<double>(k) * KnotDistance;
    for (std::size_t l = 0; l < ShapeLengths.size(); ++l)
    {
      this->Knots[k].Value[l] = MaternCorrelation(distance, ShapeLengths[l]);
      this->Knots[k].Slope[l] = KnotDistance * MaternSlope(distance, ShapeLengths[l]);
    }
  }
}
}
