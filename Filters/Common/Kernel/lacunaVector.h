// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small vector algebra for points and directions in millimetres.
#ifndef lacunaVector_h
#define lacunaVector_h

#include <array>
#include <cmath>

namespace lacuna
{
using Vec2 = std::array<double, 2>;

/// A point or direction. A struct of its own, so that its operators are found from anywhere.
struct Vec3
{
  std::array<double, 3> Elements;

  double operator[](int i) const { return this->Elements[i]; }
  double& operator[](int i) { return this->Elements[i]; }
  const double* data() const { return this->Elements.data(); }
  double* data() { return this->Elements.data(); }
};

inline bool operator==(const Vec3& a, const Vec3& b)
{
  return a.Elements == b.Elements;
}

inline Vec3 operator+(const Vec3& a, const Vec3& b)
{
  return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}

inline Vec3 operator-(const Vec3& a, const Vec3& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

inline Vec3 operator*(double s, const Vec3& a)
{
  return { s * a[0], s * a[1], s * a[2] };
}

inline double Dot(const Vec3& a, const Vec3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Vec3 Cross(const Vec3& a, const Vec3& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

inline double Norm(const Vec3& a)
{
  return std::sqrt(Dot(a, a));
}

/// Unit vector along a; the zero vector stays zero.
inline Vec3 Normalized(const Vec3& a)
{
  const double n = Norm(a);
  return n > 0 ? (1 / n) * a : a;
}

inline bool IsFinite(const Vec3& a)
{
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// Whether a can be normalized: neither zero, nor so long that its length overflows.
inline bool HasDirection(const Vec3& a)
{
  const double n = Norm(a);
  return n > 0 && std::isfinite(n);
}
}
#endif
