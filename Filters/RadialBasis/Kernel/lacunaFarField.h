// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How boxes that do not touch act on one another: the operators of the fast summation.
#ifndef lacunaFarField_h
#define lacunaFarField_h

#include "lacunaChebyshevBasis.h"
#include "lacunaRadialSum.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// The offsets between boxes of equal size that do not touch while their parents do, up to the
/// symmetries of the square (cube): all of them are one of a few canonical offsets, turned and
/// reflected (Messner, Schanz & Darve 2012).
template <int Dimension>
class FarOffsets
{
public:
  static constexpr int Symmetries = Dimension == 2 ? 8 : 48;

  struct Entry
  {
    std::uint8_t Operator;
    std::uint8_t Symmetry;
  };

  FarOffsets();
  /// Canonical offsets, in box sizes: falling components >= 0, the first 2 or 3.
  const std::vector<std::array<int, Dimension>>& GetCanonical() const { return this->Canonical; }
  /// For an offset with components of magnitude 0..3, one of them at least 2.
  Entry Find(const std::array<int, Dimension>& offset) const;
  /// To which node of an order^Dimension lattice each node goes under a symmetry.
  static std::vector<std::int32_t> GetPermutation(int symmetry, int order);

private:
  std::vector<std::array<int, Dimension>> Canonical;
};

/// L = K M for one canonical offset at one level; K is size x size and kept as A B^T of some rank
/// when that is cheaper.
struct FarOperator
{
  int Size = 0;
  int Rank = 0;          ///< 0: A is the dense matrix
  std::vector<double> A; ///< Size x Rank, or Size x Size
  std::vector<double> B; ///< Size x Rank

  /// out = K in, for count columns; scratch is resized as needed.
  void Apply(const double* in, int count, double* out, std::vector<double>& scratch) const;
};

/// The operators of one kernel and one order of interpolation for all levels of a tree.
template <int Dimension>
class FarField
{
public:
  /// Finds out the errors; operators have still to be made. Boxes at level l have the size rootSize /
  /// 2^l; levels says which ones are of interest.
  FarField(Execution& execution, RadialKernel kernel, int order, double rootSize,
    const std::vector<char>& levels);

  /// Makes the operators that Get returns, unless they are there.
  void MakeOperators(Execution& execution);

  const ChebyshevBasis& GetBasis() const { return this->Basis; }
  int GetSize() const { return this->Size; }
  /// K = GetScale(level) x the operator.
  const FarOperator& Get(int level, int op) const
  {
    return this->Operators[this->Homogeneous ? 0 : level][op];
  }
  double GetScale(int level) const { return this->Scales[level]; }
  /// max |phi - its interpolant| over pairs of points of two boxes at that offset.
  double GetError(int level, int op) const
  {
    return this->Scales[level] * this->Errors[this->Homogeneous ? 0 : level][op];
  }
  /// The largest of a level: also for interpolation in one box only, at points that do not touch it.
  double GetLargestError(int level) const;

private:
  class Maker;
  /// body(maker, level, op) for each operator, in parallel.
  template <class Body>
  void ForOperators(Execution& execution, const Body& body);

  RadialKernel Kernel;
  ChebyshevBasis Basis;
  int Size;
  double RootSize;
  bool Homogeneous;
  std::vector<char> Used;
  std::vector<std::vector<double>> Errors;
  std::vector<std::vector<FarOperator>> Operators;
  std::vector<double> Scales;
};
}
#endif
