// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOpenIGTLinkClock.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Step = 0.5;          // s that a clock must jump to be another
constexpr double Tolerance = 0.008;   // s, as of FrameClock: 0.2 mm at 23 mm/s
constexpr double LargestDrift = 1e-3; // of clocks; 50 parts in a million are usual
constexpr int NumberOfParts = 20;
}

OpenIGTLinkClock::OpenIGTLinkClock(double window)
  : Window(window)
{
}

double OpenIGTLinkClock::Estimate::GetSmallest() const
{
  return std::min_element(this->Parts.begin(), this->Parts.end(),
    [](const Part& a, const Part& b) { return a.Smallest < b.Smallest; })
    ->Smallest;
}

double OpenIGTLinkClock::Estimate::GetLargest() const
{
  return std::max_element(this->Parts.begin(), this->Parts.end(),
    [](const Part& a, const Part& b) { return a.Largest < b.Largest; })
    ->Largest;
}

double OpenIGTLinkClock::ToLocal(const std::string& device, double stamp, double arrival)
{
  if (this->Devices.size() >= MostDevices && this->Devices.count(device) == 0)
  {
    return arrival;
  }
  Estimate& own = this->Devices[device];
  const double difference = arrival - stamp;
  // stamps that go back, or that would be of the future
  if (!own.Parts.empty() &&
    (stamp < own.NewestStamp - Step || difference < own.GetSmallest() - Step))
  {
    own.Parts.clear();
    own.NewestStamp = stamp;
    ++own.Steps;
  }
  own.NewestStamp = own.Parts.empty() ? stamp : std::max(own.NewestStamp, stamp);
  while (!own.Parts.empty() && own.Parts.front().Begin < arrival - this->Window)
  {
    own.Parts.pop_front();
  }
  if (own.Parts.empty() || arrival >= own.Parts.back().Begin + this->Window / NumberOfParts)
  {
    own.Parts.push_back({ arrival, difference, difference });
  }
  else
  {
    own.Parts.back().Smallest = std::min(own.Parts.back().Smallest, difference);
    own.Parts.back().Largest = std::max(own.Parts.back().Largest, difference);
  }
  this->Revise(own, arrival);
  return std::min(stamp + this->GetOffset(own), arrival); // but for rounding it is never later
}

void OpenIGTLinkClock::Revise(Estimate& own, double arrival)
{
  const double offset = this->GetOffset(own);
  const double passed = arrival - std::exchange(own.RevisedTime, arrival);
  const double drift = own.Revised ? LargestDrift * std::max(passed, 0.0) : 0;
  if (!own.Revised) // times of others of this clock are by their offset
  {
    own.Revised = offset;
    for (const auto& [device, other] : this->Devices)
    {
      if (other.Revised && std::abs(*other.Revised - offset) < Step)
      {
        own.Revised = other.Revised;
      }
    }
  }
  own.Revised = *own.Revised + std::clamp(offset - *own.Revised, -drift, drift);
  if (std::abs(*own.Revised - offset) > Tolerance)
  {
    ++this->Revision;
    for (auto& [device, other] : this->Devices)
    {
      other.Revised = this->GetOffset(other);
    }
  }
}

double OpenIGTLinkClock::GetOffset(const Estimate& own) const
{
  const double smallest = own.GetSmallest();
  double offset = smallest;
  for (const auto& [device, other] : this->Devices)
  {
    const double theirs = other.GetSmallest();
    const bool silent = other.Parts.back().Begin < own.Parts.back().Begin - this->Window;
    if (!silent && std::abs(theirs - smallest) < Step)
    {
      offset = std::min(offset, theirs);
    }
  }
  return offset;
}

double OpenIGTLinkClock::GetStep(const std::string& a, const std::string& b) const
{
  const auto one = this->Devices.find(a);
  const auto other = this->Devices.find(b);
  if (one == this->Devices.end() || other == this->Devices.end())
  {
    return 0;
  }
  const double difference = std::abs(one->second.GetSmallest() - other->second.GetSmallest());
  return difference < Step ? 0 : difference;
}

std::optional<double> OpenIGTLinkClock::GetOffset(const std::string& device) const
{
  const auto found = this->Devices.find(device);
  return found == this->Devices.end() ? std::nullopt
                                      : std::optional<double>(this->GetOffset(found->second));
}

int OpenIGTLinkClock::GetNumberOfSteps(const std::string& device) const
{
  const auto found = this->Devices.find(device);
  return found == this->Devices.end() ? 0 : found->second.Steps;
}

double OpenIGTLinkClock::GetJitter(const std::string& device) const
{
  const auto found = this->Devices.find(device);
  return found == this->Devices.end() ? 0
                                      : found->second.GetLargest() - found->second.GetSmallest();
}
}
