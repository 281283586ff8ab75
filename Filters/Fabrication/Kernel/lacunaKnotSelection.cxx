// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaKnotSelection.h"

#include "lacunaCubicSpline.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
struct KnotSelection::Trial
{
  std::vector<double> Interior;
  std::vector<double> AtSites; // deviation
  double Deviation = 0;        // the largest of them
};

//------------------------------------------------------------------------------
KnotSelection::KnotSelection(const std::vector<double>& sites, const std::vector<double>& samples,
  std::int64_t width, int components)
  : Sites(sites)
  , Samples(samples)
  , Width(width)
  , Components(components)
{
  const auto count = static_cast<std::int64_t>(sites.size());
  // Divided differences of order 4, five sites each; 24 times them is the fourth derivative.
  std::vector<double> fourth(std::max<std::int64_t>(0, count - 4), 0.0);
  for (std::int64_t i = 0; i + 4 < count; ++i)
  {
    double weight[5];
    for (int a = 0; a < 5; ++a)
    {
      weight[a] = 1;
      for (int b = 0; b < 5; ++b)
      {
        weight[a] /= a == b ? 1 : sites[i + a] - sites[i + b];
      }
    }
    const double* d = samples.data() + i * width;
    for (std::int64_t k = 0; k < width; k += components)
    {
      double sum = 0;
      for (int c = 0; c < components; ++c)
      {
        double difference = 0;
        for (int a = 0; a < 5; ++a)
        {
          difference += weight[a] * d[a * width + k + c];
        }
        sum += difference * difference;
      }
      fourth[i] = std::max(fourth[i], sum);
    }
  }
  // The fourth root of the largest difference in which an interval takes part.
  this->Density.assign(count - 1, 0.0);
  double total = 0;
  for (std::int64_t i = 0; i + 1 < count; ++i)
  {
    double largest = 0;
    for (std::int64_t j = std::max<std::int64_t>(0, i - 3);
         j <= i && j < static_cast<std::int64_t>(fourth.size()); ++j)
    {
      largest = std::max(largest, fourth[j]);
    }
    this->Density[i] = std::sqrt(std::sqrt(std::sqrt(largest)));
    total += this->Density[i] * (sites[i + 1] - sites[i]);
  }
  // Nowhere is it nothing: the differences of a part say little of long intervals.
  const double least =
    total > 0 ? 0.1 * total / (sites.back() - sites.front()) : 1 / (sites.back() - sites.front());
  for (double& d : this->Density)
  {
    d = std::max(d, least);
  }
}

//------------------------------------------------------------------------------
std::vector<double> KnotSelection::Place(std::int64_t count) const
{
  const auto sites = static_cast<std::int64_t>(this->Sites.size());
  std::vector<double> mass(sites, 0.0);
  for (std::int64_t i = 1; i < sites; ++i)
  {
    mass[i] = mass[i - 1] + this->Density[i - 1] * (this->Sites[i] - this->Sites[i - 1]);
  }
  // Positions in numbers of sites, at equal steps of the mass.
  std::vector<double> positions(count);
  double closest = static_cast<double>(sites);
  double previous = 0;
  std::int64_t i = 1;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const double wanted = mass.back() * static_cast<double>(k + 1) / static_cast<double>(count + 1);
    while (i + 1 < sites && mass[i] < wanted)
    {
      ++i;
    }
    positions[k] = static_cast<double>(i) - (mass[i] - wanted) / (mass[i] - mass[i - 1]);
    closest = std::min(closest, positions[k] - previous);
    previous = positions[k];
  }
  std::vector<double> interior(count);
  if (count == 0 || closest >= 1.25)
  {
    // Every interval holds a site: anywhere will do. Short decimals make a short file.
    double spacing = this->Sites.back() - this->Sites.front();
    for (std::int64_t s = 1; s < sites; ++s)
    {
      spacing = std::min(spacing, this->Sites[s] - this->Sites[s - 1]);
    }
    const double steps = std::pow(10, std::ceil(-std::log10(0.101 * spacing)));
    for (std::int64_t k = 0; k < count; ++k)
    {
      const auto whole = static_cast<std::int64_t>(positions[k]);
      const double x = this->Sites[whole] +
        (positions[k] - static_cast<double>(whole)) * (this->Sites[whole + 1] - this->Sites[whole]);
      interior[k] = std::round(steps * x) / steps;
    }
    return interior;
  }
  // At sites, each one's own, those of interpolation at most: always well posed.
  std::int64_t lowest = 2;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const std::int64_t highest = sites - 3 - (count - 1 - k);
    const std::int64_t site =
      std::clamp(static_cast<std::int64_t>(std::llround(positions[k])), lowest, highest);
    interior[k] = this->Sites[site];
    lowest = site + 1;
  }
  return interior;
}

