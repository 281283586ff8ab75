// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialControl.h"

#include "lacunaExecution.h"
#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
// Of the accuracy that is asked of the nodes: what the column of one control point may use up.
constexpr double ColumnShare = 0.1;
constexpr int MaximumTrials = 4;
constexpr double ConditionLimit = 1e12;
// Of phi over the extent of the nodes: a weight that moves the surface by less has no grip on it.
constexpr double SmallestPower = 1e-13;
constexpr const char* Contradiction =
  "control points lie too close together or too close to nodes with other values";

// Of the first list's length; the second may go on.
double Dot(const std::vector<double>& a, const std::vector<double>& b)
{
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
}

//------------------------------------------------------------------------------
template <int Dimension>
RadialControl<Dimension>::RadialControl(
  const RadialSystem<Dimension>& system, RadialEquations<Dimension>& equations, double accuracy)
  : System(system)
  , Equations(equations)
  , Accuracy(accuracy)
  , Loops(GetRadialLoops<Dimension>(system.Kernel, BestInstructionSet()))
  , Anchors(system.Nodes, system.Polynomial)
{
}

template <int Dimension>
double RadialControl<Dimension>::GetPhi(const Point& a, const Point& b) const
{
  return GetRadialValue<Dimension>(this->Loops, a, b);
}

template <int Dimension>
typename RadialControl<Dimension>::Unknown RadialControl<Dimension>::MakeControlPoint(
  const Point& place) const
{
  Unknown unknown{ place, None, {} };
  this->Anchors.GetLagrange(place, unknown.Lagrange.data());
  return unknown;
}

//------------------------------------------------------------------------------
// The weight of a control point at c comes with -L_k(c) at the anchors, so that all right-hand sides
// satisfy the side conditions.
template <int Dimension>
double RadialControl<Dimension>::GetCorner(const Unknown& a, const Unknown& b) const
{
  const std::vector<std::size_t>& anchors = this->Anchors.GetNodes();
  if (a.Node != None || b.Node != None)
  {
    const Unknown& node = a.Node != None ? a : b;
    const Unknown& other = a.Node != None ? b : a;
    const auto anchor = std::find(anchors.begin(), anchors.end(), node.Node);
    return other.Node == None && anchor != anchors.end() ? -other.Lagrange[anchor - anchors.begin()]
                                                         : 0;
  }
  double corner = this->GetPhi(a.Place, b.Place);
  for (std::size_t k = 0; k < anchors.size(); ++k)
  {
    const Point& anchor = this->System.Nodes[anchors[k]];
    corner -= a.Lagrange[k] * this->GetPhi(anchor, b.Place);
    corner -= b.Lagrange[k] * this->GetPhi(anchor, a.Place);
    for (std::size_t l = 0; l < anchors.size(); ++l)
    {
      corner += a.Lagrange[k] * b.Lagrange[l] *
        (this->GetPhi(anchor, this->System.Nodes[anchors[l]]) +
          (k == l ? this->System.Diagonal[anchors[k]] : 0));
    }
  }
  return corner;
}

