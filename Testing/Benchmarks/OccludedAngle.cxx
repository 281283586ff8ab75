// SPDX-License-Identifier: BSD-3-Clause
// Occluded angles beside the time that memory alone needs: 12 bytes per voxel (read the data,
// update the sums), in the same run.
#include "lacunaBenchmark.h"
#include "lacunaOccludedAngle.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

using lacunaBenchmark::Measure;

namespace
{
lacuna::AttenuationField MakeField(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  lacuna::AttenuationField field({ nx, ny, nz }, { 1, 1, 1 });
  std::uint32_t state = 1;
  for (std::int64_t k = 0; k < nz; ++k)
  {
    for (std::int64_t j = 0; j < ny; ++j)
    {
      float* row = field.Row(j, k);
      for (std::int64_t i = 0; i < nx; ++i)
      {
        state = state * 1664525U + 1013904223U;
        row[i] = static_cast<float>(state >> 8) * (0.02F / (1 << 24));
      }
    }
  }
  return field;
}

void PerDirection(benchmark::State& state, double voxels, double directions)
{
  state.counters["ns_per_voxel_and_direction"] =
    benchmark::Counter(voxels * directions * 1e-9, // seconds / (this * 1e9): in ns
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Body>
double ProcessorSeconds(Body&& body)
{
  const double start = lacunaBenchmark::GetProcessSeconds();
  body();
  return lacunaBenchmark::GetProcessSeconds() - start;
}

// The anchor: sums += data.
class Anchor
{
public:
  explicit Anchor(std::int64_t voxels)
    : Data(voxels, 0.5F)
    , Sums(voxels, 0.0F)
  {
  }

  void Run()
  {
    const std::size_t n = this->Sums.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      this->Sums[i] += this->Data[i];
    }
    benchmark::ClobberMemory();
  }

private:
  std::vector<float> Data;
  std::vector<float> Sums;
};

void Stream(benchmark::State& state)
{
  const std::int64_t n = state.range(0) * state.range(0) * state.range(0);
  Anchor anchor(n);
  for (auto _ : state)
  {
    anchor.Run();
  }
  PerDirection(state, static_cast<double>(n), 1);
}
BENCHMARK(Stream)->Arg(192)->Apply(Measure);

// edge, threads, Binary, local radius in voxels
void Cube(benchmark::State& state)
{
  const std::int64_t n = state.range(0);
  lacuna::AttenuationField field = MakeField(n, n, n);
  lacuna::OccludedAngleOptions options;
  options.Directions = n > 200 ? 60 : 200;
  options.Binary = state.range(2) != 0;
  options.Radius = static_cast<double>(state.range(3));
  std::vector<float> angle(field.GetNumberOfVoxels());
  lacuna::ThreadExecution execution(static_cast<int>(state.range(1)));
  Anchor anchor(n * n * n);
  double seconds = 0;
  double anchorSeconds = 0;
  for (auto _ : state)
  {
    seconds += ProcessorSeconds(
      [&] { lacuna::ComputeOccludedAngle(field, options, angle.data(), execution); });
    state.PauseTiming();
    const int times = 20;
    for (int i = 0; i < times; ++i)
    {
      anchorSeconds += ProcessorSeconds([&] { anchor.Run(); }) / times;
    }
    state.ResumeTiming();
  }
  PerDirection(state, static_cast<double>(angle.size()), options.Directions);
  // of the processor, also when others have it meanwhile
  const double perDirection =
    seconds / options.Directions / static_cast<double>(state.iterations());
  state.counters["cpu_ns"] = 1e9 * perDirection / static_cast<double>(angle.size());
  state.counters["times_stream"] = seconds / options.Directions / anchorSeconds;
}
BENCHMARK(Cube)
  ->Args({ 192, 1, 0, 0 })
  ->Args({ 192, 2, 0, 0 })
  ->Args({ 192, 4, 0, 0 })
  ->Args({ 192, 1, 1, 0 })
  ->Args({ 192, 1, 0, 15 })
  ->Args({ 64, 1, 0, 0 })
  ->Args({ 128, 1, 0, 0 })
  ->Args({ 256, 1, 0, 0 })
  ->Args({ 512, 1, 0, 0 })
  ->Apply(Measure);

// The part of each iteration that every rank repeats, whatever directions are its own: filling the field,
// and what a few directions take beyond their share of many.
void Repeated(benchmark::State& state)
{
  const std::int64_t n = state.range(0);
  constexpr int Few = 2;
  constexpr int Many = 42;
  std::vector<float> angle(static_cast<std::size_t>(n * n * n));
  lacuna::ThreadExecution execution(1);
  double fill = 0;
  double few = 0;
  double many = 0;
  for (auto _ : state)
  {
    const double start = lacunaBenchmark::GetProcessSeconds();
    lacuna::AttenuationField field = MakeField(n, n, n);
    fill += lacunaBenchmark::GetProcessSeconds() - start;
    lacuna::OccludedAngleOptions options;
    const auto compute = [&](int directions)
    {
      options.Directions = directions;
      return ProcessorSeconds(
        [&] { lacuna::ComputeOccludedAngle(field, options, angle.data(), execution); });
    };
    few += compute(Few);
    many += compute(Many);
  }
  const double direction = (many - few) / (Many - Few);
  const double repeated = fill + std::max(0.0, few - Few * direction);
  for (const int directions : { 1000, 10000 })
  {
    state.counters["f_" + std::to_string(directions)] =
      repeated / (repeated + directions * direction);
  }
  const double times = static_cast<double>(state.iterations());
  state.counters["repeated_s"] = repeated / times;
  state.counters["direction_s"] = direction / times;
}
BENCHMARK(Repeated)->ArgName("edge")->Arg(128)->Arg(512)->Iterations(3)->Apply(Measure);

// Two threads; times: one after the other.
void Compute(benchmark::State& state, lacuna::AttenuationField field, int directions, int times)
{
  lacuna::OccludedAngleOptions options;
  options.Directions = directions;
  std::vector<float> angle(field.GetNumberOfVoxels());
  lacuna::ThreadExecution execution(2);
  for (auto _ : state)
  {
    for (int i = 0; i < times; ++i)
    {
      lacuna::ComputeOccludedAngle(field, options, angle.data(), execution);
    }
  }
  PerDirection(state, static_cast<double>(angle.size()), 1.0 * times * directions);
}

// argument: edge
void Size(benchmark::State& state)
{
  const std::int64_t n = state.range(0);
  Compute(state, MakeField(n, n, n), 20, 1);
}
BENCHMARK(Size)->ArgName("edge")->Arg(46)->Arg(100)->Arg(215)->Arg(464)->Apply(Measure);

// How much faster several threads are than one, turn by turn in the same run: the shortest time of
// each. On a busy machine look at cpu_ratio, what the threads take together over what one takes.
void Scaling(benchmark::State& state)
{
  lacuna::AttenuationField field = MakeField(192, 192, 192);
  lacuna::OccludedAngleOptions options;
  options.Directions = 200;
  std::vector<float> angle(field.GetNumberOfVoxels());
  const int threads[2] = { 1, static_cast<int>(state.range(0)) };
  double wall[2] = { 1e9, 1e9 };
  double cpu[2] = { 1e9, 1e9 };
  for (auto _ : state)
  {
    for (int i : { 0, 1 })
    {
      lacuna::ThreadExecution execution(threads[i]);
      const auto start = std::chrono::steady_clock::now();
      cpu[i] = std::min(cpu[i],
        ProcessorSeconds(
          [&] { lacuna::ComputeOccludedAngle(field, options, angle.data(), execution); }));
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      wall[i] = std::min(wall[i], taken.count());
    }
  }
  state.counters["one_ms"] = 1e3 * wall[0];
  state.counters["all_ms"] = 1e3 * wall[1];
  state.counters["speedup"] = wall[0] / wall[1];
  state.counters["cpu_ratio"] = cpu[1] / cpu[0];
}
BENCHMARK(Scaling)->Arg(2)->Iterations(10)->Apply(Measure);

// The thesis's kumara: 190 x 80 x 90 voxels, two iterations of 1000 directions.
void Kumara(benchmark::State& state)
{
  Compute(state, MakeField(190, 80, 90), 1000, 2);
}
BENCHMARK(Kumara)->Apply(Measure);
}

BENCHMARK_MAIN();
