// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bicubic B-spline surfaces through grids of points.
#ifndef lacunaSurfaceFit_h
#define lacunaSurfaceFit_h

#include "lacunaBSplineSurface.h"
#include "lacunaMatrix4.h"
#include "lacunaProperties.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// Searches for the fewest knots with which the least squares cubic splines through many functions
/// sampled at the same sites deviate by no more than a tolerance. Knots are placed where the fourth
/// derivative asks for them (its fourth root is the density of knots at which all intervals deviate
/// alike: de Boor 1978, ch. XII), then moved until they do.
class KnotSelection
{
public:
  /// samples: one row of width values per site; points consist of the given number of consecutive
  /// values. Both are referred to, not copied.
  KnotSelection(const std::vector<double>& sites, const std::vector<double>& samples,
    std::int64_t width, int components);

  /// Interior knots of the space found, and its deviation.
  struct Result
  {
    std::vector<double> Interior;
    double Deviation;
  };

  /// The fewest knots found for a tolerance > 0; at most those of interpolation.
  Result Select(Execution& execution, double tolerance);

  /// The best place found for a given number of knots, 0 <= count <= sites - 4.
  Result SelectCount(Execution& execution, std::int64_t count);

private:
  struct Trial;
  std::vector<double> Place(std::int64_t count) const;
  Trial Try(Execution& execution, std::int64_t count) const;
  void Equalise(const Trial& trial);

  const std::vector<double>& Sites;
  const std::vector<double>& Samples;
  std::int64_t Width;
  int Components;
  std::vector<double> Density; // of knots, per interval between sites
  double LastCount = 0;        // of knots tried, and their deviation: where the next search starts
  double LastDeviation = 0;
};

/// How a surface is fitted.
struct SurfaceFitOptions
{
  /// Largest distance in mm allowed between a sample and the surface at its parameters; as few
  /// knots are used as it takes. 0: interpolation, exact up to rounding.
  double Tolerance = 0.001;

  void Describe(Properties& properties) const; ///< with the range
};

/// A fitted surface and what was achieved.
struct SurfaceFit
{
  BSplineSurface Surface;
  /// mm, over all samples, of the control points as they are (rounded, see Decimals).
  double MaximumDeviation = 0;
  /// Digits after the point, in mm, to which the control points were rounded, so that they can be
  /// written short; 17 when they were not. Rounding counts in the deviation.
  int Decimals = 17;
  /// The parameters of the columns and of the rows of samples.
  std::vector<double> U;
  std::vector<double> V;
};

/// A rectangle of samples: column fastest.
struct GridSize
{
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
};

/// Fits a height field: sample (i, j) is the point toWorld.Point(i, j, heights[i + Columns * j]).
/// u is the column and v the row, so the surface is linear in both but for the height. The third
/// column of toWorld is a unit vector perpendicular to the others, right-handed. Throws
/// std::invalid_argument when it is not, when there are fewer than 4 x 4 samples or when one is not
/// finite, std::runtime_error when
/// double precision cannot reach the tolerance.
SurfaceFit FitHeights(Execution& execution, GridSize size, const std::vector<double>& heights,
  const Matrix4& toWorld, const SurfaceFitOptions& options = {});

/// Fits a surface through points. u runs along the columns from 0 to Columns - 1, v along the rows.
/// Samples sit at whole numbers (uniform parameters); where the mean distances of neighbouring
/// columns (rows) change abruptly, by more than a quarter, at parameters in proportion to them
/// (averaged chord lengths). Throws as FitHeights, and when neighbouring columns (rows) coincide.
/// Does not see whether the surface folds back: see CheckRegular.
SurfaceFit FitPoints(Execution& execution, GridSize size, const std::vector<Vec3>& points,
  const SurfaceFitOptions& options = {});
}
#endif
