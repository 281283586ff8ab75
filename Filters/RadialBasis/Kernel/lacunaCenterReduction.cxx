// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCenterReduction.h"

#include "lacunaExecution.h"
#include "lacunaNodePartition.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
// How many centres one starts with, and how many are added to those there are.
constexpr std::size_t Start = 50;
constexpr double Growth = 0.5;
}

template <int Dimension>
std::vector<std::size_t> ReduceCenters(Execution& execution,
  const std::vector<std::array<double, Dimension>>& nodes, const std::vector<double>& values,
  const RadialBasisOptions& options, double tolerance)
{
  using Point = std::array<double, Dimension>;
  if (!(tolerance > 0) || !std::isfinite(tolerance))
  {
    throw std::invalid_argument("the tolerance must be a finite number above 0");
  }
  if (!options.Errors.empty())
  {
    throw std::invalid_argument("errors of values cannot be given when centres are reduced");
  }
  const Execution::NestedStages stages(execution);
  const std::vector<std::size_t> distinct =
    FindDistinctNodes<Dimension>(nodes, { values }, Dimension + 1);
  std::vector<Point> all;
  all.reserve(distinct.size());
  for (const std::size_t i : distinct)
  {
    all.push_back(nodes[i]);
  }
  std::vector<char> chosen(all.size(), 0);
  const auto choose = [&](std::size_t groups)
  {
    const std::size_t size = std::max<std::size_t>(1, all.size() / groups);
    return NodePartition<Dimension>(all, static_cast<int>(size));
  };
  for (const std::uint32_t i : choose(Start).GetRepresentatives())
  {
    chosen[i] = 1;
  }
  double progress = 0;
  while (true)
  {
    std::vector<Point> centers;
    std::vector<double> at;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      if (chosen[i])
      {
        centers.push_back(all[i]);
        at.push_back(values[distinct[i]]);
      }
    }
    // The number of rounds is not known; each takes longer than the one before.
    execution.SetStage(progress, 1 - 0.8 * (1 - progress));
    progress = 1 - 0.8 * (1 - progress);
    const RadialBasis<Dimension> function(execution, centers, at, options);
    std::vector<double> fit;
    function.Evaluate(execution, all, fit);
    const auto error = [&](std::size_t i) { return std::abs(fit[i] - values[distinct[i]]); };
    double worst = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      worst = std::max(worst, error(i));
    }
    if (worst <= tolerance)
    {
      break;
    }
    // The worst node of each of many groups, if it is too far off
    const NodePartition<Dimension> partition =
      choose(static_cast<std::size_t>(Growth * static_cast<double>(centers.size())) + 1);
    bool added = false;
    for (std::size_t g = 0; g < partition.GetNumberOfGroups(); ++g)
    {
      const std::vector<std::uint32_t> group = partition.GetGroup(g);
      const std::uint32_t i = *std::max_element(group.begin(), group.end(),
        [&](std::uint32_t a, std::uint32_t b) { return error(a) < error(b); });
      if (error(i) > std::max(tolerance, 0.1 * worst) && !chosen[i])
      {
        chosen[i] = 1;
        added = true;
      }
    }
    if (!added)
    {
      std::ostringstream message;
      message << "with " << centers.size() << " centres values are still missed by up to " << worst
              << ", more than the tolerance " << tolerance << "; raise it"
              << (options.Smoothing > 0 ? ", or lower the smoothing" : "");
      throw std::runtime_error(message.str());
    }
  }
  std::vector<std::size_t> centers;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    if (chosen[i])
    {
      centers.push_back(distinct[i]);
    }
  }
  return centers;
}

template std::vector<std::size_t> ReduceCenters<2>(Execution&,
  const std::vector<std::array<double, 2>>&, const std::vector<double>&, const RadialBasisOptions&,
  double);
template std::vector<std::size_t> ReduceCenters<3>(Execution&,
  const std::vector<std::array<double, 3>>&, const std::vector<double>&, const RadialBasisOptions&,
  double);
}
