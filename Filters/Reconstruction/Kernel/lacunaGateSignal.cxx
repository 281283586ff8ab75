// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGateSignal.h"

#include "lacunaProperties.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Of a period or of a bound: what was computed in another way than a value is still the same.
constexpr double RelativeTolerance = 1e-9;
// s; times were rounded when they were written to a file.
constexpr double TimeTolerance = 1e-6;

// x modulo period, >= 0 and < period.
double Wrap(double x, double period)
{
  const double wrapped = x - period * std::floor(x / period);
  return wrapped < period ? wrapped : 0; // rounding
}

// The change from a to b along the shorter way around.
double GetShortestChange(double a, double b, double period)
{
  const double forwards = Wrap(b - a, period);
  return forwards > 0.5 * period ? forwards - period : forwards;
}
}

GateSignal::GateSignal(GateKind kind, const std::vector<double>& times,
  const std::vector<double>& values, double period, double maximumGap)
  : Kind(kind)
  , Period(period)
  , MaximumGap(maximumGap)
{
  if (kind != GateKind::Value)
  {
    ValueRange::Above(0).Check("Period", period);
  }
  if (kind != GateKind::Trigger && values.size() != times.size())
  {
    throw std::invalid_argument("the gate signal has " + std::to_string(values.size()) +
      " values for " + std::to_string(times.size()) + " times");
  }
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    if (!std::isfinite(times[i]))
    {
      throw std::invalid_argument("the gate signal has no finite time in row " + std::to_string(i));
    }
    const double value = kind == GateKind::Trigger ? 0 : values[i];
    if (std::isfinite(value))
    {
      this->Samples.push_back({ times[i], value });
    }
  }
  std::stable_sort(this->Samples.begin(), this->Samples.end(),
    [](const Sample& a, const Sample& b) { return a.Time < b.Time; });
  this->Samples.erase(std::unique(this->Samples.begin(), this->Samples.end(),
                        [](const Sample& a, const Sample& b) { return a.Time == b.Time; }),
    this->Samples.end());
  if (this->Samples.empty())
  {
    throw std::invalid_argument("the gate signal has no row with a finite value");
  }
  if (kind == GateKind::Trigger && this->Samples.size() < 2)
  {
    throw std::invalid_argument("the gate signal has one trigger; a cycle needs two");
  }
}

double GateSignal::At(double time) const
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!(time >= this->GetFirstTime() - TimeTolerance &&
        time <= this->GetLastTime() + TimeTolerance))
  {
    return none;
  }
  time = std::clamp(time, this->GetFirstTime(), this->GetLastTime());
  // the first sample after time
  const auto after = std::upper_bound(this->Samples.begin(), this->Samples.end(), time,
    [](double t, const Sample& sample) { return t < sample.Time; });
  const Sample& a = *(after - 1);
  if (a.Time == time || after == this->Samples.end())
  {
    return this->Kind == GateKind::Value ? a.Value : Wrap(a.Value, this->Period);
  }
  const Sample& b = *after;
  if (this->MaximumGap > 0 && b.Time - a.Time > this->MaximumGap)
  {
    return none;
  }
  const double part = (time - a.Time) / (b.Time - a.Time);
  switch (this->Kind)
  {
    case GateKind::Value:
      return a.Value + part * (b.Value - a.Value);
    case GateKind::Phase:
      return Wrap(a.Value + part * GetShortestChange(a.Value, b.Value, this->Period), this->Period);
    default:
      return Wrap(part * this->Period, this->Period);
  }
}

GateRange::GateRange(double first, double last, double period)
  : First(first)
  , Last(last)
  , Period(period)
{
  if (!std::isfinite(first) || !std::isfinite(last) || (!(period > 0) && first > last))
  {
    std::ostringstream message;
    message << "the gate lets values from " << first << " to " << last
            << " through; the first must be the smaller one, unless they are phases of a cycle";
    throw std::invalid_argument(message.str());
  }
}

bool GateRange::Accepts(double value) const
{
  if (!std::isfinite(value))
  {
    return false;
  }
  if (!(this->Period > 0))
  {
    const double tolerance =
      RelativeTolerance * std::max(std::abs(this->First), std::abs(this->Last));
    return value >= this->First - tolerance && value <= this->Last + tolerance;
  }
  const double tolerance = RelativeTolerance * this->Period;
  double width = this->Last - this->First;
  if (width < 0)
  {
    width = Wrap(width, this->Period);
  }
  const double after = Wrap(value - this->First, this->Period);
  return width >= this->Period - tolerance || after <= width + tolerance ||
    after >= this->Period - tolerance;
}
}
