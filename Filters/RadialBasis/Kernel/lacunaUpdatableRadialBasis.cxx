// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaUpdatableRadialBasis.h"

#include "lacunaExecution.h"
#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

// Fortran interfaces; the last arguments are the lengths of the character arguments.
extern "C"
{
  void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
}

namespace lacuna
{
namespace
{
constexpr std::size_t None = static_cast<std::size_t>(-1);

[[noreturn]] void ThrowSingular()
{
  throw std::runtime_error("the interpolation equations cannot be solved: nodes lie too close "
                           "together for their extent, use fewer or add smoothing");
}
}

//------------------------------------------------------------------------------
template <int Dimension>
UpdatableRadialBasis<Dimension>::UpdatableRadialBasis(Execution& execution,
  const std::vector<Point>& nodes, const std::vector<double>& values,
  const RadialBasisOptions& options)
  : Options(options)
  , Loops(GetRadialLoops<Dimension>(options.Kernel, BestInstructionSet()))
{
  if (!(options.Smoothing >= 0) || !std::isfinite(options.Smoothing))
  {
    throw std::invalid_argument("smoothing must be a finite number >= 0");
  }
  this->Polynomial.Degree = GetRadialDegree(options.Kernel);
  const std::size_t distinct =
    FindDistinctNodes<Dimension>(nodes, { values }, this->Polynomial.GetCount()).size();
  if (distinct != nodes.size())
  {
    throw std::invalid_argument("two nodes lie at the same place");
  }
  this->Frame = FindRadialFrame<Dimension>(nodes, options.Kernel, options.Shape);
  this->Polynomial.Length = this->Frame.Length;
  this->Diagonal = options.Smoothing * GetRadialEnergyFactor(options.Kernel) *
    std::pow(this->Frame.Scale, GetRadialPower(options.Kernel));
  std::vector<Node> all;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    all.push_back({ i, this->Frame.ToScaled(nodes[i]), values[i], {}, {} });
  }
  this->NextNumber = nodes.size();
  this->Build(all);
  execution.Report(1);
}

template <int Dimension>
double UpdatableRadialBasis<Dimension>::GetPhi(const Point& a, const Point& b) const
{
  return GetRadialValue<Dimension>(this->Loops, a, b);
}

template <int Dimension>
typename UpdatableRadialBasis<Dimension>::Node UpdatableRadialBasis<Dimension>::MakeNode(
  std::size_t number, const Point& scaled, double value) const
{
  const std::size_t count = this->Anchors.size();
  Node node{ number, scaled, value, std::vector<double>(RadialPolynomial<Dimension>::MaximumCount),
    std::vector<double>(count) };
  this->Basis.GetLagrange(scaled, node.Lagrange.data());
  for (std::size_t k = 0; k < count; ++k)
  {
    node.ToAnchors[k] = this->GetPhi(scaled, this->Anchors[k].Scaled);
  }
  return node;
}

template <int Dimension>
double UpdatableRadialBasis<Dimension>::GetElement(const Node& a, const Node& b) const
{
  // phi with the parts taken away that the side conditions tie to the anchors
  const std::size_t count = this->Anchors.size();
  double element = this->GetPhi(a.Scaled, b.Scaled);
  for (std::size_t k = 0; k < count; ++k)
  {
    element -= a.Lagrange[k] * b.ToAnchors[k] + b.Lagrange[k] * a.ToAnchors[k];
    for (std::size_t l = 0; l < count; ++l)
    {
      element += a.Lagrange[k] * b.Lagrange[l] * this->AnchorMatrix[k + count * l];
    }
  }
  return a.Number == b.Number ? element + this->Diagonal : element;
}

//------------------------------------------------------------------------------
template <int Dimension>
void UpdatableRadialBasis<Dimension>::Build(const std::vector<Node>& nodes)
{
  const auto count = static_cast<std::size_t>(this->Polynomial.GetCount());
  std::vector<Point> places;
  places.reserve(nodes.size());
  for (const Node& node : nodes)
  {
    places.push_back(node.Scaled);
  }
  CheckSpread<Dimension>(places, this->Polynomial);
  PolynomialAnchors<Dimension> basis(places, this->Polynomial);
  std::vector<char> isAnchor(nodes.size(), 0);
  std::vector<Node> anchors;
  for (const std::size_t i : basis.GetNodes())
  {
    isAnchor[i] = 1;
    anchors.push_back(nodes[i]);
  }
  this->Anchors = std::move(anchors);
  this->Basis = std::move(basis);
  this->AnchorMatrix.assign(count * count, 0.0);
  for (std::size_t k = 0; k < count; ++k)
  {
    for (std::size_t l = 0; l < count; ++l)
    {
      this->AnchorMatrix[k + count * l] =
        this->GetPhi(this->Anchors[k].Scaled, this->Anchors[l].Scaled) +
        (k == l ? this->Diagonal : 0);
    }
  }
  this->Others.clear();
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    if (!isAnchor[i])
    {
      this->Others.push_back(this->MakeNode(nodes[i].Number, nodes[i].Scaled, nodes[i].Value));
    }
  }
  const std::size_t n = this->Others.size();
  std::vector<double> matrix(n * n);
  for (std::size_t j = 0; j < n; ++j)
  {
    for (std::size_t i = j; i < n; ++i)
    {
      matrix[i + n * j] = this->GetElement(this->Others[i], this->Others[j]);
    }
  }
  const SingleBlasThread single;
  const int order = static_cast<int>(n);
  int info = 0;
  if (n > 0)
  {
    dpotrf_("L", &order, matrix.data(), &order, &info, 1);
  }
  if (info != 0)
  {
    ThrowSingular();
  }
  this->Factor.assign(n, {});
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t j = 0; j <= i; ++j)
    {
      this->Factor[i].push_back(matrix[i + n * j]);
    }
  }
  this->Solved = false;
}

