// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// When a video frame would have come if the computer had not held it up.
#ifndef lacunaFrameClock_h
#define lacunaFrameClock_h

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace lacuna
{
/// A frame that a busy computer or network delivers late shows what the probe saw before that. Where
/// the stream's own times keep pace with ours, they tell by how much: frames came, by the median of
/// the last 50, so long after their stream time. One that is late by more than the tolerance is
/// given the arrival that the median tells. Others keep theirs, so that the clock never changes
/// what steady frames have, and so does every frame of a stream whose times are not in step: of
/// another rate, in bursts, set anew. What was held up comes faster than it was sent; frames that
/// stay equally late were not: a sender that counts has lost one, or the way has become longer.
///
/// The first frames tell nothing by themselves: any of them may have been held up. They are judged once
/// the clock has settled: by 25 frames of which three quarters agree, or by the first 10 when all of
/// them agree. When 50 frames do not agree, the times are not in step with ours, and arrivals stay.
class FrameClock
{
public:
  struct Answer
  {
    double Arrival; ///< s
    bool Known;     ///< false: it may be late; TakeArrivals gives the right one later
  };

  /// tolerance: s later than the median.
  explicit FrameClock(double tolerance = 0.008)
    : Tolerance(tolerance)
  {
  }

  /// Both in s. Results are never later than the arrival and, where arrivals ascend, never earlier
  /// than the one before.
  Answer FindArrival(double arrival, double streamTime);
  /// Of all earlier frames whose answer was not Known, in order, as soon as the clock has settled; of
  /// frames before the stream began anew, nothing. Gives each only once.
  std::vector<std::optional<double>> TakeArrivals();

private:
  struct Frame
  {
    double StreamTime;
    double Offset; ///< arrival minus stream time
    double Found;
    bool Late;
  };
  double Judge(double arrival, double streamTime);
  void Forget();
  void Settle();
  bool IsSteady(double median) const;
  /// s of lateness that two frames may differ by and still be equally late.
  double FindPace(double streamTime) const;

  double Tolerance;
  std::deque<double> Offsets; ///< of the last frames
  std::optional<Frame> Before;
  bool HeldUp = false; ///< the frames that are late now
  bool Settled = false;
  std::vector<std::pair<double, double>> Early; ///< arrival and stream time, before it was
  std::vector<std::optional<double>> Known;     ///< arrivals of early frames, which nobody took yet
};
}
#endif
