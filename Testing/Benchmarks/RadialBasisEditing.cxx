// SPDX-License-Identifier: BSD-3-Clause
// Radial basis functions that change: points that a user drags, nodes that move, warps by landmarks.
#include "lacunaBenchmark.h"
#include "lacunaExecution.h"
#include "lacunaHoleFill.h"
#include "lacunaScatteredProblem.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace lacunaBenchmark;
using namespace lacunaScatteredProblem;

namespace
{
// Handles of RBF Hole Filler: five control points in a hole of 30 mm radius, of which one moves. The
// time is that of a fill with the point elsewhere; counter: processor time of the first fill, s.
// arguments: margin, mm
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
  const double start = GetProcessSeconds();
  filler.Fill(execution, input, options);
  const double first = GetProcessSeconds() - start;
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
    double residual = s.GetReport().Residual;
    benchmark::DoNotOptimize(residual);
  }
  memory.Report(state);
}
}

BENCHMARK(DragPoint)->ArgNames({ "margin" })->Args({ 12 })->Args({ 45 })->Apply(Measure);
BENCHMARK(WarpSetUp)->ArgNames({ "pairs" })->Args({ 700 })->Apply(Measure);