//------------------------------------------------------------------------------
template <int Dimension>
std::vector<typename UpdatableRadialBasis<Dimension>::Node>
UpdatableRadialBasis<Dimension>::GetNodes() const
{
  std::vector<Node> nodes = this->Anchors;
  nodes.insert(nodes.end(), this->Others.begin(), this->Others.end());
  return nodes;
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::CheckPlace(const Point& scaled, std::size_t except) const
{
  for (const std::vector<Node>* list : { &this->Anchors, &this->Others })
  {
    for (const Node& node : *list)
    {
      if (node.Number != except && node.Scaled == scaled)
      {
        throw std::invalid_argument(
          "node " + std::to_string(node.Number) + " lies at the same place already");
      }
    }
  }
}

template <int Dimension>
std::size_t UpdatableRadialBasis<Dimension>::Add(const Point& node, double value)
{
  FindDistinctNodes<Dimension>({ node }, { { value } }, 1); // finite?
  const Point scaled = this->Frame.ToScaled(node);
  this->CheckPlace(scaled, None);
  Node added = this->MakeNode(this->NextNumber, scaled, value);
  // the next row of the Cholesky factor
  const std::size_t n = this->Others.size();
  std::vector<double> row(n + 1);
  const double diagonal = this->GetElement(added, added);
  double left = diagonal;
  for (std::size_t i = 0; i < n; ++i)
  {
    double sum = this->GetElement(added, this->Others[i]);
    for (std::size_t j = 0; j < i; ++j)
    {
      sum -= this->Factor[i][j] * row[j];
    }
    row[i] = sum / this->Factor[i][i];
    left -= row[i] * row[i];
  }
  if (!(left > 1e-15 * diagonal))
  {
    ThrowSingular();
  }
  row[n] = std::sqrt(left);
  this->Factor.push_back(std::move(row));
  this->Others.push_back(std::move(added));
  this->Solved = false;
  return this->NextNumber++;
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::RemoveRow(std::size_t row)
{
  // Below it, L L^T + l l^T with the column l that goes
  const std::size_t n = this->Factor.size();
  std::vector<double> column(n, 0.0);
  for (std::size_t i = row + 1; i < n; ++i)
  {
    column[i] = this->Factor[i][row];
    this->Factor[i].erase(this->Factor[i].begin() + static_cast<std::ptrdiff_t>(row));
  }
  for (std::size_t j = row + 1; j < n; ++j)
  {
    // column j of the factor now is at j - 1 of each row
    const double old = this->Factor[j][j - 1];
    const double radius = std::hypot(old, column[j]);
    const double c = radius / old;
    const double s = column[j] / old;
    this->Factor[j][j - 1] = radius;
    for (std::size_t i = j + 1; i < n; ++i)
    {
      double& element = this->Factor[i][j - 1];
      element = (element + s * column[i]) / c;
      column[i] = c * column[i] - s * element;
    }
  }
  this->Factor.erase(this->Factor.begin() + static_cast<std::ptrdiff_t>(row));
  this->Others.erase(this->Others.begin() + static_cast<std::ptrdiff_t>(row));
  this->Solved = false;
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::Remove(std::size_t number)
{
  const auto has = [number](const Node& node) { return node.Number == number; };
  const auto other = std::find_if(this->Others.begin(), this->Others.end(), has);
  if (other != this->Others.end())
  {
    this->RemoveRow(static_cast<std::size_t>(other - this->Others.begin()));
    return;
  }
  std::vector<Node> left = this->GetNodes();
  const auto found = std::find_if(left.begin(), left.end(), has);
  if (found == left.end())
  {
    throw std::invalid_argument("there is no node " + std::to_string(number));
  }
  left.erase(found);
  if (left.size() < static_cast<std::size_t>(this->Polynomial.GetCount()))
  {
    throw std::invalid_argument("there are " + std::to_string(left.size()) +
      " nodes at different places; at least " + std::to_string(this->Polynomial.GetCount()) +
      " are needed");
  }
  std::sort(
    left.begin(), left.end(), [](const Node& a, const Node& b) { return a.Number < b.Number; });
  UpdatableRadialBasis changed = *this;
  changed.Build(left);
  *this = std::move(changed);
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::Move(std::size_t number, const Point& node, double value)
{
  UpdatableRadialBasis changed = *this;
  const std::size_t next = changed.NextNumber;
  FindDistinctNodes<Dimension>({ node }, { { value } }, 1); // finite?
  changed.CheckPlace(this->Frame.ToScaled(node), number);
  changed.Remove(number);
  changed.Add(node, value);
  changed.Others.back().Number = number;
  changed.NextNumber = next;
  *this = std::move(changed);
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::SetValue(std::size_t number, double value)
{
  for (std::vector<Node>* list : { &this->Anchors, &this->Others })
  {
    for (Node& node : *list)
    {
      if (node.Number == number)
      {
        if (!std::isfinite(value))
        {
          throw std::invalid_argument("a value is not a finite number");
        }
        node.Value = value;
        this->Solved = false;
        return;
      }
    }
  }
  throw std::invalid_argument("there is no node " + std::to_string(number));
}

//------------------------------------------------------------------------------
template <int Dimension>
void UpdatableRadialBasis<Dimension>::Solve()
{
  const std::size_t count = this->Anchors.size();
  const std::size_t n = this->Others.size();
  std::vector<double> weights(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    weights[i] = this->Others[i].Value;
    for (std::size_t k = 0; k < count; ++k)
    {
      weights[i] -= this->Others[i].Lagrange[k] * this->Anchors[k].Value;
    }
    for (std::size_t j = 0; j < i; ++j)
    {
      weights[i] -= this->Factor[i][j] * weights[j];
    }
    weights[i] /= this->Factor[i][i];
  }
  for (std::size_t i = n; i-- > 0;)
  {
    weights[i] /= this->Factor[i][i];
    for (std::size_t j = 0; j < i; ++j)
    {
      weights[j] -= this->Factor[i][j] * weights[i];
    }
  }
  // The anchors' weights by the side conditions, their values for the polynomial
  this->Weights.assign(count, 0.0);
  this->AnchorValues.assign(count, 0.0);
  for (std::size_t k = 0; k < count; ++k)
  {
    for (std::size_t i = 0; i < n; ++i)
    {
      this->Weights[k] -= this->Others[i].Lagrange[k] * weights[i];
    }
  }
  for (std::size_t k = 0; k < count; ++k)
  {
    this->AnchorValues[k] = this->Anchors[k].Value;
    for (std::size_t l = 0; l < count; ++l)
    {
      this->AnchorValues[k] -= this->AnchorMatrix[k + count * l] * this->Weights[l];
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      this->AnchorValues[k] -= this->Others[i].ToAnchors[k] * weights[i];
    }
  }
  this->Weights.insert(this->Weights.end(), weights.begin(), weights.end());
  for (int c = 0; c < Dimension; ++c)
  {
    this->Axis[c].clear();
    for (const std::vector<Node>* list : { &this->Anchors, &this->Others })
    {
      for (const Node& node : *list)
      {
        this->Axis[c].push_back(node.Scaled[c]);
      }
    }
  }
  this->Solved = true;
}

template <int Dimension>
void UpdatableRadialBasis<Dimension>::Evaluate(
  Execution& execution, const std::vector<Point>& points, std::vector<double>& values)
{
  if (!this->Solved)
  {
    this->Solve();
  }
  values.resize(points.size());
  Coordinates<Dimension> nodes;
  for (int c = 0; c < Dimension; ++c)
  {
    nodes.Axis[c] = this->Axis[c].data();
  }
  const std::size_t count = this->Anchors.size();
  const auto blocks = static_cast<std::int64_t>((points.size() + RadialBlock - 1) / RadialBlock);
  execution.For(blocks, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      alignas(64) double block[Dimension][RadialBlock] = {};
      alignas(64) double sums[RadialBlock];
      double lagrange[RadialPolynomial<Dimension>::MaximumCount];
      for (std::int64_t b = begin; b < end; ++b)
      {
        const std::size_t first = static_cast<std::size_t>(b) * RadialBlock;
        const std::size_t size = std::min(RadialBlock, points.size() - first);
        Coordinates<Dimension> at;
        for (int c = 0; c < Dimension; ++c)
        {
          for (std::size_t p = 0; p < size; ++p)
          {
            block[c][p] = this->Frame.ToScaled(points[first + p])[c];
          }
          at.Axis[c] = block[c];
        }
        this->Loops.Sum(nodes, this->Weights.data(), this->Weights.size(), at, sums);
        for (std::size_t p = 0; p < size; ++p)
        {
          this->Basis.GetLagrange(this->Frame.ToScaled(points[first + p]), lagrange);
          double value = sums[p];
          for (std::size_t k = 0; k < count; ++k)
          {
            value += lagrange[k] * this->AnchorValues[k];
          }
          values[first + p] = value;
        }
      }
    });
}

template class UpdatableRadialBasis<2>;
template class UpdatableRadialBasis<3>;
}
