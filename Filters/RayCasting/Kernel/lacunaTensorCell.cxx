// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTensorCell.h"

#include "lacunaWide.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr int Capacity = ScaledBernstein::MaximumDegree + 1;
// Intervals shorter than 2^-40 of a cell are a point: 1e-12 voxel.
constexpr int MaximumDepth = 40;
// Two or three do as a rule; a multiple root gets the rest from bisection.
constexpr int MaximumSteps = 40;

double Power(double x, int n)
{
  double power = 1;
  for (; n > 0; n >>= 1, x *= x)
  {
    if (n & 1)
    {
      power *= x;
    }
  }
  return power;
}

struct Jet
{
  double Value;
  double Slope;
  double HalfCurvature;
};

/// h(r) = sum a[i] r^i and its derivatives. Degree: 3 or 9. Estrin's scheme: short chains of
/// operations.
template <int Degree>
inline Jet Evaluate(const double* a, double r)
{
  const double r2 = r * r;
  if constexpr (Degree == 3)
  {
    return { (a[0] + a[1] * r) + (a[2] + a[3] * r) * r2, (a[1] + 2 * a[2] * r) + 3 * a[3] * r2,
      a[2] + 3 * a[3] * r };
  }
  else
  {
    const double r4 = r2 * r2;
    const double r8 = r4 * r4;
    const double low = (a[0] + a[1] * r) + (a[2] + a[3] * r) * r2;
    const double high = (a[4] + a[5] * r) + (a[6] + a[7] * r) * r2;
    const double slopeLow = (a[1] + 2 * a[2] * r) + (3 * a[3] + 4 * a[4] * r) * r2;
    const double slopeHigh = (5 * a[5] + 6 * a[6] * r) + (7 * a[7] + 8 * a[8] * r) * r2;
    const double curveLow = (a[2] + 3 * a[3] * r) + (6 * a[4] + 10 * a[5] * r) * r2;
    const double curveHigh = (15 * a[6] + 21 * a[7] * r) + (28 * a[8] + 36 * a[9] * r) * r2;
    return { (low + high * r4) + (a[8] + a[9] * r) * r8,
      (slopeLow + slopeHigh * r4) + 9 * a[9] * r8, curveLow + curveHigh * r4 };
  }
}

/// The root in 0 <= r <= 1 of h(r) = sum a[i] r^i, which has exactly one there; h(1) does not have
/// the sign class of a[0]. start: a guess.
template <int Degree>
double SolveMonotone(const double* a, double start)
{
  const bool startsNegative = a[0] < 0;
  double low = 0;
  double high = 1;
  double r = start;
  double last = 0;
  for (int iteration = 0; high - low > 1e-15; ++iteration)
  {
    if (iteration > MaximumSteps || !(r > low && r < high))
    {
      r = 0.5 * (low + high);
    }
    const Jet h = Evaluate<Degree>(a, r);
    ((h.Value < 0) == startsNegative ? low : high) = r;
    // Halley's step. One out of the bracket comes from a slope the wrong way: bisect then.
    const double next = r - h.Value * h.Slope / (h.Slope * h.Slope - h.Value * h.HalfCurvature);
    const double step = std::abs(next - r);
    // Steps shrink cubically: the next one is some step^4 / last^3 long. Where the slope vanishes
    // they are short, but Newton's are long.
    const double square = step * step;
    const double newton = std::abs(h.Value); // times the slope
    const double slope = std::abs(h.Slope);
    const bool close = newton <= 1e-9 * slope ||
      (step < 1e-2 && newton <= 2 * step * slope &&
        square * square <= 1e-13 * (last * last * last));
    if (close && next >= low && next <= high)
    {
      return next;
    }
    last = step;
    r = next;
  }
  return high;
}

