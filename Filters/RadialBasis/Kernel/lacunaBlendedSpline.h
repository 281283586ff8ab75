// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A smooth function near any number of oriented points: one spline for all, and local ones upon it.
#ifndef lacunaBlendedSpline_h
#define lacunaBlendedSpline_h

#include "lacunaSurfaceFollower.h"
#include "lacunaSurfaceSpline.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

struct BlendedSplineOptions : SurfaceSplineOptions
{
  /// Local splines are added where points are missed by more than this (RMS), mm.
  double Accuracy = 0.01;
  /// Places that are known to lie inside or outside, mm. The surface leaves each on its side, as far as
  /// the points allow, by at least twice their error and a 500th of their extent.
  std::vector<Vec3> Inside;
  std::vector<Vec3> Outside;
};

struct BlendedSplineReport
{
  SurfaceSplineReport Spline; ///< of all points
  /// mm, of points along the normal (RMS): given, or where points were held out how far they are
  /// missed, or the residuals.
  double PointError = 0;
  bool UsesPrior = false;
  std::size_t LocalSplines = 0; ///< that were of use
  std::size_t Centers = 0;      ///< radial functions in all
  std::size_t WrongSides =
    0;                ///< of Inside and Outside, on the other side of the surface all the same
  Vec3 WrongSideAt{}; ///< one of them
};

/// One SurfaceSpline of all points carries the surface over places without points. Where it misses
/// points by more than they predict each other, local splines of the differences are added: in balls
/// of a few hundred points that overlap, blended by smooth weights (a partition of unity). Further
/// levels have smaller balls, until all points count. A local spline stays only if it predicts the
/// points better that it does not know. So creases and fine detail are followed, and noise is not.
///
/// Time grows in proportion to the number of points.
class BlendedSpline : public ImplicitFunction
{
public:
  /// prior, if not null, is about the signed distance from a surface like this one, mm. Then splines
  /// of the difference are tried, too, and kept if they predict held-out points better; it must live
  /// as long as this. Throws as SurfaceSpline does.
  BlendedSpline(Execution& execution, const OrientedPoints& data,
    const BlendedSplineOptions& options, const ImplicitFunction* prior = nullptr);
  ~BlendedSpline() override;
  BlendedSpline(BlendedSpline&&) noexcept;

  void Evaluate(Execution& execution, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override;

  const BlendedSplineReport& GetReport() const { return this->Report; }

private:
  class Level;

  std::unique_ptr<SurfaceSpline> KeepSides(
    Execution& execution, const OrientedPoints& fitted, const BlendedSplineOptions& options) const;
  void AddLevels(
    Execution& execution, const OrientedPoints& data, const BlendedSplineOptions& options);

  const ImplicitFunction* Prior = nullptr;
  std::unique_ptr<SurfaceSpline> Whole;
  std::vector<std::unique_ptr<Level>> Levels;
  BlendedSplineReport Report;
};
}
#endif
