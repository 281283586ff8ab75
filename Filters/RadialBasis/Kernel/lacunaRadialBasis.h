// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Interpolation of scattered data by radial basis functions (Carr 1996, sections 6.3 and 6.4).
#ifndef lacunaRadialBasis_h
#define lacunaRadialBasis_h

#include "lacunaProperties.h"
#include "lacunaRadialControl.h"
#include "lacunaRadialSum.h"
#include "lacunaRadialSystem.h"
#include "lacunaRadialTree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

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
/// that length, in the unit of the nodes; 0 chooses GetRadialLength. Throws
/// std::invalid_argument when the extent of the nodes is out of range or shape is bad.
template <int Dimension>
RadialFrame<Dimension> FindRadialFrame(
  const std::vector<std::array<double, Dimension>>& nodes, RadialKernel kernel, double shape);

/// Throws std::invalid_argument when nodes lie on a line (plane), or, for degree 2, on a conic
/// (quadric), up to 1e-9 of their extent: they do not determine the polynomial.
template <int Dimension>
void CheckSpread(const std::vector<std::array<double, Dimension>>& scaled,
  const RadialPolynomial<Dimension>& polynomial);

template <int Dimension>
class FastRadialSum;

/// How the equations are solved and sums are evaluated.
enum class RadialSolver
{
  Auto = 0,   ///< directly up to RadialBasisOptions::AutoDirectNodes nodes, else fast
  Direct = 1, ///< by LAPACK
  Fast = 2    ///< by preconditioned iteration with fast sums
};
inline constexpr std::array<const char*, 3> RadialSolverNames{ "Auto", "Direct", "Fast" };

struct RadialBasisOptions
{
  /// Auto solves directly up to so many nodes.
  static constexpr std::size_t AutoDirectNodes = 1500;

  RadialKernel Kernel = RadialKernel::ThinPlate;
  /// mu: above 0, instead of interpolating, s minimises sum_i ((f_i - s(x_i)) / e_i)^2 + mu E(s). In
  /// 2-D and for the thin plate E is the bending energy (no unit when values and nodes are in mm, so
  /// that mu is in mm^2); for the others see RadialBasisReport::Energy (mu in mm^Power).
  double Smoothing = 0;
  /// Limit for the dense matrix, (n + monomials)^2 x 8 bytes.
  std::uint64_t MaximumBytes = std::uint64_t(1) << 32;
  /// Length of kernels that have one, in the unit of the nodes; 0: GetRadialLength times the mean distance of neighbours.
  double Shape = 0;
  /// 0: all is exact up to round-off, and Solver Fast is refused. Above 0, relative to the range of
  /// the values: a fast solution misses no value by more, and fast sums are wrong by no more.
  double Accuracy = 0;
  RadialSolver Solver = RadialSolver::Auto;
  /// e_i > 0, how much each value may be wrong, relative to the others; empty: all 1. Counts
  /// with Smoothing only.
  std::vector<double> Errors;
  /// Keeps what control points need after the fit: the factorized matrix or the preconditioner.
  bool Controllable = false;
  RadialWords Words;

  /// Kernel, KernelLength (Shape), Smoothing, Accuracy and Solver, with the ranges.
  void Describe(Properties& properties) const;
};

/// What a fit found out about itself.
struct RadialBasisReport
{
  std::size_t NodeCount = 0; ///< after merging equal nodes
  /// max_i |f_i - s(x_i) - (smoothing term)|, in the unit of the values, after refinement.
  double Residual = 0;
  bool Refined = false;         ///< one step of iterative refinement was needed and helped
  double ConditionEstimate = 0; ///< 1-norm, of the scaled system; 0: unknown (fast solution)
  int Iterations = 0;           ///< of a fast solution, else 0
  /// C sum_ij a_i a_j phi(|x_i - x_j|) >= 0 in the unit of the nodes. For the thin plate in 2-D,
  /// C = 8 pi makes it the bending energy, the integral of s_xx^2 + 2 s_xy^2 + s_yy^2 over the
  /// whole plane; for the others C = 1. Of all right-hand sides together.
  double Energy = 0;
};

/// s(x) = p(x) + sum_i a_i phi(|x - x_i|) with the side conditions sum_i a_i q(x_i) = 0 for all
/// polynomials q like p: linear, or quadratic for the triharmonic. Nodes are shifted and scaled
/// uniformly to the unit square (cube) before solving, for kernels with a length to its multiple.
/// Dimension is 2 or 3.
///
/// The same input gives the same bits for any number of threads. Direct evaluation does not depend
/// on the machine either; the rest does, as far as OpenBLAS chooses its loops by the machine
/// (relative differences around 1e-16 times the condition number).
template <int Dimension>
class RadialBasis
{
public:
  using Point = std::array<double, Dimension>;

  /// Fits values given at nodes; reports progress over the current stage of execution.
  /// Nodes at the same place are averaged with their weights where Smoothing is above 0; else they are
  /// merged if their values are the same. Throws std::invalid_argument when two
  /// nodes at the same place have different values and Smoothing is 0, when there are fewer than Dimension + 1 nodes
  /// (6 and 10 for the triharmonic), when they lie on one line (plane), or when a number is not
  /// finite; std::length_error when the matrix would exceed MaximumBytes; std::runtime_error when
  /// the system is numerically singular (nodes too close together) or the accuracy out of reach.
  RadialBasis(Execution& execution, const std::vector<Point>& nodes,
    const std::vector<double>& values, const RadialBasisOptions& options);
  /// The same for several values at each node, values[component][node]: they share all work but the
  /// last of a solution.
  RadialBasis(Execution& execution, const std::vector<Point>& nodes,
    const std::vector<std::vector<double>>& values, const RadialBasisOptions& options);

