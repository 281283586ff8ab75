// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which voxels lie between two consecutive slices.
///
/// Let a and b be the signed distances of a voxel from the first and the second slice, along
/// normals that turn with the probe (columns x rows of each image). The planes
/// (1-t) a + t b = 0, 0 <= t <= 1, lead from the first slice to the second one, and a voxel is
/// passed by one of them just when a and b have opposite signs or one is zero: that is what
/// between means. Where the probe moves along its normal a >= 0 >= b, where it moves against it
/// a <= 0 <= b. Planes that intersect within the image have both: the region is then a double
/// wedge, whose halves meet in the line of intersection. The interpolation weight of the second
/// slice, |a|/(|a|+|b|), is the t of the plane that passes the voxel.
///
/// The voxel must also see both slices: its feet lie on both images (how far outside of the centres
/// of the outermost pixels they may lie depends on PixelSampling) and in their fans, if they have
/// any, and the slices are not further apart at the voxel, |a|+|b|, than a limit.
/// Voxels exactly on a slice belong to the pairs on both of its sides, which give them the same
/// grey level.
///
/// Footprints that reach across slices: a voxel has a height, its footprint's extent along the
/// normals, and takes the grey levels of that part of its height which lies between the slices. The
/// region then also holds the voxels that lie outside by up to half of this height. They take grey
/// levels from the pair, but only a pair that they lie between fills them.
///
/// Slices turned by 90 degrees or more against each other are no neighbours in a sweep; those that
/// lie in the same plane have nothing between them.
#ifndef lacunaSlicePair_h
#define lacunaSlicePair_h

#include "lacunaSampledSlice.h"
#include "lacunaVoxelRegion.h"

namespace lacuna
{
/// Two consecutive slices and the region between them.
class SlicePair
{
public:
  enum class Relation
  {
    Neighbours,
    Coincident,
    Turned
  };

  /// maximumGap in mm, 0 = no limit. acrossSlices: the region is that of voxels with a height. The
  /// slices must outlive the pair.
  SlicePair(const SampledSlice& first, const SampledSlice& second, const VolumeGrid& grid,
    double maximumGap, bool acrossSlices);

  Relation GetRelation() const { return this->SliceRelation; }
  const SampledSlice& GetFirst() const { return *this->First; }
  const SampledSlice& GetSecond() const { return *this->Second; }

  /// mm; both slices are this near only where they intersect, and then equally near.
  double GetTolerance() const { return this->DistanceTolerance; }

  /// Half of the voxels' height, mm; 0 unless acrossSlices.
  double GetHalfHeight() const { return this->HalfHeight; }

  /// Layers k of the grid that the region may reach.
  IndexInterval GetLayers() const { return this->Layers; }

  /// True when the region is walked in lines along y, which are then much longer than along x: the
  /// indices i and j of all that follows are exchanged.
  bool IsTransposed() const { return this->Transposed; }
  /// The functions of SampledSlice, for the first and the second slice.
  struct Functions
  {
    AffineFunction Column, Row, Distance, FanX, FanY;
  };
  const Functions& GetFirstFunctions() const { return this->FirstFunctions; }
  const Functions& GetSecondFunctions() const { return this->SecondFunctions; }

  /// The halves of the double wedge; one when the slices do not intersect there.
  int GetNumberOfWedges() const { return this->NumberOfWedges; }
  const VoxelRegion& GetWedge(int i) const { return this->Wedges[i].Region; }
  bool HasLayer(int wedge, std::int64_t k) const
  {
    return k >= this->Wedges[wedge].Layers.First && k <= this->Wedges[wedge].Layers.Last;
  }

private:
  struct Wedge
  {
    VoxelRegion Region;
    IndexInterval Layers;
  };
  void AddWedge(double direction, const VolumeGrid& grid, double maximumGap);

  const SampledSlice* First;
  const SampledSlice* Second;
  Relation SliceRelation = Relation::Neighbours;
  double DistanceTolerance;
  double HalfHeight;
  bool Transposed = false;
  Functions FirstFunctions, SecondFunctions;
  std::array<Wedge, 2> Wedges;
  int NumberOfWedges = 0;
  IndexInterval Layers;
};
}
#endif