template <int Dimension>
typename RadialControl<Dimension>::Column RadialControl<Dimension>::MakeColumn(
  Execution& execution, const Unknown& unknown) const
{
  const std::size_t n = this->System.GetSize();
  Column column;
  column.Border.assign(n, 0.0);
  if (unknown.Node != None)
  {
    column.Border[unknown.Node] = 1;
  }
  else
  {
    const Coordinates<Dimension> nodes = this->System.GetCoordinates();
    this->Loops.Column(nodes, n, unknown.Place.data(), column.Border.data());
    std::vector<double> phi(n);
    for (std::size_t k = 0; k < this->Anchors.GetNodes().size(); ++k)
    {
      const std::size_t anchor = this->Anchors.GetNodes()[k];
      this->Loops.Column(nodes, n, this->System.Nodes[anchor].data(), phi.data());
      phi[anchor] += this->System.Diagonal[anchor];
      for (std::size_t i = 0; i < n; ++i)
      {
        column.Border[i] -= unknown.Lagrange[k] * phi[i];
      }
    }
  }
  // A weight that moves the surface by 1 at the point is 1 / S; so much may its column be wrong.
  double scale = 0;
  for (const double b : column.Border)
  {
    scale = std::max(scale, std::abs(b));
  }
  double tolerance = ColumnShare * this->Accuracy * std::max(scale, 1e-300);
  for (int trial = 0; trial < MaximumTrials; ++trial)
  {
    RadialSolution found;
    column.Solution = this->Equations.Solve(execution, column.Border, tolerance, found);
    column.Residual = found.Residual;
    double power = 1; // how much the surface moves per unit of weight
    if (unknown.Node == None)
    {
      power = std::abs(this->GetCorner(unknown, unknown) - Dot(column.Border, column.Solution));
    }
    if (found.Iterations == 0 || tolerance <= 2 * ColumnShare * this->Accuracy * power)
    {
      break;
    }
    tolerance = ColumnShare * this->Accuracy * std::max(power, 1e-6 * scale);
  }
  return column;
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialControl<Dimension>::Place(
  Execution& execution, const std::vector<Point>& points, const std::vector<std::size_t>& released)
{
  const Execution::NestedStages stages(execution);
  std::vector<Unknown> unknowns;
  for (const Point& point : points)
  {
    unknowns.push_back(this->MakeControlPoint(point));
  }
  for (const std::size_t node : released)
  {
    unknowns.push_back({ this->System.Nodes[node], node, {} });
  }
  std::map<std::pair<Point, std::size_t>, Column> kept;
  for (std::size_t j = 0; j < this->Unknowns.size(); ++j)
  {
    kept[{ this->Unknowns[j].Place, this->Unknowns[j].Node }] = std::move(this->Columns[j]);
  }
  this->Unknowns.clear(); // so that nothing half made is left when the user stops
  this->Columns.clear();
  const std::size_t m = unknowns.size();
  std::vector<Column> columns;
  for (std::size_t j = 0; j < m; ++j)
  {
    const double all = static_cast<double>(m);
    execution.SetStage(static_cast<double>(j) / all, static_cast<double>(j + 1) / all);
    const auto found = kept.find({ unknowns[j].Place, unknowns[j].Node });
    columns.push_back(
      found != kept.end() ? std::move(found->second) : this->MakeColumn(execution, unknowns[j]));
  }
  this->Complement.assign(m * m, 0.0);
  for (std::size_t j = 0; j < m; ++j)
  {
    for (std::size_t i = j; i < m; ++i)
    {
      this->Complement[i + m * j] =
        this->GetCorner(unknowns[i], unknowns[j]) - Dot(columns[i].Border, columns[j].Solution);
      this->Complement[j + m * i] = this->Complement[i + m * j];
    }
  }
  this->Unknowns = std::move(unknowns);
  this->Columns = std::move(columns);
}

//------------------------------------------------------------------------------
template <int Dimension>
std::vector<double> RadialControl<Dimension>::Equilibrate() const
{
  // Weights and releases have different units; a point at a released node has no diagonal of its own.
  const std::size_t m = this->Unknowns.size();
  const std::vector<std::size_t>& anchors = this->Anchors.GetNodes();
  const double unit =
    std::abs(this->GetPhi(this->System.Nodes[anchors[0]], this->System.Nodes[anchors[1]]));
  std::vector<double> scale(m, 1.0);
  for (int pass = 0; pass < 4; ++pass)
  {
    std::vector<double> largest(m, 0.0);
    for (std::size_t j = 0; j < m; ++j)
    {
      for (std::size_t i = 0; i < m; ++i)
      {
        largest[i] =
          std::max(largest[i], scale[i] * std::abs(this->Complement[i + m * j]) * scale[j]);
      }
    }
    for (std::size_t i = 0; i < m; ++i)
    {
      if (pass == 0 && this->Unknowns[i].Node == None &&
        !(largest[i] > SmallestPower *
            std::max(unit, std::abs(this->GetCorner(this->Unknowns[i], this->Unknowns[i])))))
      {
        throw std::runtime_error(Contradiction);
      }
      scale[i] /= std::sqrt(largest[i]);
    }
  }
  return scale;
}

template <int Dimension>
void RadialControl<Dimension>::AddWeights(
  const std::vector<double>& weights, Result& result, std::vector<double>& atControl) const
{
  const std::vector<std::size_t>& anchors = this->Anchors.GetNodes();
  for (std::size_t j = 0; j < weights.size(); ++j)
  {
    const std::vector<double>& w = this->Columns[j].Solution;
    for (std::size_t i = 0; i < w.size(); ++i)
    {
      result.Coefficients[i] -= weights[j] * w[i];
    }
    atControl[j] += weights[j];
    for (std::size_t k = 0; this->Unknowns[j].Node == None && k < anchors.size(); ++k)
    {
      result.Coefficients[anchors[k]] -= weights[j] * this->Unknowns[j].Lagrange[k];
    }
  }
}

template <int Dimension>
std::vector<double> RadialControl<Dimension>::GetMisses(const std::vector<double>& atPoints,
  const std::vector<double>& coefficients, const std::vector<double>& atControl) const
{
  const std::size_t n = this->System.GetSize();
  const auto monomials = static_cast<std::size_t>(this->System.Polynomial.GetCount());
  std::vector<double> misses;
  std::vector<double> phi(n);
  double basis[RadialPolynomial<Dimension>::MaximumCount];
  for (std::size_t j = 0; j < this->Unknowns.size(); ++j)
  {
    const Unknown& unknown = this->Unknowns[j];
    if (unknown.Node != None)
    {
      misses.push_back(-coefficients[unknown.Node]);
      continue;
    }
    this->Loops.Column(this->System.GetCoordinates(), n, unknown.Place.data(), phi.data());
    double value = Dot(phi, coefficients);
    this->System.Polynomial.Evaluate(unknown.Place, basis);
    for (std::size_t k = 0; k < monomials; ++k)
    {
      value += coefficients[n + k] * basis[k];
    }
    for (std::size_t l = 0; l < this->Unknowns.size(); ++l)
    {
      value += this->Unknowns[l].Node == None
        ? atControl[l] * this->GetPhi(unknown.Place, this->Unknowns[l].Place)
        : 0;
    }
    misses.push_back(atPoints[j] - value);
  }
  return misses;
}

template <int Dimension>
typename RadialControl<Dimension>::Result RadialControl<Dimension>::Solve(
  const std::vector<double>& atPoints, const std::vector<double>& solution) const
{
  const std::size_t m = this->Unknowns.size();
  const std::vector<double> scale = this->Equilibrate();
  SquareMatrix matrix(m);
  for (std::size_t j = 0; j < m; ++j)
  {
    for (std::size_t i = j; i < m; ++i)
    {
      matrix.Column(j)[i] = scale[i] * this->Complement[i + m * j] * scale[j];
    }
  }
  const SymmetricFactorization factorization(std::move(matrix));
  if (!(factorization.GetConditionEstimate() < ConditionLimit))
  {
    throw std::runtime_error(Contradiction);
  }
  Result result;
  result.Coefficients = solution;
  std::vector<double> atControl(m, 0.0);
  std::vector<double> misses = this->GetMisses(atPoints, result.Coefficients, atControl);
  // A fast solution has errors within its accuracy; with a second pass the points are met beyond it.
  for (int pass = 0; pass < 2; ++pass)
  {
    for (std::size_t j = 0; j < m; ++j)
    {
      misses[j] *= scale[j];
    }
    factorization.Solve(misses);
    for (std::size_t j = 0; j < m; ++j)
    {
      misses[j] *= scale[j];
    }
    this->AddWeights(misses, result, atControl);
    misses = this->GetMisses(atPoints, result.Coefficients, atControl);
  }
  double worst = 0;
  std::vector<double> inserted;
  for (std::size_t j = 0; j < m; ++j)
  {
    result.Residual += std::abs(atControl[j]) * this->Columns[j].Residual;
    if (this->Unknowns[j].Node == None)
    {
      inserted.push_back(atControl[j]);
      worst = std::max(worst, std::abs(misses[j]));
    }
    else
    {
      result.Coefficients[this->Unknowns[j].Node] = 0; // up to round-off it is already
    }
  }
  result.Residual = std::max(result.Residual, worst);
  result.Coefficients.insert(
    result.Coefficients.begin() + static_cast<std::ptrdiff_t>(this->System.GetSize()),
    inserted.begin(), inserted.end());
  return result;
}

template class RadialControl<2>;
template class RadialControl<3>;
}
