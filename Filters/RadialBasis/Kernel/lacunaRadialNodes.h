// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Nodes as the user gives them, checked and scaled.
#ifndef lacunaRadialNodes_h
#define lacunaRadialNodes_h

#include "lacunaRadialSystem.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// How scaled coordinates follow from those of the user: u = Scale (x - Origin).
template <int Dimension>
struct RadialFrame
{
  using Point = std::array<double, Dimension>;

  Point Origin{};
  double Scale = 1;
  double Length = 1; ///< longest edge of the bounding box of the nodes, scaled

  Point ToScaled(const Point& x) const
  {
    Point u;
    for (int c = 0; c < Dimension; ++c)
    {
      u[c] = (x[c] - this->Origin[c]) * this->Scale;
    }
    return u;
  }
};

/// Indices of nodes at different places, ascending: the first of equal ones.
///
/// values holds one list, as long as nodes, for each right-hand side. Throws std::invalid_argument
/// when a list has another length, when a number is not finite (naming the node), when two nodes lie
/// at the same place with different values (naming both), or when fewer than minimum are left.
template <int Dimension>
std::vector<std::size_t> FindDistinctNodes(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, std::size_t minimum);

/// Nodes with those at the same place taken together, as a smoothing fit does: their values averaged
/// with the weights 1 / error^2, and the error that the average has. Unchanged when all places differ.
template <int Dimension>
struct AveragedNodes
{
  std::vector<std::array<double, Dimension>> Nodes;
  std::vector<std::vector<double>> Values; ///< one list for each right-hand side
  std::vector<double> Errors;              ///< relative to each other

  /// errors: above 0, one for each node; empty: all 1. Throws as FindDistinctNodes of other lengths
  /// and numbers that are not finite.
  AveragedNodes(const std::vector<std::array<double, Dimension>>& nodes,
    const std::vector<std::vector<double>>& values, const std::vector<double>& errors);
};

/// The frame for a kernel: the unit cube, or for kernels that have a length its multiple. shape is
/// that length, in the unit of the nodes; 0 chooses 1.25 times the mean distance of neighbours. Throws
/// std::invalid_argument when the extent of the nodes is out of range or shape is bad.
template <int Dimension>
RadialFrame<Dimension> FindRadialFrame(
  const std::vector<std::array<double, Dimension>>& nodes, RadialKernel kernel, double shape);

/// Throws std::invalid_argument when nodes lie on a line (plane), or, for degree 2, on a conic
/// (quadric), up to 1e-9 of their extent: they do not determine the polynomial.
template <int Dimension>
void CheckSpread(const std::vector<std::array<double, Dimension>>& scaled,
  const RadialPolynomial<Dimension>& polynomial);
}
#endif
