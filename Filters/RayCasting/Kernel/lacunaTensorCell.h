// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One cell of a tensor-product field: uniform cubic B-spline (64 control points) or trilinear (8).
///
/// A cell lies between eight voxels and has local coordinates 0..1. Its control points are given
/// with i fastest: for Support 4 those at -1, 0, 1, 2 along each axis, for Support 2 those at 0, 1.
/// Carr 1996, 3.3.3.
#ifndef lacunaTensorCell_h
#define lacunaTensorCell_h

#include "lacunaBernstein.h"
#include "lacunaFour.h"
#include "lacunaVector.h"

namespace lacuna
{
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
