// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A sweep of an analytic scene, without and with noise, and what is known about its volume.
///
/// Slices of 640 x 480 pixels of 0.1 mm over 60 mm, twisting from -12 to 12 degrees about the image's
/// vertical and fanning from -8 to 8 degrees about its horizontal; grey levels between 20 and 240.
///
/// Noise: each pixel times 1 + 0.15 N, N independent and standard normal, in 8 bit then rounded and
/// cut to 0..255; and each slice reported where it is not: moved by 0.1 N mm along each of its axes
/// and turned by 0.1 N degrees about each of them, through the image's centre. The pixels are those
/// of the true place.
#ifndef lacunaSweptScene_h
#define lacunaSweptScene_h

#include "lacunaCounterNoise.h"
#include "lacunaExecution.h"
#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace lacuna
{
constexpr int SceneWidth = 640;
constexpr int SceneHeight = 480;
constexpr double ScenePixelSpacing = 0.1;
constexpr double SceneTravel = 60;

inline double GetSceneTruth(const Vec3& p)
{
  constexpr double turn = 2 * 3.14159265358979323846;
  return 130 + 55 * std::sin(turn * p[0] / 25) * std::cos(turn * p[2] / 31) +
    55 * std::sin(turn * (p[1] / 21 + p[2] / 47));
}

/// The sweep of count slices, or the first ones of it. T: std::uint8_t or float.
template <class T>
class SceneSweep
{
public:
  SceneSweep(int count, bool isNoisy)
    : SceneSweep(count, isNoisy, count)
  {
  }
  SceneSweep(int count, bool isNoisy, int first)
    : Pixels(new T[std::size_t(1) * first * SceneWidth * SceneHeight])
  {
    constexpr double degree = 3.14159265358979323846 / 180;
    const Matrix4 pixels = Matrix4::Scaling({ ScenePixelSpacing, ScenePixelSpacing, 1 }) *
      Matrix4::Translation({ -0.5 * (SceneWidth - 1), -0.5 * (SceneHeight - 1), 0 });
    for (int n = 0; n < first; ++n)
    {
      const double t = static_cast<double>(n) / (count - 1);
      const Matrix4 pose = Matrix4::Translation({ 0, 0, SceneTravel * (t - 0.5) }) *
        Matrix4::Rotation({ 0, 1, 0 }, 12 * degree * (2 * t - 1)) *
        Matrix4::Rotation({ 1, 0, 0 }, 8 * degree * (2 * t - 1));
      const CounterNoise noise(1, n);
      const auto jitter = [&](std::uint64_t i) { return isNoisy ? 0.1 * noise.Normal(i) : 0; };
      const Matrix4 error = Matrix4::Translation({ jitter(0), jitter(1), jitter(2) }) *
        Matrix4::Rotation({ 1, 0, 0 }, degree * jitter(3)) *
        Matrix4::Rotation({ 0, 1, 0 }, degree * jitter(4)) *
        Matrix4::Rotation({ 0, 0, 1 }, degree * jitter(5));
      SliceImage slice;
      slice.Type = std::is_same<T, std::uint8_t>::value ? ScalarType::UInt8 : ScalarType::Float32;
      slice.Pixels = this->GetPixels(n);
      slice.Width = SceneWidth;
      slice.Height = SceneHeight;
      slice.RowStride = SceneWidth;
      slice.PixelToReference = pose * error * pixels;
      slice.Label = "slice " + std::to_string(n);
      this->Slices.push_back(slice);
      this->TruePoses.push_back(pose * pixels);
    }
    ThreadExecution execution;
    execution.For(first, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t n = begin; n < end; ++n)
        {
          this->Draw(n, isNoisy);
        }
      });
  }

  std::vector<SliceImage> Slices;
  std::vector<Matrix4> TruePoses; ///< PixelToReference without the jitter

