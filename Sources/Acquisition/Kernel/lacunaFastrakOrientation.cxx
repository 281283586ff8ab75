// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakOrientation.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
}

Matrix4 FastrakRotation(const Vec3& angles)
{
  return Matrix4::Rotation({ 0, 0, 1 }, angles[0] * Degree) *
    Matrix4::Rotation({ 0, 1, 0 }, angles[1] * Degree) *
    Matrix4::Rotation({ 1, 0, 0 }, angles[2] * Degree);
}

Matrix4 FastrakRotation(const std::array<double, 4>& q)
{
  const Vec3 axis{ q[1], q[2], q[3] };
  const double sine = Norm(axis);
  return sine > 0 ? Matrix4::Rotation(axis, 2 * std::atan2(sine, q[0])) : Matrix4();
}

Vec3 FastrakAngles(const Matrix4& r)
{
  const double cosine = std::hypot(r(0, 0), r(1, 0));
  const double elevation = std::atan2(-r(2, 0), cosine);
  if (cosine < 1e-12)
  {
    return { std::atan2(-r(0, 1), r(1, 1)) / Degree, elevation / Degree, 0 };
  }
  return { std::atan2(r(1, 0), r(0, 0)) / Degree, elevation / Degree,
    std::atan2(r(2, 1), r(2, 2)) / Degree };
}

std::array<double, 4> FastrakQuaternion(const Matrix4& r)
{
  // four times the squares of w x y z; dividing by the largest loses no digits
  const std::array<double, 4> squares{ 1 + r(0, 0) + r(1, 1) + r(2, 2),
    1 + r(0, 0) - r(1, 1) - r(2, 2), 1 - r(0, 0) + r(1, 1) - r(2, 2),
    1 - r(0, 0) - r(1, 1) + r(2, 2) };
  const Vec3 odd{ r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1) };
  const Vec3 even{ r(2, 1) + r(1, 2), r(0, 2) + r(2, 0), r(1, 0) + r(0, 1) };
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  std::array<double, 4> q{};
  switch (largest)
  {
    case 0:
      q = { squares[0], odd[0], odd[1], odd[2] };
      break;
    case 1:
      q = { odd[0], squares[1], even[2], even[1] };
      break;
    case 2:
      q = { odd[1], even[2], squares[2], even[0] };
      break;
    default:
      q = { odd[2], even[1], even[0], squares[3] };
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double divisor = q[0] < 0 ? -length : length;
  for (double& element : q)
  {
    element /= divisor;
  }
  return q;
}
}
