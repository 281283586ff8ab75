// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMotionCheck.h"

#include <algorithm>

namespace lacuna
{
namespace
{
TrackedPose Flip(TrackedPose pose)
{
  for (int i = 0; i < 3; ++i)
  {
    pose.ReceiverToTransmitter(i, 3) *= -1;
  }
  pose.Flipped = true;
  return pose;
}
}

MotionCheck::MotionCheck(const MotionLimits& limits)
  : Limits(limits)
{
}

void MotionCheck::Reset()
{
  this->Track.clear();
  this->Dropped += this->Waiting.size();
  this->Waiting.clear();
}

bool MotionCheck::Fits(
  const TrackedPose& first, const TrackedPose& second, const TrackedPose& third) const
{
  const double before = second.Time - first.Time;
  const double after = third.Time - second.Time;
  if (!(before > 0) || !(after > 0))
  {
    return false;
  }
  const double ratio = after / before;
  const double bend = 0.5 * after * (after + before);
  const double noise = 1 + 2 * ratio;
  for (int column = 0; column < 4; ++column)
  {
    const Vec3 a = first.ReceiverToTransmitter.Column(column);
    const Vec3 b = second.ReceiverToTransmitter.Column(column);
    const Vec3 expected = b + ratio * (b - a);
    const double limit = column == 3
      ? this->Limits.Acceleration * bend + this->Limits.PositionNoise * noise
      : this->Limits.AngularAcceleration * bend + this->Limits.AngularNoise * noise;
    if (!(Norm(third.ReceiverToTransmitter.Column(column) - expected) <= limit))
    {
      return false;
    }
  }
  return true;
}

// Of the first pose after a gap or of a new motion. A tracker that was silent for a moment, or a
// jerk, hides how the receiver went on: it has hardly gone round the transmitter. Into the other
// hemisphere it has gone only when it would come out near where it was, and soon.
bool MotionCheck::IsInOtherHemisphere(const TrackedPose& first) const
{
  constexpr double near = 3; // times nearer
  constexpr double soon = 2; // s
  if (this->Track.empty())
  {
    return false;
  }
  const Vec3 last = this->Track.back().ReceiverToTransmitter.Column(3);
  const Vec3 position = first.ReceiverToTransmitter.Column(3);
  const double there = Norm(-1 * position - last);
  const double here = Norm(position - last);
  return this->Track.back().Flipped
    ? there < here
    : near * there < here && first.Time - this->Track.back().Time < soon;
}

void MotionCheck::Judge(const TrackedPose& pose, std::vector<TrackedPose>& accepted)
{
  if (!pose.Usable)
  {
    accepted.push_back(pose);
    return;
  }
  const auto isOld = [&](const TrackedPose& earlier)
  { return pose.Time - earlier.Time > this->Limits.MaximumGap; };
  const auto firstYoung = std::find_if_not(this->Waiting.begin(), this->Waiting.end(), isOld);
  this->Dropped += static_cast<std::uint64_t>(firstYoung - this->Waiting.begin());
  this->Waiting.erase(this->Waiting.begin(), firstYoung);

  if (this->Track.size() == 2 && !isOld(this->Track.back()))
  {
    const TrackedPose flipped = Flip(pose);
    const bool here = this->Fits(this->Track[0], this->Track[1], pose);
    const bool there = this->Fits(this->Track[0], this->Track[1], flipped);
    if (here || there)
    {
      // after some tenths of a second both may fit near the transmitter
      const bool flip = there && (!here || this->IsInOtherHemisphere(pose));
      this->Flipped += flip ? 1 : 0;
      accepted.push_back(flip ? flipped : pose);
      this->Track = { this->Track[1], accepted.back() };
      this->Dropped += this->Waiting.size();
      this->Waiting.clear();
      return;
    }
  }
  if (this->Waiting.size() == 2)
  {
    if (this->Fits(this->Waiting[0], this->Waiting[1], pose))
    {
      this->Waiting.push_back(pose);
      if (this->IsInOtherHemisphere(this->Waiting.front()))
      {
        std::transform(this->Waiting.begin(), this->Waiting.end(), this->Waiting.begin(), Flip);
        this->Flipped += this->Waiting.size();
      }
      accepted.insert(accepted.end(), this->Waiting.begin(), this->Waiting.end());
      this->Track = { this->Waiting[1], this->Waiting[2] };
      this->Waiting.clear();
      return;
    }
    ++this->Dropped;
    this->Waiting.erase(this->Waiting.begin());
  }
  this->Waiting.push_back(pose);
}
}
