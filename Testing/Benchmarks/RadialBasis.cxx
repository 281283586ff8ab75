// SPDX-License-Identifier: BSD-3-Clause
// Radial basis functions by direct sums, as for a hole of some hundred nodes: fit and evaluation on a
// grid, beside the sum that one would write first. Rows with many nodes are in RadialBasisFast.cxx,
// those of points that move and of warps in RadialBasisEditing.cxx; all belong to one program.
#include "lacunaBenchmark.h"
#include "lacunaExecution.h"
#include "lacunaScatteredProblem.h"

using namespace lacunaBenchmark;
using namespace lacunaScatteredProblem;

namespace
{
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
}

BENCHMARK(Fit)
  ->ArgNames({ "kernel", "nodes" })
  ->Args({ ThinPlate, 700 })
  ->Args({ Linear, 700 })
  ->Args({ ThinPlate, 2700 })
  ->Apply(Measure);
BENCHMARK(PlainSum)
  ->ArgNames({ "nodes", "grid" })
  ->ArgsProduct({ { 700 }, { 205, 512 } })
  ->Apply(Measure);
BENCHMARK(Evaluate)
  ->ArgNames({ "kernel", "nodes", "grid", "threads", "set" })
  ->ArgsProduct({ { ThinPlate }, { 700 }, { 205, 512 }, { 1, 2, 4 }, { 0, 1, 2 } })
  ->Args({ Linear, 700, 512, 1, 1 })
  ->Apply(Measure);
BENCHMARK_MAIN();
