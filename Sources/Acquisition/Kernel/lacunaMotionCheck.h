// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether poses can be the motion of a hand.
#ifndef lacunaMotionCheck_h
#define lacunaMotionCheck_h

#include "lacunaTrackedPose.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
struct MotionLimits
{
  double Acceleration = 3000;      ///< mm/s^2 of the receiver
  double AngularAcceleration = 30; ///< rad/s^2, turning steadily at w counts as w^2
  double PositionNoise = 0.5;      ///< mm
  double AngularNoise = 0.005;     ///< rad
  double MaximumGap = 0.5;         ///< s after which the motion before says nothing
};

/// Detects damage that leaves a possible record, and the receiver's passage into the other
/// hemisphere, by continuity.
///
/// A pose is taken when it is where the two before it lead, as far as the limits allow. This is exact
/// for a uniformly accelerated motion; noise is extrapolated too. A pose whose position fits with all
/// three signs changed is taken with them changed. The FASTRAK's field is the same at opposite places:
/// there the orientation is right and the position mirrored through the origin. Others wait. Three in
/// a row that fit each other are a new motion and are taken together, late. Those that do not are
/// dropped when one fits the motion before.
///
/// A new motion after one that was in the other hemisphere is on the side that is nearer to its end.
/// One within 2 s of one that was not is in the other hemisphere when it is three times nearer there.
/// So is a pose that fits with either sign, as after 0.3 s without any within 8 cm of the transmitter.
///
/// Undetected errors are within the limits: at 50 poses a second 1.2 mm and three times the noise.
class MotionCheck
{
public:
  explicit MotionCheck(const MotionLimits& limits = {});
  /// Judges the next pose in time and adds what is taken now to accepted, in order of time. Poses
  /// that are not Usable pass and are not judged.
  void Judge(const TrackedPose& pose, std::vector<TrackedPose>& accepted);
  /// Forgets the motion.
  void Reset();

  std::uint64_t GetNumberOfDropped() const { return this->Dropped; }
  std::uint64_t GetNumberOfFlipped() const { return this->Flipped; }

private:
  bool Fits(const TrackedPose& first, const TrackedPose& second, const TrackedPose& third) const;
  bool IsInOtherHemisphere(const TrackedPose& first) const;

  MotionLimits Limits;
  std::vector<TrackedPose> Track;   ///< the last two that were taken, however old
  std::vector<TrackedPose> Waiting; ///< up to two that may begin a new motion
  std::uint64_t Dropped = 0;
  std::uint64_t Flipped = 0;
};
}
#endif
