// SPDX-License-Identifier: BSD-3-Clause
// Radial basis functions on Franke's function in the unit square (in 3-D times cos 3z): fit, and
// evaluation on a grid, beside the direct sum that one would write first and VTK's thin plate
// spline. CPU is processor time over all threads. peak_MB is the largest memory of the process in the
// row, grown_MB how much of it the row took beyond its input (where Linux tells).
#include "lacunaCenterReduction.h"
#include "lacunaExecution.h"
#include "lacunaHoleFill.h"
#include "lacunaProcessMemory.h"
#include "lacunaRadialBasis.h"
#include "lacunaUpdatableRadialBasis.h"

#include <benchmark/benchmark.h>

#ifdef LACUNA_WITH_VTK_TRANSFORMS
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkThinPlateSplineTransform.h"
#endif

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <random>
#include <vector>

namespace
{
// The memory that a row takes.
class Memory
{
public:
  Memory()
  {
#ifdef __GLIBC__
    malloc_trim(0); // what rows before have freed
#endif
    lacuna::ResetPeakMemory();
    this->Start = lacuna::GetProcessMemory("VmRSS") / 1e6;
  }
  void Report(benchmark::State& state) const
  {
    const double peak = lacuna::GetProcessMemory("VmHWM") / 1e6;
    if (peak > 0)
    {
      state.counters["peak_MB"] = peak;
      state.counters["grown_MB"] = std::max(0.0, peak - this->Start);
    }
  }

private:
  double Start = 0;
};

using Point = std::array<double, 2>;

double Franke(const Point& p)
{
  const auto square = [](double a) { return a * a; };
  const double x = 9 * p[0];
  const double y = 9 * p[1];
  return 0.75 * std::exp(-(square(x - 2) + square(y - 2)) / 4) +
    0.75 * std::exp(-square(x + 1) / 49 - (y + 1) / 10) +
    0.5 * std::exp(-(square(x - 7) + square(y - 3)) / 4) -
    0.2 * std::exp(-square(x - 4) - square(y - 7));
}

struct Problem
{
  std::vector<Point> Nodes;
  std::vector<double> Values;

  explicit Problem(std::int64_t count)
  {
    for (std::int64_t i = 1; i <= count; ++i)
    {
      const double x = static_cast<double>(i) * 0.7548776662466927;
      const double y = static_cast<double>(i) * 0.5698402909980532;
      this->Nodes.push_back({ x - std::floor(x), y - std::floor(y) });
      this->Values.push_back(Franke(this->Nodes.back()));
    }
  }
};

std::vector<Point> MakeGrid(std::int64_t size)
{
  std::vector<Point> points;
  for (std::int64_t j = 0; j < size; ++j)
  {
    for (std::int64_t i = 0; i < size; ++i)
    {
      points.push_back({ static_cast<double>(i) / static_cast<double>(size - 1),
        static_cast<double>(j) / static_cast<double>(size - 1) });
    }
  }
  return points;
}

lacuna::RadialBasisOptions MakeOptions(std::int64_t kernel)
{
  lacuna::RadialBasisOptions options;
  options.Kernel = static_cast<lacuna::RadialKernel>(kernel);
  return options;
}

// arguments: kernel, nodes
void Fit(benchmark::State& state)
{
  const Problem problem(state.range(1));
  lacuna::ThreadExecution execution;
  const Memory memory;
  for (auto _ : state)
  {
    const lacuna::RadialBasis<2> s(
      execution, problem.Nodes, problem.Values, MakeOptions(state.range(0)));
    state.counters["condition"] = s.GetReport().ConditionEstimate;
  }
  memory.Report(state);
}

// arguments: kernel, nodes, grid size, threads, instruction set
void Evaluate(benchmark::State& state)
{
  const Problem problem(state.range(1));
  const std::vector<Point> points = MakeGrid(state.range(2));
  lacuna::ThreadExecution execution(static_cast<int>(state.range(3)));
  const auto set = static_cast<lacuna::InstructionSet>(state.range(4));
  if (set > lacuna::BestInstructionSet())
  {
    state.SkipWithError("this machine lacks the instruction set");
    return;
  }
  lacuna::RadialBasis<2> s(execution, problem.Nodes, problem.Values, MakeOptions(state.range(0)));
  s.SetInstructionSet(set);
  std::vector<double> values;
  const Memory memory;
  for (auto _ : state)
  {
    s.Evaluate(execution, points, values);
    benchmark::DoNotOptimize(values.data());
  }
  memory.Report(state);
}

// The direct sum of a thin plate as one would write it first.
void SumPlainly(const std::vector<Point>& nodes, const std::vector<double>& weights,
  const std::vector<Point>& points, std::vector<double>& values)
{
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    double sum = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      const double dx = points[p][0] - nodes[i][0];
      const double dy = points[p][1] - nodes[i][1];
      const double r2 = dx * dx + dy * dy;
      sum += r2 > 0 ? weights[i] * 0.5 * r2 * std::log(r2) : 0;
    }
    values[p] = sum;
  }
}

