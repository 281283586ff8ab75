// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A sweep of an analytic scene reconstructed: seconds, and the error against the truth.
///
/// 200 slices of 640 x 480 pixels of 0.1 mm over 60 mm, twisting from -12 to 12 degrees about the
/// image's vertical and fanning from -8 to 8 degrees about its horizontal; grey levels between 20
/// and 240, 8 bit.
#include "lacunaSweptVolume.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

using namespace lacuna;

namespace
{
constexpr int Width = 640;
constexpr int Height = 480;
constexpr double PixelSpacing = 0.1;
constexpr double Travel = 60;
constexpr double Pi = 3.14159265358979323846;

double Truth(const Vec3& p)
{
  constexpr double turn = 2 * Pi;
  return 130 + 55 * std::sin(turn * p[0] / 25) * std::cos(turn * p[2] / 31) +
    55 * std::sin(turn * (p[1] / 21 + p[2] / 47));
}

struct Sweep
{
  explicit Sweep(int count)
    : Pixels(static_cast<std::size_t>(count) * Width * Height)
  {
    for (int n = 0; n < count; ++n)
    {
      const double t = static_cast<double>(n) / (count - 1);
      SliceImage slice;
      slice.Width = Width;
      slice.Height = Height;
      slice.RowStride = Width;
      slice.Label = "slice " + std::to_string(n);
      slice.PixelToReference = Matrix4::Translation({ 0, 0, Travel * (t - 0.5) }) *
        Matrix4::Rotation({ 0, 1, 0 }, 12 * Pi / 180 * (2 * t - 1)) *
        Matrix4::Rotation({ 1, 0, 0 }, 8 * Pi / 180 * (2 * t - 1)) *
        Matrix4::Scaling({ PixelSpacing, PixelSpacing, 1 }) *
        Matrix4::Translation({ -0.5 * (Width - 1), -0.5 * (Height - 1), 0 });
      slice.Pixels = this->GetPixels(n);
      this->Slices.push_back(slice);
    }
    ThreadExecution execution;
    execution.For(count, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t n = begin; n < end; ++n)
        {
          this->Draw(n);
        }
      });
  }

  std::uint8_t* GetPixels(std::int64_t n) { return this->Pixels.data() + n * Width * Height; }

  void Draw(std::int64_t n)
  {
    std::uint8_t* pixels = this->GetPixels(n);
    const Matrix4& pose = this->Slices[n].PixelToReference;
    for (int y = 0; y < Height; ++y)
    {
      for (int x = 0; x < Width; ++x)
      {
        const Vec3 p = pose.Point({ static_cast<double>(x), static_cast<double>(y), 0 });
        *pixels++ = static_cast<std::uint8_t>(std::lround(Truth(p)));
      }
    }
  }

  std::vector<std::uint8_t> Pixels;
  std::vector<SliceImage> Slices;
};

const Sweep& GetSweep(int count)
{
  static const Sweep shortSweep(200);
  if (count == 200)
  {
    return shortSweep;
  }
  static const Sweep longSweep(600);
  return longSweep;
}

template <class T>
struct Volume
{
  explicit Volume(const VolumeGrid& grid)
    : Intensity(std::size_t(1) * grid.Dimensions[0] * grid.Dimensions[1] * grid.Dimensions[2])
    , Contributions(this->Intensity.size())
    , Mask(this->Intensity.size())
  {
  }
  std::vector<T> Intensity;
  std::vector<unsigned int> Contributions;
  std::vector<char> Mask;
};

template <class T>
double GetError(const VolumeGrid& grid, const Volume<T>& volume)
{
  double sum = 0;
  double count = 0;
  std::size_t n = 0;
  for (int k = 0; k < grid.Dimensions[2]; ++k)
  {
    for (int j = 0; j < grid.Dimensions[1]; ++j)
    {
      for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
      {
        if (volume.Mask[n])
        {
          const Vec3 p{ grid.Origin[0] + i * grid.Spacing[0], grid.Origin[1] + j * grid.Spacing[1],
            grid.Origin[2] + k * grid.Spacing[2] };
          const double e = static_cast<double>(volume.Intensity[n]) - Truth(p);
          sum += e * e;
          count += 1;
        }
      }
    }
  }
  return std::sqrt(sum / count);
}

