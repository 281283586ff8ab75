// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSlicePair.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna
{
namespace
{
// Far above rounding and far below what a tracker resolves: voxels on a slice or on its border,
// as in grids that fit the slices exactly, do not drop out by chance. In voxels and pixels.
constexpr double Tolerance = 1e-6;
// Normals at 90 degrees but for rounding count as 90 degrees.
constexpr double SmallestCosine = 1e-6;
// Lines along y jump in memory: they pay when they are this many times longer.
constexpr double TransposeRatio = 2;

SlicePair::Functions GetFunctions(const SampledSlice& slice, bool transposed)
{
  SlicePair::Functions f{ slice.Column, slice.Row, slice.Distance, slice.FanX, slice.FanY };
  if (transposed)
  {
    for (AffineFunction* g : { &f.Column, &f.Row, &f.Distance, &f.FanX, &f.FanY })
    {
      std::swap(g->I, g->J);
    }
  }
  return f;
}

// Distances of slice's corners from the plane of other along other's normal, times direction.
std::array<double, 4> GetCornerDistances(
  const SampledSlice& slice, const SampledSlice& other, double direction)
{
  std::array<double, 4> distances;
  for (int i = 0; i < 4; ++i)
  {
    distances[i] = direction * Dot(other.Normal, slice.Corners[i] - other.Corners[0]);
  }
  return distances;
}

double GetLargestMagnitude(const std::array<double, 4>& values)
{
  double largest = 0;
  for (const double v : values)
  {
    largest = std::max(largest, std::abs(v));
  }
  return largest;
}

// mm. Voxels may be far larger than all slices: what lies apart is then still told apart.
double GetDistanceTolerance(const SampledSlice& slice, const VolumeGrid& grid)
{
  return Tolerance *
    std::min({ grid.Spacing[0], grid.Spacing[1], grid.Spacing[2],
      Norm(slice.Corners[1] - slice.Corners[0]), Norm(slice.Corners[2] - slice.Corners[0]) });
}

void AddImageBounds(
  VoxelRegion& region, const SampledSlice& slice, const SlicePair::Functions& functions)
{
  region.Add(functions.Column + (Tolerance - slice.Columns[0]));
  region.Add(-functions.Column + (slice.Columns[1] + Tolerance));
  region.Add(functions.Row + (Tolerance - slice.Rows[0]));
  region.Add(-functions.Row + (slice.Rows[1] + Tolerance));
}
}

SlicePair::SlicePair(const SampledSlice& first, const SampledSlice& second, const VolumeGrid& grid,
  double maximumGap, bool acrossSlices)
  : First(&first)
  , Second(&second)
  , DistanceTolerance(GetDistanceTolerance(first, grid))
  , HalfHeight(acrossSlices ? first.FootprintHeight / 2 : 0)
{
  const double tolerance = this->DistanceTolerance;
  if (!(Dot(first.Normal, second.Normal) > SmallestCosine))
  {
    this->SliceRelation = Relation::Turned;
    return;
  }
  if (GetLargestMagnitude(GetCornerDistances(first, second, 1)) < tolerance &&
    GetLargestMagnitude(GetCornerDistances(second, first, 1)) < tolerance)
  {
    this->SliceRelation = Relation::Coincident;
    return;
  }
  this->Transposed = std::abs(first.Distance.I) > TransposeRatio * std::abs(first.Distance.J);
  this->FirstFunctions = GetFunctions(first, this->Transposed);
  this->SecondFunctions = GetFunctions(second, this->Transposed);
  for (const double direction : { 1.0, -1.0 })
  {
    this->AddWedge(direction, grid, maximumGap);
  }
}

// direction 1: the half where the probe moves along its normal, -1: against it.
void SlicePair::AddWedge(double direction, const VolumeGrid& grid, double maximumGap)
{
  const double tolerance = this->DistanceTolerance;
  // A voxel's foot lies on the first image; from there the way along the normal to the second plane
  // is at most that of the farthest corner.
  const std::array<double, 4> ahead = GetCornerDistances(*this->First, *this->Second, -direction);
  double reach = (*std::max_element(ahead.begin(), ahead.end()) + 2 * tolerance) /
    Dot(this->First->Normal, this->Second->Normal);
  if (reach < 0)
  {
    return;
  }
  reach = maximumGap > 0 ? std::min(reach, maximumGap) : reach;
  double lowest = this->First->Corners[0][2];
  double highest = lowest;
  for (const Vec3& corner : this->First->Corners)
  {
    for (const double way : { -this->HalfHeight, reach + this->HalfHeight })
    {
      const double z = corner[2] + direction * way * this->First->Normal[2];
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
    }
  }
  const auto layerOf = [&](double z)
  {
    const double k = (z - grid.Origin[2]) / grid.Spacing[2];
    return std::clamp(k, -2.0, grid.Dimensions[2] + 1.0);
  };
  Wedge wedge;
  wedge.Layers.First =
    std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(layerOf(lowest) - 0.01)));
  wedge.Layers.Last = std::min<std::int64_t>(
    grid.Dimensions[2] - 1, static_cast<std::int64_t>(std::floor(layerOf(highest) + 0.01)));
  if (wedge.Layers.IsEmpty())
  {
    return;
  }

  const AffineFunction fromFirst = direction * this->FirstFunctions.Distance;
  const AffineFunction toSecond = -direction * this->SecondFunctions.Distance;
  // the tightest bounds first: most rows end there
  wedge.Region.Add(fromFirst + (tolerance + this->HalfHeight));
  wedge.Region.Add(toSecond + (tolerance + this->HalfHeight));
  if (this->HalfHeight > 0)
  {
    wedge.Region.Add(fromFirst + toSecond + tolerance); // not implied by the two
  }
  if (maximumGap > 0)
  {
    wedge.Region.Add(-(fromFirst + toSecond) + (maximumGap + tolerance));
  }
  AddImageBounds(wedge.Region, *this->First, this->FirstFunctions);
  AddImageBounds(wedge.Region, *this->Second, this->SecondFunctions);

  this->Layers = this->NumberOfWedges == 0
    ? wedge.Layers
    : IndexInterval{ std::min(this->Layers.First, wedge.Layers.First),
        std::max(this->Layers.Last, wedge.Layers.Last) };
  this->Wedges[this->NumberOfWedges++] = wedge;
}
}
