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

/// Of the lengths, those whose variations are rougher in some regions of a skull than in others. The longest
/// is the shape of the whole.
constexpr std::size_t RoughLengths = 3;

/// Covariance of two places without their noise: the sum of the own and the common parts at their
/// distance, and the common part at the distance to the mirror image. Both are functions of a distance,
/// which are looked up in tables (cubic, better than 1e-8 of the variance).
class ShapeCovariance
{
public:
  /// reach: no two places, nor their mirror images, are farther apart, mm.
  ShapeCovariance(const ShapeVariances& variances, double reach);

  /// For two places and the mirror image of the second. roughness: the product of what multiplies the
  /// standard deviations of RoughLengths at both.
  double operator()(const Vec3& a, const Vec3& b, const Vec3& mirrored, double roughness = 1) const
  {
    return LookUp(this->Direct, Norm(a - b), roughness) +
      LookUp(this->Across, Norm(a - mirrored), roughness);
  }

private:
  struct Knot
  {
    double Value;
    double Slope; ///< times the distance of knots
    double RoughValue;
    double RoughSlope;
  };
  double LookUp(const std::vector<Knot>& table, double distance, double roughness) const
  {
    const double position = distance * this->KnotsPerMillimetre;
    const auto knot = std::min(static_cast<std::size_t>(position), table.size() - 2);
    const double t = position - static_cast<double>(knot);
    const Knot& a = table[knot];
    const Knot& b = table[knot + 1];
    const double begin = a.Value + roughness * a.RoughValue;
    const double rise = b.Value + roughness * b.RoughValue - begin;
    const double first = a.Slope + roughness * a.RoughSlope;
    const double last = b.Slope + roughness * b.RoughSlope;
    return begin + t * (first + t * (3 * rise - 2 * first - last + t * (first + last - 2 * rise)));
  }

  double KnotsPerMillimetre = 1;
  std::vector<Knot> Direct;
  std::vector<Knot> Across;
};
}
#endif
