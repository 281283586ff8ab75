// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Cubic splines of one variable: spaces and least squares. Source: de Boor, A Practical Guide to
/// Splines, 1978.
#ifndef lacunaCubicSpline_h
#define lacunaCubicSpline_h

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// The C2 cubic splines with given simple interior knots on an interval, in terms of B-splines with
/// clamped end knots (four-fold).
class CubicSplineSpace
{
public:
  /// The four B-splines that are not zero at a point: those of First, First + 1, ...
  struct Values
  {
    std::int64_t First;
    std::array<double, 4> Weights; ///< they add up to 1
  };

  /// Cubic polynomials on 0..1.
  CubicSplineSpace();
  /// Throws std::invalid_argument unless first < interior... < last, all finite.
  CubicSplineSpace(double first, const std::vector<double>& interior, double last);
  /// The space in which interpolation at the sites is unique with not-a-knot ends: a knot at every
  /// site but the first and last two. At least four, increasing.
  static CubicSplineSpace NotAKnot(const std::vector<double>& sites);

  /// Number of B-splines, the dimension of the space: interior knots + 4.
  std::int64_t GetSize() const { return static_cast<std::int64_t>(this->Knots.size()) - 4; }
  /// All knots, GetSize() + 4 of them.
  const std::vector<double>& GetKnots() const { return this->Knots; }
  double GetFirst() const { return this->Knots.front(); }
  double GetLast() const { return this->Knots.back(); }

  /// Coefficient i of the identity x -> x (the Greville abscissa).
  double GetIdentityCoefficient(std::int64_t i) const;

  /// The B-splines at x, or their first or second derivatives (then the weights add up to 0). x is
  /// clamped to the interval.
  Values Evaluate(double x, int derivative = 0) const;

private:
  std::vector<double> Knots;
};

/// Least squares approximation of samples at fixed sites by splines of one space; interpolation
/// where the space has as many dimensions as there are sites. Works on many functions at once.
class CubicSplineFit
{
public:
  /// Sites increase and lie within the space's interval. Throws std::invalid_argument when they do
  /// not determine a spline of the space (Schoenberg-Whitney: each B-spline needs a site of its
  /// own).
  CubicSplineFit(const CubicSplineSpace& space, const std::vector<double>& sites);

  std::int64_t GetNumberOfSites() const { return static_cast<std::int64_t>(this->Basis.size()); }

  /// samples: one row of width values per site. coefficients: one row per B-spline. Normal
  /// equations, with refinement until their squared condition number does not show.
  void Solve(Execution& execution, const std::vector<double>& samples, std::int64_t width,
    std::vector<double>& coefficients) const;

  /// The inverse of Solve: the splines at the sites.
  void Evaluate(Execution& execution, const std::vector<double>& coefficients, std::int64_t width,
    std::vector<double>& samples) const;

  /// As Solve, but returns for each site the largest distance between samples and spline, where
  /// points consist of the given number of consecutive values.
  std::vector<double> Deviation(Execution& execution, const std::vector<double>& samples,
    std::int64_t width, int components) const;

private:
  using Row = std::array<double, 4>;
  void Factorise();
  /// Solves L Lt x = rhs in place, for so many right sides.
  void Substitute(std::int64_t count, double* rhs) const;
  /// work: (size of the space + 1) count numbers.
  void SolveBlock(const double* samples, std::int64_t width, std::int64_t first, std::int64_t count,
    int refinements, double* work, double* coefficients) const;
  void DeviationBlock(const double* coefficients, const double* samples, std::int64_t width,
    std::int64_t count, int components, double* squares) const;

  CubicSplineSpace Space;
  std::vector<CubicSplineSpace::Values> Basis; // at each site
  std::vector<Row> Factor; // L of the banded normal matrix L Lt: L(i, i - 3 + k); diagonal inverted
};
}
#endif
