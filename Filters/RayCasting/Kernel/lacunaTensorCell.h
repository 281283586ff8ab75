// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One cell of a tensor-product field: uniform cubic B-spline (64 control points) or trilinear (8).
///
/// A cell lies between eight voxels and has local coordinates 0..1. Its control points are given
/// with i fastest: for Support 4 those at -1, 0, 1, 2 along each axis, for Support 2 those at 0, 1.
/// Carr 1996, 3.3.3.
#ifndef lacunaTensorCell_h
#define lacunaTensorCell_h

#include "lacunaFour.h"
#include "lacunaVector.h"

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

template <int Support>
struct TensorCell
{
  static constexpr int Degree = Support - 1;
  static constexpr int NumberOfPoints = Support * Support * Support;

  /// Control points at these offsets below and above a cell's first voxel.
  static constexpr int Before = Support / 2 - 1;
  static constexpr int After = Support / 2;

  alignas(32) double Points[NumberOfPoints];

  /// The field along the straight line between two local points, as a polynomial in 0 <= s <= 1 of
  /// degree Degree times the number of axes along which the line moves. Every coefficient is a
  /// convex combination of the control points, so rounding errors stay at some 1e-16 of them.
  ScaledBernstein Along(const Vec3& from, const Vec3& to) const;

  /// The same of four lines along one axis at once: coefficients[m][l] of line l from
  /// (from[0][l], from[1][l], from[2][l]) to to.
  void FourAlong(int axis, const Four* from, const Four* to, Four* coefficients) const;

  double Value(const Vec3& at) const;
  /// Per voxel step along each axis.
  Vec3 Gradient(const Vec3& at) const;
};

extern template struct TensorCell<2>;
extern template struct TensorCell<4>;
}
#endif
