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

/// A place of a skull as covariances need it.
struct ShapePlace
{
  ShapePlace(const Vec3& point, const MirrorPlane& plane, double roughness)
    : Point(point)
    , Mirrored(plane.Reflect(point))
    , Roughness(roughness)
  {
    for (std::size_t l = 0; l < ShapeLengths.size(); ++l)
    {
      this->Share[l] =
        1 / std::sqrt(1 + MaternCorrelation(Norm(point - this->Mirrored), ShapeLengths[l]));
    }
  }

  Vec3 Point{ 0, 0, 0 };    ///< world mm
  Vec3 Mirrored{ 0, 0, 0 }; ///< its image
  double Roughness = 1;     ///< multiplies the standard deviations of RoughLengths
  /// Multiplies the common part of each length, which is a sum over the place and its image. So its variance is the
  /// same everywhere: without this it would be twice as large at the midline, where both are one.
  std::array<double, 4> Share{};
};

/// Covariance of two places without their noise: the own part at their distance, and the common part at their
/// distance and at that to the mirror image. Correlations are looked up in tables (cubic, better than 1e-8).
class ShapeCovariance
{
public:
  /// reach: no two places, nor their mirror images, are farther apart, mm.
  ShapeCovariance(const ShapeVariances& variances, double reach);

  double operator()(const ShapePlace& a, const ShapePlace& b) const
  {
    const std::array<double, 4> direct = this->LookUp(Norm(a.Point - b.Point));
    const std::array<double, 4> across = this->LookUp(Norm(a.Point - b.Mirrored));
    double rough = 0;
    double rest = 0;
    for (std::size_t l = 0; l < ShapeLengths.size(); ++l)
    {
      (l < RoughLengths ? rough : rest) += this->Variances.Own[l] * direct[l] +
        this->Variances.Common[l] * a.Share[l] * b.Share[l] * (direct[l] + across[l]);
    }
    return rest + a.Roughness * b.Roughness * rough;
  }

private:
  struct Knot
  {
    std::array<double, 4> Value;
    std::array<double, 4> Slope; ///< times the distance of knots
  };
  std::array<double, 4> LookUp(double distance) const
  {
    const double position = distance * this->KnotsPerMillimetre;
    const auto knot = std::min(static_cast<std::size_t>(position), this->Knots.size() - 2);
    const double t = position - static_cast<double>(knot);
    const Knot& a = this->Knots[knot];
    const Knot& b = this->Knots[knot + 1];
    std::array<double, 4> values;
    for (std::size_t l = 0; l < ShapeLengths.size(); ++l)
    {
      const double rise = b.Value[l] - a.Value[l];
      values[l] = a.Value[l] +
        t *
          (a.Slope[l] +
            t *
              (3 * rise - 2 * a.Slope[l] - b.Slope[l] + t * (a.Slope[l] + b.Slope[l] - 2 * rise)));
    }
    return values;
  }

  ShapeVariances Variances;
  double KnotsPerMillimetre = 1;
  std::vector<Knot> Knots;
};
}
#endif
