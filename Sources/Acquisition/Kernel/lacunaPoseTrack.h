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
  double Nearest = 0; ///< s to the nearer one; of a held pose to the one before
  bool Held = false;  ///< the pose is the last measured one, and Gap is not a number
};

/// The newest measurements of one receiver. Between two the position goes straight on and the
/// orientation turns evenly about one axis; nothing is extrapolated. By choice the last measurement
/// holds for some time where that is not possible (SetHold).
class PoseTrack
{
public:
  /// Keeps the poses of the last seconds; does not bridge more than maximumGap.
  explicit PoseTrack(double seconds = 10, double maximumGap = 0.25);
  /// s for which a measurement holds when the next one is too far away; 0: not at all.
  void SetHold(double seconds) { this->Hold = seconds; }
  /// Forgets all before when the pose is of another estimate of their sender's clock.
  /// Poses that are not later than the newest are left out. One that is not Usable only ends the hold
  /// of the one before.
  void Add(const TrackedPose& pose);
  /// The newest measurement does not hold any more: its tracker is gone.
  void EndHold();
  /// The next measurements are another tracker's: nothing lies between those before and these.
  void Break()
  {
    this->Broken = true;
    this->EndHold();
  }
  /// Nothing when there is no measurement on one side (yet), the gap is too wide, or the time is of
  /// another estimate of the same sender's clock.
  std::optional<PoseAtInstant> At(double time, const ClockEpoch& epoch = {}) const;
  /// Whether a pose at that time can still come: it is later than the newest measurement.
  bool IsAhead(double time) const;

private:
  struct Measurement
  {
    TrackedPose Pose;
    bool Joined;    ///< to the one before
    double HoldEnd; ///< s of the clock, at which it holds no more, whatever Hold is
  };
  std::optional<PoseAtInstant> FindHeld(double time) const;

  double Seconds;
  double MaximumGap;
  double Hold = 0;
  std::deque<Measurement> Poses;
  bool Broken = false;
};
}
#endif
