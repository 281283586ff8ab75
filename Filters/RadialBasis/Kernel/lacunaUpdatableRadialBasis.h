// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A radial basis function of which nodes are added, moved and taken away.
#ifndef lacunaUpdatableRadialBasis_h
#define lacunaUpdatableRadialBasis_h

#include "lacunaPolynomialAnchors.h"
#include "lacunaRadialBasis.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// The function of RadialBasis for control points that the user drags: a change of one node costs
/// O(n^2), not a new O(n^3) solution.
///
/// Some of the first nodes, just enough to determine the polynomial, are anchors; for the others
/// the equations reduce to a positive definite matrix whose elements depend on a pair of nodes and
/// the anchors only, and whose Cholesky factor grows and shrinks by rows. To take an anchor away
/// means to choose new ones, at the cost of a new solution.
///
/// The frame (scale) stays that of the first nodes; new ones may lie outside.
template <int Dimension>
class UpdatableRadialBasis
{
public:
  using Point = std::array<double, Dimension>;

  /// The first nodes have the numbers 0, 1, ... in the order given. options are as for RadialBasis,
  /// without Accuracy, Solver and Errors. Throws as RadialBasis does; nodes at the same place are
  /// errors here, since each has its number.
  UpdatableRadialBasis(Execution& execution, const std::vector<Point>& nodes,
    const std::vector<double>& values, const RadialBasisOptions& options);

  /// Adds a node and returns its number, which is never used again. Throws std::invalid_argument
  /// when it is not finite or there is a node at that place, std::runtime_error when the equations
  /// become singular; the function is as before then.
  std::size_t Add(const Point& node, double value);
  /// Takes a node away. Throws std::invalid_argument when there is no such number, or when the
  /// nodes left do not determine a function; the function is as before then.
  void Remove(std::size_t number);
  /// Moves a node to another place with another value. Throws as Add and Remove.
  void Move(std::size_t number, const Point& node, double value);
  /// Changes the value of a node only: no factor changes.
  void SetValue(std::size_t number, double value);

  std::size_t GetNumberOfNodes() const { return this->Anchors.size() + this->Others.size(); }

  /// s at points; values is resized. Solves the equations first if something has changed, O(n^2).
  void Evaluate(
    Execution& execution, const std::vector<Point>& points, std::vector<double>& values);

private:
  struct Node
  {
    std::size_t Number;
    Point Scaled;
    double Value;
    std::vector<double> Lagrange;  // the anchors' Lagrange polynomials at the node
    std::vector<double> ToAnchors; // phi to each anchor
  };

  void Build(const std::vector<Node>& nodes);
  Node MakeNode(std::size_t number, const Point& scaled, double value) const;
  double GetPhi(const Point& a, const Point& b) const;
  double GetElement(const Node& a, const Node& b) const;
  void CheckPlace(const Point& scaled, std::size_t except) const;
  void RemoveRow(std::size_t row);
  std::vector<Node> GetNodes() const;
  void Solve();

  RadialBasisOptions Options;
  RadialLoops<Dimension> Loops;
  RadialFrame<Dimension> Frame;
  RadialPolynomial<Dimension> Polynomial;
  double Diagonal = 0;
  std::size_t NextNumber = 0;
  std::vector<Node> Anchors;
  std::vector<Node> Others;
  PolynomialAnchors<Dimension> Basis;
  std::vector<double> AnchorMatrix;        // phi between anchors, with the diagonal
  std::vector<std::vector<double>> Factor; // rows of the lower triangle
  // the solution
  bool Solved = false;
  std::array<std::vector<double>, Dimension> Axis;
  std::vector<double> Weights;
  std::vector<double> AnchorValues; // of the polynomial
};
}
#endif
