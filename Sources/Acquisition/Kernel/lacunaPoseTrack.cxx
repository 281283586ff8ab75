// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseTrack.h"

#include "lacunaPoseTable.h"

#include <algorithm>

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
  this->Poses.push_back(pose);
  while (this->Poses.front().Time < pose.Time - this->Seconds)
  {
    this->Poses.pop_front();
  }
}

bool PoseTrack::IsAhead(double time) const
{
  return this->Poses.empty() || time > this->Poses.back().Time;
}

std::optional<PoseAtInstant> PoseTrack::At(double time) const
{
  const auto after = std::lower_bound(this->Poses.begin(), this->Poses.end(), time,
    [](const TrackedPose& pose, double t) { return pose.Time < t; });
  if (after == this->Poses.end())
  {
    return std::nullopt;
  }
  if (after->Time == time)
  {
    return PoseAtInstant{ after->ReceiverToTransmitter, 0, 0 };
  }
  if (after == this->Poses.begin())
  {
    return std::nullopt;
  }
  const TrackedPose& before = *std::prev(after);
  const double gap = after->Time - before.Time;
  if (gap > this->MaximumGap)
  {
    return std::nullopt;
  }
  return PoseAtInstant{ InterpolatePose(before.ReceiverToTransmitter, after->ReceiverToTransmitter,
                          (time - before.Time) / gap),
    gap, std::min(time - before.Time, after->Time - time) };
}
}
