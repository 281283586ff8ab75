// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The equations of a radial basis function, whatever solves them.
#ifndef lacunaRadialSystem_h
#define lacunaRadialSystem_h

#include "lacunaRadialSum.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

/// The monomials up to a degree of 1 or 2 of x / Length: 1, then the coordinates, then their
/// products.
template <int Dimension>
struct RadialPolynomial
{
  using Point = std::array<double, Dimension>;

  int Degree = 1;
  double Length = 1;
  static constexpr int MaximumCount = (Dimension + 1) * (Dimension + 2) / 2;

  int GetCount() const { return this->Degree == 1 ? Dimension + 1 : MaximumCount; }
  void Evaluate(const Point& x, double* monomials) const
  {
    *monomials++ = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      *monomials++ = x[c] / this->Length;
    }
    for (int c = 0; c < Dimension && this->Degree == 2; ++c)
    {
      for (int d = c; d < Dimension; ++d)
      {
        *monomials++ = x[c] * x[d] / (this->Length * this->Length);
      }
    }
  }
};

/// (A + diagonal  P) (a)   (f)
/// (P^T           0) (c) = (0)  with A_ij = phi(|x_i - x_j|) and P_ik = monomial k at x_i; several
/// right-hand sides f. Nodes lie at different places and determine the polynomial.
template <int Dimension>
struct RadialSystem
{
  using Point = std::array<double, Dimension>;

  RadialKernel Kernel = RadialKernel::ThinPlate;
  RadialPolynomial<Dimension> Polynomial;
  std::vector<Point> Nodes;
  std::array<std::vector<double>, Dimension> Axis; ///< the same by coordinate
  std::vector<double> Diagonal;                    ///< >= 0, one for each node
  std::vector<std::vector<double>> Values;         ///< one for each right-hand side
  RadialWords Words;

  std::size_t GetSize() const { return this->Nodes.size(); }
  bool IsSmoothed() const; ///< whether any node has a diagonal above 0
  Coordinates<Dimension> GetCoordinates(std::size_t first = 0) const;
  /// (A + diagonal) a + P c at the nodes, less the values; by direct sums.
  std::vector<double> GetResidual(Execution& execution, const std::vector<double>& values,
    const std::vector<double>& coefficients) const;
};

/// What is found out while right-hand sides are solved: of all of them, the worst.
struct RadialSolution
{
  double Residual = 0;          ///< largest |(A + diagonal) a + P c - f|
  bool Refined = false;         ///< one step of iterative refinement was needed and helped
  double ConditionEstimate = 0; ///< in the 1-norm; 0 if unknown
  int Iterations = 0;           ///< 0 for direct solutions; else the largest number
};

/// A RadialSystem made ready for right-hand sides that come one by one. The system must outlive it.
template <int Dimension>
class RadialEquations
{
public:
  virtual ~RadialEquations() = default;

  /// a, then c, for the right-hand side (values, 0). Iterative solutions miss no value by more than
  /// tolerance (> 0, in the unit of the values) or throw std::runtime_error.
  virtual std::vector<double> Solve(Execution& execution, const std::vector<double>& values,
    double tolerance, RadialSolution& found) = 0;
};

/// By LAPACK's diagonal pivoting method. Throws std::length_error when the matrix takes more than
/// maximumBytes, std::runtime_error when it is numerically singular.
template <int Dimension>
std::unique_ptr<RadialEquations<Dimension>> PrepareDirectly(
  Execution& execution, const RadialSystem<Dimension>& system, std::uint64_t maximumBytes);

/// By flexible GMRES on the complement of the polynomials with fast sums and a
/// SchwarzPreconditioner, in O(n) memory. The residual of a solution is computed anew, from sums whose
/// error bound is a tenth of the tolerance and counted in.
template <int Dimension>
std::unique_ptr<RadialEquations<Dimension>> PrepareIteratively(
  Execution& execution, const RadialSystem<Dimension>& system);
}
#endif