// One thread. arguments: nodes, grid size
void PlainSum(benchmark::State& state)
{
  const Problem problem(state.range(0));
  const std::vector<Point> points = MakeGrid(state.range(1));
  std::vector<double> values(points.size());
  const Memory memory;
  for (auto _ : state)
  {
    SumPlainly(problem.Nodes, problem.Values, points, values);
    benchmark::DoNotOptimize(values.data());
  }
  memory.Report(state);
}

// Processor time of a function in milliseconds, the least of several calls.
template <class Function>
double GetMilliseconds(const Function& function)
{
  double least = 0;
  for (int call = 0; call < 5; ++call)
  {
    const std::clock_t start = std::clock();
    function();
    const double time = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    least = call == 0 ? time : std::min(least, time);
  }
  return least;
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
  const double fastTime = GetMilliseconds([&] { s.EvaluateGrid(execution, grid, fast.data()); });
  const double directTime = GetMilliseconds([&] { s.Evaluate(execution, points, direct); });
  const double plainTime = GetMilliseconds([&] { SumPlainly(nodes, depths, points, plain); });
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

template <int Dimension>
struct Scattered
{
  std::vector<std::array<double, Dimension>> Nodes;
  std::vector<double> Values;

  explicit Scattered(std::int64_t count)
  {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::int64_t i = 0; i < count; ++i)
    {
      std::array<double, Dimension> p;
      for (double& x : p)
      {
        x = uniform(random);
      }
      this->Nodes.push_back(p);
      this->Values.push_back(
        Franke({ p[0], p[1] }) * (Dimension == 3 ? std::cos(3 * p[Dimension - 1]) : 1));
    }
  }
};

lacuna::RadialBasisOptions MakeFastOptions(const benchmark::State& state)
{
  lacuna::RadialBasisOptions options = MakeOptions(state.range(0));
  options.Accuracy = std::pow(10.0, -static_cast<double>(state.range(2)));
  return options;
}

