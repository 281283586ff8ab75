// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialBasis.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// Relative to the extent of the nodes: flatter than this is a line (plane).
constexpr double FlatnessLimit = 1e-9;
// In mean distances of neighbours: smooth between nodes, and the equations are still well-conditioned.

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
    frame.Scale = 1 / (shape > 0 ? shape : GetRadialLength(kernel) * distance);
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

//------------------------------------------------------------------------------
void RadialBasisOptions::Describe(Properties& properties) const
{
  properties.Add("Kernel", static_cast<int>(this->Kernel), RadialKernelNames)
    .Add("KernelLength", this->Shape, ValueRange::AtLeast(0))
    .Add("Smoothing", this->Smoothing, ValueRange::AtLeast(0))
    .Add("Accuracy", this->Accuracy, ValueRange::Between(0, 1))
    .Add("Solver", static_cast<int>(this->Solver), RadialSolverNames);
}

//------------------------------------------------------------------------------
namespace
{
void CheckOptions(const RadialBasisOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  if (options.Accuracy == 1)
  {
    throw std::invalid_argument("Accuracy is 1; it must be less");
  }
  if (options.Solver == RadialSolver::Fast && options.Accuracy == 0)
  {
    throw std::invalid_argument("a fast solution needs an accuracy above 0");
  }
}
}

//------------------------------------------------------------------------------
template <int Dimension>
RadialBasis<Dimension>::RadialBasis(Execution& execution, const std::vector<Point>& nodes,
  const std::vector<double>& values, const RadialBasisOptions& options)
  : RadialBasis(execution, nodes, std::vector<std::vector<double>>{ values }, options)
{
}

