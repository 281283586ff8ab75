// SPDX-License-Identifier: BSD-3-Clause
// Radial basis functions of many nodes: fits and grids by fast sums, centre reduction, and how much
// the fast sums gain in the cases of the thesis.
#include "lacunaBenchmark.h"
#include "lacunaCenterReduction.h"
#include "lacunaExecution.h"
#include "lacunaScatteredProblem.h"

#include <algorithm>
#include <stdexcept>

using namespace lacunaBenchmark;
using namespace lacunaScatteredProblem;

namespace
{
// arguments: kernel, nodes, digits of the accuracy, threads (0: all cores)
template <int Dimension>
void FastFit(benchmark::State& state)
{
  const Scattered<Dimension> problem(state.range(1));
  lacuna::ThreadExecution execution(static_cast<int>(state.range(3)));
  const Memory memory;
  for (auto _ : state)
  {
    try
    {
      const lacuna::RadialBasis<Dimension> s(
        execution, problem.Nodes, problem.Values, MakeFastOptions(state));
      state.counters["iterations"] = s.GetReport().Iterations;
      state.counters["residual"] = s.GetReport().Residual;
    }
    catch (const std::runtime_error& error) // the accuracy is out of reach
    {
      state.SkipWithError(error.what());
      return;
    }
  }
  memory.Report(state);
}

// The set-up of the sums included. arguments: kernel, nodes, digits of the accuracy, grid size
template <int Dimension>
void FastGrid(benchmark::State& state)
{
  const Scattered<Dimension> problem(state.range(1));
  lacuna::ThreadExecution execution;
  const lacuna::RadialBasis<Dimension> s(
    execution, problem.Nodes, problem.Values, MakeFastOptions(state));
  lacuna::RegularGrid<Dimension> grid;
  grid.Size.fill(state.range(3));
  grid.Spacing.fill(1.0 / static_cast<double>(state.range(3) - 1));
  std::vector<double> values(grid.GetNumberOfPoints());
  const Memory memory;
  for (auto _ : state)
  {
    s.EvaluateGrid(execution, grid, values.data());
    benchmark::DoNotOptimize(values.data());
  }
  memory.Report(state);
}

// Fewer centres for values that are missed by no more than a tolerance (1 is their range). arguments:
// kernel, nodes, digits of the tolerance
template <int Dimension>
void Reduce(benchmark::State& state)
{
  const Scattered<Dimension> problem(state.range(1));
  lacuna::RadialBasisOptions options = MakeOptions(state.range(0));
  options.Accuracy = 1e-4;
  const auto ends = std::minmax_element(problem.Values.begin(), problem.Values.end());
  const double tolerance = (*ends.second - *ends.first) * MakeFastOptions(state).Accuracy;
  lacuna::ThreadExecution execution;
  const Memory memory;
  for (auto _ : state)
  {
    const lacuna::ReducedCenters<Dimension> reduced = lacuna::ReduceCenters<Dimension>(
      execution, problem.Nodes, { problem.Values }, options, tolerance);
    state.counters["centers"] = static_cast<double>(reduced.Indices.size());
    state.counters["residual/tolerance"] = reduced.Residual / tolerance;
  }
  memory.Report(state);
}

// Fast against direct evaluation in the cases of Carr 1996, section 6.4: a skull's depth about a
// hole, thin plate, accuracy 1e-4 of its range. The time is that of the fast evaluation; counters:
// how many times as long the same took by direct sums (exact, with vectors) and by the plain sum
// (counted in processor time, in the same run), and the largest difference of fast from direct,
// divided by what the accuracy allows. arguments: nodes, grid size
void ThesisCase(benchmark::State& state)
{
  // A hole of 30 mm radius, its nodes up to 12 mm around it, spread evenly by the golden angle
  const auto count = state.range(0);
  std::vector<Point> nodes;
  std::vector<double> depths;
  for (std::int64_t i = 0; i < count; ++i)
  {
    const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = std::sqrt(30.0 * 30 + part * (42.0 * 42 - 30.0 * 30));
    const double angle = 2.399963229728653 * static_cast<double>(i);
    const Point p = { r * std::cos(angle), r * std::sin(angle) };
    nodes.push_back(p);
    depths.push_back(90 - 90 * std::sqrt(1 - std::pow(p[0] / 95, 2) - std::pow(p[1] / 75, 2)) +
      0.5 * std::sin(p[0] / 7) * std::cos(p[1] / 9));
  }
  lacuna::RadialBasisOptions options = MakeOptions(0);
  options.Accuracy = 1e-4;
  lacuna::ThreadExecution execution;
  const lacuna::RadialBasis<2> s(execution, nodes, depths, options);

  lacuna::RegularGrid<2> grid;
  grid.Size.fill(state.range(1));
  grid.Spacing.fill(84.0 / static_cast<double>(state.range(1) - 1));
  grid.Origin.fill(-42);
  std::vector<Point> points = MakeGrid(state.range(1));
  for (Point& p : points)
  {
    p = { -42 + 84 * p[0], -42 + 84 * p[1] };
  }
  std::vector<double> fast(points.size());
  std::vector<double> direct;
  std::vector<double> plain(points.size());
  const Memory memory;
  for (auto _ : state)
  {
    s.EvaluateGrid(execution, grid, fast.data());
    benchmark::DoNotOptimize(fast.data());
  }
  memory.Report(state);
  const double fastTime = GetLeastSeconds([&] { s.EvaluateGrid(execution, grid, fast.data()); });
  const double directTime = GetLeastSeconds([&] { s.Evaluate(execution, points, direct); });
  const double plainTime = GetLeastSeconds([&] { SumPlainly(nodes, depths, points, plain); });
  benchmark::DoNotOptimize(plain.data());
  double error = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    error = std::max(error, std::abs(fast[p] - direct[p]));
  }
  const double allowed = options.Accuracy * s.GetRange();
  state.counters["direct/fast"] = directTime / fastTime;
  state.counters["plain/fast"] = plainTime / fastTime;
  state.counters["error/bound"] = error / allowed;
  if (!(error <= allowed))
  {
    state.SkipWithError("the error is above the bound");
  }
}
}

