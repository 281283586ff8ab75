// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseTrack.h"

#include "lacunaPoseTable.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace lacuna
{
PoseTrack::PoseTrack(double seconds, double maximumGap)
  : Seconds(seconds)
  , MaximumGap(maximumGap)
{
}

void PoseTrack::Add(const TrackedPose& pose)
{
  if (!this->Poses.empty() && !this->Poses.back().Pose.Epoch.Fits(pose.Epoch))
  {
    this->Poses.clear();
  }
  if (!this->IsAhead(pose.Time))
  {
    return;
  }
  if (!pose.Usable)
  {
    if (!this->Poses.empty())
    {
      this->Poses.back().HoldEnd = std::min(this->Poses.back().HoldEnd, pose.Time);
    }
    return;
  }
  this->Poses.push_back(
    { pose, !std::exchange(this->Broken, false), std::numeric_limits<double>::infinity() });
  // one that is older may hold
  while (this->Poses.size() > 1 && this->Poses[1].Pose.Time < pose.Time - this->Seconds)
  {
    this->Poses.pop_front();
  }
}

void PoseTrack::EndHold()
{
  if (!this->Poses.empty())
  {
    this->Poses.back().HoldEnd = this->Poses.back().Pose.Time;
  }
}

std::optional<PoseAtInstant> PoseTrack::FindHeld(double time) const
{
  const auto after = std::upper_bound(this->Poses.begin(), this->Poses.end(), time,
    [](double t, const Measurement& measurement) { return t < measurement.Pose.Time; });
  if (after == this->Poses.begin())
  {
    return std::nullopt;
  }
  const Measurement& before = *std::prev(after);
  const double age = time - before.Pose.Time;
  if (age > this->Hold || time >= before.HoldEnd)
  {
    return std::nullopt;
  }
  return PoseAtInstant{ before.Pose.ReceiverToTransmitter, std::numeric_limits<double>::quiet_NaN(),
    age, true };
}

bool PoseTrack::IsAhead(double time) const
{
  return this->Poses.empty() || time > this->Poses.back().Pose.Time;
}

std::optional<PoseAtInstant> PoseTrack::At(double time, const ClockEpoch& epoch) const
{
  if (!this->Poses.empty() && !this->Poses.back().Pose.Epoch.Fits(epoch))
  {
    return std::nullopt;
  }
  const auto after = std::lower_bound(this->Poses.begin(), this->Poses.end(), time,
    [](const Measurement& measurement, double t) { return measurement.Pose.Time < t; });
  if (after == this->Poses.end())
  {
    return this->FindHeld(time);
  }
  const TrackedPose& next = after->Pose;
  if (next.Time == time)
  {
    return PoseAtInstant{ next.ReceiverToTransmitter, 0, 0 };
  }
  if (after == this->Poses.begin() || !after->Joined)
  {
    return this->FindHeld(time);
  }
  const TrackedPose& before = std::prev(after)->Pose;
  const double gap = next.Time - before.Time;
  if (gap > this->MaximumGap)
  {
    return this->FindHeld(time);
  }
  return PoseAtInstant{ InterpolatePose(before.ReceiverToTransmitter, next.ReceiverToTransmitter,
                          (time - before.Time) / gap),
    gap, std::min(time - before.Time, next.Time - time) };
}
}
