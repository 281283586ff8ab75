// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Data voxels on the surface of an object that occluded angles made of them, and which side of
/// them is outside.
#ifndef lacunaOrientedData_h
#define lacunaOrientedData_h

#include "lacunaExecution.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
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
}
#endif
