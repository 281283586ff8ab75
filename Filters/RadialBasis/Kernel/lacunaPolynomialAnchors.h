// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A few nodes whose values determine the polynomial part of a radial basis function.
#ifndef lacunaPolynomialAnchors_h
#define lacunaPolynomialAnchors_h

#include "lacunaRadialSystem.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// As many nodes as there are monomials, chosen one after the other: each the node whose monomials
/// are farthest from those of the ones before. Weights w at any place x and -w L_k(x) at anchor k
/// satisfy the side conditions, L_k being the Lagrange polynomials of the anchors.
template <int Dimension>
class PolynomialAnchors
{
public:
  using Point = std::array<double, Dimension>;

  PolynomialAnchors() = default;
  /// nodes must determine the polynomial (see CheckSpread). Throws std::runtime_error when they
  /// hardly do.
  PolynomialAnchors(const std::vector<Point>& nodes, const RadialPolynomial<Dimension>& polynomial);

  const std::vector<std::size_t>& GetNodes() const { return this->Nodes; }
  /// L_k(x) for each anchor; lagrange has room for RadialPolynomial::MaximumCount.
  void GetLagrange(const Point& x, double* lagrange) const;

private:
  RadialPolynomial<Dimension> Polynomial;
  std::vector<std::size_t> Nodes;
  std::vector<double> FromMonomials; // L_k = sum_j m[k + count j] monomial j
};
}
#endif
