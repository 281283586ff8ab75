// SPDX-License-Identifier: BSD-3-Clause
/// Solid a hundredth of a voxel thick: iso-values just below a crest of the field, against fine
/// brute-force scans with certificates. About a sample a field cannot rise by more than the
/// greatest slope times the distance; so a scan certifies intervals in which there is nothing.
#include "lacunaSplineFilter.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace
{
using namespace lacuna;

/// Noise, and a field of it by its definition.
struct Noise
{
  TestField Field;   ///< what the caster gets
  TestField Control; ///< the control points of the oracle
  FieldInterpolation Interpolation;
  double GreatestSlope = 0; ///< a bound, per voxel

  Noise(std::mt19937& random, const std::array<int, 3>& size, FieldInterpolation interpolation)
    : Field(
        size, Matrix4(), [&](const Vec3&) { return std::normal_distribution<double>()(random); })
    , Control(Field)
    , Interpolation(interpolation)
  {
    if (interpolation == FieldInterpolation::InterpolatingBSpline)
    {
      ThreadExecution execution(1);
      const SplineCoefficients c = FilterToCoefficients(this->Field.View(), true, execution);
      std::copy(c.Values.begin(), c.Values.end(), this->Control.Voxels.begin());
    }
    // Derivatives are convex combinations of differences of neighbouring control points, those
    // beyond the border included.
    Vec3 greatest{ 0, 0, 0 };
    for (int k = -1; k < size[2]; ++k)
    {
      for (int j = -1; j < size[1]; ++j)
      {
        for (int i = -1; i < size[0]; ++i)
        {
          const double v = this->Control.Control(i, j, k);
          const double steps[3] = { this->Control.Control(i + 1, j, k) - v,
            this->Control.Control(i, j + 1, k) - v, this->Control.Control(i, j, k + 1) - v };
          for (int a = 0; a < 3; ++a)
          {
            greatest[a] = std::max(greatest[a], std::abs(steps[a]));
          }
        }
      }
    }
    this->GreatestSlope = Norm(greatest);
  }

  double operator()(const Vec3& p) const
  {
    return this->Interpolation == FieldInterpolation::Trilinear ? this->Control.Trilinear(p)
                                                                : this->Control.BSpline(p);
  }

  bool Holds(const Vec3& p) const
  {
    bool holds = true;
    for (int a = 0; a < 3; ++a)
    {
      holds = holds && p[a] >= 0 && p[a] <= this->Field.Size[a] - 1;
    }
    return holds;
  }
};

/// Whether certainly nothing of the ray from t0 to t1 reaches the iso-value: intervals are halved
/// until the bound of the slope excludes them.
bool IsBelow(const Noise& noise, const Vec3& origin, const Vec3& direction, double t0, double t1,
  double isoValue, int depth = 0)
{
  const double middle = 0.5 * (t0 + t1);
  const double rise = noise.GreatestSlope * 0.5 * (t1 - t0);
  if (noise(origin + middle * direction) + rise < isoValue)
  {
    return true;
  }
  return depth < 14 && IsBelow(noise, origin, direction, t0, middle, isoValue, depth + 1) &&
    IsBelow(noise, origin, direction, middle, t1, isoValue, depth + 1);
}

/// The greatest value between t0 and t1, by a grid and a search about its best point.
double FindCrest(
  const Noise& noise, const Vec3& origin, const Vec3& direction, double t0, double t1)
{
  constexpr double step = 0.01;
  double best = t0;
  double value = -1e300;
  for (double t = t0; t < t1; t += step)
  {
    const double v = noise(origin + t * direction);
    if (v > value)
    {
      value = v;
      best = t;
    }
  }
  double low = std::max(t0, best - step);
  double high = std::min(t1, best + step);
  for (int i = 0; i < 80; ++i)
  {
    const double a = low + (high - low) / 3;
    const double b = high - (high - low) / 3;
    const bool rises = noise(origin + a * direction) < noise(origin + b * direction);
    (rises ? low : high) = rises ? a : b;
  }
  return 0.5 * (low + high);
}

constexpr FieldInterpolation AllInterpolations[] = { FieldInterpolation::BSpline,
  FieldInterpolation::InterpolatingBSpline, FieldInterpolation::Trilinear };

/// A map of one ray; the eye may be null.
bool CastPixel(const IsoRayCaster& caster, const Vec3& origin, const Vec3& direction,
  const Vec3& up, const Vec3* eye, double isoValue, double& depth)
{
  ViewSettings view;
  view.Direction = direction;
  view.Up = up;
  view.HasFocalPoint = view.HasPlaneOrigin = true;
  view.FocalPoint = view.PlaneOrigin = origin;
  view.Size = { 1, 1 };
  view.PixelSpacing = 1;
  const ImagePlane plane = MakeImagePlane(Matrix4(), { 12, 11, 10 }, view);
  ThreadExecution execution(1);
  RayRequest request;
  request.Eye = eye;
  char valid = 0;
  caster.Cast(plane, isoValue, { { 0, 0, 0, 0 }, &depth, &valid, nullptr }, request, execution);
  return valid != 0;
}
}

