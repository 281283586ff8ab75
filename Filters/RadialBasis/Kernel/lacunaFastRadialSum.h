// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sums of radial functions over many nodes at many points, with a bound for the error.
#ifndef lacunaFastRadialSum_h
#define lacunaFastRadialSum_h

#include "lacunaFarField.h"
#include "lacunaInteractionLists.h"
#include "lacunaRadialSum.h"
#include "lacunaRadialTree.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

/// u(x) = sum_i w_i phi(|x - y_i|) at fixed points x, for fixed sources y, by a black-box fast
/// multipole method (Fong & Darve 2009): boxes that do not touch act on one another through tensor
/// Chebyshev interpolants of phi, compressed (Messner, Schanz & Darve 2012); those that touch by
/// direct sums. Time and memory grow in proportion to the number of sources and points.
///
/// The order of interpolation is chosen for each sum so that the error cannot exceed the tolerance:
/// the largest error of the interpolated phi for each pair of boxes, times the absolute weights in
/// the box of sources, adds up to less. (Since weights differ in sign, the true error usually is
/// ten to a hundred times smaller.) Results are the same, bit for bit, for any number of threads.
template <int Dimension>
class FastRadialSum
{
public:
  using Point = std::array<double, Dimension>;

  /// Sums at scattered points; when these are the very list of sources, one tree serves both. Throws std::invalid_argument when there are no sources or points.
  FastRadialSum(
    RadialKernel kernel, const std::vector<Point>& sources, const std::vector<Point>& points);
  /// Sums at the points of a grid: there interpolants are evaluated axis by axis.
  FastRadialSum(
    RadialKernel kernel, const std::vector<Point>& sources, const RegularGrid<Dimension>& grid);
  ~FastRadialSum();

  std::int64_t GetNumberOfPoints() const;

  /// The part of the grid where values are wanted, by default all. They have the same bits.
  void SetPart(const GridPart<Dimension>& part) { this->Part = part; }

  /// Bytes that interpolants over the boxes of the grid's part may take at once, by default any: with
  /// more of them values are made for some boxes after the others, which have the same bits and take
  /// somewhat longer. Those of scattered points are all there, or refused with their bytes.
  void SetMemoryForInterpolants(double bytes) { this->MemoryForInterpolants = bytes; }

  /// For errors. By default the options' own names.
  void SetWords(const RadialWords& words) { this->Words = words; }

  /// values[k] = u(x_k) within tolerance (> 0, in the unit of weight x phi); the points of the grid's
  /// part with the first index fastest. Returns the bound of the error. Throws std::runtime_error
  /// when doubles cannot give the tolerance.
  double Apply(
    Execution& execution, const std::vector<double>& weights, double tolerance, double* values);
  /// The same for one sum only: by direct sums (bound 0) where the interpolants that the tolerance
  /// needs would take longer to set up.
  double ApplyOnce(
    Execution& execution, const std::vector<double>& weights, double tolerance, double* values);
  /// ApplyOnce in two steps: what all parts of a grid have in common, then values of parts of the
  /// part, any number of them.
  double SetUpOnce(Execution& execution, const std::vector<double>& weights, double tolerance);
  void EvaluatePart(Execution& execution, const GridPart<Dimension>& part, double* values) const;
  /// The same with interpolants of at most some order, whatever bound they have.
  double ApplyUpTo(int order, Execution& execution, const std::vector<double>& weights,
    double tolerance, double* values);

  /// Order of the interpolation that the last sum used.
  int GetOrder() const { return this->Order; }

  /// Largest order that is tried: beyond, round-off is all there is to gain.
  static constexpr int MaximumOrder = Dimension == 2 ? 18 : 11;

private:
  using Cell = TreeCell<Dimension>;

