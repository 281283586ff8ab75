// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpotTracking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double CostOfNone = 0.5;
constexpr double CostOfJump = 0.15;
constexpr double CostOfJumpInSweep = 2;
constexpr double LeastScoreOfSweep = 0.5;
constexpr double NearPart = 0.5;       // of the reach, a step in a sweep
constexpr std::size_t LongestGap = 10; // slices over which a step is still judged by its length
constexpr double UsualPart = 0.6;      // of the usual brightness: bright enough
constexpr double UsualPercentile = 0.75;
constexpr double Forbidden = 1e6;

struct Node
{
  Spot Choice;
  double Cost = 0;                   // of the best way up to here
  std::optional<std::size_t> Before; // of the nodes; none: the way begins here
  std::size_t Slice = 0;
};

// Brightness of the best spots of those slices that have any.
double GetUsualLevel(const std::vector<SpotSlice>& slices)
{
  std::vector<double> levels;
  for (const SpotSlice& slice : slices)
  {
    if (!slice.Spots.empty())
    {
      levels.push_back(slice.Spots.front().Level);
    }
  }
  if (levels.empty())
  {
    return 1;
  }
  const auto place = levels.begin() +
    static_cast<std::ptrdiff_t>(UsualPercentile * static_cast<double>(levels.size() - 1));
  std::nth_element(levels.begin(), place, levels.end());
  return *place;
}

double GetSteps(const Spot& from, const Spot& to, double reach)
{
  return std::hypot(to.Pixel[0] - from.Pixel[0], to.Pixel[1] - from.Pixel[1]) / reach;
}

// Whether most of the best spots of slices that follow one another do, too.
bool IsSweep(const std::vector<SpotSlice>& slices, double reach)
{
  std::size_t steps = 0, near = 0;
  const auto isClear = [](const SpotSlice& slice)
  { return !slice.Spots.empty() && slice.Spots.front().Score > LeastScoreOfSweep; };
  for (std::size_t k = 1; k < slices.size(); ++k)
  {
    if (isClear(slices[k - 1]) && isClear(slices[k]))
    {
      ++steps;
      near +=
        GetSteps(slices[k - 1].Spots.front(), slices[k].Spots.front(), reach) < NearPart ? 1 : 0;
    }
  }
  return 2 * near > steps;
}
}

std::vector<std::optional<Spot>> TrackSpots(const std::vector<SpotSlice>& slices, double reach)
{
  if (!(reach > 0))
  {
    throw std::invalid_argument("the reach of a step must be above 0 pixels");
  }
  const double usual = GetUsualLevel(slices);
  const double jump = IsSweep(slices, reach) ? CostOfJumpInSweep : CostOfJump;
  // what it costs to leave out all slices before one
  std::vector<double> skipped(slices.size() + 1, 0);
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    skipped[k + 1] = skipped[k] + (slices[k].Known ? Forbidden : CostOfNone);
  }
  std::vector<Node> nodes;
  std::vector<std::size_t> begins; // of each slice in nodes
  // the best way that ended long before, with what it costs to leave out all slices
  double endedCost = 0;
  std::optional<std::size_t> ended;
  const auto end = [&](std::size_t first, std::size_t last)
  {
    for (std::size_t n = first; n < last; ++n)
    {
      const double cost = nodes[n].Cost - skipped[nodes[n].Slice + 1];
      if (!ended || cost < endedCost)
      {
        ended = n;
        endedCost = cost;
      }
    }
  };
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    begins.push_back(nodes.size());
    if (k > LongestGap)
    {
      end(begins[k - LongestGap - 1], begins[k - LongestGap]);
    }
    std::vector<Spot> choices = slices[k].Spots;
    if (slices[k].Known)
    {
      choices = { { *slices[k].Known, 0, 1 } };
    }
    else
    {
      for (Spot& spot : choices)
      {
        spot.Score *= std::min(1.0, spot.Level / (UsualPart * usual));
      }
    }
    for (const Spot& spot : choices)
    {
      Node node{ spot, 0, {}, k };
      double best = skipped[k]; // the first of all
      if (ended && endedCost + skipped[k] + CostOfJump < best)
      {
        best = endedCost + skipped[k] + CostOfJump;
        node.Before = ended;
      }
      const std::size_t first = begins[k > LongestGap ? k - LongestGap : 0];
      for (std::size_t n = first; n < begins[k]; ++n)
      {
        const double step = std::min(
          1.0, GetSteps(nodes[n].Choice, spot, reach * static_cast<double>(k - nodes[n].Slice)));
        const double cost =
          nodes[n].Cost + skipped[k] - skipped[nodes[n].Slice + 1] + jump * step * step;
        if (cost < best)
        {
          best = cost;
          node.Before = n;
        }
      }
      node.Cost = best + 1 - spot.Score;
      nodes.push_back(node);
    }
  }
  ended.reset();
  end(0, nodes.size());
  std::vector<std::optional<Spot>> track(slices.size());
  // none at all costs 0 more than leaving out all slices
  for (std::optional<std::size_t> n = endedCost < 0 ? ended : std::nullopt; n; n = nodes[*n].Before)
  {
    track[nodes[*n].Slice] = nodes[*n].Choice;
  }
  return track;
}
}
