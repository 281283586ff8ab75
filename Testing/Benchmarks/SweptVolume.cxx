// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sweeps of an analytic scene (lacunaSweptScene.h) reconstructed: seconds, error against the
/// truth, memory, and the time that one slice more takes.
///
/// Beside them two yardsticks of the same run, so that ratios mean something on any machine: Splat,
/// the usual way (lacunaPixelSplat.h), and ReadAndWrite, which only touches the memory.
///
/// Counters: filled, the part of the swept region that has grey levels; RMS, the error there;
/// RMSall, that of all voxels with grey levels, also of those just outside of the swept region;
/// bytes, what one voxel takes; grown_MB, what the process took most in one reconstruction beyond
/// what it had, and peak_MB with it.
#include "lacunaBenchmark.h"
#include "lacunaMemory.h"
#include "lacunaPixelSplat.h"
#include "lacunaSweptScene.h"
#include "lacunaSweptVolume.h"

#include <cstring>
#include <map>
#include <utility>

using namespace lacuna;
using lacunaBenchmark::GetProcessSeconds;
using lacunaBenchmark::Measure;

namespace
{
enum Mode
{
  Footprint,
  Bilinear,
  Nearest,
  NearestVoxel,
  AcrossSlices, ///< footprints that reach across slices
  Wide          ///< the same, 3.5 voxels wide and high: against noise
};
constexpr std::array<const char*, 6> ModeNames{ "Footprint", "Bilinear", "Nearest", "NearestVoxel",
  "AcrossSlices", "Wide" };

SweptVolume::Options GetOptions(Mode mode)
{
  SweptVolume::Options options;
  switch (mode)
  {
    case NearestVoxel:
      options.Interpolation = SweptVolume::Method::NearestVoxel;
      break;
    case AcrossSlices:
    case Wide:
      options.FootprintAcrossSlices = true;
      options.FootprintScale = mode == Wide ? 3.5 : 1;
      break;
    default:
      options.Sampling = static_cast<PixelSampling>(mode);
  }
  return options;
}

template <class T>
const SceneSweep<T>& GetSweep(int count, bool isNoisy)
{
  static std::map<std::pair<int, bool>, std::unique_ptr<SceneSweep<T>>> sweeps;
  auto& sweep = sweeps[{ count, isNoisy }];
  if (!sweep)
  {
    sweep = std::make_unique<SceneSweep<T>>(count, isNoisy);
  }
  return *sweep;
}

VolumeGrid GetGrid(const std::vector<SliceImage>& slices, std::int64_t spacing)
{
  return MakeSceneGrid(slices, static_cast<double>(spacing) / 10);
}

std::array<int, 6> GetExtent(const VolumeGrid& grid)
{
  return { 0, grid.Dimensions[0] - 1, 0, grid.Dimensions[1] - 1, 0, grid.Dimensions[2] - 1 };
}

std::size_t GetSize(const VolumeGrid& grid)
{
  return std::size_t(1) * grid.Dimensions[0] * grid.Dimensions[1] * grid.Dimensions[2];
}

// What a user gets; not initialised, like the arrays of the filter.
template <class T>
struct Volume
{
  explicit Volume(const VolumeGrid& grid)
    : Intensity(new T[GetSize(grid)])
    , Contributions(new unsigned int[GetSize(grid)])
    , Mask(new char[GetSize(grid)])
  {
    PreferLargePages(this->Intensity.get(), GetSize(grid) * sizeof(T));
    PreferLargePages(this->Contributions.get(), GetSize(grid) * sizeof(unsigned int));
    PreferLargePages(this->Mask.get(), GetSize(grid));
  }
  static constexpr std::size_t BytesPerVoxel = sizeof(T) + sizeof(unsigned int) + sizeof(char);
  std::unique_ptr<T[]> Intensity;
  std::unique_ptr<unsigned int[]> Contributions;
  std::unique_ptr<char[]> Mask;
};

// The whole work: memory, slices, arrays.
template <class Out>
Volume<Out> Reconstruct(
  const std::vector<SliceImage>& slices, const VolumeGrid& grid, Mode mode, int threads)
{
  ThreadExecution execution(threads);
  SweptVolume accumulator(grid, GetExtent(grid), GetOptions(mode));
  accumulator.AddSlices(slices, execution);
  Volume<Out> volume(grid);
  accumulator.Write(
    volume.Intensity.get(), volume.Contributions.get(), volume.Mask.get(), execution);
  return volume;
}

template <class In, class Out>
void Batch(benchmark::State& state, bool isNoisy)
{
  const auto& sweep = GetSweep<In>(static_cast<int>(state.range(0)), isNoisy);
  const VolumeGrid grid = GetGrid(sweep.Slices, state.range(1));
  const auto mode = static_cast<Mode>(state.range(2));
  const auto threads = static_cast<int>(state.range(3));
  state.SetLabel(ModeNames[mode]);
  // the first to ask for so much memory waits for the system to make it
  benchmark::DoNotOptimize(Reconstruct<Out>(sweep.Slices, grid, mode, threads));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(Reconstruct<Out>(sweep.Slices, grid, mode, threads));
  }
  const lacunaBenchmark::Memory memory;
  const Volume<Out> volume = Reconstruct<Out>(sweep.Slices, grid, mode, threads);
  memory.Report(state);
  const auto size = static_cast<double>(GetSize(grid));
  const std::vector<char> region = MarkSweptRegion(sweep.TruePoses, grid);
  const SceneScore score = GetScore(grid, region, volume.Intensity.get(), volume.Mask.get());
  state.counters["filled"] = score.Filled;
  state.counters["RMS"] = score.Error;
  state.counters["RMSall"] = score.All;
  state.counters["Mvoxel"] = size * 1e-6;
  state.counters["bytes"] = static_cast<double>(
    SweptVolume::GetBytesPerVoxel(GetOptions(mode)) + Volume<Out>::BytesPerVoxel);
}

