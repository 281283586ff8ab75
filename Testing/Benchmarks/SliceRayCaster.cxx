// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Slices put into a depth map of 512 x 512 pixels, as during a scan: one by one, on one thread;
/// and all at once.
///
/// 200 slices of 640 x 480 pixels of 0.1 mm over 60 mm, twisting from -12 to 12 degrees and fanning
/// from -8 to 8 degrees; a bright ball in darker speckle, 8 bit. The view decides what a slice
/// costs: Across looks along the way of the probe, so that every slice covers all of the map but
/// its corners (the most there can be); Oblique looks at 45 degrees to it. The order decides what
/// is hidden already: Towards brings the nearest slices last, so that all of every slice counts and
/// nothing is hidden; Away brings them first; Shuffled is any order.
///
/// Counters: slices/s, the time for each pixel of the map that a slice covers, both by the time
/// that the process was busy, and the share of the map that a slice covers.
#include "lacunaSliceFingerprint.h"
#include "lacunaSliceRayCaster.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

using namespace lacuna;

namespace
{
constexpr int Count = 200;
constexpr int Width = 640;
constexpr int Height = 480;
constexpr double PixelSpacing = 0.1;
constexpr double Travel = 60;
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr double IsoValue = 110;
constexpr int MapSize = 512;

enum Order
{
  Towards,
  Away,
  Shuffled
};

struct Sweep
{
  Sweep()
    : Pixels(static_cast<std::size_t>(Count) * Width * Height)
  {
    std::mt19937 random(1);
    std::uint8_t* pixel = this->Pixels.data();
    for (int n = 0; n < Count; ++n)
    {
      const double t = 2.0 * n / (Count - 1) - 1;
      SliceImage slice;
      slice.Width = Width;
      slice.Height = Height;
      slice.RowStride = Width;
      slice.Pixels = pixel;
      slice.Label = "slice " + std::to_string(n);
      slice.PixelToReference = Matrix4::Translation({ 0, 0, 0.5 * Travel * t }) *
        Matrix4::Rotation({ 0, 1, 0 }, 12 * Degree * t) *
        Matrix4::Rotation({ 1, 0, 0 }, 8 * Degree * t) *
        Matrix4::Scaling({ PixelSpacing, PixelSpacing, 1 }) *
        Matrix4::Translation({ -0.5 * (Width - 1), -0.5 * (Height - 1), 0 });
      this->Slices.push_back(slice);
      for (int y = 0; y < Height; ++y)
      {
        for (int x = 0; x < Width; ++x)
        {
          const Vec3 p =
            slice.PixelToReference.Point({ static_cast<double>(x), static_cast<double>(y), 0 });
          const double mean = Norm(p) < 20 ? 150 : 60;
          *pixel++ = static_cast<std::uint8_t>(mean + static_cast<double>(random() % 60));
        }
      }
    }
  }