//------------------------------------------------------------------------------
KnotSelection::Trial KnotSelection::Try(Execution& execution, std::int64_t count) const
{
  Trial trial;
  trial.Interior = this->Place(count);
  const CubicSplineFit fit(
    CubicSplineSpace(this->Sites.front(), trial.Interior, this->Sites.back()), this->Sites);
  trial.AtSites = fit.Deviation(execution, this->Samples, this->Width, this->Components);
  trial.Deviation = *std::max_element(trial.AtSites.begin(), trial.AtSites.end());
  return trial;
}

//------------------------------------------------------------------------------
void KnotSelection::Equalise(const Trial& trial)
{
  if (!(trial.Deviation > 0))
  {
    return;
  }
  // Deviation goes with the fourth power of an interval's length.
  std::size_t first = 0;
  for (std::size_t k = 0; k <= trial.Interior.size(); ++k)
  {
    const double end = k < trial.Interior.size() ? trial.Interior[k] : this->Sites.back();
    std::size_t last = first;
    double largest = trial.AtSites[first];
    while (last + 1 < this->Sites.size() && this->Sites[last + 1] <= end)
    {
      ++last;
      largest = std::max(largest, trial.AtSites[last]);
    }
    const double factor = std::pow(std::max(largest / trial.Deviation, 0.01), 0.125);
    for (std::size_t i = first; i < std::max(last, first + 1) && i < this->Density.size(); ++i)
    {
      this->Density[i] *= factor;
    }
    first = last;
  }
}

//------------------------------------------------------------------------------
KnotSelection::Result KnotSelection::Select(Execution& execution, double tolerance)
{
  const auto sites = static_cast<std::int64_t>(this->Sites.size());
  Trial best;
  best.Interior.assign(this->Sites.begin() + 2, this->Sites.end() - 2);
  Trial failed;
  std::int64_t lo = -1;        // not enough knots
  std::int64_t hi = sites - 4; // interpolation
  // The fewest knots of this density. Deviation goes with the fourth power of the intervals'
  // length, which leads from a known number to a good guess.
  while (hi - lo > 1)
  {
    double law = 0;
    if (this->LastDeviation > 0)
    {
      law = std::ceil((this->LastCount + 1) * std::pow(this->LastDeviation / tolerance, 0.25) - 1);
    }
    std::int64_t guess = (lo + hi) / 2;
    if (law < static_cast<double>(hi))
    {
      guess = std::max(lo + 1, static_cast<std::int64_t>(law));
    }
    Trial trial = this->Try(execution, guess);
    this->LastCount = static_cast<double>(guess);
    this->LastDeviation = trial.Deviation;
    if (trial.Deviation <= tolerance)
    {
      best = std::move(trial);
      hi = guess;
    }
    else
    {
      failed = std::move(trial);
      lo = guess;
    }
  }
  // Fewer by moving them, as long as that brings the deviation down.
  for (int round = 0; round < 5 && lo > 0; ++round)
  {
    this->Equalise(failed);
    Trial trial = this->Try(execution, lo);
    if (trial.Deviation <= tolerance)
    {
      best = std::move(trial);
      round = -1;
      trial = this->Try(execution, --lo);
    }
    else if (round > 1 && trial.Deviation > failed.Deviation)
    {
      break;
    }
    failed = std::move(trial);
  }
  return { best.Interior, best.Deviation };
}

//------------------------------------------------------------------------------
KnotSelection::Result KnotSelection::SelectCount(Execution& execution, std::int64_t count)
{
  Trial best = this->Try(execution, count);
  Trial trial = best;
  for (int round = 0; round < 3 && count > 0; ++round)
  {
    this->Equalise(trial);
    trial = this->Try(execution, count);
    if (trial.Deviation < best.Deviation)
    {
      best = trial;
    }
  }
  return { best.Interior, best.Deviation };
}
}
