// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepReplay.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
SweepReplay::SweepReplay(const std::vector<double>& timestamps, std::int64_t first,
  std::int64_t stride, std::int64_t count)
{
  std::vector<double> times;
  for (std::int64_t i = 0; i < count; ++i)
  {
    const auto frame = static_cast<std::size_t>(first + i * stride);
    times.push_back(frame < timestamps.size() ? timestamps[frame] : std::nan(""));
  }
  const auto known =
    std::find_if(times.begin(), times.end(), [](double time) { return std::isfinite(time); });
  this->Stamped = known != times.end();
  if (!this->Stamped)
  {
    for (std::int64_t i = 0; i < count; ++i)
    {
      times[static_cast<std::size_t>(i)] = static_cast<double>(first + i * stride);
    }
  }
  double latest = this->Stamped ? *known : times.front();
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    latest = std::isfinite(times[i]) ? std::max(latest, times[i]) : latest;
    if (this->Times.empty() || latest > this->Times.back())
    {
      this->Times.push_back(latest);
      this->Counts.push_back(0);
    }
    this->Counts.back() = static_cast<std::int64_t>(i) + 1;
  }
}

std::int64_t SweepReplay::GetNumberOfSlices(double time) const
{
  const auto after = std::upper_bound(this->Times.begin(), this->Times.end(), time);
  return after == this->Times.begin() ? 1 : this->Counts[after - this->Times.begin() - 1];
}

double SweepReplay::GetTimeBefore(double time) const
{
  const auto after = std::upper_bound(this->Times.begin(), this->Times.end(), time);
  return after == this->Times.begin() ? this->Times.front() : *(after - 1);
}
}
