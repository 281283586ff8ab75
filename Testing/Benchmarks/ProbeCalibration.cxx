// SPDX-License-Identifier: BSD-3-Clause
// Probe calibration on simulated scans (an image of 90 x 72 mm, phantom and probe anywhere, no first
// guess): how long one takes, and how exact it is. Counters: solved, %, with all corners of the image
// within 5 mm; corner_mm, median error at the corners; rms_mm, median of the residuals' RMS;
// covered, %, true errors at the corners within the predicted covariance's 95 %; chi_square, %,
// residuals within the 95 % of the chi-square distribution for the noise (without outliers).
#include "lacunaCalibrationStudy.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>

using namespace lacunaCalibrationStudy;

namespace
{
void Report(benchmark::State& state, const Study& study, bool hasChiSquare)
{
  const double percent = 100.0 / study.Count;
  state.counters["solved"] = percent * study.Converged;
  state.counters["corner_mm"] = Median(study.Errors);
  state.counters["rms_mm"] = Median(study.Rms);
  state.counters["covered"] = 100 * study.GetCoverage();
  if (hasChiSquare)
  {
    state.counters["chi_square"] = percent * study.InChiSquare;
  }
  state.counters["time_each"] = benchmark::Counter(
    study.Count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// arguments: geometries, % of outliers
void ThreeWires(benchmark::State& state)
{
  const auto geometries = static_cast<unsigned>(state.range(0));
  const double outliers = 0.01 * static_cast<double>(state.range(1));
  Study study;
  for (auto _ : state)
  {
    study = StudyWires(geometries, outliers);
  }
  Report(state, study, outliers == 0);
}
BENCHMARK(ThreeWires)
  ->ArgNames({ "geometries", "outliers" })
  ->ArgsProduct({ { 5, 200 }, { 0, 5 } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);

void SingleWall(benchmark::State& state)
{
  Study study;
  for (auto _ : state)
  {
    study = StudyWall(static_cast<unsigned>(state.range(0)));
  }
  Report(state, study, false);
}
BENCHMARK(SingleWall)
  ->ArgName("geometries")
  ->Arg(5)
  ->Arg(200)
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);

// arguments: geometries, % of the 0.5 mm's variance that is common to the ends of a line
void WallCommonErrors(benchmark::State& state)
{
  const double common = 0.01 * static_cast<double>(state.range(1));
  Study study;
  for (auto _ : state)
  {
    study = StudyWall(
      static_cast<unsigned>(state.range(0)), 0.5 * std::sqrt(1 - common), 0.5 * std::sqrt(common));
  }
  Report(state, study, false);
}
BENCHMARK(WallCommonErrors)
  ->ArgNames({ "geometries", "common" })
  ->ArgsProduct({ { 5, 200, 1000 }, { 50, 99 } })
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);

// four frames of each of 40 places in which the probe was held still
void WallAtRest(benchmark::State& state)
{
  Study study;
  for (auto _ : state)
  {
    study = StudyWallAtRest(static_cast<unsigned>(state.range(0)));
  }
  Report(state, study, false);
}
BENCHMARK(WallAtRest)
  ->ArgName("geometries")
  ->Arg(5)
  ->Arg(200)
  ->MeasureProcessCPUTime()
  ->Unit(benchmark::kMillisecond);
}

BENCHMARK_MAIN();