/// Near the root: by the parabola through p at 0, 1/2 and 1. early: the root lies before 1/2.
double Guess(double at0, double atHalf, double at1, bool early)
{
  const double chord = early ? 0.5 * at0 / (at0 - atHalf) : 0.5 + 0.5 * atHalf / (atHalf - at1);
  const double slope = 4 * atHalf - 3 * at0 - at1;
  const double curvature = 2 * (at0 + at1) - 4 * atHalf;
  const double value = at0 + chord * (slope + chord * curvature);
  const double better = chord - value / (slope + 2 * chord * curvature);
  const double first = early ? 0 : 0.5;
  return better > first && better < first + 0.5 ? better : chord;
}

double SolveCubic(const ScaledBernstein& p)
{
  const double* b = p.A.data();
  const double atHalf = 0.125 * ((b[0] + b[1]) + (b[2] + b[3]));
  const double a[4] = { b[0], b[1] - 3 * b[0], (b[2] - 2 * b[1]) + 3 * b[0],
    (b[3] - b[2]) + (b[1] - b[0]) };
  return SolveMonotone<3>(a, Guess(b[0], atHalf, b[3], (atHalf < 0) != (b[0] < 0)));
}

double SolveOneChange(const ScaledBernstein& p)
{
  constexpr int degree = ScaledBernstein::MaximumDegree;
  const int n = p.Degree;
  if (n == 3)
  {
    return SolveCubic(p);
  }
  double atHalf = 0;
  double scale = 1;
  for (int i = 0; i <= n; ++i)
  {
    atHalf += p.A[i];
    scale *= i < n ? 0.5 : 1;
  }
  atHalf *= scale;
  const bool early = (atHalf < 0) != (p.A[0] < 0);
  const double start = Guess(p.A[0], atHalf, p.A[n], early);
  // With r = s / (1 - s), or its reciprocal, p becomes a plain polynomial on 0 <= r <= 1.
  double a[degree + 1];
  for (int i = 0; i <= degree; ++i)
  {
    a[i] = i <= n ? p.A[early ? i : n - i] : 0.0;
  }
  const double r = SolveMonotone<degree>(a, early ? start / (1 - start) : (1 - start) / start);
  return early ? r / (1 + r) : 1 / (1 + r);
}

/// Splits p at 1/2 by de Casteljau's scheme.
void Split(const ScaledBernstein& p, ScaledBernstein& left, ScaledBernstein& right)
{
  const int n = p.Degree;
  double binomial[Capacity];
  double b[Capacity];
  double c = 1;
  for (int i = 0; i <= n; ++i)
  {
    binomial[i] = c;
    b[i] = p.A[i] / c;
    c = c * (n - i) / (i + 1);
  }
  left.Degree = right.Degree = n;
  for (int k = 0; k <= n; ++k)
  {
    left.A[k] = b[0] * binomial[k];
    right.A[n - k] = b[n - k] * binomial[k];
    for (int i = 0; i < n - k; ++i)
    {
      b[i] = 0.5 * (b[i] + b[i + 1]);
    }
  }
}

/// The same over an interval of 0..1, left part first.
bool Search(
  const ScaledBernstein& p, bool startsNegative, double low, double width, int depth, double& s)
{
  const SignPattern pattern = ClassifySigns(p);
  if (pattern == SignPattern::AllNegative || pattern == SignPattern::NoneNegative)
  {
    if ((pattern == SignPattern::AllNegative) != startsNegative)
    {
      s = low; // rounding of the split moved a root from the left part's end to here
      return true;
    }
    return false;
  }
  if ((p.A[0] < 0) != startsNegative)
  {
    s = low;
    return true;
  }
  if (pattern == SignPattern::OneChange)
  {
    s = low + width * SolveOneChange(p);
    return true;
  }
  if (depth == MaximumDepth)
  {
    s = low + width;
    return (p.A[p.Degree] < 0) != startsNegative;
  }
  ScaledBernstein left;
  ScaledBernstein right;
  Split(p, left, right);
  return Search(left, startsNegative, low, 0.5 * width, depth + 1, s) ||
    Search(right, startsNegative, low + 0.5 * width, 0.5 * width, depth + 1, s);
}
}

