// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFramePairing.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double LongestDelay = 1; // s of who takes the frames, after which those are dropped
}

FramePairing::FramePairing(double patience)
  : Patience(patience)
{
}

void FramePairing::AddFrame(PairedFrame frame, double now)
{
  const double deadline = std::max(now, frame.Instant) + this->Patience;
  // the one before a wanted frame tells the speed at that
  auto kept = this->Frames.begin();
  for (auto i = kept; i != this->Frames.end(); ++i)
  {
    const auto next = std::next(i);
    if (i->Frame.Wanted || now <= i->Expiry || (next != this->Frames.end() && next->Frame.Wanted))
    {
      std::iter_swap(kept++, i);
    }
  }
  this->Frames.erase(kept, this->Frames.end());
  this->Frames.push_back({ std::move(frame), deadline, deadline + LongestDelay });
}

// The track does not reach back to frames that are taken late.
void FramePairing::AddPose(const TrackedPose& pose)
{
  this->Track.Add(pose);
  for (Waiting& waiting : this->Frames)
  {
    if (!waiting.Settled && !this->Track.IsAhead(waiting.Frame.Instant))
    {
      waiting.Frame.Pose = this->Track.At(waiting.Frame.Instant);
      waiting.Settled = true;
    }
  }
}

void FramePairing::Abandon()
{
  for (Waiting& waiting : this->Frames)
  {
    waiting.Deadline = 0;
  }
}

std::vector<PairedFrame> FramePairing::Take(double now)
{
  std::vector<PairedFrame> ready;
  while (!this->Frames.empty())
  {
    Waiting& first = this->Frames.front();
    if (!first.Settled)
    {
      if (this->Track.IsAhead(first.Frame.Instant) && now < first.Deadline)
      {
        break;
      }
      first.Frame.Pose = this->Track.At(first.Frame.Instant);
    }
    ready.push_back(std::move(first.Frame));
    this->Frames.pop_front();
  }
  return ready;
}

std::optional<double> FramePairing::GetLatestInstant() const
{
  std::optional<double> latest;
  for (const Waiting& waiting : this->Frames)
  {
    latest = std::max(latest.value_or(waiting.Frame.Instant), waiting.Frame.Instant);
  }
  return latest;
}
}
