// SPDX-License-Identifier: BSD-3-Clause
/// Against brute force: fine scans of fields evaluated by their definition.
#include "lacunaIsoRayCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <string>

namespace
{
using namespace lacuna;

/// The field along a ray through the volume, by the oracle.
struct Probe
{
  const TestField& Field;
  bool Cubic;
  Matrix4 WorldToIndex;
  Vec3 Origin;
  Vec3 Direction;
  double First;
  double Last;

  Probe(const TestField& field, bool cubic, const Vec3& origin, const Vec3& direction)
    : Field(field)
    , Cubic(cubic)
    , WorldToIndex(field.IndexToWorld.Inverse())
    , Origin(origin)
    , Direction(direction)
    , First(-1e9)
    , Last(1e9)
  {
    const Vec3 a = this->WorldToIndex.Point(origin);
    const Vec3 b = this->WorldToIndex.Vector(direction);
    for (int i = 0; i < 3; ++i)
    {
      const double u = -a[i] / b[i];
      const double v = (field.Size[i] - 1 - a[i]) / b[i];
      this->First = std::max(this->First, std::min(u, v));
      this->Last = std::min(this->Last, std::max(u, v));
    }
  }

  double operator()(double t) const
  {
    const Vec3 index = this->WorldToIndex.Point(this->Origin + t * this->Direction);
    return this->Cubic ? this->Field.BSpline(index) : this->Field.Trilinear(index);
  }
};

/// First change from below to not below the iso-value among samples, bisected; NaN if none.
double Scan(const Probe& f, double isoValue, int samples)
{
  bool outside = false;
  double before = f.First;
  for (int i = 0; i <= samples; ++i)
  {
    const double t = f.First + (f.Last - f.First) * i / samples;
    const bool solid = f(t) >= isoValue;
    if (solid && outside)
    {
      double low = before;
      double high = t;
      while (high - low > 1e-13 * (1 + std::abs(high)))
      {
        const double middle = 0.5 * (low + high);
        (f(middle) >= isoValue ? high : low) = middle;
      }
      return high;
    }
    outside = outside || !solid;
    before = t;
  }
  return std::nan("");
}

struct Tally
{
  int Hits = 0;
  int Misses = 0;
  int BetweenSamples = 0; ///< hits that the scan stepped over
};

/// A hit must be a crossing of the oracle's field, and never behind the scan's.
void CheckRay(const Probe& f, const IsoRayCaster& caster, double isoValue, int samples,
  const std::string& what, Tally& tally)
{
  const double scanned = Scan(f, isoValue, samples);
  RayHit hit;
  const bool found = caster.CastRay(f.Origin, f.Direction, isoValue, hit);
  if (!found)
  {
    ASSERT_TRUE(std::isnan(scanned)) << "missed " << what << " at " << scanned;
    ++tally.Misses;
    return;
  }
  ++tally.Hits;
  ASSERT_NEAR(f(hit.Distance), isoValue, 1e-12) << "not on the surface " << what;
  ASSERT_LT(f(hit.Distance - 1e-7), isoValue + 1e-12)
    << "not an entry " << what << " at " << hit.Distance - f.First << " of " << f.Last - f.First
    << ", scanned " << scanned - f.First;
  if (std::isnan(scanned) || hit.Distance < scanned - 1e-9)
  {
    ++tally.BetweenSamples;
  }
  else
  {
    ASSERT_NEAR(hit.Distance, scanned, 1e-9) << what;
  }
}

TestField Noise(std::mt19937& random, const std::array<int, 3>& size, bool mirrored)
{
  std::uniform_real_distribution<double> uniform(-1, 1);
  return TestField(size, RandomFrame(random, { 1, 0.7, 1.9 }, mirrored),
    [&](const Vec3&) { return uniform(random); });
}

Probe RandomRay(const TestField& field, bool cubic, std::mt19937& random)
{
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 through = field.IndexToWorld.Point({ uniform(random) * (field.Size[0] - 1),
    uniform(random) * (field.Size[1] - 1), uniform(random) * (field.Size[2] - 1) });
  const Vec3 direction = RandomUnit(random);
  return Probe(field, cubic, through - 40 * direction, direction);
}
}

