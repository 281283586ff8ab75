// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFrameClock.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna
{
namespace
{
constexpr std::size_t Window = 50;
constexpr std::size_t Fewest = 25; // that tell anything
constexpr double LongestStall = 1; // s; what is later is a stream that began anew

double FindMedian(const std::deque<double>& values)
{
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}
}

double FrameClock::FindArrival(double arrival, double streamTime)
{
  const double offset = arrival - streamTime;
  double found = arrival;
  if (!this->Offsets.empty())
  {
    const double median = FindMedian(this->Offsets);
    const double late = offset - median;
    if (std::abs(late) > LongestStall)
    {
      this->Offsets.clear();
    }
    else if (late > this->Tolerance && this->IsSteady(median))
    {
      found = streamTime + median;
    }
  }
  this->Offsets.push_back(offset);
  if (this->Offsets.size() > Window)
  {
    this->Offsets.pop_front();
  }
  return found;
}

// Three of four within half the tolerance: a rate that is wrong by more than 0.5 % at 25 Hz spreads
// them further, and one that is less wrong takes no frame out of the tolerance.
bool FrameClock::IsSteady(double median) const
{
  const auto near = std::count_if(this->Offsets.begin(), this->Offsets.end(),
    [&](double offset) { return std::abs(offset - median) <= this->Tolerance / 2; });
  return this->Offsets.size() >= Fewest &&
    4 * static_cast<std::size_t>(near) >= 3 * this->Offsets.size();
}
}