BENCHMARK_TEMPLATE(FastFit, 2)
  ->ArgNames({ "kernel", "nodes", "digits", "threads" })
  ->ArgsProduct({ { ThinPlate }, { 1000, 10000, 20000, 100000 }, { 4 }, { 0 } })
  ->ArgsProduct({ { ThinPlate }, { 20000 }, { 4 }, { 1, 2, 4 } })
  ->Apply(Measure);
BENCHMARK_TEMPLATE(FastFit, 3)
  ->ArgNames({ "kernel", "nodes", "digits", "threads" })
  ->ArgsProduct({ { Linear }, { 100000, 1000000 }, { 3 }, { 0 } })
  ->Apply(Measure);
BENCHMARK_TEMPLATE(FastGrid, 2)
  ->ArgNames({ "kernel", "nodes", "digits", "grid" })
  ->ArgsProduct({ { ThinPlate }, { 700 }, { 4 }, { 205, 512 } })
  ->ArgsProduct({ { ThinPlate }, { 1000, 10000, 20000, 100000 }, { 4 }, { 512 } })
  ->Apply(Measure);
BENCHMARK_TEMPLATE(FastGrid, 3)
  ->ArgNames({ "kernel", "nodes", "digits", "grid" })
  ->Args({ Linear, 100000, 3, 64 })
  ->Args({ Linear, 1000000, 3, 128 })
  ->Iterations(1) // the fit is not counted, but would be made anew for each trial
  ->Apply(Measure);
BENCHMARK_TEMPLATE(Reduce, 2)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->ArgsProduct({ { ThinPlate }, { 100000 }, { 2, 3, 4 } })
  ->Iterations(1)
  ->Apply(Measure);
BENCHMARK_TEMPLATE(Reduce, 3)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->ArgsProduct({ { Linear }, { 100000 }, { 1, 2, 3 } })
  ->Iterations(1)
  ->Apply(Measure);
BENCHMARK(ThesisCase)
  ->ArgNames({ "nodes", "grid" })
  ->ArgsProduct({ { 697, 578 }, { 205, 512 } })
  ->Apply(Measure);