template <int Dimension>
RadialBasis<Dimension>::RadialBasis(Execution& execution, const std::vector<Point>& nodes,
  const std::vector<std::vector<double>>& values, const RadialBasisOptions& options)
  : Options(options)
  , Loops(GetRadialLoops<Dimension>(options.Kernel, BestInstructionSet()))
{
  CheckOptions(options);
  const std::vector<double>& errors = options.Errors;
  const bool isSound = std::all_of(
    errors.begin(), errors.end(), [](double error) { return error > 0 && std::isfinite(error); });
  if (options.Smoothing > 0 && isSound && (errors.empty() || errors.size() == nodes.size()))
  {
    const AveragedNodes<Dimension> averaged(nodes, values, errors);
    this->Options.Errors = averaged.Errors;
    this->SetNodes(averaged.Nodes, averaged.Values);
  }
  else
  {
    this->SetNodes(nodes, values);
  }
  const double range = *std::min_element(this->Ranges.begin(), this->Ranges.end(),
    [](double a, double b) { return b == 0 || (a != 0 && a < b); });
  const bool fast = options.Accuracy > 0 &&
    (options.Solver == RadialSolver::Fast ||
      (options.Solver == RadialSolver::Auto &&
        this->System->GetSize() > RadialBasisOptions::AutoDirectNodes));
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, fast ? 0.3 : 1);
  std::shared_ptr<RadialEquations<Dimension>> equations = fast
    ? PrepareIteratively(execution, *this->System)
    : PrepareDirectly(execution, *this->System, options.MaximumBytes);
  RadialSolution found;
  const auto count = static_cast<double>(this->System->Values.size());
  for (const std::vector<double>& list : this->System->Values)
  {
    const auto done = static_cast<double>(this->Coefficients.size());
    execution.SetStage(
      fast ? 0.3 + 0.7 * done / count : 1, fast ? 0.3 + 0.7 * (done + 1) / count : 1);
    // All values equal: the constant polynomial it is, exactly.
    this->Coefficients.push_back(
      equations->Solve(execution, list, range > 0 ? options.Accuracy * range : 1.0, found));
  }
  this->Report.Residual = found.Residual;
  this->Report.Refined = found.Refined;
  this->Report.ConditionEstimate = found.ConditionEstimate;
  this->Report.Iterations = found.Iterations;
  this->ComputeEnergy();
  if (options.Controllable)
  {
    this->Control =
      std::make_shared<RadialControl<Dimension>>(*this->System, *equations, options.Accuracy);
    this->Equations = std::move(equations);
    this->BaseCoefficients = this->Coefficients;
    this->BaseReport = this->Report;
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::SetNodes(
  const std::vector<Point>& nodes, const std::vector<std::vector<double>>& values)
{
  this->System = std::make_shared<RadialSystem<Dimension>>();
  this->Centers = this->System;
  RadialSystem<Dimension>& system = *this->System;
  system.Kernel = this->Options.Kernel;
  system.Words = this->Options.Words;
  system.Polynomial.Degree = GetRadialDegree(system.Kernel);
  const std::vector<std::size_t> distinct =
    FindDistinctNodes<Dimension>(nodes, values, system.Polynomial.GetCount());
  std::vector<Point> own;
  own.reserve(distinct.size());
  for (const std::size_t i : distinct)
  {
    own.push_back(nodes[i]);
  }
  this->Frame = FindRadialFrame<Dimension>(own, system.Kernel, this->Options.Shape);
  system.Polynomial.Length = this->Frame.Length;
  for (const Point& node : own)
  {
    system.Nodes.push_back(this->Frame.ToScaled(node));
    for (int c = 0; c < Dimension; ++c)
    {
      system.Axis[c].push_back(system.Nodes.back()[c]);
    }
  }
  CheckSpread<Dimension>(system.Nodes, system.Polynomial);
  for (const std::vector<double>& list : values)
  {
    double mean = 0;
    double low = list[distinct[0]];
    double high = low;
    for (const std::size_t i : distinct)
    {
      mean += list[i] / static_cast<double>(distinct.size());
      low = std::min(low, list[i]);
      high = std::max(high, list[i]);
    }
    if (!std::isfinite(mean) || !std::isfinite(high - low))
    {
      throw std::invalid_argument("the extent of the nodes or of their values is out of range");
    }
    this->Means.push_back(mean);
    this->Ranges.push_back(high - low);
    system.Values.emplace_back();
    for (const std::size_t i : distinct)
    {
      system.Values.back().push_back(list[i] - mean);
    }
  }
  this->SetDiagonal(distinct);
  this->Report.NodeCount = distinct.size();
}

template <int Dimension>
void RadialBasis<Dimension>::SetDiagonal(const std::vector<std::size_t>& distinct)
{
  // E = C Scale^Power sum a_i a_j phi, so minimising puts this on the diagonal.
  const double diagonal = this->Options.Smoothing * GetRadialEnergyFactor(this->Options.Kernel) *
    std::pow(this->Frame.Scale, GetRadialPower(this->Options.Kernel));
  for (const std::size_t i : distinct)
  {
    double error = 1;
    if (!this->Options.Errors.empty())
    {
      error = i < this->Options.Errors.size() ? this->Options.Errors[i] : 0;
      if (!(error > 0) || !std::isfinite(error))
      {
        throw std::invalid_argument(
          "there must be an error, a finite number above 0, for each node; node " +
          std::to_string(i) + " has none");
      }
    }
    this->System->Diagonal.push_back(diagonal * error * error);
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::ComputeEnergy()
{
  // sum_j a_j phi(x_i - x_j) = s(x_i) - p(x_i), s(x_i) = f_i - diagonal a_i, and p falls out by the
  // side conditions
  const RadialSystem<Dimension>& centers = this->GetCenters();
  double energy = 0;
  for (std::size_t k = 0; k < this->Coefficients.size(); ++k)
  {
    for (std::size_t i = 0; i < centers.GetSize(); ++i)
    {
      const double a = this->Coefficients[k][i];
      energy += a * (centers.Values[k][i] - centers.Diagonal[i] * a);
    }
  }
  this->Report.Energy = std::max(0.0,
    energy * GetRadialEnergyFactor(this->Options.Kernel) *
      std::pow(this->Frame.Scale, GetRadialPower(this->Options.Kernel)));
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::SetControlPoints(Execution& execution,
  const std::vector<Point>& points, const std::vector<std::vector<double>>& values,
  double clearance)
{
  if (!this->Control)
  {
    throw std::logic_error("the function was not made to be controllable");
  }
  const std::vector<std::size_t> distinct = FindDistinctNodes<Dimension>(points, values, 0);
  const RadialSystem<Dimension>& system = *this->System;
  std::vector<Point> scaled;
  for (const std::size_t i : distinct)
  {
    scaled.push_back(this->Frame.ToScaled(points[i]));
  }
  const double limit = std::pow(clearance * this->Frame.Scale, 2);
  std::vector<std::size_t> released;
  for (std::size_t i = 0; i < system.GetSize(); ++i)
  {
    const auto isNear = [&](const Point& p)
    {
      double squared = 0;
      for (int c = 0; c < Dimension; ++c)
      {
        squared += (p[c] - system.Nodes[i][c]) * (p[c] - system.Nodes[i][c]);
      }
      return squared < limit;
    };
    if (std::any_of(scaled.begin(), scaled.end(), isNear))
    {
      released.push_back(i);
    }
  }
  if (scaled.empty())
  {
    this->Centers = this->System;
    this->Coefficients = this->BaseCoefficients;
    this->Report = this->BaseReport;
    return;
  }
  this->Control->Place(execution, scaled, released);

  auto centers = std::make_shared<RadialSystem<Dimension>>(system);
  for (const Point& p : scaled)
  {
    centers->Nodes.push_back(p);
    centers->Diagonal.push_back(0);
    for (int c = 0; c < Dimension; ++c)
    {
      centers->Axis[c].push_back(p[c]);
    }
  }
  std::vector<std::vector<double>> coefficients;
  double residual = 0;
  for (std::size_t k = 0; k < this->BaseCoefficients.size(); ++k)
  {
    std::vector<double> atPoints;
    for (const std::size_t i : distinct)
    {
      atPoints.push_back(values[k][i] - this->Means[k]);
    }
    typename RadialControl<Dimension>::Result result =
      this->Control->Solve(atPoints, this->BaseCoefficients[k]);
    centers->Values[k].insert(centers->Values[k].end(), atPoints.begin(), atPoints.end());
    coefficients.push_back(std::move(result.Coefficients));
    residual = std::max(residual, result.Residual);
  }
  this->Centers = std::move(centers);
  this->Coefficients = std::move(coefficients);
  this->Report.NodeCount = system.GetSize() - released.size() + scaled.size();
  this->Report.Residual = this->BaseReport.Residual + residual;
  this->ComputeEnergy();
}

//------------------------------------------------------------------------------
template <int Dimension>
std::array<double, Dimension + 1> RadialBasis<Dimension>::GetPolynomial(int component) const
{
  const std::size_t n = this->GetCenters().GetSize();
  const std::vector<double>& coefficients = this->Coefficients[component];
  std::array<double, Dimension + 1> polynomial;
  polynomial[0] = this->Means[component] + coefficients[n];
  for (int k = 0; k < Dimension; ++k)
  {
    polynomial[1 + k] = coefficients[n + 1 + k] * this->Frame.Scale / this->Frame.Length;
    polynomial[0] -= polynomial[1 + k] * this->Frame.Origin[k];
  }
  if (this->Options.Kernel == RadialKernel::ThinPlate)
  {
    // u^2 log u = Scale^2 (r^2 log r + r^2 log Scale), and by the side conditions the last term
    // adds up to a constant.
    double moment = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      for (const double u : this->GetCenters().Nodes[i])
      {
        moment += coefficients[i] * u * u;
      }
    }
    polynomial[0] += std::log(this->Frame.Scale) * moment;
  }
  return polynomial;
}

template <int Dimension>
void RadialBasis<Dimension>::SetInstructionSet(InstructionSet set)
{
  this->Loops = GetRadialLoops<Dimension>(this->Options.Kernel, set);
}

template class RadialBasis<2>;
template class RadialBasis<3>;
}
