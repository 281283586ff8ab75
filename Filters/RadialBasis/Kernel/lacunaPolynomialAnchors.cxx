// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPolynomialAnchors.h"

#include "lacunaSingleBlasThread.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

// Fortran interface
extern "C" void dgesv_(const int* n, const int* columns, double* a, const int* lda, int* pivots,
  double* b, const int* ldb, int* info);

namespace lacuna
{
template <int Dimension>
PolynomialAnchors<Dimension>::PolynomialAnchors(
  const std::vector<Point>& nodes, const RadialPolynomial<Dimension>& polynomial)
  : Polynomial(polynomial)
{
  const auto count = static_cast<std::size_t>(polynomial.GetCount());
  constexpr auto none = static_cast<std::size_t>(-1);
  std::vector<std::vector<double>> rest; // what the anchors before leave of each node's monomials
  double monomials[RadialPolynomial<Dimension>::MaximumCount];
  for (const Point& node : nodes)
  {
    polynomial.Evaluate(node, monomials);
    rest.emplace_back(monomials, monomials + count);
  }
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b)
  { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  std::vector<char> isAnchor(nodes.size(), 0);
  std::vector<double> transposed(count * count); // monomials at anchors, a column for each
  for (std::size_t k = 0; k < count; ++k)
  {
    std::size_t best = none;
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      if (!isAnchor[i] && (best == none || dot(rest[i], rest[i]) > dot(rest[best], rest[best])))
      {
        best = i;
      }
    }
    isAnchor[best] = 1;
    this->Nodes.push_back(best);
    polynomial.Evaluate(nodes[best], &transposed[count * k]);
    std::vector<double> axis = rest[best];
    const double length = std::sqrt(dot(axis, axis));
    for (double& a : axis)
    {
      a /= length;
    }
    for (std::vector<double>& r : rest)
    {
      const double along = dot(r, axis);
      for (std::size_t j = 0; j < count; ++j)
      {
        r[j] -= along * axis[j];
      }
    }
  }
  this->FromMonomials.assign(count * count, 0.0);
  for (std::size_t k = 0; k < count; ++k)
  {
    this->FromMonomials[k + count * k] = 1;
  }
  const SingleBlasThread single;
  std::vector<int> pivots(count);
  const int size = static_cast<int>(count);
  int info = 0;
  dgesv_(&size, &size, transposed.data(), &size, pivots.data(), this->FromMonomials.data(), &size,
    &info);
  if (info != 0)
  {
    throw std::runtime_error("the nodes do not determine the polynomial part of the function");
  }
}

template <int Dimension>
void PolynomialAnchors<Dimension>::GetLagrange(const Point& x, double* lagrange) const
{
  const std::size_t count = this->Nodes.size();
  double monomials[RadialPolynomial<Dimension>::MaximumCount];
  this->Polynomial.Evaluate(x, monomials);
  for (std::size_t k = 0; k < count; ++k)
  {
    lagrange[k] = 0;
    for (std::size_t j = 0; j < count; ++j)
    {
      lagrange[k] += this->FromMonomials[k + count * j] * monomials[j];
    }
  }
}

template class PolynomialAnchors<2>;
template class PolynomialAnchors<3>;
}
