// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// When the slices of a sweep were taken, for playing it back.
#ifndef lacunaSweepReplay_h
#define lacunaSweepReplay_h

#include <cstdint>
#include <vector>

namespace lacuna
{
/// At a time t those slices are shown that had been taken by then: the first n of the stack, n
/// being the number of slices whose replay time is at most t. A slice's replay time is its
/// timestamp, or that of a slice before it when that is later: slices appear in their order, also
/// when clocks jump back. A slice without a timestamp appears with the one before it; those before
/// the first timestamp appear with it. Without any timestamp a slice's time is its number in s.
class SweepReplay
{
public:
  /// timestamps: of the frames of the file, in s, NaN where one lacks it; may be empty. The stack
  /// is made of the count >= 1 frames first, first + stride, ...
  SweepReplay(const std::vector<double>& timestamps, std::int64_t first, std::int64_t stride,
    std::int64_t count);

  /// The times at which slices appear, increasing.
  const std::vector<double>& GetTimes() const { return this->Times; }
  /// Slices of the stack at a time; at least one, also before the first time.
  std::int64_t GetNumberOfSlices(double time) const;
  /// The last of GetTimes() that is not after time; the first one before it.
  double GetTimeBefore(double time) const;
  /// False when numbers stand in for timestamps.
  bool HasTimestamps() const { return this->Stamped; }

private:
  std::vector<double> Times;
  std::vector<std::int64_t> Counts; ///< slices at each of the times
  bool Stamped = false;
};
}
#endif