  /// Makes the function pass through control points, too, exactly whatever the smoothing, instead of
  /// those of before; values[component][point]. Nodes nearer than clearance to a control point have
  /// no say any more. The cost is one solution with kept equations, O(n^2) or a fast one, for
  /// each point and each node without a say that were not there before; the result does not depend
  /// on what was there before. The function must be Controllable. Throws std::invalid_argument when
  /// two points are at the same place with different values (equal ones are merged) or a number is
  /// not finite, std::runtime_error when points contradict each other or nodes nearby; the function
  /// then is as before.
  void SetControlPoints(Execution& execution, const std::vector<Point>& points,
    const std::vector<std::vector<double>>& values, double clearance);

  const RadialBasisReport& GetReport() const { return this->Report; }
  int GetNumberOfComponents() const { return static_cast<int>(this->Means.size()); }
  /// Largest less smallest value of a component.
  double GetRange(int component = 0) const { return this->Ranges[component]; }

  /// s at points, by direct sums; values is resized.
  void Evaluate(Execution& execution, const std::vector<Point>& points, std::vector<double>& values,
    int component = 0) const;
  /// s and its gradient at points, by direct sums; both are resized.
  void Evaluate(Execution& execution, const std::vector<Point>& points, std::vector<double>& values,
    std::vector<Point>& gradients, int component = 0) const;
  /// s at points, by direct sums or, where these would take longer, fast ones with an error of at most
  /// tolerance (> 0, in the unit of the values); values is resized. Returns the bound of the error.
  /// Throws std::runtime_error when doubles cannot give the tolerance.
  double EvaluateWithin(Execution& execution, double tolerance, const std::vector<Point>& points,
    std::vector<double>& values, int component = 0) const;
  /// s at the points of a grid, the first index fastest: by direct sums when Accuracy is 0, else
  /// with an error of at most Accuracy x GetRange. values has room for all points.
  void EvaluateGrid(Execution& execution, const RegularGrid<Dimension>& grid, double* values,
    int component = 0) const
  {
    this->EvaluateGrid(execution, grid, WholeGrid(grid), values, component);
  }
  /// The same for a part of the grid, with the same bits; values has room for the part's points.
  void EvaluateGrid(Execution& execution, const RegularGrid<Dimension>& grid,
    const GridPart<Dimension>& part, double* values, int component = 0) const;

  /// The same for many parts, with the same bits: what these have in common is computed once. The
  /// function must live longer.
  class OnGrid
  {
  public:
    static constexpr double Memory = 512 * 1048576.0;
    /// region: contains the parts that will be asked for. memory: bytes that are kept for them, see
    /// FastRadialSum::SetMemoryForInterpolants.
    OnGrid(Execution& execution, const RadialBasis& function, const RegularGrid<Dimension>& grid,
      const GridPart<Dimension>& region, int component = 0, double memory = Memory);
    void Evaluate(Execution& execution, const GridPart<Dimension>& part, double* values) const;

  private:
    const RadialBasis& Function;
    RegularGrid<Dimension> Grid;
    int Component;
    RegularGrid<Dimension> Scaled;
    std::shared_ptr<const FastRadialSum<Dimension>> Sum; // none: by direct sums
  };

  /// Coefficients of p for one component, up to the linear ones: constant, then one for each axis,
  /// for nodes in their own unit (the constant belongs to a thin plate r^2 log r with r in that
  /// unit; it would differ in another one). Of the triharmonic they belong to r in units of the
  /// longest edge of the nodes' bounding box, with the quadratic terms about its lowest corner.
  std::array<double, Dimension + 1> GetPolynomial(int component = 0) const;

  /// Loops to evaluate with; by default those of BestInstructionSet(). Results do not depend on it.
  void SetInstructionSet(InstructionSet set);

private:
  void SetNodes(const std::vector<Point>& nodes, const std::vector<std::vector<double>>& values);
  void SetDiagonal(const std::vector<std::size_t>& distinct);
  void ComputeEnergy();
  const RadialSystem<Dimension>& GetCenters() const { return *this->Centers; }
  double EvaluatePolynomial(const double* coefficients, const Point& u, Point* gradient) const;
  /// One block of up to RadialBlock points.
  void EvaluateBlock(
    int component, const Point* points, std::size_t count, double* values, Point* gradients) const;
  void EvaluateBlocks(Execution& execution, int component, const std::vector<Point>& points,
    double* values, Point* gradients) const;

  RadialBasisOptions Options;
  RadialLoops<Dimension> Loops;
  RadialBasisReport Report;
  RadialFrame<Dimension> Frame;
  // Scaled, values less their mean; equations refer to it.
  std::shared_ptr<RadialSystem<Dimension>> System;
  std::shared_ptr<RadialEquations<Dimension>> Equations; // if Controllable
  std::shared_ptr<RadialControl<Dimension>> Control;     // if Controllable
  // What is summed: System, or its nodes and the control points
  std::shared_ptr<const RadialSystem<Dimension>> Centers;
  std::vector<double> Means;
  std::vector<double> Ranges;
  std::vector<std::vector<double>> Coefficients; // of Centers, then those of p, scaled
  // without control points
  std::vector<std::vector<double>> BaseCoefficients;
  RadialBasisReport BaseReport;
};
}
#endif
