// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The depth map of slices taken at its word, and what tests of it share.
#ifndef lacunaSliceRayOracle_h
#define lacunaSliceRayOracle_h

#include "lacunaSliceRayCaster.h"
#include "lacunaSyntheticSweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace lacuna
{
/// What SliceRayCaster writes.
struct WrittenMap
{
  explicit WrittenMap(const std::array<int, 4>& extent)
    : Extent(extent)
    , Width(extent[1] - extent[0] + 1)
    , Height(extent[3] - extent[2] + 1)
    , Depth(static_cast<std::size_t>(this->Width) * this->Height)
    , Valid(this->Depth.size())
    , Normals(3 * this->Depth.size())
  {
  }

  double At(int i, int j) const
  {
    return this
      ->Depth[static_cast<std::size_t>(j - this->Extent[2]) * this->Width + i - this->Extent[0]];
  }
  std::int64_t CountValid() const { return std::count(this->Valid.begin(), this->Valid.end(), 1); }

  /// Bit by bit: NaN equals NaN.
  bool operator==(const WrittenMap& other) const
  {
    return this->Depth.size() == other.Depth.size() &&
      std::memcmp(this->Depth.data(), other.Depth.data(), this->Depth.size() * sizeof(double)) ==
      0 &&
      this->Valid == other.Valid && this->Normals == other.Normals;
  }

  std::array<int, 4> Extent;
  int Width, Height;
  std::vector<double> Depth;
  std::vector<char> Valid;
  std::vector<float> Normals;
};

inline std::array<int, 4> GetExtent(const ImagePlane& plane)
{
  return { 0, plane.Size[0] - 1, 0, plane.Size[1] - 1 };
}

inline WrittenMap Write(const SliceRayCaster& caster, const std::array<int, 4>& extent,
  double maximumGap = 0, int threads = 1)
{
  WrittenMap map(extent);
  ThreadExecution execution(threads);
  caster.Write(
    maximumGap, { extent, map.Depth.data(), map.Valid.data(), map.Normals.data() }, execution);
  return map;
}

inline WrittenMap Cast(const std::vector<SliceImage>& slices, const ImagePlane& plane,
  const std::array<int, 4>& extent, double isoValue, SolidSide side = SolidSide::Above,
  double maximumGap = 0, int threads = 1)
{
  ThreadExecution execution(threads);
  SliceRayCaster caster(plane, extent, isoValue, side);
  caster.AddSlices(slices, execution);
  return Write(caster, extent, maximumGap, threads);
}

/// A plane that shows all slices.
inline ImagePlane MakePlane(const std::vector<SliceImage>& slices, const Vec3& direction,
  double pixelSpacing, const Vec3& up = { 0.1, 1, 0.2 })
{
  std::vector<Vec3> points;
  for (const SliceImage& slice : slices)
  {
    for (const Vec3& corner : GetCorners(slice))
    {
      points.push_back(corner);
    }
  }
  ViewSettings view;
  view.Direction = direction;
  view.Up = up;
  view.PixelSpacing = pixelSpacing;
  return MakeImagePlane(points, 1, view);
}

/// Where a ray meets a slice; false when it does not. Solved as three equations in space.
template <class T>
bool IntersectRay(
  const SliceImage& slice, const Vec3& start, const Vec3& ray, double& depth, double& level)
{
  const Matrix4& pose = slice.PixelToReference;
  // start + depth ray = origin + column x + row y
  const Vec3 solution =
    Matrix4::FromColumns(pose.Column(0), pose.Column(1), -1 * ray, pose.Column(3))
      .Inverse()
      .Point(start);
  const double column = solution[0];
  const double row = solution[1];
  depth = solution[2];
  if (!(column >= 0 && column <= slice.Width - 1 && row >= 0 && row <= slice.Height - 1))
  {
    return false;
  }
  if (slice.Fan && !slice.Fan->Contains(column, row))
  {
    return false;
  }
  level = 0;
  double weights = 0;
  for (int y = std::max(0, static_cast<int>(row) - 1);
       y < std::min(slice.Height, static_cast<int>(row) + 3); ++y)
  {
    for (int x = std::max(0, static_cast<int>(column) - 1);
         x < std::min(slice.Width, static_cast<int>(column) + 3); ++x)
    {
      // a tent over each pixel
      const double weight =
        std::max(0.0, 1 - std::abs(column - x)) * std::max(0.0, 1 - std::abs(row - y));
      if (weight > 0 && (!slice.Fan || slice.Fan->Contains(x, y)))
      {
        weights += weight;
        level += weight *
          static_cast<double>(static_cast<const T*>(slice.Pixels)[y * slice.RowStride + x]);
      }
    }
  }
  level /= weights;
  return std::isfinite(level);
}

/// The depth at a pixel: all slices, sorted; the sample in front is the nearest one of the same sweep.
template <class T>
double CastOneRay(const std::vector<SliceImage>& slices, const ImagePlane& plane, int i, int j,
  double isoValue, SolidSide side, double maximumGap)
{
  struct Sample
  {
    double Depth, Level;
    int Sweep;
  };
  std::vector<Sample> samples;
  int sweep = 0;
  for (const SliceImage& slice : slices)
  {
    sweep += slice.BeginsSweep ? 1 : 0;
    Sample sample{ 0, 0, sweep };
    if (!SliceProjection::IsEdgeOn(slice, plane) &&
      IntersectRay<T>(slice, plane.PixelPosition(i, j), plane.View, sample.Depth, sample.Level))
    {
      samples.push_back(sample);
    }
  }
  std::sort(samples.begin(), samples.end(),
    [](const Sample& a, const Sample& b) { return a.Depth < b.Depth; });
  for (std::size_t n = 0; n < samples.size(); ++n)
  {
    const Sample& solid = samples[n];
    if (side == SolidSide::Above ? solid.Level >= isoValue : solid.Level <= isoValue)
    {
      const auto found = std::find_if(samples.rbegin() + (samples.size() - n), samples.rend(),
        [&](const Sample& sample) { return sample.Sweep == solid.Sweep; });
      if (found == samples.rend() || (maximumGap > 0 && solid.Depth - found->Depth > maximumGap))
      {
        return solid.Depth;
      }
      const Sample& front = *found;
      return front.Depth +
        (isoValue - front.Level) / (solid.Level - front.Level) * (solid.Depth - front.Depth);
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}
}
#endif
