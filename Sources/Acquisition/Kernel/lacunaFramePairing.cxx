// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFramePairing.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double LongestDelay = 1;   // s of who takes the frames, after which those are dropped
constexpr double LongestUntimed = 3; // s: 25 frames at 9 a second
}

FramePairing::FramePairing(double patience)
  : Patience(patience)
{
}

void FramePairing::AddFrame(PairedFrame frame, double now)
{
  frame.Timed = frame.Timed || !frame.Wanted; // who only looks does not wait
  const double deadline =
    std::max(now, frame.Instant) + (frame.Timed ? this->Patience : LongestUntimed);
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
    this->Settle(waiting);
  }
}

void FramePairing::Settle(Waiting& waiting)
{
  if (!waiting.Settled && waiting.Frame.Timed && !this->Track.IsAhead(waiting.Frame.Instant))
  {
    waiting.Frame.Pose = this->Track.At(waiting.Frame.Instant, waiting.Frame.Epoch);
    waiting.Settled = true;
  }
}

void FramePairing::SetTime(std::int64_t number, std::optional<double> later)
{
  const auto found = std::find_if(this->Frames.begin(), this->Frames.end(),
    [&](const Waiting& waiting) { return waiting.Frame.Number == number; });
  if (found == this->Frames.end() || found->Frame.Timed)
  {
    return;
  }
  if (!later)
  {
    found->Settled = true; // without a pose
    return;
  }
  found->Frame.Instant += *later;
  found->Frame.Timed = true;
  this->Settle(*found);
}

std::optional<PairedFrame> FramePairing::FindUntimed() const
{
  return this->Frames.empty() || this->Frames.back().Frame.Timed
    ? std::nullopt
    : std::optional<PairedFrame>(this->Frames.back().Frame);
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
      const bool waits = !first.Frame.Timed || this->Track.IsAhead(first.Frame.Instant);
      if (waits && now < first.Deadline)
      {
        break;
      }
      if (first.Frame.Timed)
      {
        first.Frame.Pose = this->Track.At(first.Frame.Instant, first.Frame.Epoch);
      }
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
