// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The one time scale of an acquisition.
#ifndef lacunaClock_h
#define lacunaClock_h

#include <chrono>

namespace lacuna
{
/// Seconds that never go back. Requests, records and video frames are stamped by the same clock.
class Clock
{
public:
  virtual ~Clock() = default;
  virtual double Now() const = 0;
};

/// The computer's monotonic clock.
class SteadyClock : public Clock
{
public:
  double Now() const override
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
  }
};
}
#endif