TEST(ThinCrests, AreNotMissed)
{
  std::mt19937 random(77);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const FieldInterpolation interpolation : AllInterpolations)
  {
    int certified = 0;
    for (int volume = 0; volume < 6; ++volume)
    {
      const Noise noise(random, { 12, 11, 10 }, interpolation);
      ThreadExecution execution(1);
      const IsoRayCaster caster(noise.Field.View(), interpolation, SolidSide::Above, execution);
      for (int trial = 0; trial < 60; ++trial)
      {
        const Vec3 direction = RandomUnit(random);
        const Vec3 through{ 11 * uniform(random), 10 * uniform(random), 9 * uniform(random) };
        const Vec3 origin = through - 30 * direction;
        double t0 = 30;
        double t1 = 30;
        for (; noise.Holds(origin + (t0 - 0.01) * direction); t0 -= 0.01)
        {
        }
        for (; noise.Holds(origin + (t1 + 0.01) * direction); t1 += 0.01)
        {
        }
        if (t1 - t0 < 1)
        {
          continue;
        }
        const double crest = FindCrest(noise, origin, direction, t0, t1);
        const auto value = [&](double t) { return noise(origin + t * direction); };
        if (crest < t0 + 0.11 || crest > t1 - 0.11)
        {
          continue; // at the border
        }
        const double top = value(crest);
        const double isoValue = std::max(value(crest - 0.005), value(crest + 0.005));
        if (!(isoValue < top - 1e-8) ||
          !IsBelow(noise, origin, direction, t0 - 0.01, crest - 0.1, isoValue) ||
          !IsBelow(noise, origin, direction, crest + 0.1, t1 + 0.01, isoValue))
        {
          continue; // another crest is as high, or a step
        }
        ++certified;
        RayHit hit;
        ASSERT_TRUE(caster.CastRay(origin, direction, isoValue, hit)) << trial;
        ASSERT_NEAR(hit.Distance, crest, 0.0111) << trial;
        ASSERT_LE(hit.Distance, crest) << "the near side of the crest";
        ASSERT_NEAR(value(hit.Distance), isoValue, 1e-11) << trial;
        ASSERT_FALSE(caster.CastRay(origin, direction, top + 1e-9, hit)) << trial;
        // and the rays of maps, which are cast in another way
        const Vec3 up = RandomUnit(random);
        const Vec3 eye = origin - 5 * direction;
        for (const Vec3* seenFrom : { static_cast<const Vec3*>(nullptr), &eye })
        {
          double depth;
          ASSERT_TRUE(CastPixel(caster, origin, direction, up, seenFrom, isoValue, depth)) << trial;
          // the rays differ by rounding, which moves a hit on a crest by its root
          ASSERT_NEAR(depth, hit.Distance, 1e-5) << trial;
          ASSERT_FALSE(CastPixel(caster, origin, direction, up, seenFrom, top + 1e-9, depth));
        }
      }
    }
    EXPECT_GT(certified, 80);
    std::printf("%d crests\n", certified);
  }
}

/// Many rays on a blob a hundredth of a voxel wide, somewhere in the volume, also at its border.
TEST(ThinCrests, BlobsAreSeenByAllTheirRays)
{
  std::mt19937 random(78);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr int pixels = 10;
  for (const FieldInterpolation interpolation : AllInterpolations)
  {
    int hits = 0;
    int misses = 0;
    for (int trial = 0; trial < 16; ++trial)
    {
      const Noise noise(random, { 8, 7, 9 }, interpolation);
      ThreadExecution execution(1);
      const IsoRayCaster caster(noise.Field.View(), interpolation, SolidSide::Above, execution);
      // uphill to a crest of the field, by a search that needs no derivatives
      Vec3 peak{ 7 * uniform(random), 6 * uniform(random), 8 * uniform(random) };
      for (double step = 0.5; step > 1e-9;)
      {
        const Vec3 next = peak + step * RandomUnit(random);
        const bool better = noise.Holds(next) && noise(next) > noise(peak);
        peak = better ? next : peak;
        step *= better ? 1.5 : 0.93;
      }
      const Vec3 direction = RandomUnit(random);
      ViewSettings view;
      view.Direction = direction;
      view.Up = RandomUnit(random);
      view.HasFocalPoint = view.HasPlaneOrigin = true;
      view.FocalPoint = view.PlaneOrigin = peak - 0.5 * direction;
      view.Size = { pixels, pixels };
      view.PixelSpacing = 0.02 / pixels;
      const ImagePlane plane = MakeImagePlane(Matrix4(), { 8, 7, 9 }, view);
      const double isoValue =
        noise(peak) - std::max(1e-7, noise(peak) - noise(peak + 0.005 * RandomUnit(random)));
      // A start depth leaves out other crests.
      const std::vector<double> start(pixels * pixels, 0.4);
      std::vector<double> depth(pixels * pixels);
      RayRequest request;
      request.StartDepth = start.data();
      caster.Cast(plane, isoValue,
        { { 0, pixels - 1, 0, pixels - 1 }, depth.data(), nullptr, nullptr }, request, execution);
      for (int i = 0; i < pixels * pixels; ++i)
      {
        const Vec3 origin = plane.PixelPosition(i % pixels, i / pixels);
        if (!noise.Holds(origin + 0.4 * direction) || !noise.Holds(origin + 0.6 * direction))
        {
          continue;
        }
        const double crest = FindCrest(noise, origin, direction, 0.45, 0.55);
        const double top = noise(origin + crest * direction);
        const bool entersBelow = noise(origin + 0.4 * direction) < isoValue - 1e-9;
        if (entersBelow && top > isoValue + 1e-11)
        {
          ASSERT_LE(depth[i], crest + 1e-9) << trial << " " << i;
          ++hits;
        }
        else if (top < isoValue - 1e-9 && IsBelow(noise, origin, direction, 0.4, 0.46, isoValue) &&
          IsBelow(noise, origin, direction, 0.54, 0.6, isoValue))
        {
          ASSERT_FALSE(depth[i] < 0.6) << trial << " " << i;
          ++misses;
        }
      }
    }
    EXPECT_GT(hits, 200);
    EXPECT_GT(misses, 100);
    std::printf("%d hits, %d misses\n", hits, misses);
  }
}
