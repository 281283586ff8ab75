// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A few control points, which a user drags, on top of many nodes that stay.
#ifndef lacunaRadialControl_h
#define lacunaRadialControl_h

#include "lacunaPolynomialAnchors.h"
#include "lacunaRadialSystem.h"

#include <array>
#include <cstddef>
#include <map>
#include <vector>

namespace lacuna
{
class Execution;

/// Borders the equations of a RadialSystem by those of control points c_j with values g_j, which
/// the function meets exactly whatever the smoothing, and by releases of nodes, whose weights become
/// 0. Each is one more unknown and one more right-hand side of the system that stays:
///
///     (K   B) (u)   (f)      K W = B,  S = C - B^T W,  S b = g - s_0(c),  u = u_0 - W b
///     (B^T C) (b) = (g)
///
/// The columns W are kept from one call to the next for the points and nodes that come again, so
/// that moving one point costs one solution with equations that are factorized already. A column
/// depends on its own point only: the result is the same, bit for bit, whatever came before.
template <int Dimension>
class RadialControl
{
public:
  using Point = std::array<double, Dimension>;

  /// system and equations must outlive this. accuracy as in RadialBasisOptions.
  RadialControl(
    const RadialSystem<Dimension>& system, RadialEquations<Dimension>& equations, double accuracy);

  /// Places the control points (scaled, at different places) and the nodes to release.
  void Place(Execution& execution, const std::vector<Point>& points,
    const std::vector<std::size_t>& released);

  struct Result
  {
    /// Weights of the nodes, of the control points, and the polynomial.
    std::vector<double> Coefficients;
    double Residual = 0; ///< bound for what control adds to the residual at nodes
  };
  /// With values at the points for the solution of one right-hand side without control points.
  /// Throws std::runtime_error when a point lies so near to a node that is not released, or to
  /// another point, that they contradict each other.
  Result Solve(const std::vector<double>& atPoints, const std::vector<double>& solution) const;

private:
  struct Column
  {
    std::vector<double> Border;   // B, n
    std::vector<double> Solution; // W, n and the polynomial
    double Residual = 0;
  };
  // A control point, or a node to release.
  struct Unknown
  {
    Point Place;
    std::size_t Node;                                                       // None: control point
    std::array<double, RadialPolynomial<Dimension>::MaximumCount> Lagrange; // of the anchors
  };
  static constexpr std::size_t None = static_cast<std::size_t>(-1);

  Unknown MakeControlPoint(const Point& place) const;
  double GetPhi(const Point& a, const Point& b) const;
  double GetCorner(const Unknown& a, const Unknown& b) const;
  Column MakeColumn(Execution& execution, const Unknown& unknown) const;
  /// Factors that bring the largest element of each row of S to about 1.
  std::vector<double> Equilibrate() const;
  void AddWeights(
    const std::vector<double>& weights, Result& result, std::vector<double>& atControl) const;
  /// What is left to do at each control point (a value) and release (a weight).
  std::vector<double> GetMisses(const std::vector<double>& atPoints,
    const std::vector<double>& coefficients, const std::vector<double>& atControl) const;

  const RadialSystem<Dimension>& System;
  RadialEquations<Dimension>& Equations;
  double Accuracy;
  RadialLoops<Dimension> Loops;
  PolynomialAnchors<Dimension> Anchors;
  std::vector<Unknown> Unknowns;
  std::vector<Column> Columns;    // of Unknowns
  std::vector<double> Complement; // S, column after column
};
}
#endif
