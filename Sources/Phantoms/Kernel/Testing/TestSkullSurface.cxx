// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCounterNoise.h"
#include "lacunaSkull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using lacuna::SkullSurface;
using lacuna::Vec3;

namespace
{
const lacuna::CounterNoise Noise(1996, 0);

Vec3 RandomDirection(int i)
{
  return lacuna::Normalized(
    { Noise.Normal(3 * i), Noise.Normal(3 * i + 1), Noise.Normal(3 * i + 2) });
}

// Directions on a Fibonacci lattice: even cover of the sphere.
Vec3 Lattice(int i, int n)
{
  const double z = 1 - (2 * i + 1.0) / n;
  const double r = std::sqrt(1 - z * z);
  const double a = i * 2.399963229728653;
  return { r * std::cos(a), r * std::sin(a), z };
}
}

TEST(SkullSurface, HasTheSizeOfAHead)
{
  Vec3 low{ 0, 0, 0 };
  Vec3 high{ 0, 0, 0 };
  double least = 1e9;
  double most = 0;
  double slope = 0;
  constexpr int N = 400000;
  for (int i = 0; i < N; ++i)
  {
    const Vec3 n = Lattice(i, N);
    const double r = SkullSurface::Radius(n);
    least = std::min(least, r);
    most = std::max(most, r);
    for (int a = 0; a < 3; ++a)
    {
      low[a] = std::min(low[a], r * n[a]);
      high[a] = std::max(high[a], r * n[a]);
    }
    Vec3 gradient;
    SkullSurface::Implicit(r * n, &gradient);
    slope = std::max(slope, Norm(gradient));
  }
  EXPECT_NEAR(high[0] - low[0], 145, 3); // breadth
  EXPECT_NEAR(high[1] - low[1], 180, 3); // length
  EXPECT_GT(high[2], 62);                // vertex above the centre
  EXPECT_GT(least, SkullSurface::MinimumRadius);
  EXPECT_LT(most, SkullSurface::MaximumRadius);
  EXPECT_LT(slope, SkullSurface::MaximumSlope);
}

TEST(SkullSurface, GradientsAgreeWithDifferences)
{
  for (int i = 0; i < 3000; ++i)
  {
    // Near the bump now and then, where it is steepest.
    const Vec3 p = (i % 3 ? 40 + 80 * Noise.Uniform(90000 + i) : 95) *
      (i % 3 ? RandomDirection(i)
             : lacuna::Normalized(Vec3{ 0.42, -0.80, 0.43 } + 0.1 * RandomDirection(i)));
    Vec3 gradient;
    SkullSurface::Implicit(p, &gradient);
    for (int a = 0; a < 3; ++a)
    {
      constexpr double H = 1e-4;
      Vec3 e{ 0, 0, 0 };
      e[a] = H;
      const double difference =
        (SkullSurface::Implicit(p + e) - SkullSurface::Implicit(p - e)) / (2 * H);
      EXPECT_NEAR(gradient[a], difference, 1e-7);
    }
  }
  EXPECT_LT(SkullSurface::Implicit({ 0, 0, 0 }), -59);
}

// Points built from a surface point and its normal: the distance must come back.
TEST(SkullSurface, SignedDistanceIsExact)
{
  for (int i = 0; i < 20000; ++i)
  {
    const Vec3 n = i % 4
      ? RandomDirection(i)
      : lacuna::Normalized(Vec3{ 0.42, -0.80, 0.43 } + 0.15 * RandomDirection(i));
    const Vec3 surface = SkullSurface::Radius(n) * n;
    Vec3 gradient;
    SkullSurface::Implicit(surface, &gradient);
    const double distance = -10 + 20 * Noise.Uniform(200000 + i);
    Vec3 foot;
    Vec3 normal;
    const double found =
      SkullSurface::SignedDistance(surface + distance * Normalized(gradient), foot, normal);
    EXPECT_NEAR(found, distance, 1e-11);
    EXPECT_NEAR(Norm(foot - surface), 0, 1e-6);
    EXPECT_NEAR(Dot(normal, gradient) / Norm(gradient), 1, 1e-12);
  }
}

// The bound that the skull uses to skip voxels far from the bone, and that rays use to step.
TEST(SkullSurface, ImplicitValueBoundsTheDistance)
{
  for (int i = 0; i < 20000; ++i)
  {
    const Vec3 n = i % 4
      ? RandomDirection(i)
      : lacuna::Normalized(Vec3{ 0.42, -0.80, 0.43 } + 0.15 * RandomDirection(i));
    const double offset = -15 + 27 * Noise.Uniform(300000 + i);
    const Vec3 p = (SkullSurface::Radius(n) + offset) * n;
    Vec3 foot;
    Vec3 normal;
    const double distance = SkullSurface::SignedDistance(p, foot, normal);
    EXPECT_LE(std::abs(distance), std::abs(offset) + 1e-9);
    EXPECT_GE(std::abs(distance),
      std::abs(offset) / (offset > 0 ? SkullSurface::MaximumSlope : 1.5) - 1e-9);
  }
}