// arguments: kernel, nodes, digits of the accuracy
template <int Dimension>
void FastFit(benchmark::State& state)
{
  const Scattered<Dimension> problem(state.range(1));
  lacuna::ThreadExecution execution;
  const Memory memory;
  for (auto _ : state)
  {
    const lacuna::RadialBasis<Dimension> s(
      execution, problem.Nodes, problem.Values, MakeFastOptions(state));
    state.counters["iterations"] = s.GetReport().Iterations;
    state.counters["residual"] = s.GetReport().Residual;
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

// Handles of RBF Hole Filler: five control points in a hole of 30 mm radius, of which one moves. The
// time is that of a fill with the point elsewhere; counter: processor time of the first fill, s. arguments: margin, mm
void DragPoint(benchmark::State& state)
{
  const auto margin = static_cast<double>(state.range(0));
  lacuna::HoleFillInput input;
  input.Grid.Width = input.Grid.Height = 61 + 2 * static_cast<int>(state.range(0));
  input.Grid.Spacing = { 1, 1 };
  const double middle = 30 + margin;
  for (std::size_t i = 0; i < input.Grid.GetSize(); ++i)
  {
    const double x = static_cast<double>(i % input.Grid.Width) - middle;
    const double y = static_cast<double>(i / input.Grid.Width) - middle;
    input.Depth.push_back(90 - 90 * std::sqrt(1 - std::pow(x / 150, 2) - std::pow(y / 130, 2)) +
      0.5 * std::sin(x / 7) * std::cos(y / 9));
    input.Valid.push_back(1);
    input.Defect.push_back(std::hypot(x, y) <= 30);
  }
  for (int k = 0; k < 5; ++k)
  {
    const double angle = 2 * 3.14159265358979 * k / 5;
    input.ControlPoints.push_back(
      { middle + 15.3 * std::cos(angle), middle + 15.3 * std::sin(angle), 2.0 + 0.1 * k });
  }
  lacuna::HoleFillOptions options;
  options.SupportMargin = margin;
  lacuna::ThreadExecution execution;
  lacuna::HoleFiller filler;
  const std::clock_t start = std::clock();
  filler.Fill(execution, input, options);
  const double first = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const Memory memory;
  for (auto _ : state)
  {
    input.ControlPoints[2][0] += 0.01;
    input.ControlPoints[2][2] += 0.01;
    const lacuna::HoleFillResult result = filler.Fill(execution, input, options);
    state.counters["nodes"] = result.Fit.NodeCount;
    if (!result.Reused)
    {
      state.SkipWithError("the equations were solved anew");
    }
  }
  memory.Report(state);
  state.counters["first_s"] = first;
}

// A node of UpdatableRadialBasis moves, and the function is evaluated at one point. Counter: how many
// times as long a new fit takes. arguments: nodes
void MoveNode(benchmark::State& state)
{
  const Problem problem(state.range(0));
  lacuna::ThreadExecution execution(1);
  lacuna::UpdatableRadialBasis<2> s(execution, problem.Nodes, problem.Values, MakeOptions(0));
  std::vector<double> values;
  Point p = problem.Nodes[static_cast<std::size_t>(state.range(0) / 2)];
  const Memory memory;
  const std::clock_t start = std::clock();
  for (auto _ : state)
  {
    p[0] += 1e-6;
    s.Move(static_cast<std::size_t>(state.range(0) / 2), p, 0.5);
    s.Evaluate(execution, { { 0.3, 0.4 } }, values);
    benchmark::DoNotOptimize(values.data());
  }
  memory.Report(state);
  const double milliseconds = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC /
    static_cast<double>(state.iterations());
  state.counters["new_fit/move"] = GetMilliseconds(
                                     [&]
                                     {
                                       const lacuna::RadialBasis<2> fresh(
                                         execution, problem.Nodes, problem.Values, MakeOptions(0));
                                       benchmark::DoNotOptimize(fresh.GetReport().Residual);
                                     }) /
    milliseconds;
}

// What it takes to set up a warp by landmarks in space. arguments: pairs
void WarpSetUp(benchmark::State& state)
{
  const Scattered<3> problem(state.range(0));
  std::vector<std::vector<double>> ways(3, problem.Values);
  lacuna::RadialBasisOptions options = MakeOptions(0);
  options.Accuracy = 1e-4;
  lacuna::ThreadExecution execution;
  const Memory memory;
  for (auto _ : state)
  {
    const lacuna::RadialBasis<3> s(execution, problem.Nodes, ways, options);
    benchmark::DoNotOptimize(s.GetReport().Residual);
  }
  memory.Report(state);
}

#ifdef LACUNA_WITH_VTK_TRANSFORMS
// The same by the peer. arguments: pairs
void WarpSetUpVTK(benchmark::State& state)
{
  const Scattered<3> problem(state.range(0));
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  from->SetDataTypeToDouble();
  to->SetDataTypeToDouble();
  for (std::size_t i = 0; i < problem.Nodes.size(); ++i)
  {
    const auto& p = problem.Nodes[i];
    const double way = problem.Values[i];
    from->InsertNextPoint(p[0], p[1], p[2]);
    to->InsertNextPoint(p[0] + way, p[1] + way, p[2] + way);
  }
  const Memory memory;
  for (auto _ : state)
  {
    vtkNew<vtkThinPlateSplineTransform> transform;
    transform->SetSourceLandmarks(from);
    transform->SetTargetLandmarks(to);
    transform->SetBasisToR2LogR();
    transform->Update();
  }
  memory.Report(state);
}
#endif

constexpr std::int64_t ThinPlate = static_cast<std::int64_t>(lacuna::RadialKernel::ThinPlate);
constexpr std::int64_t Linear = static_cast<std::int64_t>(lacuna::RadialKernel::Linear);
}

BENCHMARK(Fit)
  ->ArgNames({ "kernel", "nodes" })
  ->Args({ ThinPlate, 700 })
  ->Args({ Linear, 700 })
  ->Args({ ThinPlate, 2700 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(PlainSum)
  ->ArgNames({ "nodes", "grid" })
  ->ArgsProduct({ { 700 }, { 205, 512 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(ThesisCase)
  ->ArgNames({ "nodes", "grid" })
  ->ArgsProduct({ { 697, 578 }, { 205, 512 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(Evaluate)
  ->ArgNames({ "kernel", "nodes", "grid", "threads", "set" })
  ->ArgsProduct({ { ThinPlate }, { 700 }, { 205, 512 }, { 1, 2 }, { 0, 1, 2 } })
  ->Args({ Linear, 700, 512, 1, 1 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(FastFit, 2)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->Args({ ThinPlate, 20000, 4 })
  ->Args({ ThinPlate, 100000, 4 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(FastFit, 3)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->Args({ Linear, 100000, 3 })
  ->Args({ Linear, 1000000, 3 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(FastGrid, 2)
  ->ArgNames({ "kernel", "nodes", "digits", "grid" })
  ->ArgsProduct({ { ThinPlate }, { 700 }, { 4 }, { 205, 512 } })
  ->Args({ ThinPlate, 20000, 4, 512 })
  ->Args({ ThinPlate, 100000, 4, 512 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(FastGrid, 3)
  ->ArgNames({ "kernel", "nodes", "digits", "grid" })
  ->Args({ Linear, 100000, 3, 64 })
  ->Args({ Linear, 1000000, 3, 128 })
  ->Iterations(1) // the fit is not counted, but would be made anew for each trial
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Reduce, 2)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->ArgsProduct({ { ThinPlate }, { 100000 }, { 2, 3, 4 } })
  ->Iterations(1)
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Reduce, 3)
  ->ArgNames({ "kernel", "nodes", "digits" })
  ->ArgsProduct({ { Linear }, { 100000 }, { 1, 2, 3 } })
  ->Iterations(1)
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(DragPoint)
  ->ArgNames({ "margin" })
  ->Args({ 12 })
  ->Args({ 45 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(MoveNode)
  ->ArgNames({ "nodes" })
  ->Args({ 700 })
  ->Args({ 2000 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(WarpSetUp)
  ->ArgNames({ "pairs" })
  ->Args({ 700 })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
#ifdef LACUNA_WITH_VTK_TRANSFORMS
BENCHMARK(WarpSetUpVTK)
  ->ArgNames({ "pairs" })
  ->Args({ 700 })
  ->Iterations(1)
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
#endif
BENCHMARK_MAIN();
