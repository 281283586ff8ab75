// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a filter takes while a sweep grows by one slice at a time, as during a scan: all of an
/// update, with what it takes to see that the old slices are the same, and to write the output.
///
/// Slices of lacunaSweptScene.h, 640 x 480, 8 bit, that come without time steps, as from a live
/// source. SliceRayCaster: a map of 512 x 512 along the way of the probe. SweptVolume: voxels of
/// 0.4 mm, fixed OutputBounds. EmptyMap: SliceRayCaster with an IsoValue that no slice has.
///
/// Counters, ms per update: early, the mean of the 5th to the 14th slice; late, that of the last
/// ten; worst; cpuEarly and cpuLate, the processor time of all threads. added: slices that the
/// last update worked on.
#include "lacunaBenchmark.h"
#include "lacunaSweptScene.h"
#include "lacunaTrackedSlices.h"
#include "vtkImageData.h"
#include "vtkLacunaSliceRayCaster.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <numeric>

using namespace lacuna;
using lacunaBenchmark::GetProcessSeconds;

namespace
{
const SceneSweep<std::uint8_t>& GetSweep()
{
  static const SceneSweep<std::uint8_t> sweep(200, false);
  return sweep;
}

// The first slices of the sweep; refers to its pixels.
vtkSmartPointer<vtkImageData> MakeStack(int count)
{
  const auto& slices = GetSweep().Slices;
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(SceneWidth, SceneHeight, count);
  vtkNew<vtkUnsignedCharArray> levels;
  levels->SetName("Intensity");
  auto* pixels = const_cast<void*>(slices[0].Pixels); // nothing writes to an input
  levels->SetArray(static_cast<unsigned char*>(pixels), stack->GetNumberOfPoints(), 1);
  stack->GetPointData()->SetScalars(levels);
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  for (int n = 0; n < count; ++n)
  {
    poses.push_back(slices[n].PixelToReference);
    times.push_back(0.04 * n);
    frames.push_back(n);
  }
  lacuna::TrackedSlices::Write(
    stack, poses, times, std::vector<unsigned char>(poses.size(), 0), frames);
  return stack;
}

double GetMean(const std::vector<double>& values, std::size_t first)
{
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + 10, 0.0) / 10;
}

// One iteration is a whole sweep.
void Grow(benchmark::State& state, const std::function<vtkSmartPointer<vtkImageAlgorithm>()>& make,
  const std::function<vtkIdType(vtkImageAlgorithm*)>& getAdded)
{
  using Clock = std::chrono::steady_clock;
  const auto count = static_cast<int>(state.range(0));
  GetSweep();
  std::vector<double> wall, processor;
  vtkIdType added = 0;
  for (auto _ : state)
  {
    wall.clear();
    processor.clear();
    const vtkSmartPointer<vtkImageAlgorithm> filter = make();
    for (int n = 2; n <= count; ++n)
    {
      const auto stack = MakeStack(n);
      const auto begin = Clock::now();
      const double busy = GetProcessSeconds();
      filter->SetInputDataObject(stack);
      filter->Update();
      processor.push_back(1e3 * (GetProcessSeconds() - busy));
      wall.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    added = getAdded(filter);
  }
  state.counters["early"] = GetMean(wall, 3);
  state.counters["late"] = GetMean(wall, wall.size() - 10);
  state.counters["worst"] = *std::max_element(wall.begin() + 2, wall.end());
  state.counters["cpuEarly"] = GetMean(processor, 3);
  state.counters["cpuLate"] = GetMean(processor, wall.size() - 10);
  state.counters["added"] = static_cast<double>(added);
}

void GrowMap(benchmark::State& state, double isoValue)
{
  Grow(
    state,
    [&]
    {
      auto caster = vtkSmartPointer<vtkLacunaSliceRayCaster>::New();
      caster->SetIsoValue(isoValue);
      caster->SetViewDirection(0, 0, 1);
      caster->SetViewUp(0, -1, 0);
      caster->SetFocalPoint(0, 0, 0);
      caster->SetPlaneOrigin(0, 0, -60);
      caster->SetPixelSpacing(46.0 / 512);
      caster->SetImageSize(512, 512);
      return caster;
    },
    [](vtkImageAlgorithm* filter)
    { return vtkLacunaSliceRayCaster::SafeDownCast(filter)->GetNumberOfCastSlices(); });
}

void SliceRayCaster(benchmark::State& state)
{
  GrowMap(state, 180);
}
void EmptyMap(benchmark::State& state)
{
  vtkObject::GlobalWarningDisplayOff(); // it says that the map is empty
  GrowMap(state, 255);
}

void SweptVolume(benchmark::State& state)
{
  Grow(
    state,
    []
    {
      auto volume = vtkSmartPointer<vtkLacunaSweptVolume>::New();
      volume->SetOutputSpacing(0.4, 0.4, 0.4);
      volume->SetOutputBounds(-34, 34, -28, 28, -37, 37);
      return volume;
    },
    [](vtkImageAlgorithm* filter)
    { return vtkLacunaSweptVolume::SafeDownCast(filter)->GetNumberOfSlicesAdded(); });
}

void Set(benchmark::internal::Benchmark* b)
{
  b->ArgName("slices")->Arg(20)->Arg(200)->Iterations(1)->Apply(lacunaBenchmark::Measure);
}
}

BENCHMARK(SliceRayCaster)->Apply(Set);
BENCHMARK(EmptyMap)->Apply(Set);
BENCHMARK(SweptVolume)->Apply(Set);
BENCHMARK_MAIN();