double ScaledBernstein::Value(double s) const
{
  // Horner's scheme in the smaller of s/(1-s) and its reciprocal: all terms stay bounded.
  const int n = this->Degree;
  double value;
  if (s <= 0.5)
  {
    const double r = s / (1 - s);
    value = this->A[n];
    for (int i = n - 1; i >= 0; --i)
    {
      value = value * r + this->A[i];
    }
    return value * Power(1 - s, n);
  }
  const double r = (1 - s) / s;
  value = this->A[0];
  for (int i = 1; i <= n; ++i)
  {
    value = value * r + this->A[i];
  }
  return value * Power(s, n);
}

SignPattern ClassifySigns(const ScaledBernstein& p)
{
  int changes = 0;
  for (int i = 1; i <= p.Degree; ++i)
  {
    changes += (p.A[i] < 0) != (p.A[i - 1] < 0);
  }
  if (changes == 0)
  {
    return p.A[0] < 0 ? SignPattern::AllNegative : SignPattern::NoneNegative;
  }
  return changes == 1 ? SignPattern::OneChange : SignPattern::SeveralChanges;
}

bool FindFirstSignChange(const ScaledBernstein& p, double& s)
{
  return Search(p, p.A[0] < 0, 0, 1, 0, s);
}

//------------------------------------------------------------------------------
namespace
{
/// Weights of the control points in the field's polar form at (r, s, t): its values at the
/// arguments' permutations of two ends are the Bernstein coefficients between them.
template <class Real>
LACUNA_INLINE void PolarWeights(
  const Real& r, const Real& s, const Real& t, Real& w0, Real& w1, Real& w2, Real& w3)
{
  // de Boor's scheme for knots -2, -1, 0, 1, 2, 3
  constexpr double third = 1.0 / 3;
  const Real b0 = 0.5 * (1 - s) * (1 - t);
  const Real b1 = 0.5 * ((1 + s) * (1 - t) + (2 - s) * t);
  const Real b2 = 0.5 * s * t;
  w0 = third * (1 - r) * b0;
  w1 = third * ((2 + r) * b0 + (2 - r) * b1);
  w2 = third * ((1 + r) * b1 + (3 - r) * b2);
  w3 = third * r * b2;
}

/// Scaled Bernstein coefficients m of the weights i on x0..x1: w[i][m], all m side by side.
LACUNA_INLINE void CubicBernstein(double x0, double x1, Four* w)
{
  const Four r{ x0, x0, x0, x1 };
  const Four s{ x0, x0, x1, x1 };
  const Four t{ x0, x1, x1, x1 };
  const Four binomial{ 1, 3, 3, 1 };
  PolarWeights(r, s, t, w[0], w[1], w[2], w[3]);
  for (int i = 0; i < 4; ++i)
  {
    w[i] *= binomial;
  }
}

/// The same of four lines: w[i][m].
template <class Real>
LACUNA_INLINE void CubicBernstein(const Real& x0, const Real& x1, Real (*w)[4])
{
  const Real r[4] = { x0, x0, x0, x1 };
  const Real s[4] = { x0, x0, x1, x1 };
  const Real t[4] = { x0, x1, x1, x1 };
  constexpr double binomial[4] = { 1, 3, 3, 1 };
  for (int m = 0; m < 4; ++m)
  {
    PolarWeights(r[m], s[m], t[m], w[0][m], w[1][m], w[2][m], w[3][m]);
    for (int i = 0; i < 4; ++i)
    {
      w[i][m] *= binomial[m];
    }
  }
}

template <int S>
struct Basis;

template <>
struct Basis<4>
{
  template <class Real>
  LACUNA_INLINE static void Value(const Real& x, Real w[4])
  {
    PolarWeights(x, x, x, w[0], w[1], w[2], w[3]);
  }
  template <class Real>
  LACUNA_INLINE static void Slope(const Real& x, Real w[4])
  {
    const Real y = 1 - x;
    w[0] = -0.5 * y * y;
    w[1] = x * (1.5 * x - 2);
    w[2] = 0.5 + x * (1 - 1.5 * x);
    w[3] = 0.5 * x * x;
  }
  template <class Real>
  LACUNA_INLINE static void Bernstein(const Real& x0, const Real& x1, Real w[4][4])
  {
    CubicBernstein(x0, x1, w);
  }
};

template <>
struct Basis<2>
{
  template <class Real>
  LACUNA_INLINE static void Value(const Real& x, Real w[2])
  {
    w[0] = 1 - x;
    w[1] = x;
  }
  template <class Real>
  LACUNA_INLINE static void Bernstein(const Real& x0, const Real& x1, Real w[2][2])
  {
    w[0][0] = 1 - x0;
    w[0][1] = 1 - x1;
    w[1][0] = x0;
    w[1][1] = x1;
  }
};

/// The points contracted with constant weights along all axes but one; only the rows' loops, of
/// adjacent points, can become vector code.
template <int S>
LACUNA_INLINE void ContractAllBut(
  int axis, const double* points, const double (*w)[S], double* rest)
{
  if (axis == 0)
  {
    for (int i = 0; i < S; ++i)
    {
      rest[i] = 0;
    }
    for (int n = 0; n < S * S; ++n)
    {
      const double weight = w[1][n % S] * w[2][n / S];
      for (int i = 0; i < S; ++i)
      {
        rest[i] += weight * points[S * n + i];
      }
    }
    return;
  }
  const int step = axis == 1 ? S * S : S; // of the axis to contract besides x
  const int other = axis == 1 ? S : S * S;
  const double* weights = w[axis == 1 ? 2 : 1];
  for (int c = 0; c < S; ++c)
  {
    const double* p = points + other * c;
    double row[S];
    for (int i = 0; i < S; ++i)
    {
      row[i] = weights[0] * p[i] + weights[1] * p[i + step];
      if constexpr (S == 4)
      {
        row[i] += weights[S - 2] * p[i + 2 * step] + weights[S - 1] * p[i + 3 * step];
      }
    }
    rest[c] = w[0][0] * row[0] + w[0][1] * row[1];
    if constexpr (S == 4)
    {
      rest[c] += w[0][S - 2] * row[S - 2] + w[0][S - 1] * row[S - 1];
    }
  }
}

/// A line along one axis only: degree S - 1.
template <int S>
LACUNA_INLINE void AlongAxis(
  const double* points, int axis, const Vec3& from, const Vec3& to, double* result)
{
  double w[3][S];
  for (int a = 0; a < 3; ++a)
  {
    if (a != axis)
    {
      Basis<S>::Value(from[a], w[a]);
    }
  }
  double rest[S];
  ContractAllBut<S>(axis, points, w, rest);
  double b[S][S];
  Basis<S>::Bernstein(from[axis], to[axis], b);
  for (int m = 0; m < S; ++m)
  {
    result[m] = rest[0] * b[0][m] + rest[1] * b[1][m];
    if constexpr (S == 4)
    {
      result[m] += rest[S - 2] * b[S - 2][m] + rest[S - 1] * b[S - 1][m];
    }
  }
}

LACUNA_WIDE void CubicAlongAxis(
  const double* points, int axis, const Vec3& from, const Vec3& to, double* result)
{
  AlongAxis<4>(points, axis, from, to, result);
}

LACUNA_WIDE void ComposeCubic(
  const double* points, const Vec3& from, const Vec3& to, double* result)
{
  Four wx[4];
  Four wy[4];
  Four wz[4];
  CubicBernstein(from[0], to[0], wx);
  CubicBernstein(from[1], to[1], wy);
  CubicBernstein(from[2], to[2], wz);
  // along z and y for all points along x side by side: [coefficient][point]
  Four columns[7];
  for (int n = 0; n < 4; ++n)
  {
    Four rows[4];
    for (int j = 0; j < 4; ++j)
    {
      const double* p = points + 4 * j;
      rows[j] = LoadFour(p) * wz[0][n] + LoadFour(p + 16) * wz[1][n] + LoadFour(p + 32) * wz[2][n] +
        LoadFour(p + 48) * wz[3][n];
    }
    for (int m = 0; m < 4; ++m)
    {
      const Four sum =
        rows[0] * wy[0][m] + rows[1] * wy[1][m] + rows[2] * wy[2][m] + rows[3] * wy[3][m];
      columns[m + n] = n == 0 || m == 3 ? sum : columns[m + n] + sum;
    }
  }
  // along x for its coefficients side by side
  alignas(32) double products[7][4];
  for (int m = 0; m < 7; ++m)
  {
    const Four product =
      columns[m][0] * wx[0] + columns[m][1] * wx[1] + columns[m][2] * wx[2] + columns[m][3] * wx[3];
    for (int n = 0; n < 4; ++n)
    {
      products[m][n] = product[n];
    }
  }
  const auto p = products;
  result[0] = p[0][0];
  result[1] = p[1][0] + p[0][1];
  result[2] = p[2][0] + p[1][1] + p[0][2];
  for (int m = 3; m < 7; ++m)
  {
    result[m] = (p[m][0] + p[m - 1][1]) + (p[m - 2][2] + p[m - 3][3]);
  }
  result[7] = p[6][1] + p[5][2] + p[4][3];
  result[8] = p[6][2] + p[5][3];
  result[9] = p[6][3];
}

void ComposeLinear(const double* points, const double (*wx)[2], const double (*wy)[2],
  const double (*wz)[2], double* result)
{
  for (int m = 0; m < 4; ++m)
  {
    result[m] = 0;
  }
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
    const int axis = moves[0] ? 0 : (moves[1] ? 1 : 2);
    ScaledBernstein p;
    p.Degree = Degree;
    if constexpr (S == 4)
    {
      CubicAlongAxis(this->Points, axis, from, to, p.A.data());
    }
    else
    {
      AlongAxis<S>(this->Points, axis, from, to, p.A.data());
    }
    return p;
  }
  ScaledBernstein p;
  p.Degree = 3 * Degree;
  if constexpr (S == 4)
  {
    ComposeCubic(this->Points, from, to, p.A.data());
  }
  else
  {
    double w[3][S][S];
    for (int axis = 0; axis < 3; ++axis)
    {
      Basis<S>::Bernstein(from[axis], to[axis], w[axis]);
    }
    ComposeLinear(this->Points, w[0], w[1], w[2], p.A.data());
  }
  return p;
}

