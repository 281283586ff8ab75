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

// A loop that several threads work on while the calling thread reports.
class Loop
{
public:
  // callerWorks: the thread that makes this works on it too, and reports between its ranges.
  Loop(Execution& execution, std::int64_t count, std::int64_t grain, const Execution::Body& body,
    bool callerWorks)
    : Owner(execution)
    , Count(count)
    , Grain(grain)
    , Body(body)
    , CallerWorks(callerWorks)
    , Next(Clock::now() + this->Interval)
  {
  }

  // Back ends hand out ranges as they like and let no exception through: divide and guard here.
  void Work(std::int64_t begin, std::int64_t end)
  {
    for (std::int64_t b = begin; b < end && !this->Stop; b += this->Grain)
    {
      const std::int64_t e = std::min(end, b + this->Grain);
      try
      {
        this->Body(b, e);
        if (this->CallerWorks && std::this_thread::get_id() == this->Caller &&
          Clock::now() >= this->Next)
        {
          this->Report();
          this->Next = Clock::now() + this->Interval;
        }
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(this->ErrorMutex);
        if (!this->Error)
        {
          this->Error = std::current_exception();
        }
        this->Stop = true;
      }
      this->Done += e - b;
    }
  }

  // Reports until the others are done.
  void Watch(std::future<void> others)
  {
    bool aborted = false;
    while (others.wait_for(this->Interval) != std::future_status::ready)
    {
      if (aborted)
      {
        continue;
      }
      try
      {
        this->Report();
      }
      catch (const Aborted&)
      {
        this->Stop = true;
        aborted = true;
      }
    }
    others.get();
    if (aborted && !this->Error)
    {
      throw Aborted();
    }
  }

  // Throws what a range threw, or reports that all is done.
  void Finish()
  {
    if (this->Error)
    {
      std::rethrow_exception(this->Error);
    }
    this->Owner.Report(1);
  }

private:
  using Clock = std::chrono::steady_clock;

  void Report()
  {
    this->Owner.Report(static_cast<double>(this->Done) / static_cast<double>(this->Count));
  }

  Execution& Owner;
  const std::int64_t Count;
  const std::int64_t Grain;
  const Execution::Body& Body;
  const bool CallerWorks;
  const std::thread::id Caller = std::this_thread::get_id();
  const std::chrono::microseconds Interval = GetReportInterval();
  Clock::time_point Next; // of the calling thread
  std::atomic<std::int64_t> Done{ 0 };
  std::atomic<bool> Stop{ false };
  std::exception_ptr Error;
  std::mutex ErrorMutex;
};
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
  const std::int64_t least = std::max<std::int64_t>(1, grain);
  const bool alone = GetReportInterval() == std::chrono::microseconds::zero();
  const bool works = alone || this->LaunchWorks();
  Loop loop(*this, count, least, body, works);
  const Body work = [&](std::int64_t begin, std::int64_t end) { loop.Work(begin, end); };
  if (alone)
  {
    loop.Work(0, count);
  }
  else if (works)
  {
    this->Launch(count, least, work);
  }
  else
  {
    // Only the calling thread may report: so the loop is launched from another one, and this one
    // watches it.
    loop.Watch(std::async(std::launch::async, [&] { this->Launch(count, least, work); }));
  }
  loop.Finish();
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
