// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFrameClock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
constexpr std::size_t Window = 50;
constexpr std::size_t Fewest = 25; // that tell anything when some of them are late
constexpr std::size_t FewestAlike = 10;
constexpr double LongestStall = 1; // s; what is later is a stream that began anew

double FindMedian(const std::deque<double>& values)
{
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}
}

FrameClock::Answer FrameClock::FindArrival(double arrival, double streamTime)
{
  const double found = this->Judge(arrival, streamTime);
  if (this->Settled)
  {
    return { found, true };
  }
  this->Early.emplace_back(arrival, streamTime);
  this->Settle();
  if (!this->Settled)
  {
    return { found, false };
  }
  const double last = *this->Known.back(); // of this frame
  this->Known.pop_back();
  return { last, true };
}

std::vector<std::optional<double>> FrameClock::TakeArrivals()
{
  return std::exchange(this->Known, {});
}

// What follows is another stream.
void FrameClock::Forget()
{
  this->Offsets.clear();
  this->HeldUp = false;
  this->Settled = false;
  this->Known.resize(this->Known.size() + this->Early.size());
  this->Early.clear();
}

// Judges the early frames by what all of them tell.
void FrameClock::Settle()
{
  const double median = FindMedian(this->Offsets);
  const bool steady = this->IsSteady(median);
  if (!steady && this->Offsets.size() < Window)
  {
    return;
  }
  FrameClock judge = *this;
  judge.Settled = true;
  judge.HeldUp = false;
  // as if frames that are not late had come before
  judge.Before = Frame{ this->Early.front().second, median, this->Early.front().first, false };
  judge.Before->Found = -std::numeric_limits<double>::infinity();
  for (const auto& [arrival, streamTime] : this->Early)
  {
    judge.Offsets = this->Offsets;
    this->Known.emplace_back(steady ? judge.Judge(arrival, streamTime) : arrival);
  }
  this->Before = judge.Before;
  this->HeldUp = judge.HeldUp;
  this->Settled = true;
  this->Early.clear();
}

double FrameClock::Judge(double arrival, double streamTime)
{
  Frame frame{ streamTime, arrival - streamTime, arrival, false };
  bool catchingUp = false;
  if (this->Before && streamTime < this->Before->StreamTime)
  {
    this->Forget(); // set anew
  }
  if (!this->Offsets.empty())
  {
    const double median = FindMedian(this->Offsets);
    const double late = frame.Offset - median;
    frame.Late = late > this->Tolerance;
    if (std::abs(late) > LongestStall)
    {
      this->Forget();
    }
    else if (frame.Late)
    {
      const double change = frame.Offset - this->Before->Offset;
      const double pace = this->FindPace(streamTime);
      catchingUp = this->Before->Late && change < -pace;
      // as long as they are late: one that kept its arrival would be followed by an earlier one
      this->HeldUp = this->IsSteady(median) &&
        (!this->Before->Late || (this->HeldUp && std::abs(change) > pace));
      if (this->HeldUp)
      {
        frame.Found = std::min(arrival, std::max(streamTime + median, this->Before->Found));
      }
    }
  }
  if (!catchingUp) // they tell nothing of the way, and may be many
  {
    this->Offsets.push_back(frame.Offset);
  }
  if (this->Offsets.size() > Window)
  {
    this->Offsets.pop_front();
  }
  this->Before = frame;
  return frame.Found;
}

double FrameClock::FindPace(double streamTime) const
{
  return std::min(this->Tolerance / 2, (streamTime - this->Before->StreamTime) / 4);
}

// Three of four within half the tolerance: a rate that is wrong by more than 0.5 % at 25 Hz spreads
// them further, and one that is less wrong takes no frame out of the tolerance.
bool FrameClock::IsSteady(double median) const
{
  const auto near = std::count_if(this->Offsets.begin(), this->Offsets.end(),
    [&](double offset) { return std::abs(offset - median) <= this->Tolerance / 2; });
  const auto all = static_cast<std::ptrdiff_t>(this->Offsets.size());
  if (this->Offsets.size() < Fewest && !this->Settled && near < all)
  {
    return false;
  }
  return this->Offsets.size() >= FewestAlike && 4 * near >= 3 * all;
}
}
