// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Slices and volumes for tests, and the definition of the swept volume taken at its word.
#ifndef lacunaSyntheticSweep_h
#define lacunaSyntheticSweep_h

#include "lacunaSweptVolume.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace lacuna
{
/// Slices of grey levels of type T, with their pixels.
template <class T>
class SyntheticSweep
{
public:
  SyntheticSweep(int width, int height, ScalarType type)
    : Width(width)
    , Height(height)
    , Type(type)
  {
  }

  /// grey(column, row) gives the pixels.
  void Add(const Matrix4& pose, const std::function<double(int, int)>& grey)
  {
    auto pixels = std::make_shared<std::vector<T>>();
    for (int y = 0; y < this->Height; ++y)
    {
      for (int x = 0; x < this->Width; ++x)
      {
        pixels->push_back(static_cast<T>(grey(x, y)));
      }
    }
    SliceImage slice;
    slice.Type = this->Type;
    slice.Pixels = pixels->data();
    slice.RowStride = this->Width;
    slice.Width = this->Width;
    slice.Height = this->Height;
    slice.PixelToReference = pose;
    slice.Label = "slice " + std::to_string(this->Slices.size());
    this->Slices.push_back(slice);
    this->Pixels.push_back(pixels);
  }

  /// The pixels sample a field in space.
  void AddField(const Matrix4& pose, const std::function<double(const Vec3&)>& field)
  {
    this->Add(pose,
      [&](int x, int y) {
        return field(pose.Point({ static_cast<double>(x), static_cast<double>(y), 0 }));
      });
  }

  std::vector<SliceImage> Slices;

private:
  int Width, Height;
  ScalarType Type;
  std::vector<std::shared_ptr<std::vector<T>>> Pixels;
};

/// What SweptVolume writes.
template <class T>
struct WrittenVolume
{
  std::vector<T> Intensity;
  std::vector<unsigned int> Contributions;
  std::vector<char> Mask;
  std::int64_t Faults = 0; ///< voxels left empty since they are not finite

  bool operator==(const WrittenVolume& other) const
  {
    return this->Intensity == other.Intensity && this->Contributions == other.Contributions &&
      this->Mask == other.Mask;
  }
};

inline std::array<int, 6> GetExtent(const VolumeGrid& grid)
{
  return { 0, grid.Dimensions[0] - 1, 0, grid.Dimensions[1] - 1, 0, grid.Dimensions[2] - 1 };
}

inline std::size_t GetNumberOfVoxels(const std::array<int, 6>& extent)
{
  return static_cast<std::size_t>(extent[1] - extent[0] + 1) * (extent[3] - extent[2] + 1) *
    (extent[5] - extent[4] + 1);
}

inline Vec3 GetPoint(const VolumeGrid& grid, int i, int j, int k)
{
  return { grid.Origin[0] + i * grid.Spacing[0], grid.Origin[1] + j * grid.Spacing[1],
    grid.Origin[2] + k * grid.Spacing[2] };
}

template <class T>
WrittenVolume<T> Write(const SweptVolume& volume, const std::array<int, 6>& extent, int threads = 1)
{
  WrittenVolume<T> written;
  const std::size_t size = GetNumberOfVoxels(extent);
  written.Intensity.resize(size);
  written.Contributions.resize(size);
  written.Mask.resize(size);
  ThreadExecution execution(threads);
  written.Faults = volume.Write(
    written.Intensity.data(), written.Contributions.data(), written.Mask.data(), execution);
  return written;
}

/// All slices as one sweep.
template <class T>
WrittenVolume<T> Reconstruct(const std::vector<SliceImage>& slices, const VolumeGrid& grid,
  const std::array<int, 6>& extent, const SweptVolume::Options& options, int threads = 1)
{
  ThreadExecution execution(threads);
  SweptVolume volume(grid, extent, options);
  volume.AddSlices(slices, execution);
  return Write<T>(volume, extent, threads);
}

/// A sweep of random poses: small steps forwards and back, turns, slices that intersect.
inline std::vector<Matrix4> MakeRandomPoses(int count, unsigned int seed, double turn)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  // compilers evaluate arguments in different orders
  const auto rotate = [&](double turn)
  {
    const double angle = turn * u(random);
    return Matrix4::Rotation({ u(random), u(random), u(random) }, angle);
  };
  // any overall orientation of the probe, sheared pixels of unequal size
  const Matrix4 turned = rotate(3);
  const Matrix4 probe = Matrix4::Translation({ 30 * u(random), 20, -40 }) * turned;
  std::vector<Matrix4> poses;
  for (int n = 0; n < count; ++n)
  {
    Matrix4 pixels = Matrix4::Scaling({ 0.31, 0.23, 1 });
    pixels(0, 1) = 0.02;
    const Matrix4 tilted = rotate(turn);
    const Matrix4 moved = Matrix4::Translation({ 0.5 * u(random), 0.5 * u(random), 0.6 * n });
    poses.push_back(probe * moved * tilted * pixels * Matrix4::Translation({ -15, -12, 0 }));
  }
  return poses;
}

inline VolumeGrid MakeGrid(const std::vector<SliceImage>& slices, const Vec3& spacing)
{
  VolumeGridRequest request;
  request.Spacing = spacing;
  return MakeVolumeGrid(slices, request);
}
}
#endif
