// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the rows of all benchmarks have in common.
///
/// A row is one of Google Benchmark's: printed in a table, and written as JSON with
/// --benchmark_out=FILE. Its real_time is that of the clock, its cpu_time that of all threads of the
/// process, both in ms for one iteration; counters say what else a program measures. run.py reads
/// these rows, also from programs in Python (rows.py writes the same).
#ifndef lacunaBenchmark_h
#define lacunaBenchmark_h

#include "lacunaProcessMemory.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace lacunaBenchmark
{
/// For Apply: what every row is measured by.
inline void Measure(benchmark::internal::Benchmark* row)
{
  row->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
}

/// What BENCHMARK_MAIN does, for programs that register their rows one by one.
inline int RunRows(int argc, char* argv[])
{
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

/// Processor time of all threads since the process began, s.
inline double GetProcessSeconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor time of a function, s: the least of several calls.
template <class Function>
double GetLeastSeconds(const Function& function)
{
  double least = 0;
  for (int call = 0; call < 5; ++call)
  {
    const double start = GetProcessSeconds();
    function();
    const double time = GetProcessSeconds() - start;
    least = call == 0 ? time : std::min(least, time);
  }
  return least;
}

/// The memory that a row takes, where the system tells: counters peak_MB, the largest memory of the
/// process since this was made, and grown_MB, how much of it came since.
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
}
#endif
