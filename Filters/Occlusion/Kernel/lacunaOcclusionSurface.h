// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A closed, smooth surface through data voxels, oriented by their occluded angle.
#ifndef lacunaOcclusionSurface_h
#define lacunaOcclusionSurface_h

#include "lacunaExecution.h"
#include "lacunaProperties.h"
#include "lacunaRadialBasis.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
// Data voxels on the surface of an object that occluded angles made of them, and which side of
// them is outside.

/// Three images of the same 3-D grid, x fastest, that must outlive what is made of them.
struct OcclusionImages
{
  std::array<std::int64_t, 3> Dimensions; ///< at least 2 each
  Vec3 Spacing;                           ///< mm, above 0
  const float* Angle;                     ///< steradians
  const unsigned char* Object;            ///< not 0 where the angle reaches the last threshold
  const unsigned char* Data;              ///< not 0 where the surface was seen

  /// Edge of a cube of a voxel's volume, mm: the unit of length below.
  double GetEdge() const;
};

/// In units of the voxel edge, from the centre of the first voxel, along the axes of the grid.
struct OrientedData
{
  using Point = std::array<double, 3>;

  std::vector<Point> Points;  ///< centres of data voxels on the surface
  std::vector<Point> Normals; ///< unit, outwards: against the gradient of the angle
  std::vector<std::vector<std::int32_t>> Neighbors; ///< the nearest of Points, each with itself
  std::vector<Point> FarPoints;                     ///< a lattice, away from the surface
  std::vector<double> FarDistances;                 ///< of these, roughly: negative inside
  std::int64_t Outliers = 0; ///< data voxels left out: not on the surface of the largest region
  /// Of these, how many lie together (within two voxels of the next) in groups of at least 20 and a
  /// hundredth of the data, as the wall of a cavity does; and a voxel of the largest group.
  std::int64_t Together = 0;
  std::array<std::int64_t, 3> TogetherAt{};
};

/// Takes the data voxels at the surface of the object's largest region (voxels joined by faces):
/// there the angle changes from seen to hidden. Those apart from it are seen from nearly everywhere,
/// those deep in it hidden from everywhere; neither kind is used. Throws std::invalid_argument when
/// there is no object, no data, or fewer than MinimumPoints of them are left.
OrientedData OrientData(const OcclusionImages& images, Execution& execution);

constexpr std::size_t MinimumSurfacePoints = 10;

struct OcclusionSurfaceOptions
{
  double Smoothing = 1;    ///< without unit; 1 suits voxels that the surface runs through
  double Tolerance = 0.05; ///< how much the function may be wrong, in voxel edges

  void Describe(Properties& properties) const; ///< with the ranges
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