TEST(SkullSurface, IntersectionsLieOnTheSurfaceAndAreTheFirst)
{
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 8000; ++i)
  {
    const Vec3 origin = (10 + 250 * Noise.Uniform(400000 + i)) * RandomDirection(2 * i);
    const Vec3 target = 110 * RandomDirection(2 * i + 1);
    const Vec3 direction = 3.7 * (target - origin); // any length
    const double t = SkullSurface::Intersect(origin, direction);
    const Vec3 unit = Normalized(direction);
    const double side = SkullSurface::Implicit(origin);
    // Brute force: sides along the ray at a step of 0.1 mm.
    double first = -1;
    double closest = 1e9;
    for (double s = 0; s < 480 && first < 0; s += 0.1)
    {
      const double value = SkullSurface::Implicit(origin + s * unit);
      closest = std::min(closest, std::abs(value));
      if (value * side < 0)
      {
        first = s;
      }
    }
    if (std::isnan(t))
    {
      ++misses;
      EXPECT_LT(first, 0);
      continue;
    }
    ++hits;
    EXPECT_NEAR(SkullSurface::Implicit(origin + t * unit), 0, 1e-10);
    if (first >= 0)
    {
      EXPECT_LE(t, first + 1e-9);
      EXPECT_TRUE(t >= first - 0.1 - 1e-9 || closest < 1e-3); // grazing
    }
    else
    {
      EXPECT_LT(closest, 1e-3); // a dip that the brute force stepped over
    }
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(misses, 200);
}

// A ray built to graze: it must hit just below the tangent and miss just above it.
TEST(SkullSurface, GrazingRays)
{
  for (int i = 0; i < 500; ++i)
  {
    const Vec3 n = RandomDirection(i);
    const Vec3 surface = SkullSurface::Radius(n) * n;
    Vec3 gradient;
    SkullSurface::Implicit(surface, &gradient);
    const Vec3 normal = Normalized(gradient);
    if (Dot(n, { 0.46, -0.76, 0.46 }) > 0.9)
    {
      continue; // around the bump the surface is not convex: a tangent may cut it elsewhere
    }
    const Vec3 along = Normalized(Cross(normal, RandomDirection(i + 1000)));
    const double hit = SkullSurface::Intersect(surface - 1e-5 * normal - 200.0 * along, along);
    EXPECT_NEAR(hit, 200, 0.1) << i;
    EXPECT_TRUE(std::isnan(SkullSurface::Intersect(surface + 1e-5 * normal - 200.0 * along, along)))
      << i;
  }
}

TEST(SkullSurface, OddRaysHaveAnAnswer)
{
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 0, 0, 200 }, { 0, 0, 0 })));
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 0, nan, 200 }, { 0, 0, -1 })));
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 0, 0, 200 }, { 0, nan, -1 })));
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 0, 0, 200 }, { 0, 0, HUGE_VAL })));
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 0, 0, 200 }, { 0, 0, 1 })));
  EXPECT_TRUE(std::isnan(SkullSurface::Intersect({ 1e15, 0, 0 }, { 0, 0, 1 })));
  const double top = SkullSurface::Radius({ 0, 0, 1 });
  EXPECT_NEAR(SkullSurface::Intersect({ 0, 0, 200 }, { 0, 0, -1 }), 200 - top, 1e-9);
  EXPECT_NEAR(SkullSurface::Intersect({ 0, 0, 0 }, { 0, 0, 1 }), top, 1e-9);
  EXPECT_NEAR(SkullSurface::Intersect({ 0, 0, -1 }, { 0, 0, 5 }), top + 1, 1e-9);
}

TEST(SkullSurface, LeftDiffersFromRight)
{
  // The bump on the left forehead, and a left half that is larger.
  const Vec3 left = lacuna::Normalized({ 0.42, -0.80, 0.43 });
  const Vec3 right{ -left[0], left[1], left[2] };
  EXPECT_GT(SkullSurface::Radius(left) - SkullSurface::Radius(right), 2);
  EXPECT_GT(SkullSurface::Radius({ 1, 0, 0 }) - SkullSurface::Radius({ -1, 0, 0 }), 0.5);
  for (int axis = 0; axis < 3; ++axis)
  {
    double mean = 0;
    for (int i = 0; i < 2000; ++i)
    {
      const Vec3 n = Lattice(i, 2000);
      Vec3 m = n;
      m[axis] = -n[axis];
      mean += std::abs(SkullSurface::Radius(n) - SkullSurface::Radius(m)) / 2000;
    }
    EXPECT_GT(mean, 0.3) << axis;
  }
}
