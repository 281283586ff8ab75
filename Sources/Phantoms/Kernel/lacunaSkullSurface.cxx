// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
constexpr Vec3 InverseSquares{ { 1 / (71.5 * 71.5), 1 / (90.0 * 90.0), 1 / (66.0 * 66.0) } };
// The bump: height in mm, sharpness (squared ratio of skull radius to bump radius), direction.
constexpr double BumpHeight = 2.5;
constexpr double BumpSharpness = 180;
const Vec3 BumpDirection = Normalized({ 0.42, -0.80, 0.43 });
// Below this radius the direction means nothing; it is far from any surface.
constexpr double TinyRadius = 1e-9;

// R at a unit vector n and, where gradient is not null, the gradient of its extension off the
// sphere (the caller projects it onto the tangent plane).
double RadiusAndGradient(const Vec3& n, Vec3* gradient)
{
  const double x = n[0];
  const double y = n[1];
  const double z = n[2];
  const double square =
    x * x * InverseSquares[0] + y * y * InverseSquares[1] + z * z * InverseSquares[2];
  const double ellipsoid = 1 / std::sqrt(square);
  const double shape = 1 + 0.09 * y * x * x - 0.05 * y * z + 0.05 * z * z * z +
    0.04 * x * x * z * z + 0.012 * x * y + 0.006 * x;
  const double bump = BumpHeight * std::exp(BumpSharpness * (Dot(n, BumpDirection) - 1));
  if (gradient)
  {
    const double e = -ellipsoid * ellipsoid * ellipsoid * shape;
    const double b = BumpSharpness * bump;
    *gradient = { e * x * InverseSquares[0] + b * BumpDirection[0] +
        ellipsoid * (0.18 * x * y + 0.08 * x * z * z + 0.012 * y + 0.006),
      e * y * InverseSquares[1] + b * BumpDirection[1] +
        ellipsoid * (0.09 * x * x - 0.05 * z + 0.012 * x),
      e * z * InverseSquares[2] + b * BumpDirection[2] +
        ellipsoid * (-0.05 * y + 0.15 * z * z + 0.08 * x * x * z) };
  }
  return ellipsoid * shape + bump;
}
}

double SkullSurface::Radius(const Vec3& direction)
{
  return RadiusAndGradient(direction, nullptr);
}

double SkullSurface::Implicit(const Vec3& point, Vec3* gradient)
{
  const double r = Norm(point);
  if (r < TinyRadius)
  {
    if (gradient)
    {
      *gradient = { 0, 0, 0 };
    }
    return -MinimumRadius;
  }
  const Vec3 n = (1 / r) * point;
  if (!gradient)
  {
    return r - RadiusAndGradient(n, nullptr);
  }
  Vec3 g;
  const double radius = RadiusAndGradient(n, &g);
  *gradient = n - (1 / r) * (g - Dot(g, n) * n);
  return r - radius;
}

double SkullSurface::SignedDistance(const Vec3& point, Vec3& foot, Vec3& normal)
{
  constexpr double Tolerance = 1e-7;
  constexpr int MaximumIterations = 200;
  const double side = Implicit(point) < 0 ? -1 : 1;
  const auto project = [](const Vec3& p)
  {
    const Vec3 n = Normalized(p);
    return RadiusAndGradient(n, nullptr) * n;
  };
  foot = project(point);
  for (int i = 0; i < MaximumIterations; ++i)
  {
    Vec3 gradient;
    Implicit(foot, &gradient);
    normal = Normalized(gradient);
    const Vec3 offset = point - foot;
    const Vec3 tangential = offset - Dot(offset, normal) * normal;
    if (Norm(tangential) < Tolerance)
    {
      break;
    }
    foot = project(foot + tangential);
  }
  return side * Norm(point - foot);
}

double SkullSurface::Intersect(const Vec3& origin, const Vec3& direction)
{
  constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();
  constexpr double SmallestStep = 1e-4;
  const double length = Norm(direction);
  if (!IsFinite(origin) || !std::isfinite(length) || !(length > 0))
  {
    return Nothing;
  }
  const Vec3 unit = (1 / length) * direction;
  // The part of the ray within the circumscribed sphere.
  const double b = -Dot(origin, unit);
  const Vec3 nearest = origin + b * unit;
  const double half = MaximumRadius * MaximumRadius - Dot(nearest, nearest);
  if (!(half > 0) || b + std::sqrt(half) < 0)
  {
    return Nothing;
  }
  const double last = b + std::sqrt(half);
  double t = std::max(0.0, b - std::sqrt(half));
  const auto implicit = [&](double s) { return Implicit(origin + s * unit); };
  double value = implicit(t);
  // Outside, a distance is at least value / MaximumSlope; inside, the sphere of MinimumRadius is
  // free, and between it and the surface the slope is below 2 MaximumSlope.
  const auto safeStep = [&](double s, double v)
  {
    if (v > 0)
    {
      return std::max(SmallestStep, v / MaximumSlope);
    }
    const double free = MinimumRadius - Norm(origin + s * unit);
    return std::max({ SmallestStep, free, -v / (2 * MaximumSlope) });
  };
  if (value == 0)
  {
    return t;
  }
  const bool inside = value < 0;
  double next = t;
  double nextValue = value;
  do
  {
    t = next;
    value = nextValue;
    if (t > last)
    {
      return Nothing;
    }
    next = t + safeStep(t, value);
    nextValue = implicit(next);
  } while ((nextValue < 0) == inside);

  // The crossing lies between t and next: bisection cannot fail, and 60 halvings reach rounding.
  for (int i = 0; i < 60 && next - t > 1e-13 * std::max(1.0, next); ++i)
  {
    const double middle = 0.5 * (t + next);
    if ((implicit(middle) < 0) == inside)
    {
      t = middle;
    }
    else
    {
      next = middle;
    }
  }
  return 0.5 * (t + next);
}
}
