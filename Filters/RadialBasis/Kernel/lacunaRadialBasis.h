// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Interpolation of scattered data by radial basis functions (Carr 1996, sections 6.3 and 6.4).
#ifndef lacunaRadialBasis_h
#define lacunaRadialBasis_h

#include "lacunaRadialSum.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

struct RadialBasisOptions
{
  RadialKernel Kernel = RadialKernel::ThinPlate;
  /// mu >= 0: instead of interpolating, s minimises sum_i (f_i - s(x_i))^2 + mu E(s). In 2-D and
  /// for the thin plate E is the bending energy (no unit when values and nodes are in mm, so that
  /// mu is in mm^2); for the others see RadialBasisReport::Energy (mu in mm^Power).
  double Smoothing = 0;
  /// Limit for the dense matrix, (n + Dimension + 1)^2 x 8 bytes.
  std::uint64_t MaximumBytes = std::uint64_t(1) << 32;
};

/// What a fit found out about itself.
struct RadialBasisReport
{
  std::size_t NodeCount = 0; ///< after merging equal nodes
  /// max_i |f_i - s(x_i) - (smoothing term)|, in the unit of the values, after refinement.
  double Residual = 0;
  bool Refined = false;         ///< one step of iterative refinement was needed and helped
  double ConditionEstimate = 0; ///< 1-norm, of the scaled system
  /// C sum_ij a_i a_j phi(|x_i - x_j|) >= 0 in the unit of the nodes. For the thin plate in 2-D,
  /// C = 8 pi makes it the bending energy, the integral of s_xx^2 + 2 s_xy^2 + s_yy^2 over the
  /// whole plane; for the others C = 1.
  double Energy = 0;
};

/// s(x) = p(x) + sum_i a_i phi(|x - x_i|), p a linear polynomial, with the side conditions
/// sum_i a_i q(x_i) = 0 for all linear polynomials q. Nodes are shifted and scaled uniformly to the
/// unit square (cube) before solving. Dimension is 2 or 3.
///
/// The same input gives the same bits for any number of threads. Evaluation does not depend on the
/// machine either; the coefficients do, as far as OpenBLAS chooses its loops by the machine
/// (relative differences around 1e-16 times the condition number).
template <int Dimension>
class RadialBasis
{
public:
  using Point = std::array<double, Dimension>;

  /// Fits values given at nodes; reports progress over the current stage of execution.
  /// Nodes at the same place with the same value are merged. Throws std::invalid_argument when two
  /// nodes at the same place have different values, when there are fewer than Dimension + 1 nodes,
  /// when they lie on one line (plane), or when a number is not finite; std::length_error when the
  /// matrix would exceed MaximumBytes; std::runtime_error when the system is numerically singular
  /// (nodes too close together).
  RadialBasis(Execution& execution, const std::vector<Point>& nodes,
    const std::vector<double>& values, const RadialBasisOptions& options);

  const RadialBasisReport& GetReport() const { return this->Report; }

  /// s at points; values is resized.
  void Evaluate(
    Execution& execution, const std::vector<Point>& points, std::vector<double>& values) const;
  /// s and its gradient at points; both are resized.
  void Evaluate(Execution& execution, const std::vector<Point>& points, std::vector<double>& values,
    std::vector<Point>& gradients) const;

  /// Coefficients of p: constant, then one for each axis, for nodes in their own unit (the constant
  /// belongs to a thin plate r^2 log r with r in that unit; it would differ in another one).
  const std::array<double, Dimension + 1>& GetPolynomial() const { return this->Polynomial; }

  /// Loops to evaluate with; by default those of BestInstructionSet(). Results do not depend on it.
  void SetInstructionSet(InstructionSet set);

private:
  void SetNodes(const std::vector<Point>& nodes, const std::vector<double>& values);
  void CheckSpread() const;
  void Solve(Execution& execution, double diagonal);
  std::vector<double> GetResidual(double diagonal) const;
  void ConvertPolynomial();
  void ComputeEnergy();
  Coordinates<Dimension> GetNodes() const;
  Point ToScaled(const Point& point) const;
  /// One block of up to RadialBlock points.
  void EvaluateBlock(
    const Point* points, std::size_t count, double* values, Point* gradients) const;
  void EvaluateBlocks(
    Execution& execution, const std::vector<Point>& points, double* values, Point* gradients) const;

  RadialKernel Kernel;
  RadialLoops<Dimension> Loops;
  RadialBasisReport Report;
  // The scaled problem: u = Scale (x - Origin), values less their mean.
  Point Origin{};
  double Scale = 1;
  std::array<std::vector<double>, Dimension> Nodes;
  std::vector<double> Values;
  double Mean = 0;
  std::vector<double> Coefficients; // a_i, then those of p, in scaled coordinates
  std::array<double, Dimension + 1> Polynomial{};
};
}
#endif
