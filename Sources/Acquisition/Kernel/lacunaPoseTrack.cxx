// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseTrack.h"

#include "lacunaPoseTable.h"

#include <algorithm>
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
  if (!pose.Usable || !this->IsAhead(pose.Time))
  {
    return;
  }
  this->Poses.push_back({ pose, !std::exchange(this->Broken, false) });
  while (this->Poses.front().Pose.Time < pose.Time - this->Seconds)
  {
    this->Poses.pop_front();
  }
}

bool PoseTrack::IsAhead(double time) const
{
  return this->Poses.empty() || time > this->Poses.back().Pose.Time;
}

std::optional<PoseAtInstant> PoseTrack::At(double time) const
{
  const auto after = std::lower_bound(this->Poses.begin(), this->Poses.end(), time,
    [](const Measurement& measurement, double t) { return measurement.Pose.Time < t; });
  if (after == this->Poses.end())
  {
    return std::nullopt;
  }
  const TrackedPose& next = after->Pose;
  if (next.Time == time)
  {
    return PoseAtInstant{ next.ReceiverToTransmitter, 0, 0 };
  }
  if (after == this->Poses.begin() || !after->Joined)
  {
    return std::nullopt;
  }
  const TrackedPose& before = std::prev(after)->Pose;
  const double gap = next.Time - before.Time;
  if (gap > this->MaximumGap)
  {
    return std::nullopt;
  }
  return PoseAtInstant{ InterpolatePose(before.ReceiverToTransmitter, next.ReceiverToTransmitter,
                          (time - before.Time) / gap),
    gap, std::min(time - before.Time, next.Time - time) };
}
}