  void Prepare();
  const CellTree<Dimension>& GetTargets() const;
  /// Evaluations of the kernel that direct sums take.
  double GetDirectEvaluations() const
  {
    return static_cast<double>(this->Sources->Cells[0].Count) *
      static_cast<double>(this->GetNumberOfPoints());
  }
  /// What it takes to set up interpolants of an order, in evaluations of the kernel.
  double GetSetUpEvaluations(int order) const;
  /// For a sum that is made once.
  int GetLargestOrder() const;
  double SetUpWithin(
    int order, Execution& execution, const std::vector<double>& weights, double tolerance);
  double ApplyWithin(int order, Execution& execution, const std::vector<double>& weights,
    double tolerance, double* values);
  FarField<Dimension>& GetFarField(Execution& execution, int order);
  /// Returns the bound of the error.
  double ChooseOrder(Execution& execution, double tolerance, int maximum);
  void SetUpInterpolants(Execution& execution);
  void SortWeights(const std::vector<double>& weights);
  double GetBound(const FarField<Dimension>& far) const;
  void SumMagnitudes();
  void Upward(Execution& execution);
  void PointsToMultipole(const Cell& cell, double* multipole) const;
  /// Target boxes with points of a part: which they are among these, else -1, and values at the nodes
  /// of their interpolants.
  struct Interpolants
  {
    std::vector<std::int32_t> Slots;
    std::vector<double> Locals;
  };
  /// How many boxes have points of a part.
  std::int64_t CountWanted(const GridPart<Dimension>& part) const;
  bool Fits(const GridPart<Dimension>& part) const;
  Interpolants MakeInterpolants(Execution& execution, const GridPart<Dimension>& part) const;
  void Across(Execution& execution, Interpolants& to) const;
  void ApplyPairs(const typename InteractionLists<Dimension>::Block& block, Interpolants& to) const;
  void PointsToLocal(int target, Interpolants& to) const;
  void Downward(Execution& execution, Interpolants& to) const;
  /// Of some of a part; values are those of the part.
  void EvaluateSome(Execution& execution, const GridPart<Dimension>& some,
    const Interpolants& interpolants, const GridPart<Dimension>& part, double* values) const;
  void EvaluateLocal(const Cell& cell, const double* local, double* values) const;
  /// At points of a target: the points of cell.
  void EvaluateDirect(int target, const Cell& cell, double* values) const;
  void SumDirectly(const Cell& cell, double* values) const;
  /// The points of a box without children, the last repeated up to padded.
  void GetTargetPoints(
    const Cell& cell, std::size_t padded, std::array<std::vector<double>, Dimension>& axis) const;
  /// Boxes without children that have points of the part; of scattered points all.
  std::vector<int> GetLeaves(const GridPart<Dimension>& part) const;
  /// What is left of a box in the part.
  Cell Clip(const Cell& cell, const GridPart<Dimension>& part) const;
  static bool IsWithin(const Cell& cell, const GridPart<Dimension>& part);
  /// Whether a box of points has some of a part.
  bool IsWanted(const Cell& cell, const GridPart<Dimension>& part) const
  {
    return !this->Grid || IsWithin(cell, part);
  }
  static void ForCells(Execution& execution, int first, int last,
    const std::function<void(std::int64_t, std::int64_t)>& body);

  RadialKernel Kernel;
  RadialWords Words;
  RadialLoops<Dimension> Loops;
  std::unique_ptr<PointTree<Dimension>> Sources;
  std::unique_ptr<PointTree<Dimension>> Points;
  std::unique_ptr<GridTree<Dimension>> Grid;
  GridPart<Dimension> Part{};
  bool SameTree = false;
  std::unique_ptr<InteractionLists<Dimension>> Lists;
  std::vector<char> Levels;                                    // where interpolants are used
  std::vector<std::unique_ptr<FarField<Dimension>>> FarFields; // by order
  std::vector<std::vector<std::int32_t>> Permutations;         // for Order

  // of the sum at hand
  bool Direct = false; // without interpolants
  int Order = 0;
  const FarField<Dimension>* Far = nullptr;
  std::vector<double> Weights;    // in the order of Sources
  std::vector<double> Magnitudes; // sum of |w| in each box of sources
  std::vector<double> Multipoles; // each box's weights of the nodes of its interpolant
  Interpolants OfPart;            // none when those of the whole part are too many
  double MemoryForInterpolants = std::numeric_limits<double>::infinity();
};
}
#endif