namespace
{
template <int S>
LACUNA_INLINE void FourAlongAxis(
  const double* points, int axis, const Four* from, const Four* to, Four* coefficients)
{
  const int steps[3] = { 1, S, S * S };
  const int u = axis == 0 ? 1 : 0;
  const int v = axis == 2 ? 1 : 2;
  Four wu[S];
  Four wv[S];
  Basis<S>::Value(from[u], wu);
  Basis<S>::Value(from[v], wv);
  Four b[S][S];
  Basis<S>::Bernstein(from[axis], to[axis], b);
  for (int c = 0; c < S; ++c)
  {
    Four rest{};
    for (int j = 0; j < S; ++j)
    {
      const double* p = points + c * steps[axis] + j * steps[v];
      Four row = p[0] * wu[0] + p[steps[u]] * wu[1];
      if constexpr (S == 4)
      {
        row += p[2 * steps[u]] * wu[S - 2] + p[3 * steps[u]] * wu[S - 1];
      }
      rest += row * wv[j];
    }
    for (int m = 0; m < S; ++m)
    {
      coefficients[m] = c == 0 ? rest * b[c][m] : coefficients[m] + rest * b[c][m];
    }
  }
}

LACUNA_WIDE void FourCubicAlongAxis(
  const double* points, int axis, const Four* from, const Four* to, Four* coefficients)
{
  FourAlongAxis<4>(points, axis, from, to, coefficients);
}

LACUNA_WIDE void FourLinearAlongAxis(
  const double* points, int axis, const Four* from, const Four* to, Four* coefficients)
{
  FourAlongAxis<2>(points, axis, from, to, coefficients);
}
}

