// SPDX-License-Identifier: BSD-3-Clause
// The same by the peers that are installed: ALGLIB's thin plates (domain decomposition; one thread)
// and VTK's thin plate spline.
#include "lacunaBenchmark.h"
#include "lacunaScatteredProblem.h"

#ifdef LACUNA_WITH_VTK_TRANSFORMS
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkThinPlateSplineTransform.h"
#endif

#ifdef LACUNA_WITH_ALGLIB
#include <libalglib/interpolation.h>
#endif

#include <cstddef>

using namespace lacunaBenchmark;
using namespace lacunaScatteredProblem;

namespace
{
#ifdef LACUNA_WITH_ALGLIB
alglib::rbfmodel FitByALGLIB(const Problem& problem)
{
  alglib::real_2d_array nodes;
  nodes.setlength(static_cast<alglib::ae_int_t>(problem.Nodes.size()), 3);
  for (std::size_t i = 0; i < problem.Nodes.size(); ++i)
  {
    const auto row = static_cast<alglib::ae_int_t>(i);
    nodes(row, 0) = problem.Nodes[i][0];
    nodes(row, 1) = problem.Nodes[i][1];
    nodes(row, 2) = problem.Values[i];
  }
  alglib::rbfmodel model;
  alglib::rbfcreate(2, 1, model);
  alglib::rbfsetpoints(model, nodes);
  alglib::rbfsetalgothinplatespline(model);
  alglib::rbfreport report;
  alglib::rbfbuildmodel(model, report);
  return model;
}

// arguments: nodes
void FitALGLIB(benchmark::State& state)
{
  const Problem problem(state.range(0));
  const Memory memory;
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(FitByALGLIB(problem));
  }
  memory.Report(state);
}

// arguments: nodes, grid size
void GridALGLIB(benchmark::State& state)
{
  const alglib::rbfmodel model = FitByALGLIB(Problem(state.range(0)));
  alglib::real_1d_array places;
  places.setlength(state.range(1));
  for (alglib::ae_int_t i = 0; i < places.length(); ++i)
  {
    places(i) = static_cast<double>(i) / static_cast<double>(places.length() - 1);
  }
  alglib::real_1d_array values;
  const Memory memory;
  for (auto _ : state)
  {
    alglib::rbfgridcalc2v(model, places, places.length(), places, places.length(), values);
    benchmark::DoNotOptimize(values.getcontent());
  }
  memory.Report(state);
}
#endif

#ifdef LACUNA_WITH_VTK_TRANSFORMS
// What WarpSetUp does. arguments: pairs
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
}

#ifdef LACUNA_WITH_ALGLIB
BENCHMARK(FitALGLIB)->ArgName("nodes")->Arg(700)->Arg(1000)->Arg(10000)->Apply(Measure);
BENCHMARK(GridALGLIB)
  ->ArgNames({ "nodes", "grid" })
  ->Args({ 700, 512 })
  ->Args({ 1000, 512 })
  ->Args({ 3000, 512 })
  ->Iterations(1) // the fit is not counted, but would be made anew for each trial
  ->Apply(Measure);
#endif
#ifdef LACUNA_WITH_VTK_TRANSFORMS
BENCHMARK(WarpSetUpVTK)->ArgNames({ "pairs" })->Args({ 700 })->Iterations(1)->Apply(Measure);
#endif
