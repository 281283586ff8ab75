// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// When a video frame would have come if the computer had not held it up.
#ifndef lacunaFrameClock_h
#define lacunaFrameClock_h

#include <cstddef>
#include <deque>

namespace lacuna
{
/// A frame that a busy computer or network delivers late shows what the probe saw before that. Where
/// the stream's own times keep pace with ours, they tell by how much: frames came, by the median of
/// the last 50, so long after their stream time. One that is late by more than the tolerance is
/// given the arrival that the median tells. Others keep theirs, so that the clock never changes
/// what steady frames have, and so does every frame of a stream whose times are not in step: of
/// another rate, in bursts, set anew.
class FrameClock
{
public:
  /// tolerance: s later than the median.
  explicit FrameClock(double tolerance = 0.008)
    : Tolerance(tolerance)
  {
  }

  /// Both in s; stream times ascend. Results are never later than the arrival and, where arrivals
  /// ascend and frames are more than the tolerance apart, ascend.
  double FindArrival(double arrival, double streamTime);

private:
  bool IsSteady(double median) const;

  double Tolerance;
  std::deque<double> Offsets; ///< arrival minus stream time, of the last frames
};
}
#endif
