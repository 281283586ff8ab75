// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A closed, smooth surface through data voxels, oriented by their occluded angle.
#ifndef lacunaOcclusionSurface_h
#define lacunaOcclusionSurface_h

#include "lacunaOrientedData.h"
#include "lacunaRadialBasis.h"

#include <array>
#include <memory>
#include <vector>

namespace lacuna
{
struct OcclusionSurfaceOptions
{
  double Smoothing = 1;    ///< above 0, without unit; 1 suits voxels that the surface runs through
  double Tolerance = 0.05; ///< how much the function may be wrong, in voxel edges, 0.001...0.5
};

/// What a fit came to. Lengths in mm.
struct OcclusionSurfaceReport
{
  std::int64_t DataVoxels = 0;              ///< that carry the surface
  std::int64_t Outliers = 0;                ///< that do not
  std::int64_t Together = 0;                ///< of these, see OrientedData::Together
  std::array<std::int64_t, 3> TogetherAt{}; ///< voxel of the grid
  std::int64_t Nodes = 0;                   ///< of the radial basis function
  double Residual = 0; ///< root mean square distance of the data from the surface
};

/// s(x), about the signed distance from the surface, negative inside: the radial basis function
/// r^3 (twice continuously differentiable) that smooths
/// - 0 at the data, and distances at points a quarter of a voxel edge before and behind them (Carr
///   et al. 2001), outwards being where the occluded angle falls;
/// - rough distances of the object's surface far from it, so that there are no other surfaces.
///
/// Four rounds: from the second the surface's own normals count, and each datum as much as the 24
/// around it agree with the surface: at least 0.01 voxel edges are taken as their error (exact
/// faces), at most 0.3 (voxels half an edge around the surface: 0.29).
class OcclusionSurface
{
public:
  using Point = std::array<double, 3>;

  /// Throws std::invalid_argument for options out of range and what OrientData throws; what
  /// RadialBasis throws.
  OcclusionSurface(
    Execution& execution, const OcclusionImages& images, const OcclusionSurfaceOptions& options);

  const OcclusionSurfaceReport& GetReport() const { return this->Report; }

  /// s (mm) at the images' voxels and GridMargin more on every side, x fastest.
  static constexpr std::int64_t GridMargin = 3;
  std::vector<float> EvaluateGrid(Execution& execution) const;

  /// Moves points (mm from the centre of the first voxel, along the axes of the grid) onto the
  /// surface by Newton steps, each at most one voxel edge in all; normals, unit and outwards, are
  /// the function's gradient.
  void Project(Execution& execution, std::vector<Point>& points, std::vector<Point>& normals) const;

private:
  void Fit(Execution& execution, const OrientedData& data, const std::vector<double>& errors);
  // Distances of the data from the surface, with the gradient's direction as their normals.
  std::vector<double> Compare(Execution& execution, OrientedData& data) const;

  OcclusionImages Images;
  OcclusionSurfaceOptions Options;
  OcclusionSurfaceReport Report;
  std::unique_ptr<RadialBasis<3>> Function; // in voxel edges
};
}
#endif
