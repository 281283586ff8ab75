// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeSymmetry.h"

#include "lacunaVolumeLevel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>

namespace lacuna
{
namespace
{
struct LevelSize
{
  int Cells; ///< at most so many along the longest edge
  std::size_t Samples;
};
constexpr LevelSize Levels[] = { { 20, 2000 }, { 44, 6000 }, { 96, 20000 }, { 192, 150000 } };
constexpr int NumberOfDirections = 320; // some 8 degrees apart
constexpr int NumberOfRingDirections = 36;

// The volume's own frame: mm along its axes, from its first voxel. Mirror planes are mirror planes in
// it because its axes are perpendicular.
struct OwnFrame
{
  explicit OwnFrame(const VoxelVolume& volume)
    : Origin(volume.IndexToWorld.Column(3))
  {
    for (int a = 0; a < 3; ++a)
    {
      const Vec3 step = volume.IndexToWorld.Column(a);
      this->Spacing[a] = Norm(step);
      this->Axes[a] = Normalized(step);
    }
    for (int a = 0; a < 3; ++a)
    {
      if (!(this->Spacing[a] > 0) || !IsFinite(this->Axes[a]) ||
        std::abs(Dot(this->Axes[a], this->Axes[(a + 1) % 3])) > 1e-6)
      {
        throw std::runtime_error("the axes of the volume are not perpendicular to one another (see "
                                 "its spacing and direction matrix)");
      }
    }
  }

  MirrorPlane ToWorld(const MirrorPlane& own) const
  {
    const Vec3& n = own.Normal;
    const Vec3 normal = n[0] * this->Axes[0] + n[1] * this->Axes[1] + n[2] * this->Axes[2];
    return { normal, own.Offset + Dot(normal, this->Origin) };
  }

  Vec3 Origin;
  std::array<Vec3, 3> Axes;
  Vec3 Spacing{ 0, 0, 0 };
};
}

//------------------------------------------------------------------------------
SymmetryResult FindSymmetryPlane(const MaskedVolume& volume, Execution& execution)
{
  const OwnFrame frame(volume.Volume);
  int flat = -1;
  int numberOfFlat = 0;
  double longest = 0;
  double finest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    if (volume.Volume.Size[a] < 2)
    {
      flat = a;
      ++numberOfFlat;
      continue;
    }
    longest = std::max(longest, volume.Volume.Size[a] * frame.Spacing[a]);
    finest = std::min(finest, frame.Spacing[a]);
  }
  if (numberOfFlat > 1)
  {
    throw std::runtime_error("the volume has one row of voxels only; a plane of symmetry can be "
                             "found in a volume or in a slice");
  }
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.2);
  std::vector<std::unique_ptr<SymmetryLevel>> levels;
  for (const LevelSize& size : Levels)
  {
    const double cell = longest / size.Cells;
    auto level =
      std::make_unique<VolumeLevel>(volume, frame.Spacing, cell, size.Samples, execution);
    if (!(level->GetRange() > 0))
    {
      throw std::runtime_error(
        "all valid voxels have the same value, or there is none: there is no "
        "plane of best symmetry; give a plane instead");
    }
    levels.push_back(std::move(level));
    if (cell < finest * 1.5)
    {
      break; // the next one would be the same
    }
  }
  execution.SetStage(0.2, 1);
  // thin stacks of slices have nothing but planes that are nearly perpendicular to the slices
  std::vector<Vec3> directions;
  for (int a = 0; a < 3; ++a)
  {
    const std::vector<Vec3> ring = RingDirections(a, NumberOfRingDirections);
    if (flat < 0 || flat == a)
    {
      directions.insert(directions.end(), ring.begin(), ring.end());
    }
  }
  if (flat < 0)
  {
    const std::vector<Vec3> sphere = HemisphereDirections(NumberOfDirections);
    directions.insert(directions.end(), sphere.begin(), sphere.end());
  }
  SymmetryResult result = FindSymmetryPlane(levels, directions, execution);
  result.Plane = frame.ToWorld(result.Plane);
  return result;
}
}
