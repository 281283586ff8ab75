// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialBasis.h"

#include "lacunaExecution.h"
#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
// Relative to the values: what one asks of a backward stable solve. Carr 1996, section 6.4 reports
// 2e-13.
constexpr double ResidualWanted = 1e-13;
// Relative to the extent of the nodes: flatter than this is a line (plane).
constexpr double FlatnessLimit = 1e-9;
// Above this no digit of the coefficients can be trusted.
constexpr double ConditionLimit = 4503599627370496.0; // 2^52

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

double MaximumNorm(const double* values, std::size_t count)
{
  double norm = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    norm = std::max(norm, std::abs(values[i]));
  }
  return norm;
}

template <int Dimension>
void CheckInput(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<double>& values, const RadialBasisOptions& options)
{
  if (nodes.size() != values.size())
  {
    throw std::invalid_argument("there must be one value for each node");
  }
  if (!(options.Smoothing >= 0) || !std::isfinite(options.Smoothing))
  {
    throw std::invalid_argument("smoothing must be a finite number >= 0");
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    bool finite = std::isfinite(values[i]);
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

// Indices of the nodes without those that repeat an earlier one, in their order.
template <int Dimension>
std::vector<std::size_t> FindDistinct(
  const std::vector<std::array<double, Dimension>>& nodes, const std::vector<double>& values)
{
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
      if (values[first] != values[i])
      {
        std::ostringstream message;
        message << "nodes " << first << " and " << i << " lie at the same place "
                << ToText<Dimension>(nodes[i]) << " but have different values " << values[first]
                << " and " << values[i];
        throw std::invalid_argument(message.str());
      }
      continue;
    }
    distinct.push_back(i);
  }
  std::sort(distinct.begin(), distinct.end());
  return distinct;
}
}

