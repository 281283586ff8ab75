// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTensorCell.h"

#include "lacunaWide.h"

namespace lacuna
{
namespace
{
/// Weights of the control points in the field's polar form at (r, s, t): its values at the
/// arguments' permutations of two ends are the Bernstein coefficients between them.
inline void PolarWeights(
  double r, double s, double t, double& w0, double& w1, double& w2, double& w3)
{
  // de Boor's scheme for knots -2, -1, 0, 1, 2, 3
  constexpr double third = 1.0 / 3;
  const double b0 = 0.5 * (1 - s) * (1 - t);
  const double b1 = 0.5 * ((1 + s) * (1 - t) + (2 - s) * t);
  const double b2 = 0.5 * s * t;
  w0 = third * (1 - r) * b0;
  w1 = third * ((2 + r) * b0 + (2 - r) * b1);
  w2 = third * ((1 + r) * b1 + (3 - r) * b2);
  w3 = third * r * b2;
}

template <int S>
struct Basis;

template <>
struct Basis<4>
{
  static void Value(double x, double w[4]) { PolarWeights(x, x, x, w[0], w[1], w[2], w[3]); }
  static void Slope(double x, double w[4])
  {
    const double y = 1 - x;
    w[0] = -0.5 * y * y;
    w[1] = x * (1.5 * x - 2);
    w[2] = 0.5 + x * (1 - 1.5 * x);
    w[3] = 0.5 * x * x;
  }
  /// w[i][m]: scaled Bernstein coefficient m of weight i on x0..x1.
  static void Bernstein(double x0, double x1, double w[4][4])
  {
    const double r[4] = { x0, x0, x0, x1 };
    const double s[4] = { x0, x0, x1, x1 };
    const double t[4] = { x0, x1, x1, x1 };
    constexpr double binomial[4] = { 1, 3, 3, 1 };
    for (int m = 0; m < 4; ++m)
    {
      PolarWeights(r[m], s[m], t[m], w[0][m], w[1][m], w[2][m], w[3][m]);
    }
    for (int i = 0; i < 4; ++i)
    {
      for (int m = 0; m < 4; ++m)
      {
        w[i][m] *= binomial[m];
      }
    }
  }
};

template <>
struct Basis<2>
{
  static void Value(double x, double w[2])
  {
    w[0] = 1 - x;
    w[1] = x;
  }
  static void Slope(double, double w[2])
  {
    w[0] = -1;
    w[1] = 1;
  }
  static void Bernstein(double x0, double x1, double w[2][2])
  {
    w[0][0] = 1 - x0;
    w[0][1] = 1 - x1;
    w[1][0] = x0;
    w[1][1] = x1;
  }
};

/// The points contracted with constant weights along two axes: those of the third remain.
/// Strides are those of the axes u and v to contract and of w to keep.
template <int S>
void ContractTwo(
  const double* points, int u, int v, int w, const double* wu, const double* wv, double* rest)
{
  for (int c = 0; c < S; ++c)
  {
    double sum = 0;
    for (int b = 0; b < S; ++b)
    {
      double row = 0;
      for (int a = 0; a < S; ++a)
      {
        row += wu[a] * points[a * u + b * v + c * w];
      }
      sum += wv[b] * row;
    }
    rest[c] = sum;
  }
}

/// A line along one axis only: degree S - 1.
template <int S>
ScaledBernstein AlongAxis(const double* points, int axis, const Vec3& from, const Vec3& to)
{
  constexpr int strides[3] = { 1, S, S * S };
  const int a = axis == 0 ? 1 : 0;
  const int b = axis == 2 ? 1 : 2;
  double wa[S];
  double wb[S];
  Basis<S>::Value(from[a], wa);
  Basis<S>::Value(from[b], wb);
  double rest[S];
  ContractTwo<S>(points, strides[a], strides[b], strides[axis], wa, wb, rest);
  double w[S][S];
  Basis<S>::Bernstein(from[axis], to[axis], w);
  ScaledBernstein p;
  p.Degree = S - 1;
  for (int i = 0; i < S; ++i)
  {
    for (int m = 0; m < S; ++m)
    {
      p.A[m] += rest[i] * w[i][m];
    }
  }
  return p;
}

LACUNA_WIDE void ComposeCubic(const double* points, const double (*wx)[4], const double (*wy)[4],
  const double (*wz)[4], double* result)
{
  alignas(32) double planes[4][8];
  for (int k = 0; k < 4; ++k)
  {
    alignas(32) double rows[4][4] = {};
    for (int j = 0; j < 4; ++j)
    {
      const double* p = &points[16 * k + 4 * j];
      for (int m = 0; m < 4; ++m)
      {
        rows[j][m] = p[0] * wx[0][m] + p[1] * wx[1][m] + p[2] * wx[2][m] + p[3] * wx[3][m];
      }
    }
    for (int m = 0; m < 8; ++m)
    {
      planes[k][m] = 0;
    }
    for (int n = 0; n < 4; ++n)
    {
      for (int m = 0; m < 4; ++m)
      {
        planes[k][m + n] += rows[0][m] * wy[0][n] + rows[1][m] * wy[1][n] + rows[2][m] * wy[2][n] +
          rows[3][m] * wy[3][n];
      }
    }
  }
  for (int m = 0; m < 12; ++m)
  {
    result[m] = 0;
  }
  for (int n = 0; n < 4; ++n)
  {
    for (int m = 0; m < 8; ++m)
    {
      result[m + n] += planes[0][m] * wz[0][n] + planes[1][m] * wz[1][n] + planes[2][m] * wz[2][n] +
        planes[3][m] * wz[3][n];
    }
  }
}

void ComposeLinear(const double* points, const double (*wx)[2], const double (*wy)[2],
  const double (*wz)[2], double* result)
{
  for (int k = 0; k < 2; ++k)
  {
    for (int j = 0; j < 2; ++j)
    {
      const double* p = &points[4 * k + 2 * j];
      for (int l = 0; l < 2; ++l)
      {
        const double x = p[0] * wx[0][l] + p[1] * wx[1][l];
        for (int m = 0; m < 2; ++m)
        {
          const double xy = x * wy[j][m];
          for (int n = 0; n < 2; ++n)
          {
            result[l + m + n] += xy * wz[k][n];
          }
        }
      }
    }
  }
}
}

template <int S>
ScaledBernstein TensorCell<S>::Along(const Vec3& from, const Vec3& to) const
{
  const bool moves[3] = { from[0] != to[0], from[1] != to[1], from[2] != to[2] };
  if (moves[0] + moves[1] + moves[2] <= 1)
  {
    return AlongAxis<S>(this->Points, moves[0] ? 0 : (moves[1] ? 1 : 2), from, to);
  }
  alignas(32) double w[3][S][S];
  for (int axis = 0; axis < 3; ++axis)
  {
    Basis<S>::Bernstein(from[axis], to[axis], w[axis]);
  }
  ScaledBernstein p;
  p.Degree = 3 * Degree;
  if constexpr (S == 4)
  {
    ComposeCubic(this->Points, w[0], w[1], w[2], p.A.data());
  }
  else
  {
    ComposeLinear(this->Points, w[0], w[1], w[2], p.A.data());
  }
  return p;
}

template <int S>
double TensorCell<S>::Value(const Vec3& at) const
{
  double w[3][S];
  for (int axis = 0; axis < 3; ++axis)
  {
    Basis<S>::Value(at[axis], w[axis]);
  }
  double rest[S];
  ContractTwo<S>(this->Points, 1, S, S * S, w[0], w[1], rest);
  double value = 0;
  for (int k = 0; k < S; ++k)
  {
    value += rest[k] * w[2][k];
  }
  return value;
}

template <int S>
Vec3 TensorCell<S>::Gradient(const Vec3& at) const
{
  double w[3][S];
  double d[3][S];
  for (int axis = 0; axis < 3; ++axis)
  {
    Basis<S>::Value(at[axis], w[axis]);
    Basis<S>::Slope(at[axis], d[axis]);
  }
  Vec3 gradient{ 0, 0, 0 };
  for (int k = 0; k < S; ++k)
  {
    double dx = 0;
    double dy = 0;
    double value = 0;
    for (int j = 0; j < S; ++j)
    {
      const double* p = this->Points + (S * k + j) * S;
      double row = 0;
      double slope = 0;
      for (int i = 0; i < S; ++i)
      {
        row += p[i] * w[0][i];
        slope += p[i] * d[0][i];
      }
      dx += slope * w[1][j];
      dy += row * d[1][j];
      value += row * w[1][j];
    }
    gradient[0] += dx * w[2][k];
    gradient[1] += dy * w[2][k];
    gradient[2] += value * d[2][k];
  }
  return gradient;
}

template struct TensorCell<2>;
template struct TensorCell<4>;
}