// One slice more, one thread, as during a scan. meanMs and worstMs are processor time: what else
// runs on the machine does not count.
void OneByOne(benchmark::State& state)
{
  const auto& sweep = GetSweep<std::uint8_t>(200, false);
  const VolumeGrid grid = GetGrid(sweep.Slices, state.range(0));
  const auto mode = static_cast<Mode>(state.range(1));
  state.SetLabel(ModeNames[mode]);
  ThreadExecution execution(1);
  SweptVolume accumulator(grid, GetExtent(grid), GetOptions(mode));
  std::size_t n = 0;
  double sum = 0;
  double worst = 0;
  for (auto _ : state)
  {
    if (n % sweep.Slices.size() == 0)
    {
      accumulator.BeginSweep();
    }
    const double start = GetProcessSeconds();
    accumulator.AddSlices({ sweep.Slices[n++ % sweep.Slices.size()] }, execution);
    const double seconds = GetProcessSeconds() - start;
    sum += seconds;
    worst = std::max(worst, seconds);
  }
  state.counters["meanMs"] = 1e3 * sum / static_cast<double>(n);
  state.counters["worstMs"] = 1e3 * worst;
}

template <class In>
void Splat(benchmark::State& state, bool isNoisy)
{
  const auto& sweep = GetSweep<In>(static_cast<int>(state.range(0)), isNoisy);
  const VolumeGrid grid = GetGrid(sweep.Slices, state.range(1));
  Volume<float> volume(grid);
  for (auto _ : state)
  {
    std::vector<SplatVoxel> voxels(GetSize(grid));
    SplatPixels<In>(sweep.Slices, grid, voxels);
    for (std::size_t i = 0; i < voxels.size(); ++i)
    {
      volume.Mask[i] = voxels[i].Weight > 0 ? 1 : 0;
      volume.Intensity[i] = volume.Mask[i] ? voxels[i].Sum / voxels[i].Weight : 0;
      volume.Contributions[i] = 1;
    }
  }
  const std::vector<char> region = MarkSweptRegion(sweep.TruePoses, grid);
  const SceneScore score = GetScore(grid, region, volume.Intensity.get(), volume.Mask.get());
  state.counters["filled"] = score.Filled;
  state.counters["RMS"] = score.Error;
  state.counters["RMSall"] = score.All;
}

