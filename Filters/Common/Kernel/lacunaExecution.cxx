// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaExecution.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <future>
#include <locale>
#include <mutex>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
// Often enough for a progress bar and a prompt stop, rarely enough to cost nothing; or ms that the
// environment gives. 0, for tests: after each range of a loop, which the calling thread does alone then,
// so that a run repeats.
std::chrono::microseconds GetReportInterval()
{
  static const std::chrono::microseconds interval = []
  {
    double ms = 50;
    if (const char* given = std::getenv("LACUNA_REPORT_INTERVAL"))
    {
      std::istringstream text(given);
      text.imbue(std::locale::classic()); // Qt has others
      text >> ms;
      ms = ms > 0 ? std::min(ms, 1e6) : 0;
    }
    return std::chrono::microseconds(static_cast<std::int64_t>(std::ceil(1000 * ms)));
  }();
  return interval;
}
}

Aborted::Aborted()
  : std::runtime_error("stopped by the user")
{
}

void Execution::SetStage(double first, double last)
{
  const double length = this->WholeLast - this->WholeFirst;
  this->StageFirst = this->WholeFirst + first * length;
  this->StageLast = this->WholeFirst + last * length;
}

Execution::NestedStages::NestedStages(Execution& execution)
  : Outer(execution)
  , WholeFirst(execution.WholeFirst)
  , WholeLast(execution.WholeLast)
  , StageFirst(execution.StageFirst)
  , StageLast(execution.StageLast)
{
  execution.WholeFirst = execution.StageFirst;
  execution.WholeLast = execution.StageLast;
}

Execution::NestedStages::~NestedStages()
{
  this->Outer.WholeFirst = this->WholeFirst;
  this->Outer.WholeLast = this->WholeLast;
  this->Outer.StageFirst = this->StageFirst;
  this->Outer.StageLast = this->StageLast;
}

void Execution::Report(double fraction)
{
  const double whole = this->StageFirst + fraction * (this->StageLast - this->StageFirst);
  if (!this->OnProgress(whole))
  {
    throw Aborted();
  }
}

void Execution::For(std::int64_t count, std::int64_t grain, const Body& body)
{
  if (count <= 0)
  {
    return;
  }
  grain = std::max<std::int64_t>(1, grain);
  std::atomic<std::int64_t> done(0);
  std::atomic<bool> stop(false);
  std::exception_ptr error;
  std::mutex errorMutex;
  using Clock = std::chrono::steady_clock;
  const std::thread::id caller = std::this_thread::get_id();
  const std::chrono::microseconds interval = GetReportInterval();
  const bool alone = interval == std::chrono::microseconds::zero();
  const bool works = alone || this->LaunchWorks();
  Clock::time_point next = Clock::now() + interval; // of the calling thread
  const auto report = [&] { this->Report(static_cast<double>(done) / static_cast<double>(count)); };
  // Back ends hand out ranges as they like and let no exception through: divide and guard here.
  const Body guarded = [&](std::int64_t begin, std::int64_t end)
  {
    for (std::int64_t b = begin; b < end && !stop; b += grain)
    {
      const std::int64_t e = std::min(end, b + grain);
      try
      {
        body(b, e);
        if (works && std::this_thread::get_id() == caller && Clock::now() >= next)
        {
          report();
          next = Clock::now() + interval;
        }
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(errorMutex);
        if (!error)
        {
          error = std::current_exception();
        }
        stop = true;
      }
      done += e - b;
    }
  };

  if (alone)
  {
    guarded(0, count);
  }
  else if (works)
  {
    this->Launch(count, grain, guarded);
  }
  else
  {
    // Only the calling thread may report: so the loop is launched from another one, and this one
    // watches it.
    std::future<void> loop =
      std::async(std::launch::async, [&] { this->Launch(count, grain, guarded); });
    bool aborted = false;
    while (loop.wait_for(interval) != std::future_status::ready)
    {
      if (aborted)
      {
        continue;
      }
      try
      {
        report();
      }
      catch (const Aborted&)
      {
        stop = true;
        aborted = true;
      }
    }
    loop.get();
    if (aborted && !error)
    {
      throw Aborted();
    }
  }
  if (error)
  {
    std::rethrow_exception(error);
  }
  this->Report(1);
}

ThreadExecution::ThreadExecution(int threads, std::function<bool(double)> progress)
  : Threads(
      threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency())))
  , Progress(std::move(progress))
{
}

void ThreadExecution::Launch(std::int64_t count, std::int64_t grain, const Body& body)
{
  std::atomic<std::int64_t> next(0);
  const auto work = [&]
  {
    for (std::int64_t begin = next.fetch_add(grain); begin < count; begin = next.fetch_add(grain))
    {
      body(begin, std::min(count, begin + grain));
    }
  };
  const std::int64_t ranges = (count + grain - 1) / grain;
  std::vector<std::thread> others;
  for (std::int64_t i = 1; i < std::min<std::int64_t>(this->Threads, ranges); ++i)
  {
    others.emplace_back(work);
  }
  work();
  for (std::thread& thread : others)
  {
    thread.join();
  }
}

bool ThreadExecution::OnProgress(double fraction)
{
  return !this->Progress || this->Progress(fraction);
}
}
