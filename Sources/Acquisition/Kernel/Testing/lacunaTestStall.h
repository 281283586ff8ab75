// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How real this computer's real time is.
#ifndef lacunaTestStall_h
#define lacunaTestStall_h

#include "lacunaClock.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace lacunaTest
{
/// Whether frames and poses can be expected in time: ThreadSanitizer, which looks for races, makes
/// the emulators late.
#ifdef __SANITIZE_THREAD__
constexpr bool KeepsTime = false;
#else
constexpr bool KeepsTime = true;
#endif

/// Measures for how long the computer lets a program stand still at the most, in s.
class StallWatch
{
public:
  StallWatch()
    : Thread([this] { this->Watch(); })
  {
  }
  ~StallWatch()
  {
    this->Ended = true;
    this->Thread.join();
  }
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;
  double GetLongest() const { return this->Longest; }

private:
  void Watch()
  {
    constexpr double interval = 0.005; // s
    const lacuna::SteadyClock clock;
    while (!this->Ended)
    {
      const double begin = clock.Now();
      std::this_thread::sleep_for(std::chrono::duration<double>(interval));
      this->Longest = std::max<double>(this->Longest, clock.Now() - begin - interval);
    }
  }

  std::atomic<bool> Ended{ false };
  std::atomic<double> Longest{ 0 };
  std::thread Thread;
};
}
#endif