// Reads the pixels once, and writes once what a volume of floats takes, work space included.
void ReadAndWrite(benchmark::State& state)
{
  const auto& sweep = GetSweep<std::uint8_t>(200, false);
  const VolumeGrid grid = GetGrid(sweep.Slices, state.range(0));
  const std::size_t size = GetSize(grid) *
    (SweptVolume::GetBytesPerVoxel(GetOptions(Footprint)) + Volume<float>::BytesPerVoxel);
  constexpr std::size_t pixels = std::size_t(1) * SceneWidth * SceneHeight;
  for (auto _ : state)
  {
    const std::unique_ptr<char[]> memory(new char[size]);
    std::memset(memory.get(), 1, size);
    unsigned int sum = 0;
    for (const SliceImage& slice : sweep.Slices)
    {
      const auto* const p = static_cast<const std::uint8_t*>(slice.Pixels);
      for (std::size_t i = 0; i < pixels; ++i)
      {
        sum += p[i];
      }
    }
    benchmark::DoNotOptimize(sum);
    benchmark::DoNotOptimize(memory.get());
  }
}

// Clean: 8 bit in, float or 8 bit out. Noisy: float in and out, or 8 bit in and float or 8 bit out.
void CleanFloat(benchmark::State& state)
{
  Batch<std::uint8_t, float>(state, false);
}
void CleanUInt8(benchmark::State& state)
{
  Batch<std::uint8_t, std::uint8_t>(state, false);
}
void NoisyFloat(benchmark::State& state)
{
  Batch<float, float>(state, true);
}
void NoisyUInt8(benchmark::State& state)
{
  Batch<std::uint8_t, float>(state, true);
}
void NoisyUInt8Rounded(benchmark::State& state)
{
  Batch<std::uint8_t, std::uint8_t>(state, true);
}
void SplatClean(benchmark::State& state)
{
  Splat<std::uint8_t>(state, false);
}
void SplatNoisy(benchmark::State& state)
{
  Splat<float>(state, true);
}
}

// spacing in 0.1 mm
BENCHMARK(CleanFloat)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing", "mode", "threads" })
  ->ArgsProduct({ { 200 }, { 5, 4, 3 }, { Footprint, Bilinear, Nearest, NearestVoxel }, { 1, 2 } })
  ->ArgsProduct({ { 200 }, { 4 }, { AcrossSlices, Wide }, { 1, 2 } })
  ->ArgsProduct({ { 600 }, { 4 }, { Footprint, Bilinear, Nearest, AcrossSlices }, { 1, 2 } })
  ->ArgsProduct({ { 200 }, { 4 }, { Footprint }, { 4 } })
  ->ArgsProduct({ { 20, 2000 }, { 4 }, { Footprint }, { 2 } });
BENCHMARK(CleanUInt8)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing", "mode", "threads" })
  ->ArgsProduct({ { 200 }, { 5, 4, 3 }, { Footprint, Bilinear, Nearest }, { 1, 2 } });
BENCHMARK(NoisyFloat)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing", "mode", "threads" })
  ->ArgsProduct({ { 200 }, { 5, 4, 3 }, { Footprint, AcrossSlices, Wide }, { 2 } });
BENCHMARK(NoisyUInt8)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing", "mode", "threads" })
  ->ArgsProduct({ { 200 }, { 4 }, { Footprint, AcrossSlices, Wide }, { 2 } });
BENCHMARK(NoisyUInt8Rounded)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing", "mode", "threads" })
  ->Args({ 200, 4, Wide, 2 });
BENCHMARK(SplatClean)
  ->Apply(Measure)
  ->ArgNames({ "slices", "spacing" })
  ->ArgsProduct({ { 200 }, { 5, 4, 3 } })
  ->ArgsProduct({ { 20, 2000 }, { 4 } });
BENCHMARK(SplatNoisy)->Apply(Measure)->ArgNames({ "slices", "spacing" })->Args({ 200, 4 });
BENCHMARK(ReadAndWrite)->Apply(Measure)->ArgName("spacing")->Arg(4);
BENCHMARK(OneByOne)
  ->Apply(Measure)
  ->ArgNames({ "spacing", "mode" })
  ->ArgsProduct({ { 4 }, { Footprint, Bilinear, Nearest, NearestVoxel, AcrossSlices, Wide } });
BENCHMARK_MAIN();