  std::vector<std::uint8_t> Pixels;
  std::vector<SliceImage> Slices;
};

// The viewer looks along z, or 45 degrees from it.
ImagePlane GetPlane(bool oblique)
{
  ViewSettings view;
  view.Direction = { oblique ? 1.0 : 0.0, 0, 1 };
  view.Up = { 0, -1, 0 };
  view.HasFocalPoint = view.HasPlaneOrigin = true;
  view.PlaneOrigin = { -60, 0, -60 };
  view.PixelSpacing = oblique ? 60.0 / MapSize : 46.0 / MapSize;
  view.Size = { MapSize, MapSize };
  return MakeImagePlane({ { 0, 0, 0 } }, 1, view);
}

std::vector<SliceImage> GetSlices(int order)
{
  static const Sweep sweep;
  std::vector<SliceImage> slices = sweep.Slices;
  if (order == Towards)
  {
    std::reverse(slices.begin(), slices.end());
  }
  else if (order == Shuffled)
  {
    std::shuffle(slices.begin(), slices.end(), std::mt19937(1));
  }
  return slices;
}

// Pixels of the map that all slices together cover.
double CountCovered(const std::vector<SliceImage>& slices, const ImagePlane& plane)
{
  double covered = 0;
  for (const SliceImage& slice : slices)
  {
    const SliceProjection projection(slice, plane);
    for (int j = 0; j < MapSize; ++j)
    {
      const IndexInterval row = projection.GetRow(j, { 0, MapSize - 1 });
      covered += static_cast<double>(std::max<std::int64_t>(0, row.Last - row.First + 1));
    }
  }
  return covered;
}

void SetCounters(benchmark::State& state, double covered, double slices)
{
  const auto iterations = static_cast<double>(state.iterations());
  using Counter = benchmark::Counter;
  state.counters["slices/s"] = Counter(slices * iterations, Counter::kIsRate);
  state.counters["pixel"] =
    Counter(covered * slices / Count * iterations, Counter::kIsRate | Counter::kInvert);
  state.counters["coverage"] = covered / Count / MapSize / MapSize;
}

constexpr std::array<int, 4> Extent{ 0, MapSize - 1, 0, MapSize - 1 };

// Slices arrive one by one; one iteration is all of them.
void OneByOne(benchmark::State& state)
{
  const ImagePlane plane = GetPlane(state.range(0) != 0);
  const std::vector<SliceImage> slices = GetSlices(static_cast<int>(state.range(1)));
  ThreadExecution execution(1);
  for (auto _ : state)
  {
    SliceRayCaster caster(plane, Extent, IsoValue, SolidSide::Above);
    for (const SliceImage& slice : slices)
    {
      caster.AddSlices({ slice }, execution);
    }
    benchmark::DoNotOptimize(caster);
  }
  SetCounters(state, CountCovered(slices, plane), Count);
}

void AllAtOnce(benchmark::State& state)
{
  const ImagePlane plane = GetPlane(state.range(0) != 0);
  const std::vector<SliceImage> slices = GetSlices(static_cast<int>(state.range(1)));
  ThreadExecution execution(static_cast<int>(state.range(2)));
  for (auto _ : state)
  {
    SliceRayCaster caster(plane, Extent, IsoValue, SolidSide::Above);
    caster.AddSlices(slices, execution);
    benchmark::DoNotOptimize(caster);
  }
  SetCounters(state, CountCovered(slices, plane), Count);
}

// The map with its normals, once after each slice when all are to be seen.
void Write(benchmark::State& state)
{
  const ImagePlane plane = GetPlane(false);
  ThreadExecution execution(static_cast<int>(state.range(0)));
  SliceRayCaster caster(plane, Extent, IsoValue, SolidSide::Above);
  caster.AddSlices(GetSlices(Away), execution);
  constexpr std::size_t pixels = std::size_t(1) * MapSize * MapSize;
  std::vector<double> depth(pixels);
  std::vector<char> valid(pixels);
  std::vector<float> normals(3 * pixels);
  for (auto _ : state)
  {
    caster.Write(0, { Extent, depth.data(), valid.data(), normals.data() }, execution);
  }
}

// What it takes to see that 200 slices are those of the last time.
void Fingerprints(benchmark::State& state)
{
  const std::vector<SliceImage> slices = GetSlices(Away);
  ThreadExecution execution(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(GetFingerprints(slices, execution));
  }
}
}

// oblique, order (Towards, Away, Shuffled), threads
BENCHMARK(OneByOne)
  ->ArgNames({ "oblique", "order" })
  ->ArgsProduct({ { 0, 1 }, { Towards, Away, Shuffled } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(AllAtOnce)
  ->ArgNames({ "oblique", "order", "threads" })
  ->ArgsProduct({ { 0 }, { Towards, Away, Shuffled }, { 1, 2, 4 } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(Write)
  ->ArgName("threads")
  ->ArgsProduct({ { 1, 2 } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(Fingerprints)
  ->ArgName("threads")
  ->ArgsProduct({ { 1, 2 } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
