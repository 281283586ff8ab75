// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMatrix4.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace lacuna
{
Matrix4::Matrix4(const double elements[16])
{
  std::copy(elements, elements + 16, this->Elements.begin());
}

Matrix4 Matrix4::FromColumns(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin)
{
  return Matrix4({ x[0], y[0], z[0], origin[0], x[1], y[1], z[1], origin[1], x[2], y[2], z[2],
    origin[2], 0, 0, 0, 1 });
}

Matrix4 Matrix4::Translation(const Vec3& t)
{
  return FromColumns({ 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, t);
}

Matrix4 Matrix4::Scaling(const Vec3& s)
{
  return FromColumns({ s[0], 0, 0 }, { 0, s[1], 0 }, { 0, 0, s[2] }, { 0, 0, 0 });
}

Matrix4 Matrix4::Rotation(const Vec3& axis, double radians)
{
  // Rodrigues' formula, column by column
  const Vec3 k = Normalized(axis);
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  const auto rotate = [&](const Vec3& v)
  { return c * v + s * Cross(k, v) + (1 - c) * Dot(k, v) * k; };
  return FromColumns(rotate({ 1, 0, 0 }), rotate({ 0, 1, 0 }), rotate({ 0, 0, 1 }), { 0, 0, 0 });
}

Matrix4 Matrix4::operator*(const Matrix4& right) const
{
  Matrix4 product;
  for (int r = 0; r < 4; ++r)
  {
    for (int c = 0; c < 4; ++c)
    {
      double sum = 0;
      for (int k = 0; k < 4; ++k)
      {
        sum += (*this)(r, k) * right(k, c);
      }
      product(r, c) = sum;
    }
  }
  return product;
}

double Matrix4::Determinant3() const
{
  return Dot(this->Column(0), Cross(this->Column(1), this->Column(2)));
}

bool Matrix4::IsFinite() const
{
  return std::all_of(
    this->Elements.begin(), this->Elements.end(), [](double e) { return std::isfinite(e); });
}

bool Matrix4::IsAffine() const
{
  constexpr double tolerance = 1e-9;
  return std::abs((*this)(3, 0)) < tolerance && std::abs((*this)(3, 1)) < tolerance &&
    std::abs((*this)(3, 2)) < tolerance && std::abs((*this)(3, 3) - 1) < tolerance;
}

Matrix4 Matrix4::Inverse() const
{
  if (!this->IsFinite())
  {
    throw std::invalid_argument("transform has elements that are not finite");
  }
  if (!this->IsAffine())
  {
    throw std::invalid_argument("transform is not affine: its last row is not 0 0 0 1");
  }
  const Vec3 x = this->Column(0);
  const Vec3 y = this->Column(1);
  const Vec3 z = this->Column(2);
  const double determinant = this->Determinant3();
  // Relative to the column lengths, so that a matrix in metres is as good as one in micrometres.
  const double scale = Norm(x) * Norm(y) * Norm(z);
  if (!(std::abs(determinant) > 1e-12 * scale))
  {
    throw std::invalid_argument("transform is singular");
  }
  const double f = 1 / determinant;
  const Vec3 rx = f * Cross(y, z);
  const Vec3 ry = f * Cross(z, x);
  const Vec3 rz = f * Cross(x, y);
  const Vec3 t = this->Column(3);
  return Matrix4({ rx[0], rx[1], rx[2], -Dot(rx, t), ry[0], ry[1], ry[2], -Dot(ry, t), rz[0], rz[1],
    rz[2], -Dot(rz, t), 0, 0, 0, 1 });
}
}
