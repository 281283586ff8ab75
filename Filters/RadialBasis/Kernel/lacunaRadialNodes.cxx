// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialNodes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
// Relative to the extent of the nodes: flatter than this is a line (plane).
constexpr double FlatnessLimit = 1e-9;
// In mean distances of neighbours: smooth between nodes, and the equations are still well-conditioned.
constexpr double AutoShape = 1.25;

template <int Dimension>
std::string ToText(const std::array<double, Dimension>& point)
{
  std::ostringstream text;
  text << "(";
  for (int c = 0; c < Dimension; ++c)
  {
    text << (c ? ", " : "") << point[c];
  }
  text << ")";
  return text.str();
}

template <int Dimension>
void CheckFinite(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values)
{
  for (const std::vector<double>& list : values)
  {
    if (nodes.size() != list.size())
    {
      throw std::invalid_argument("there must be one value for each node");
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    bool finite = true;
    for (const std::vector<double>& list : values)
    {
      finite = finite && std::isfinite(list[i]);
    }
    for (const double x : nodes[i])
    {
      finite = finite && std::isfinite(x);
    }
    if (!finite)
    {
      throw std::invalid_argument("node " + std::to_string(i) + " at " +
        ToText<Dimension>(nodes[i]) + " or its value is not a finite number");
    }
  }
}
}

//------------------------------------------------------------------------------
template <int Dimension>
std::vector<std::size_t> FindDistinctNodes(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, std::size_t minimum)
{
  CheckFinite<Dimension>(nodes, values);
  std::vector<std::size_t> order(nodes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b)
    { return nodes[a] != nodes[b] ? nodes[a] < nodes[b] : a < b; });
  std::vector<std::size_t> distinct;
  for (const std::size_t i : order)
  {
    if (!distinct.empty() && nodes[distinct.back()] == nodes[i])
    {
      const std::size_t first = distinct.back();
      for (const std::vector<double>& list : values)
      {
        if (list[first] != list[i])
        {
          std::ostringstream message;
          message << "nodes " << first << " and " << i << " lie at the same place "
                  << ToText<Dimension>(nodes[i]) << " but have different values " << list[first]
                  << " and " << list[i];
          throw std::invalid_argument(message.str());
        }
      }
      continue;
    }
    distinct.push_back(i);
  }
  std::sort(distinct.begin(), distinct.end());
  if (distinct.size() < minimum)
  {
    throw std::invalid_argument("there are " + std::to_string(distinct.size()) +
      " nodes at different places; at least " + std::to_string(minimum) + " are needed");
  }
  return distinct;
}

//------------------------------------------------------------------------------
template <int Dimension>
AveragedNodes<Dimension>::AveragedNodes(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, const std::vector<double>& errors)
  : Nodes(nodes)
  , Values(values)
  , Errors(errors)
{
  CheckFinite<Dimension>(nodes, values);
  std::map<std::array<double, Dimension>, std::size_t> places;
  std::vector<std::size_t> own; // of each node, the place among those that stay
  for (const std::array<double, Dimension>& node : nodes)
  {
    own.push_back(places.emplace(node, places.size()).first->second);
  }
  if (places.size() == nodes.size())
  {
    return;
  }
  std::vector<double> weights(places.size(), 0.0);
  this->Nodes.resize(places.size());
  for (std::vector<double>& list : this->Values)
  {
    list.assign(places.size(), 0.0);
  }
  const auto getWeight = [&](std::size_t i)
  { return errors.empty() ? 1 : 1 / (errors[i] * errors[i]); };
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    this->Nodes[own[i]] = nodes[i];
    weights[own[i]] += getWeight(i);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    const double share = getWeight(i) / weights[own[i]];
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      this->Values[k][own[i]] += share * values[k][i];
    }
  }
  this->Errors.clear();
  for (const double weight : weights)
  {
    this->Errors.push_back(1 / std::sqrt(weight));
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
RadialFrame<Dimension> FindRadialFrame(
  const std::vector<std::array<double, Dimension>>& nodes, RadialKernel kernel, double shape)
{
  if (!std::isfinite(shape) || shape < 0)
  {
    throw std::invalid_argument("the length of the kernel must be a finite number >= 0");
  }
  std::array<double, Dimension> low = nodes.front();
  std::array<double, Dimension> high = low;
  for (const std::array<double, Dimension>& node : nodes)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      low[c] = std::min(low[c], node[c]);
      high[c] = std::max(high[c], node[c]);
    }
  }
  double extent = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    extent = std::max(extent, high[c] - low[c]);
  }
  RadialFrame<Dimension> frame;
  frame.Origin = low;
  frame.Scale = 1 / extent;
  if (IsRadialShaped(kernel))
  {
    // a cell of the lattice of as many nodes in the same box, flat boxes taken as one cell thick
    const double cell = extent / std::pow(static_cast<double>(nodes.size()), 1.0 / Dimension);
    double volume = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      volume *= std::max(high[c] - low[c], cell);
    }
    const double distance = std::pow(volume / static_cast<double>(nodes.size()), 1.0 / Dimension);
    frame.Scale = 1 / (shape > 0 ? shape : AutoShape * distance);
    frame.Length = extent * frame.Scale;
  }
  if (!std::isfinite(extent) || !std::isfinite(frame.Scale) || !std::isfinite(frame.Length) ||
    !(frame.Length > 0))
  {
    throw std::invalid_argument("the extent of the nodes or of their values is out of range");
  }
  return frame;
}

