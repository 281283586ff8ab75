// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBernstein.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr int Capacity = ScaledBernstein::MaximumDegree + 1;
// Intervals shorter than 2^-40 of a cell are a point: 1e-12 voxel.
constexpr int MaximumDepth = 40;
// Quadratic convergence needs five or so; a multiple root gets the rest from bisection.
constexpr int MaximumNewtonSteps = 40;

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

/// h(r) = sum a[i] r^i, and its slope. Degree: 3 or 9. Estrin's scheme: short chains of operations.
template <int Degree>
inline double ValueAndSlope(const double* a, double r, double& slope)
{
  const double r2 = r * r;
  if (Degree == 3)
  {
    slope = (a[1] + 2 * a[2] * r) + 3 * a[3] * r2;
    return (a[0] + a[1] * r) + (a[2] + a[3] * r) * r2;
  }
  const double r4 = r2 * r2;
  const double r8 = r4 * r4;
  const double low = (a[0] + a[1] * r) + (a[2] + a[3] * r) * r2;
  const double high = (a[4] + a[5] * r) + (a[6] + a[7] * r) * r2;
  const double slopeLow = (a[1] + 2 * a[2] * r) + (3 * a[3] + 4 * a[4] * r) * r2;
  const double slopeHigh = (5 * a[5] + 6 * a[6] * r) + (7 * a[7] + 8 * a[8] * r) * r2;
  slope = (slopeLow + slopeHigh * r4) + 9 * a[9] * r8;
  return (low + high * r4) + (a[8] + a[9] * r) * r8;
}

/// The root in 0 <= r <= 1 of h(r) = sum a[i] r^i, which has one sign change in its coefficients
/// and so exactly one positive root; h(1) does not have the sign class of a[0]. start: a guess.
template <int Degree>
double SolveMonotone(const double* a, double start)
{
  const bool startsNegative = a[0] < 0;
  double low = 0;
  double high = 1;
  double r = start;
  for (int iteration = 0; high - low > 1e-15; ++iteration)
  {
    if (iteration > MaximumNewtonSteps || !(r > low && r < high))
    {
      r = 0.5 * (low + high);
    }
    double slope;
    const double value = ValueAndSlope<Degree>(a, r, slope);
    ((value < 0) == startsNegative ? low : high) = r;
    // A step out of the bracket comes from a slope the wrong way, near r = 0: bisect then.
    const double next = r - value / slope;
    if (std::abs(next - r) <= 1e-9 && next >= low && next <= high)
    {
      return next;
    }
    r = next;
  }
  return high;
}

/// Where the control polygon of p crosses zero, 0 < s < 1: a root is near.
double ZeroOfPolygon(const ScaledBernstein& p)
{
  const int n = p.Degree;
  int i = 1;
  while (i < n && (p.A[i] < 0) == (p.A[0] < 0))
  {
    ++i;
  }
  // A[i - 1] / (n over i - 1) and A[i] / (n over i), both times (n over i) i
  const double last = p.A[i - 1] * (n - i + 1);
  const double next = p.A[i] * i;
  return (i - 1 + last / (last - next)) / n;
}

template <int Degree>
double SolveOneChange(const ScaledBernstein& p)
{
  const int n = p.Degree;
  double atHalf = 0;
  for (int i = 0; i <= n; ++i)
  {
    atHalf += p.A[i];
  }
  const double start = ZeroOfPolygon(p);
  // With r = s / (1 - s), or its reciprocal, p becomes a plain polynomial on 0 <= r <= 1.
  if ((atHalf < 0) != (p.A[0] < 0))
  {
    const double r = SolveMonotone<Degree>(p.A.data(), start / (1 - start));
    return r / (1 + r);
  }
  double reversed[Capacity] = {};
  std::reverse_copy(p.A.begin(), p.A.begin() + n + 1, reversed);
  const double r = SolveMonotone<Degree>(reversed, (1 - start) / start);
  return 1 / (1 + r);
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
    s = low + width * (p.Degree <= 3 ? SolveOneChange<3>(p) : SolveOneChange<9>(p));
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
}
