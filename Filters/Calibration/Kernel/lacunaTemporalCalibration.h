// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// By how much the video lags behind the tracker, from a motion that both see.
#ifndef lacunaTemporalCalibration_h
#define lacunaTemporalCalibration_h

#include "lacunaMatrix4.h"
#include "lacunaProperties.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
/// A probe is moved to and fro before a flat floor. What is seen of the motion in the image (the row
/// at which the floor lies, say) is a sum of the coordinates of the tracked receiver with unknown
/// weights, if both are taken at the same instant. The lag is the one at which that sum fits best.
struct TemporalCalibration
{
  static constexpr ValueRange MaximumLagRange = ValueRange::Above(0, "s").UpTo(2);

  /// s by which the image is late: the pose that belongs to a frame stamped t is that of t - Lag.
  double Lag = 0;
  double Spread = 0;      ///< s, standard deviation of Lag as the residuals let expect
  double Correlation = 0; ///< 0 to 1, of the image's signal and the fitted sum at Lag
  double Amplitude = 0;   ///< standard deviation of the image's signal, in its unit
  std::size_t Frames = 0; ///< that were used

  /// Correlation at lags from -maximumLag to maximumLag, evenly.
  std::vector<double> Lags, Correlations;

  struct Sample
  {
    double Time;  ///< s, as the frame and the pose were stamped
    double Value; ///< what is seen in the image; NaN: nothing
    Matrix4 ProbeToTracker;
    bool HasPose;
  };

  /// samples: in order of time. Positions between poses are interpolated straight; frames beyond the
  /// first or the last pose, or between poses more than maximumGap s apart, are not used.
  /// Throws std::invalid_argument when maximumLag is out of range, times are not finite
  /// and ascending, fewer than 30 frames can be used at every lag, the probe or the image's signal
  /// stands still, the correlation stays below 0.9, or is largest at the end of the range, or when a
  /// second lag fits nearly as well: the sign of the weights is not known, so a regular motion looks the
  /// same half a cycle later.
  static TemporalCalibration Solve(
    const std::vector<Sample>& samples, double maximumLag = 0.5, double maximumGap = 0.25);
};
}
#endif