template <int S>
void TensorCell<S>::FourAlong(int axis, const Four* from, const Four* to, Four* coefficients) const
{
  if constexpr (S == 4)
  {
    FourCubicAlongAxis(this->Points, axis, from, to, coefficients);
  }
  else
  {
    FourLinearAlongAxis(this->Points, axis, from, to, coefficients);
  }
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
  ContractAllBut<S>(2, this->Points, w, rest);
  double value = 0;
  for (int k = 0; k < S; ++k)
  {
    value += rest[k] * w[2][k];
  }
  return value;
}

namespace
{
LACUNA_WIDE void CubicGradient(const double* points, const Vec3& at, double* gradient)
{
  // weights of the axes side by side
  const Four x{ at[0], at[1], at[2], 0 };
  Four w[4];
  Four d[4];
  Basis<4>::Value(x, w);
  Basis<4>::Slope(x, d);
  // along y and z for all points along x side by side
  Four value;
  Four alongY;
  Four alongZ;
  for (int k = 0; k < 4; ++k)
  {
    const double* p = points + 16 * k;
    const Four p0 = LoadFour(p);
    const Four p1 = LoadFour(p + 4);
    const Four p2 = LoadFour(p + 8);
    const Four p3 = LoadFour(p + 12);
    const Four row = (p0 * w[0][1] + p1 * w[1][1]) + (p2 * w[2][1] + p3 * w[3][1]);
    const Four slope = (p0 * d[0][1] + p1 * d[1][1]) + (p2 * d[2][1] + p3 * d[3][1]);
    value = k == 0 ? row * w[k][2] : value + row * w[k][2];
    alongY = k == 0 ? slope * w[k][2] : alongY + slope * w[k][2];
    alongZ = k == 0 ? row * d[k][2] : alongZ + row * d[k][2];
  }
  gradient[0] =
    (value[0] * d[0][0] + value[1] * d[1][0]) + (value[2] * d[2][0] + value[3] * d[3][0]);
  gradient[1] =
    (alongY[0] * w[0][0] + alongY[1] * w[1][0]) + (alongY[2] * w[2][0] + alongY[3] * w[3][0]);
  gradient[2] =
    (alongZ[0] * w[0][0] + alongZ[1] * w[1][0]) + (alongZ[2] * w[2][0] + alongZ[3] * w[3][0]);
}

void LinearGradient(const double* points, const Vec3& at, double* gradient)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const int u = axis == 0 ? 1 : 0;
    const int v = axis == 2 ? 1 : 2;
    gradient[axis] = 0;
    for (int n = 0; n < 4; ++n)
    {
      const double* p = points + ((n & 1) << u) + ((n >> 1) << v);
      gradient[axis] +=
        (n & 1 ? at[u] : 1 - at[u]) * (n >> 1 ? at[v] : 1 - at[v]) * (p[1 << axis] - p[0]);
    }
  }
}
}

template <int S>
Vec3 TensorCell<S>::Gradient(const Vec3& at) const
{
  Vec3 gradient;
  if constexpr (S == 4)
  {
    CubicGradient(this->Points, at, gradient.data());
  }
  else
  {
    LinearGradient(this->Points, at, gradient.data());
  }
  return gradient;
}

template struct TensorCell<2>;
template struct TensorCell<4>;
}