private:
  T* GetPixels(std::int64_t n) { return this->Pixels.get() + n * SceneWidth * SceneHeight; }

  void Draw(std::int64_t n, bool isNoisy)
  {
    const CounterNoise noise(2, n);
    T* const pixels = this->GetPixels(n);
    for (int i = 0; i < SceneWidth * SceneHeight; ++i)
    {
      double grey = GetSceneTruth(this->TruePoses[n].Point(
        { static_cast<double>(i % SceneWidth), static_cast<double>(i / SceneWidth), 0 }));
      grey *= isNoisy ? 1 + 0.15 * noise.Normal(i) : 1;
      pixels[i] = std::is_same<T, std::uint8_t>::value
        ? static_cast<T>(std::lround(std::clamp(grey, 0.0, 255.0)))
        : static_cast<T>(grey);
    }
  }

  std::unique_ptr<T[]> Pixels;
};

/// For each voxel, 1 in the swept region: between the true places of two consecutive slices, its feet
/// on both between the centres of the outermost pixels. The scene's slices do not intersect.
inline std::vector<char> MarkSweptRegion(const std::vector<Matrix4>& poses, const VolumeGrid& grid)
{
  std::vector<Matrix4> toSlice;
  for (const Matrix4& pose : poses)
  {
    const Vec3 x = pose.Column(0);
    const Vec3 y = pose.Column(1);
    toSlice.push_back(
      Matrix4::FromColumns(x, y, Normalized(Cross(x, y)), pose.Column(3)).Inverse());
  }
  const std::int64_t layer = std::int64_t(1) * grid.Dimensions[0] * grid.Dimensions[1];
  std::vector<char> region(layer * grid.Dimensions[2]);
  ThreadExecution execution;
  execution.For(static_cast<std::int64_t>(region.size()), layer,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t n = begin; n < end; ++n)
      {
        const Vec3 p{ grid.Origin[0] +
            static_cast<double>(n % grid.Dimensions[0]) * grid.Spacing[0],
          grid.Origin[1] + static_cast<double>(n % layer / grid.Dimensions[0]) * grid.Spacing[1],
          grid.Origin[2] + static_cast<double>(n / layer) * grid.Spacing[2] };
        // the first slice that lies ahead
        const auto next = std::partition_point(
          toSlice.begin(), toSlice.end(), [&](const Matrix4& m) { return m.Point(p)[2] > 0; });
        const auto isOnImage = [&](const Matrix4& m)
        {
          const Vec3 foot = m.Point(p);
          return foot[0] >= 0 && foot[0] <= SceneWidth - 1 && foot[1] >= 0 &&
            foot[1] <= SceneHeight - 1;
        };
        region[n] = next != toSlice.begin() && next != toSlice.end() && isOnImage(*next) &&
            isOnImage(*(next - 1))
          ? 1
          : 0;
      }
    });
  return region;
}

/// A grid of cubic voxels (mm) that holds slices.
inline VolumeGrid MakeSceneGrid(const std::vector<SliceImage>& slices, double spacing)
{
  VolumeGridRequest request;
  request.Spacing = { spacing, spacing, spacing };
  return MakeVolumeGrid(slices, request);
}

/// How well a volume shows the scene.
struct SceneScore
{
  double Filled = 0; ///< part of the swept region that has grey levels
  double Error = 0;  ///< RMS there
  double All = 0;    ///< RMS of all voxels that have grey levels
};

template <class T>
SceneScore GetScore(
  const VolumeGrid& grid, const std::vector<char>& region, const T* intensity, const char* mask)
{
  double sums[2] = {};
  double counts[2] = {};
  double size = 0;
  std::size_t n = 0;
  for (int k = 0; k < grid.Dimensions[2]; ++k)
  {
    for (int j = 0; j < grid.Dimensions[1]; ++j)
    {
      for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
      {
        size += region[n];
        if (mask[n])
        {
          const double e = static_cast<double>(intensity[n]) -
            GetSceneTruth({ grid.Origin[0] + i * grid.Spacing[0],
              grid.Origin[1] + j * grid.Spacing[1], grid.Origin[2] + k * grid.Spacing[2] });
          sums[region[n] ? 0 : 1] += e * e;
          counts[region[n] ? 0 : 1] += 1;
        }
      }
    }
  }
  return { counts[0] / size, std::sqrt(sums[0] / counts[0]),
    std::sqrt((sums[0] + sums[1]) / (counts[0] + counts[1])) };
}
}
#endif