//------------------------------------------------------------------------------
template <int Dimension>
RadialBasis<Dimension>::RadialBasis(Execution& execution, const std::vector<Point>& nodes,
  const std::vector<double>& values, const RadialBasisOptions& options)
  : Kernel(options.Kernel)
  , Loops(GetRadialLoops<Dimension>(options.Kernel, BestInstructionSet()))
{
  CheckInput<Dimension>(nodes, values, options);
  this->SetNodes(nodes, values);
  this->CheckSpread();
  const std::uint64_t bytes = SquareMatrix::GetBytes(this->Values.size() + Dimension + 1);
  if (bytes > options.MaximumBytes)
  {
    std::ostringstream message;
    message << this->Values.size() << " nodes need a matrix of " << bytes
            << " bytes, more than the limit of " << options.MaximumBytes << " bytes";
    throw std::length_error(message.str());
  }
  // E = C Scale^Power sum a_i a_j phi, so minimising puts this on the diagonal.
  const double diagonal = options.Smoothing * GetRadialEnergyFactor(this->Kernel) *
    std::pow(this->Scale, GetRadialPower(this->Kernel));
  this->Solve(execution, diagonal);
  this->ConvertPolynomial();
  this->ComputeEnergy();
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::SetNodes(
  const std::vector<Point>& nodes, const std::vector<double>& values)
{
  const std::vector<std::size_t> distinct = FindDistinct<Dimension>(nodes, values);
  if (distinct.size() <= Dimension)
  {
    throw std::invalid_argument("there are " + std::to_string(distinct.size()) +
      " nodes at different places; at least " + std::to_string(Dimension + 1) + " are needed");
  }
  Point low = nodes[distinct[0]];
  Point high = low;
  for (const std::size_t i : distinct)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      low[c] = std::min(low[c], nodes[i][c]);
      high[c] = std::max(high[c], nodes[i][c]);
    }
    this->Mean += values[i] / static_cast<double>(distinct.size());
  }
  double extent = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    extent = std::max(extent, high[c] - low[c]);
  }
  this->Origin = low;
  this->Scale = 1 / extent;
  if (!std::isfinite(extent) || !std::isfinite(this->Scale) || !std::isfinite(this->Mean))
  {
    throw std::invalid_argument("the extent of the nodes or of their values is out of range");
  }
  for (const std::size_t i : distinct)
  {
    const Point u = this->ToScaled(nodes[i]);
    for (int c = 0; c < Dimension; ++c)
    {
      this->Nodes[c].push_back(u[c]);
    }
    this->Values.push_back(values[i] - this->Mean);
  }
  this->Report.NodeCount = distinct.size();
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::CheckSpread() const
{
  // Gram-Schmidt with pivoting: the farthest node from the first, the farthest from their line, ...
  const std::size_t n = this->Values.size();
  std::vector<Point> rest(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      rest[i][c] = this->Nodes[c][i] - this->Nodes[c][0];
    }
  }
  const auto dot = [](const Point& a, const Point& b)
  { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  for (int step = 0; step < Dimension; ++step)
  {
    const auto farthest = std::max_element(rest.begin(), rest.end(),
      [&](const Point& a, const Point& b) { return dot(a, a) < dot(b, b); });
    const double distance = std::sqrt(dot(*farthest, *farthest));
    if (distance <= FlatnessLimit)
    {
      throw std::invalid_argument(Dimension == 2
          ? "all nodes lie on one line: a surface through them is not determined"
          : "all nodes lie in one plane: a function through them is not determined");
    }
    Point axis = *farthest;
    for (double& a : axis)
    {
      a /= distance;
    }
    for (Point& r : rest)
    {
      const double along = dot(r, axis);
      for (int c = 0; c < Dimension; ++c)
      {
        r[c] -= along * axis[c];
      }
    }
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::Solve(Execution& execution, double diagonal)
{
  // ( A + diagonal I   Q ) (a)   (f)
  // ( Q^T              0 ) (c) = (0),  lower triangle only
  const std::size_t n = this->Values.size();
  SquareMatrix matrix(n + Dimension + 1);
  const Coordinates<Dimension> nodes = this->GetNodes();
  execution.For(static_cast<std::int64_t>(n), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        double* column = matrix.Column(j);
        Coordinates<Dimension> below;
        double center[Dimension];
        for (int c = 0; c < Dimension; ++c)
        {
          below.Axis[c] = nodes.Axis[c] + j;
          center[c] = nodes.Axis[c][j];
          column[n + 1 + c] = center[c];
        }
        this->Loops.Column(below, n - j, center, column + j);
        column[j] += diagonal;
        column[n] = 1;
      }
    });
  for (std::size_t j = n; j < n + Dimension + 1; ++j)
  {
    std::fill(matrix.Column(j) + j, matrix.Column(j) + n + Dimension + 1, 0.0);
  }

  try
  {
    const SymmetricFactorization factorization(std::move(matrix));
    execution.Report(1);
    this->Report.ConditionEstimate = factorization.GetConditionEstimate();
    if (!(this->Report.ConditionEstimate < ConditionLimit))
    {
      throw std::runtime_error(
        "its condition number is " + std::to_string(this->Report.ConditionEstimate));
    }
    this->Coefficients.assign(n + Dimension + 1, 0.0);
    std::copy(this->Values.begin(), this->Values.end(), this->Coefficients.begin());
    factorization.Solve(this->Coefficients);
    std::vector<double> residual = this->GetResidual(diagonal);
    this->Report.Residual = MaximumNorm(residual.data(), n);
    if (this->Report.Residual > ResidualWanted * MaximumNorm(this->Values.data(), n))
    {
      const std::vector<double> first = this->Coefficients;
      factorization.Solve(residual);
      for (std::size_t i = 0; i < residual.size(); ++i)
      {
        this->Coefficients[i] += residual[i];
      }
      const std::vector<double> refined = this->GetResidual(diagonal);
      const double norm = MaximumNorm(refined.data(), n);
      this->Report.Refined = norm < this->Report.Residual;
      this->Coefficients = this->Report.Refined ? this->Coefficients : first;
      this->Report.Residual = std::min(norm, this->Report.Residual);
    }
  }
  catch (const Aborted&)
  {
    throw;
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(std::string("the interpolation equations cannot be solved: ") +
      e.what() + "; nodes lie too close together for their extent, use fewer or add smoothing");
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
std::vector<double> RadialBasis<Dimension>::GetResidual(double diagonal) const
{
  const std::size_t n = this->Values.size();
  std::vector<double> residual(n + Dimension + 1, 0.0);
  const Coordinates<Dimension> nodes = this->GetNodes();
  const double* c = this->Coefficients.data() + n;
  alignas(64) double block[Dimension][RadialBlock] = {};
  alignas(64) double sums[RadialBlock];
  for (std::size_t i = 0; i < n; i += RadialBlock)
  {
    const std::size_t count = std::min(RadialBlock, n - i);
    Coordinates<Dimension> points;
    for (int k = 0; k < Dimension; ++k)
    {
      std::copy_n(nodes.Axis[k] + i, count, block[k]);
      points.Axis[k] = block[k];
    }
    this->Loops.Sum(nodes, this->Coefficients.data(), n, points, sums);
    for (std::size_t p = 0; p < count; ++p)
    {
      const double a = this->Coefficients[i + p];
      double polynomial = c[0];
      residual[n] -= a;
      for (int k = 0; k < Dimension; ++k)
      {
        polynomial += c[1 + k] * block[k][p];
        residual[n + 1 + k] -= a * block[k][p];
      }
      residual[i + p] = this->Values[i + p] - (sums[p] + polynomial + diagonal * a);
    }
  }
  return residual;
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::ConvertPolynomial()
{
  const std::size_t n = this->Values.size();
  const double* c = this->Coefficients.data() + n;
  this->Polynomial[0] = this->Mean + c[0];
  for (int k = 0; k < Dimension; ++k)
  {
    this->Polynomial[1 + k] = c[1 + k] * this->Scale;
    this->Polynomial[0] -= this->Polynomial[1 + k] * this->Origin[k];
  }
  if (this->Kernel == RadialKernel::ThinPlate)
  {
    // u^2 log u = Scale^2 (r^2 log r + r^2 log Scale), and by the side conditions the last term
    // adds up to a constant.
    double moment = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      for (int k = 0; k < Dimension; ++k)
      {
        moment += this->Coefficients[i] * this->Nodes[k][i] * this->Nodes[k][i];
      }
    }
    this->Polynomial[0] += std::log(this->Scale) * moment;
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::ComputeEnergy()
{
  // sum_j a_j phi(x_i - x_j) = s(x_i) - p(x_i), and p falls out by the side conditions
  const std::vector<double> residual = this->GetResidual(0);
  double energy = 0;
  for (std::size_t i = 0; i < this->Values.size(); ++i)
  {
    energy += this->Coefficients[i] * (this->Values[i] - residual[i]);
  }
  this->Report.Energy = std::max(0.0,
    energy * GetRadialEnergyFactor(this->Kernel) *
      std::pow(this->Scale, GetRadialPower(this->Kernel)));
}

//------------------------------------------------------------------------------
template <int Dimension>
Coordinates<Dimension> RadialBasis<Dimension>::GetNodes() const
{
  Coordinates<Dimension> nodes;
  for (int c = 0; c < Dimension; ++c)
  {
    nodes.Axis[c] = this->Nodes[c].data();
  }
  return nodes;
}

//------------------------------------------------------------------------------
template <int Dimension>
typename RadialBasis<Dimension>::Point RadialBasis<Dimension>::ToScaled(const Point& point) const
{
  Point u;
  for (int c = 0; c < Dimension; ++c)
  {
    u[c] = (point[c] - this->Origin[c]) * this->Scale;
  }
  return u;
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::SetInstructionSet(InstructionSet set)
{
  this->Loops = GetRadialLoops<Dimension>(this->Kernel, set);
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::EvaluateBlock(
  const Point* points, std::size_t count, double* values, Point* gradients) const
{
  const std::size_t n = this->Values.size();
  alignas(64) double block[Dimension][RadialBlock] = {};
  alignas(64) double sums[RadialBlock];
  alignas(64) double slopes[Dimension][RadialBlock];
  Coordinates<Dimension> at;
  for (int k = 0; k < Dimension; ++k)
  {
    at.Axis[k] = block[k];
  }
  for (std::size_t p = 0; p < count; ++p)
  {
    const Point u = this->ToScaled(points[p]);
    for (int k = 0; k < Dimension; ++k)
    {
      block[k][p] = u[k];
    }
  }
  if (gradients)
  {
    this->Loops.SumAndGradient(this->GetNodes(), this->Coefficients.data(), n, at, sums, slopes[0]);
  }
  else
  {
    this->Loops.Sum(this->GetNodes(), this->Coefficients.data(), n, at, sums);
  }
  const double* c = this->Coefficients.data() + n;
  for (std::size_t p = 0; p < count; ++p)
  {
    double polynomial = c[0];
    for (int k = 0; k < Dimension; ++k)
    {
      polynomial += c[1 + k] * block[k][p];
      if (gradients)
      {
        gradients[p][k] = this->Scale * (slopes[k][p] + c[1 + k]);
      }
    }
    values[p] = sums[p] + polynomial + this->Mean;
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::EvaluateBlocks(
  Execution& execution, const std::vector<Point>& points, double* values, Point* gradients) const
{
  constexpr auto size = static_cast<std::int64_t>(RadialBlock);
  const auto count = static_cast<std::int64_t>(points.size());
  execution.For((count + size - 1) / size, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin * size; i < std::min(end * size, count); i += size)
      {
        this->EvaluateBlock(points.data() + i, std::min(size, count - i), values + i,
          gradients ? gradients + i : nullptr);
      }
    });
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::Evaluate(
  Execution& execution, const std::vector<Point>& points, std::vector<double>& values) const
{
  values.resize(points.size());
  this->EvaluateBlocks(execution, points, values.data(), nullptr);
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::Evaluate(Execution& execution, const std::vector<Point>& points,
  std::vector<double>& values, std::vector<Point>& gradients) const
{
  values.resize(points.size());
  gradients.resize(points.size());
  this->EvaluateBlocks(execution, points, values.data(), gradients.data());
}

template class RadialBasis<2>;
template class RadialBasis<3>;
}