//------------------------------------------------------------------------------
template <int Dimension>
void CheckSpread(const std::vector<std::array<double, Dimension>>& scaled,
  const RadialPolynomial<Dimension>& polynomial)
{
  // Gram-Schmidt with pivoting on the monomials other than 1: the farthest node from the first, the
  // farthest from their line, ...
  constexpr int maximum = RadialPolynomial<Dimension>::MaximumCount;
  using Row = std::array<double, maximum>;
  const int count = polynomial.GetCount();
  const auto dot = [](const Row& a, const Row& b)
  { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  std::vector<Row> rest(scaled.size(), Row{});
  Row first{};
  polynomial.Evaluate(scaled[0], first.data());
  for (std::size_t i = 0; i < scaled.size(); ++i)
  {
    polynomial.Evaluate(scaled[i], rest[i].data());
    for (int k = 0; k < count; ++k)
    {
      rest[i][k] -= first[k];
    }
  }
  for (int step = 1; step < count; ++step)
  {
    const auto farthest = std::max_element(
      rest.begin(), rest.end(), [&](const Row& a, const Row& b) { return dot(a, a) < dot(b, b); });
    const double distance = std::sqrt(dot(*farthest, *farthest));
    if (distance <= FlatnessLimit)
    {
      if (polynomial.Degree == 2)
      {
        throw std::invalid_argument(Dimension == 2
            ? "all nodes lie on one line or conic: the quadratic part of the function is not "
              "determined"
            : "all nodes lie in one plane or quadric: the quadratic part of the function is not "
              "determined");
      }
      throw std::invalid_argument(Dimension == 2
          ? "all nodes lie on one line: a surface through them is not determined"
          : "all nodes lie in one plane: a function through them is not determined");
    }
    Row axis = *farthest;
    for (double& a : axis)
    {
      a /= distance;
    }
    for (Row& r : rest)
    {
      const double along = dot(r, axis);
      for (int k = 0; k < count; ++k)
      {
        r[k] -= along * axis[k];
      }
    }
  }
}

template struct AveragedNodes<2>;
template struct AveragedNodes<3>;
template std::vector<std::size_t> FindDistinctNodes<2>(
  const std::vector<std::array<double, 2>>&, const std::vector<std::vector<double>>&, std::size_t);
template std::vector<std::size_t> FindDistinctNodes<3>(
  const std::vector<std::array<double, 3>>&, const std::vector<std::vector<double>>&, std::size_t);
template RadialFrame<2> FindRadialFrame<2>(
  const std::vector<std::array<double, 2>>&, RadialKernel, double);
template RadialFrame<3> FindRadialFrame<3>(
  const std::vector<std::array<double, 3>>&, RadialKernel, double);
template void CheckSpread<2>(const std::vector<std::array<double, 2>>&, const RadialPolynomial<2>&);
template void CheckSpread<3>(const std::vector<std::array<double, 3>>&, const RadialPolynomial<3>&);
}
