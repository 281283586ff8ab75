// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Certified search for the first root of a polynomial in Bernstein form.
#ifndef lacunaBernstein_h
#define lacunaBernstein_h

#include <array>

namespace lacuna
{
/// A polynomial on 0 <= s <= 1 in scaled Bernstein form, p(s) = sum_i A[i] s^i (1-s)^(Degree-i).
/// In this form products are plain convolutions, and the signs of the coefficients bound p: where
/// they are all alike p has that sign throughout, where they change once p has one root.
struct ScaledBernstein
{
  static constexpr int MaximumDegree = 9;

  int Degree = 0;
  /// 12 elements, of which Degree + 1 count, and are set: a multiple of the vector width.
  alignas(32) std::array<double, 12> A;

  double Value(double s) const;
};

/// How the coefficients' signs (zero counts as positive) exclude or isolate a root.
enum class SignPattern
{
  AllNegative,
  NoneNegative,
  OneChange,
  SeveralChanges
};
SignPattern ClassifySigns(const ScaledBernstein& p);

/// Finds the smallest s in 0..1 at which p changes between negative and not negative. p's class at
/// 0 is that of A[0]. Exact up to rounding of the coefficients: p is bounded, never sampled, so
/// that a crossing is not missed however short it is. Returns false when there is none.
bool FindFirstSignChange(const ScaledBernstein& p, double& s);
}
#endif
