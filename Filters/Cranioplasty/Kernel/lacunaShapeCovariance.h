// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How much the shape of a skull at one place tells about another place.
#ifndef lacunaShapeCovariance_h
#define lacunaShapeCovariance_h

#include "lacunaMirrorPlane.h"
#include "lacunaVector.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// Variations of a shape have these lengths, mm.
constexpr std::array<double, 4> ShapeLengths{ 8, 20, 50, 140 };

/// A variance for each of ShapeLengths, mm^2.
struct ShapeVariances
{
  std::array<double, 4> Common{}; ///< of what both sides of the plane of symmetry share
  std::array<double, 4> Own{};    ///< of what each place has of its own
  double Noise = 0;               ///< of what no neighbour shares
};

/// Correlation of the Matern class with smoothness 5/2 at a distance, mm.
/// Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 4.17.
inline double MaternCorrelation(double distance, double length)
{
  const double a = std::sqrt(5.0) * distance / length;
  return (1 + a + a * a / 3) * std::exp(-a);
}

/// Covariance of two places without their noise: the sum of the own and the common parts at their
/// distance, and the common part at the distance to the mirror image. Both are functions of a distance,
/// which are looked up in tables (cubic, better than 1e-8 of the variance).
class ShapeCovariance
{
public:
  /// reach: no two places, nor their mirror images, are farther apart, mm.
  ShapeCovariance(const ShapeVariances& variances, double reach);

  /// For two places and the mirror image of the second.
  double operator()(const Vec3& a, const Vec3& b, const Vec3& mirrored) const
  {
    return LookUp(this->Direct, Norm(a - b)) + LookUp(this->Across, Norm(a - mirrored));
  }

private:
  struct Knot
  {
    double Value;
    double Slope; ///< times the distance of knots
  };
  double LookUp(const std::vector<Knot>& table, double distance) const
  {
    const double position = distance * this->KnotsPerMillimetre;
    const auto knot = std::min(static_cast<std::size_t>(position), table.size() - 2);
    const double t = position - static_cast<double>(knot);
    const Knot& a = table[knot];
    const Knot& b = table[knot + 1];
    const double rise = b.Value - a.Value;
    return a.Value +
      t * (a.Slope + t * (3 * rise - 2 * a.Slope - b.Slope + t * (a.Slope + b.Slope - 2 * rise)));
  }

  double KnotsPerMillimetre = 1;
  std::vector<Knot> Direct;
  std::vector<Knot> Across;
};
}
#endif
