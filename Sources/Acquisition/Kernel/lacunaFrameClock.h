// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// When a video frame would have come if the computer had not held it up.
#ifndef lacunaFrameClock_h
#define lacunaFrameClock_h

#include <cstddef>
#include <deque>
#include <optional>

namespace lacuna
{
/// A frame that a busy computer or network delivers late shows what the probe saw before that. Where
/// the stream's own times keep pace with ours, they tell by how much: frames came, by the median of
/// the last 50, so long after their stream time. One that is late by more than the tolerance is
/// given the arrival that the median tells. Others keep theirs, so that the clock never changes
/// what steady frames have, and so does every frame of a stream whose times are not in step: of
/// another rate, in bursts, set anew. What was held up comes faster than it was sent; frames that
/// stay equally late were not: a sender that counts has lost one, or the way has become longer.
class FrameClock
{
public:
  /// tolerance: s later than the median.
  explicit FrameClock(double tolerance = 0.008)
    : Tolerance(tolerance)
  {
  }

  /// Both in s. Results are never later than the arrival and, where arrivals ascend, never earlier
  /// than the one before.
  double FindArrival(double arrival, double streamTime);

private:
  struct Frame
  {
    double StreamTime;
    double Offset; ///< arrival minus stream time
    double Found;
    bool Late;
  };
  bool IsSteady(double median) const;
  /// s of lateness that two frames may differ by and still be equally late.
  double FindPace(double streamTime) const;

  double Tolerance;
  std::deque<double> Offsets; ///< of the last frames
  std::optional<Frame> Before;
  bool HeldUp = false; ///< the frames that are late now
};
}
#endif