TEST(IsoRayCasterOracle, NoiseVolumes)
{
  std::mt19937 random(20);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ThreadExecution execution(1);
  Tally tally;
  for (int volume = 0; volume < 24; ++volume)
  {
    const TestField field = Noise(random, { 6 + volume % 5, 9, 5 + volume }, volume % 2 != 0);
    for (const bool cubic : { true, false })
    {
      const IsoRayCaster caster(field.View(),
        cubic ? FieldInterpolation::BSpline : FieldInterpolation::Trilinear, SolidSide::Above,
        execution);
      for (int ray = 0; ray < 25; ++ray)
      {
        const double isoValue = (cubic ? 0.4 : 0.9) * uniform(random);
        const std::string what = std::to_string(volume) + "/" + std::to_string(ray);
        CheckRay(RandomRay(field, cubic, random), caster, isoValue, 800, what, tally);
        if (testing::Test::HasFatalFailure())
        {
          return;
        }
      }
    }
  }
  EXPECT_GT(tally.Hits, 500);
  EXPECT_GT(tally.Misses, 50);
}

TEST(IsoRayCasterOracle, SmoothFieldsBelow)
{
  std::mt19937 random(21);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ThreadExecution execution(1);
  Tally tally;
  for (int volume = 0; volume < 10; ++volume)
  {
    const Vec3 k = 0.4 * RandomUnit(random);
    const Vec3 l = 0.3 * RandomUnit(random);
    TestField field({ 20, 18, 16 }, RandomFrame(random, { 1, 1, 1 }, volume % 2 != 0),
      [&](const Vec3& p) { return std::sin(Dot(k, p)) + std::cos(Dot(l, p)); });
    const IsoRayCaster caster(
      field.View(), FieldInterpolation::BSpline, SolidSide::Below, execution);
    TestField negative = field;
    for (double& v : negative.Voxels)
    {
      v = -v;
    }
    for (int ray = 0; ray < 40; ++ray)
    {
      const double isoValue = uniform(random);
      const Probe probe = RandomRay(negative, true, random);
      const double scanned = Scan(probe, -isoValue, 600);
      RayHit hit;
      const bool found = caster.CastRay(probe.Origin, probe.Direction, isoValue, hit);
      ASSERT_EQ(found, !std::isnan(scanned));
      if (found)
      {
        ++tally.Hits;
        ASSERT_NEAR(hit.Distance, scanned, 1e-9);
      }
    }
  }
  EXPECT_GT(tally.Hits, 100);
}

TEST(IsoRayCasterOracle, ThinCrestsAreNotMissed)
{
  // iso-values so little below a crest of the field along a ray that the solid is a hair thick
  std::mt19937 random(22);
  ThreadExecution execution(1);
  int crests = 0;
  for (int volume = 0; volume < 20; ++volume)
  {
    const TestField field = Noise(random, { 9, 8, 10 }, volume % 2 != 0);
    for (const bool cubic : { true, false })
    {
      const IsoRayCaster caster(field.View(),
        cubic ? FieldInterpolation::BSpline : FieldInterpolation::Trilinear, SolidSide::Above,
        execution);
      for (int ray = 0; ray < 10; ++ray)
      {
        const Probe f = RandomRay(field, cubic, random);
        // the highest smooth maximum inside the volume
        const int samples = 1000;
        const double step = (f.Last - f.First) / samples;
        double crest = std::nan("");
        double height = -1e9;
        for (int i = 1; i < samples; ++i)
        {
          const double t = f.First + i * step;
          const double value = f(t);
          if (value > f(t - step) && value > f(t + step) && value > height)
          {
            crest = t;
            height = value;
          }
        }
        if (std::isnan(crest) || std::max(f(f.First), f(f.Last)) >= height)
        {
          continue;
        }
        double low = crest - step;
        double high = crest + step;
        for (int i = 0; i < 100; ++i)
        {
          const double u = low + (high - low) / 3;
          const double v = high - (high - low) / 3;
          const bool rising = f(u) < f(v);
          (rising ? low : high) = rising ? u : v;
        }
        crest = 0.5 * (low + high);
        for (const double half : { 5e-3, 5e-4, 2e-5 }) // mm
        {
          const double isoValue = std::max(f(crest - half), f(crest + half));
          RayHit hit;
          ASSERT_TRUE(caster.CastRay(f.Origin, f.Direction, isoValue, hit))
            << volume << " " << ray << " " << half;
          ASSERT_NEAR(hit.Distance, crest, 3 * half + 1e-6);
          ASSERT_NEAR(f(hit.Distance), isoValue, 1e-12);
          // and just above the crest there is nothing
          ASSERT_FALSE(
            caster.CastRay(f.Origin, f.Direction, f(crest) + (f(crest) - isoValue) + 1e-13, hit));
        }
        ++crests;
      }
    }
  }
  EXPECT_GT(crests, 100);
}
