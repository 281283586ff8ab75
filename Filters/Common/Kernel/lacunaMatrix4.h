// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// 4x4 transforms acting on column vectors; AToB maps coordinates in A to coordinates in B.
#ifndef lacunaMatrix4_h
#define lacunaMatrix4_h

#include "lacunaVector.h"

#include <array>

namespace lacuna
{
/// Affine (last row 0 0 0 1) or general 4x4 matrix, row-major.
class Matrix4
{
public:
  /// Identity.
  Matrix4() = default;
  /// From 16 row-major elements.
  explicit Matrix4(const std::array<double, 16>& elements)
    : Elements(elements)
  {
  }
  explicit Matrix4(const double elements[16]);

  /// Affine matrix whose first three columns are x, y, z and whose fourth is origin.
  static Matrix4 FromColumns(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin);
  static Matrix4 Translation(const Vec3& t);
  static Matrix4 Scaling(const Vec3& s);
  /// Right-handed rotation by an angle in radians about a (not necessarily unit) axis.
  static Matrix4 Rotation(const Vec3& axis, double radians);

  double operator()(int row, int column) const { return this->Elements[4 * row + column]; }
  double& operator()(int row, int column) { return this->Elements[4 * row + column]; }
  const double* Data() const { return this->Elements.data(); }

  /// First three elements of a column.
  Vec3 Column(int column) const
  {
    return { (*this)(0, column), (*this)(1, column), (*this)(2, column) };
  }

  Matrix4 operator*(const Matrix4& right) const;
  /// Image of a point (w = 1); the last row is taken to be 0 0 0 1.
  Vec3 Point(const Vec3& p) const
  {
    return { (*this)(0, 0) * p[0] + (*this)(0, 1) * p[1] + (*this)(0, 2) * p[2] + (*this)(0, 3),
      (*this)(1, 0) * p[0] + (*this)(1, 1) * p[1] + (*this)(1, 2) * p[2] + (*this)(1, 3),
      (*this)(2, 0) * p[0] + (*this)(2, 1) * p[1] + (*this)(2, 2) * p[2] + (*this)(2, 3) };
  }
  /// Image of a direction (w = 0).
  Vec3 Vector(const Vec3& v) const
  {
    return { (*this)(0, 0) * v[0] + (*this)(0, 1) * v[1] + (*this)(0, 2) * v[2],
      (*this)(1, 0) * v[0] + (*this)(1, 1) * v[1] + (*this)(1, 2) * v[2],
      (*this)(2, 0) * v[0] + (*this)(2, 1) * v[1] + (*this)(2, 2) * v[2] };
  }

  /// Determinant of the upper left 3x3 part; negative means that the transform mirrors.
  double Determinant3() const;
  bool IsFinite() const;
  /// True when the last row is 0 0 0 1 (within 1e-9).
  bool IsAffine() const;
  /// Inverse of an affine matrix. Throws std::invalid_argument when it is singular, not affine or
  /// not finite.
  Matrix4 Inverse() const;

private:
  std::array<double, 16> Elements{ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
};
}
#endif