SweptVolume::Options GetOptions(int sampling)
{
  SweptVolume::Options options;
  if (sampling == 3)
  {
    options.Interpolation = SweptVolume::Method::NearestVoxel;
  }
  else
  {
    options.Sampling = static_cast<PixelSampling>(sampling);
  }
  return options;
}

VolumeGrid GetGrid(const Sweep& sweep, double spacing)
{
  VolumeGridRequest request;
  request.Spacing = { spacing, spacing, spacing };
  return MakeVolumeGrid(sweep.Slices, request);
}

// The whole work: memory, slices, arrays.
template <class T>
Volume<T> Reconstruct(const Sweep& sweep, const VolumeGrid& grid, int sampling, int threads)
{
  ThreadExecution execution(threads);
  SweptVolume accumulator(grid,
    { 0, grid.Dimensions[0] - 1, 0, grid.Dimensions[1] - 1, 0, grid.Dimensions[2] - 1 },
    GetOptions(sampling));
  accumulator.AddSlices(sweep.Slices, execution);
  Volume<T> volume(grid);
  accumulator.Write(
    volume.Intensity.data(), volume.Contributions.data(), volume.Mask.data(), execution);
  return volume;
}

template <class T>
void Batch(benchmark::State& state)
{
  const Sweep& sweep = GetSweep(static_cast<int>(state.range(0)));
  const VolumeGrid grid = GetGrid(sweep, static_cast<double>(state.range(1)) / 10);
  const auto sampling = static_cast<int>(state.range(2));
  const auto threads = static_cast<int>(state.range(3));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(Reconstruct<T>(sweep, grid, sampling, threads));
  }
  const Volume<T> volume = Reconstruct<T>(sweep, grid, sampling, threads);
  double filled = 0;
  for (const char m : volume.Mask)
  {
    filled += m;
  }
  state.counters["RMS"] = GetError(grid, volume);
  state.counters["Mvoxel"] = static_cast<double>(volume.Mask.size()) * 1e-6;
  state.counters["Mfilled"] = filled * 1e-6;
}

// One slice more, one thread, as during a scan.
void OneByOne(benchmark::State& state)
{
  const Sweep& sweep = GetSweep(200);
  const VolumeGrid grid = GetGrid(sweep, static_cast<double>(state.range(0)) / 10);
  ThreadExecution execution(1);
  SweptVolume accumulator(grid,
    { 0, grid.Dimensions[0] - 1, 0, grid.Dimensions[1] - 1, 0, grid.Dimensions[2] - 1 },
    GetOptions(static_cast<int>(state.range(1))));
  std::size_t n = 0;
  for (auto _ : state)
  {
    if (n % sweep.Slices.size() == 0)
    {
      accumulator.BeginSweep();
    }
    accumulator.AddSlices({ sweep.Slices[n++ % sweep.Slices.size()] }, execution);
  }
}
}

// slices, spacing in 0.1 mm, sampling (Footprint, Bilinear, Nearest; 3 = NearestVoxel), threads
BENCHMARK_TEMPLATE(Batch, float)
  ->ArgNames({ "slices", "spacing", "sampling", "threads" })
  ->ArgsProduct({ { 200 }, { 3, 4, 5 }, { 0, 1, 2, 3 }, { 1, 2 } })
  ->ArgsProduct({ { 600 }, { 4 }, { 0, 1 }, { 1, 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Batch, std::uint8_t)
  ->ArgNames({ "slices", "spacing", "sampling", "threads" })
  ->ArgsProduct({ { 200 }, { 3, 4, 5 }, { 0, 1, 2 }, { 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(OneByOne)
  ->ArgNames({ "spacing", "sampling" })
  ->ArgsProduct({ { 4 }, { 0, 1, 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
