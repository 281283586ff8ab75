// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Gives each video frame the pose of its instant.
#ifndef lacunaFramePairing_h
#define lacunaFramePairing_h

#include "lacunaPoseTrack.h"
#include "lacunaVideoSource.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace lacuna
{
using FramePointer = std::shared_ptr<const VideoFrame>;

struct PairedFrame
{
  FramePointer Frame;
  std::int64_t Number = 0; ///< of the video's frames
  double Instant = 0;      ///< s of the clock: when the probe saw it
  bool Wanted = false;     ///< it came during a capture
  ClockEpoch Epoch;        ///< of Instant
  bool Timed = true;       ///< false: Instant may be wrong, and is known better soon
  std::optional<PoseAtInstant> Pose;
};

/// Frames wait until a measurement later than their instant has come, so that they get a pose
/// between two; nothing is extrapolated. One whose pose does not come within the patience gets none.
/// Frames whose Instant is not known yet (Timed) wait up to 3 s for that when they are wanted, and get
/// none otherwise. Frames leave in the order in which they came. They may be taken late, while a disk is slow for
/// instance: a frame keeps its pose, and one that is not wanted, nor just before such a one, does
/// not wait in memory for long.
class FramePairing
{
public:
  /// patience: s after its instant, or its coming, until a frame is let go without a pose.
  explicit FramePairing(double patience = 0.5);

  /// Takes a frame at a time of the clock.
  void AddFrame(PairedFrame frame, double now);
  void AddPose(const TrackedPose& pose);
  /// The instant of a frame that was not Timed is so many s later; nothing: it will never be known.
  /// Frames that have left are passed over.
  void SetTime(std::int64_t number, std::optional<double> later);
  /// See PoseTrack.
  void SetHold(double seconds) { this->Track.SetHold(seconds); }
  void EndHold() { this->Track.EndHold(); }
  /// Poses that come next are another tracker's.
  void Break() { this->Track.Break(); }
  /// No poses will come for the frames there are: all may leave.
  void Abandon();
  /// The frames that have their pose or are let go.
  std::vector<PairedFrame> Take(double now);
  /// The newest frame, when it waits for its time: to be shown.
  std::optional<PairedFrame> FindUntimed() const;
  /// Of the frames that wait; nothing when none do.
  std::optional<double> GetLatestInstant() const;

private:
  struct Waiting
  {
    PairedFrame Frame;
    double Deadline;
    double Expiry;        ///< until then it is kept though nobody wants it
    bool Settled = false; ///< its pose is known, or known to be none
  };
  void Settle(Waiting& waiting);

  double Patience;
  PoseTrack Track;
  std::deque<Waiting> Frames;
};
}
#endif
