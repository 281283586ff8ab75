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
}
