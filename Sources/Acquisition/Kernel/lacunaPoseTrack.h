// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pose at an instant between two measurements.
#ifndef lacunaPoseTrack_h
#define lacunaPoseTrack_h

#include "lacunaTrackedPose.h"

#include <deque>
#include <optional>

namespace lacuna
{
/// A pose at the instant of a video frame.
struct PoseAtInstant
{
  Matrix4 ReceiverToTransmitter; ///< mm
  double Gap = 0;     ///< s between the measurements on either side; 0: one of just that instant
  double Nearest = 0; ///< s to the nearer one
};

/// The newest measurements of one receiver. Between two the position goes straight on and the
/// orientation turns evenly about one axis; nothing is extrapolated.
class PoseTrack
{
public:
  /// Keeps the poses of the last seconds; does not bridge more than maximumGap.
  explicit PoseTrack(double seconds = 10, double maximumGap = 0.25);
  /// Poses that are not later than the newest or not Usable are left out.
  void Add(const TrackedPose& pose);
  /// The next measurements are another tracker's: nothing lies between those before and these.
  void Break() { this->Broken = true; }
  /// Nothing when there is no measurement on one side (yet), or the gap is too wide.
  std::optional<PoseAtInstant> At(double time) const;
  /// Whether a pose at that time can still come: it is later than the newest measurement.
  bool IsAhead(double time) const;

private:
  double Seconds;
  double MaximumGap;
  struct Measurement
  {
    TrackedPose Pose;
    bool Joined; ///< to the one before
  };
  std::deque<Measurement> Poses;
  bool Broken = false;
};
}
#endif
