// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCounterNoise.h"
#include "lacunaSkull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

using lacuna::Extent;
using lacuna::Skull;
using lacuna::SkullSurface;
using lacuna::Vec3;

namespace
{
const lacuna::CounterNoise Noise(77, 0);
constexpr double Pi = 3.14159265358979323846;

Vec3 RandomDirection(int i)
{
  return lacuna::Normalized(
    { Noise.Normal(3 * i), Noise.Normal(3 * i + 1), Noise.Normal(3 * i + 2) });
}

Vec3 SurfaceNormal(const Vec3& surface)
{
  Vec3 gradient;
  SkullSurface::Implicit(surface, &gradient);
  return Normalized(gradient);
}

Extent WholeOf(const Skull& skull)
{
  const auto n = skull.GetDimensions();
  return { 0, n[0] - 1, 0, n[1] - 1, 0, n[2] - 1 };
}

std::vector<short> Sample(const Skull& skull, const Extent& e, int threads)
{
  lacuna::ThreadExecution execution(threads);
  std::vector<short> voxels(
    static_cast<std::size_t>(e[1] - e[0] + 1) * (e[3] - e[2] + 1) * (e[5] - e[4] + 1));
  skull.Sample(execution, e, voxels.data());
  return voxels;
}

Skull::Parameters Coarse()
{
  Skull::Parameters p;
  p.Spacing = { 3, 3, 2.3 };
  return p;
}
}

// 500 HU lies on the outer surface, and it is what a ray from outside meets first.
TEST(Skull, FiveHundredIsTheOuterSurface)
{
  Skull::Parameters p;
  p.Center = { 5, -11, 40 };
  const Skull skull(p);
  for (int i = 0; i < 2000; ++i)
  {
    const Vec3 n = RandomDirection(i);
    const Vec3 surface = SkullSurface::Radius(n) * n;
    const Vec3 normal = SurfaceNormal(surface);
    const auto at = [&](double d) { return skull.IntactValue(p.Center + surface + d * normal); };
    EXPECT_NEAR(at(0), 500, 1e-8);
    EXPECT_LT(at(0.05), 500);
    EXPECT_GT(at(-0.05), 500);
    for (double d = 0.1; d < 12; d += 0.3)
    {
      ASSERT_LT(at(d), 500);
    }
    // Through tables and diploe no further crossing, then the brain.
    for (double d = -0.1; d > -5; d -= 0.1)
    {
      ASSERT_GT(at(d), 500);
    }
    EXPECT_NEAR(at(-12), 35, 1e-9);
    EXPECT_NEAR(at(4), 0, 1e-9);
    EXPECT_NEAR(at(9), -1000, 1e-9);
  }
}

// Sutures are thin: there the outer surface sinks in, nowhere else, and the inner table stays.
TEST(Skull, SuturesAreThinAndOnlyInTheOuterPart)
{
  Skull::Parameters p;
  p.Center = { 5, -11, 40 };
  p.Spacing = { 0.5, 0.5, 0.5 };
  const Skull plain(p);
  p.Sutures = true;
  const Skull seamed(p);
  constexpr int N = 20000;
  int sunk = 0, left = 0;
  for (int i = 0; i < N; ++i)
  {
    const Vec3 n = RandomDirection(i);
    const Vec3 surface = SkullSurface::Radius(n) * n;
    const Vec3 normal = SurfaceNormal(surface);
    const auto at = [&](const Skull& skull, double d)
    { return skull.IntactValue(p.Center + surface + d * normal); };
    EXPECT_EQ(at(seamed, 1), at(plain, 1));
    EXPECT_EQ(at(seamed, -7.6), at(plain, -7.6));
    EXPECT_LE(at(seamed, -1), at(plain, -1));
    if (at(seamed, -1) < 700) // the middle of a suture
    {
      EXPECT_LT(at(seamed, 0), 500) << surface[0] << " " << surface[1] << " " << surface[2];
      ++sunk;
      left += n[0] > 0;
      EXPECT_GT(surface[2], -1);
    }
    else if (at(seamed, 0) == at(plain, 0))
    {
      EXPECT_NEAR(at(seamed, 0), 500, 1e-8);
    }
  }
  // three lines of 1.4 mm and together some 0.5 m on a head of 7 dm2
  EXPECT_GT(sunk, N / 200);
  EXPECT_LT(sunk, N / 20);
  EXPECT_GT(left, sunk / 3); // on both sides
  EXPECT_LT(left, 2 * sunk / 3);
}

// How far wider voxels move the 500 HU surface because the outer table becomes too thin.
TEST(Skull, WideVoxelsShiftTheSurfaceInwards)
{
  for (const double spacing : { 2.6, 3.0, 4.0, 5.0 })
  {
    Skull::Parameters p;
    p.Spacing = { spacing, spacing, spacing };
    const Skull skull(p);
    double least = 0;
    double most = -10;
    for (int i = 0; i < 200; ++i)
    {
      const Vec3 n = RandomDirection(i);
      const Vec3 surface = SkullSurface::Radius(n) * n;
      const Vec3 normal = SurfaceNormal(surface);
      double inside = -3;
      double outside = 2;
      for (int step = 0; step < 50; ++step)
      {
        const double middle = 0.5 * (inside + outside);
        (skull.IntactValue(surface + middle * normal) > 500 ? inside : outside) = middle;
      }
      least = std::min(least, inside);
      most = std::max(most, inside);
    }
    EXPECT_LE(most, 1e-6);
    const double documented =
      spacing < 2.62 ? 1e-6 : (spacing < 3.1 ? 0.0035 : (spacing < 4.1 ? 0.075 : 0.245));
    EXPECT_GT(least, -documented) << spacing;
  }
}

// What the average over the voxel's box would do to the 500 HU surface (the blur does nothing).
TEST(Skull, BlurIsCloseToTheAverageOverTheVoxel)
{
  Skull::Parameters sharpParameters;
  sharpParameters.Spacing = { 1e-6, 1e-6, 1e-6 };
  const Skull sharp(sharpParameters);
  double mean = 0;
  constexpr int N = 25;
  for (int i = 0; i < N; ++i)
  {
    const Vec3 n = RandomDirection(i);
    const Vec3 surface = SkullSurface::Radius(n) * n;
    const Vec3 normal = SurfaceNormal(surface);
    double inside = -0.2;
    double outside = 0.2;
    for (int step = 0; step < 9; ++step)
    {
      const Vec3 p = surface + 0.5 * (inside + outside) * normal;
      double average = 0;
      constexpr int M = 3000;
      for (int c = 0; c < M; ++c)
      {
        // An additive recurrence that fills the box evenly (Roberts' R3 sequence).
        const auto part = [&](double a) { return std::fmod(0.5 + c * a, 1.0) - 0.5; };
        average += sharp.IntactValue(
          p + Vec3{ part(0.8191725134), part(0.6710436067), 2.3 * part(0.5497004779) });
      }
      (average > 500 * M ? inside : outside) = 0.5 * (inside + outside);
    }
    EXPECT_NEAR(inside, 0, 0.015);
    mean += inside / N;
  }
  EXPECT_NEAR(mean, -0.004, 0.004);
}

TEST(Skull, TheHeadEndsInsideOfTheVolume)
{
  Skull::Parameters p = Coarse();
  p.DefectRadius = 0;
  const Skull skull(p);
  const Extent whole = WholeOf(skull);
  const auto voxels = Sample(skull, whole, 2);
  std::size_t at = 0;
  short highest = -2000;
  for (int k = 0; k <= whole[5]; ++k)
  {
    for (int j = 0; j <= whole[3]; ++j)
    {
      for (int i = 0; i <= whole[1]; ++i, ++at)
      {
        highest = std::max(highest, voxels[at]);
        if (i == 0 || i == whole[1] || j == 0 || j == whole[3] || k == 0 || k == whole[5])
        {
          ASSERT_EQ(voxels[at], -1000) << i << " " << j << " " << k;
        }
      }
    }
  }
  EXPECT_LE(highest, 1000);
  EXPECT_GT(highest, 900);
  const auto n = Skull(Skull::Parameters()).GetDimensions();
  EXPECT_EQ(n, (std::array<int, 3>{ 169, 204, 67 }));
}

TEST(Skull, VoxelsAreTheRoundedValuesAtTheirPlaces)
{
  Skull::Parameters p = Coarse();
  p.Center = { 3, 4, -5 };
  const Skull skull(p);
  const Extent part{ 8, 40, 20, 50, 30, 60 };
  const auto voxels = Sample(skull, part, 2);
  const Vec3 origin = skull.GetOrigin();
  std::size_t at = 0;
  for (int k = part[4]; k <= part[5]; ++k)
  {
    for (int j = part[2]; j <= part[3]; ++j)
    {
      for (int i = part[0]; i <= part[1]; ++i, ++at)
      {
        const Vec3 point = origin + Vec3{ i * p.Spacing[0], j * p.Spacing[1], k * p.Spacing[2] };
        ASSERT_NEAR(voxels[at], skull.Value(point), 0.5 + 1e-9);
      }
    }
  }
}

TEST(Skull, IsTheSameForAnyThreadsAndPieces)
{
  Skull::Parameters p = Coarse();
  p.NoiseLevel = 20;
  const Skull skull(p);
  const Extent whole = WholeOf(skull);
  const auto one = Sample(skull, whole, 1);
  EXPECT_EQ(one, Sample(skull, whole, 2));
  EXPECT_EQ(one, Sample(skull, whole, 5));
  const Extent part{ 11, 30, 5, 60, 7, 40 };
  const auto piece = Sample(skull, part, 3);
  std::size_t at = 0;
  for (int k = part[4]; k <= part[5]; ++k)
  {
    for (int j = part[2]; j <= part[3]; ++j)
    {
      for (int i = part[0]; i <= part[1]; ++i, ++at)
      {
        ASSERT_EQ(
          piece[at], one[(static_cast<std::size_t>(k) * (whole[3] + 1) + j) * (whole[1] + 1) + i]);
      }
    }
  }
}

TEST(Skull, NoiseHasTheStatedDeviation)
{
  Skull::Parameters p = Coarse();
  const Extent whole = WholeOf(Skull(p));
  const auto clean = Sample(Skull(p), whole, 2);
  p.NoiseLevel = 25;
  const auto noisy = Sample(Skull(p), whole, 2);
  p.Seed = 1;
  const auto other = Sample(Skull(p), whole, 2);
  double sum = 0;
  double squares = 0;
  double product = 0;
  for (std::size_t i = 0; i < clean.size(); ++i)
  {
    const double e = noisy[i] - clean[i];
    sum += e;
    squares += e * e;
    product += e * (other[i] - clean[i]);
  }
  const auto n = static_cast<double>(clean.size());
  EXPECT_NEAR(sum / n, 0, 5 * 25 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 25, 5 * 25 / std::sqrt(2 * n) + 0.01); // rounding: 1/12
  EXPECT_NEAR(product / n, 0, 5 * 625 / std::sqrt(n));
}

// The outline has the mean radius and is not a circle; only bone changes.
TEST(Skull, DefectIsAnIrregularHoleThroughTheBone)
{
  Skull::Parameters p;
  p.DefectRadius = 30;
  p.DefectDirection = { 0, 0, 5 };
  const Skull skull(p);
  double mean = 0;
  double least = 1e9;
  double most = 0;
  constexpr int N = 3600;
  for (int i = 0; i < N; ++i)
  {
    const double a = 2 * Pi * i / N;
    double inside = 0;
    double outside = 60;
    for (int step = 0; step < 40; ++step)
    {
      const double r = 0.5 * (inside + outside);
      (skull.IsInDefect({ r * std::cos(a), r * std::sin(a), 60 }) ? inside : outside) = r;
    }
    mean += inside / N;
    least = std::min(least, inside);
    most = std::max(most, inside);
  }
  EXPECT_NEAR(mean, 30, 1e-6);
  EXPECT_LT(least, 26);
  EXPECT_GT(most, 34);
  EXPECT_FALSE(skull.IsInDefect({ 0, 0, -60 }));

  const Skull::Parameters intactParameters = [&]
  {
    Skull::Parameters q = p;
    q.DefectRadius = 0;
    return q;
  }();
  const Skull intact(intactParameters);
  EXPECT_FALSE(intact.IsInDefect({ 0, 0, 60 }));
  int removed = 0;
  for (int i = 0; i < 20000; ++i)
  {
    const Vec3 n = RandomDirection(i);
    const Vec3 point = (SkullSurface::Radius(n) - 12 + 20 * Noise.Uniform(500000 + i)) * n;
    EXPECT_EQ(skull.IntactValue(point), intact.Value(point));
    const double lateral = std::hypot(point[0], point[1]);
    if (point[2] < 0 || lateral > most + 2)
    {
      EXPECT_EQ(skull.Value(point), intact.Value(point));
    }
    else if (lateral < least - 2)
    {
      EXPECT_LT(skull.Value(point), 36); // no bone left
      removed += intact.Value(point) > 500;
    }
  }
  EXPECT_GT(removed, 30);
}

TEST(Skull, RefusesBadParametersByName)
{
  struct Case
  {
    const char* Name;
    std::function<void(Skull::Parameters&)> Spoil;
  };
  using P = Skull::Parameters;
  const double nan = std::nan("");
  for (const Case& c : { Case{ "Spacing", [](P& p) { p.Spacing[1] = 0; } },
         Case{ "Spacing", [](P& p) { p.Spacing[2] = -1; } },
         Case{ "Spacing", [=](P& p) { p.Spacing[0] = nan; } },
         Case{ "Spacing", [](P& p) { p.Spacing[0] = 5.1; } },
         Case{ "DefectRadius", [](P& p) { p.DefectRadius = -1; } },
         Case{ "DefectRadius", [](P& p) { p.DefectRadius = 41; } },
         Case{ "DefectRadius", [=](P& p) { p.DefectRadius = nan; } },
         Case{ "DefectDirection",
           [](P& p) {
             p.DefectDirection = { 0, 0, 0 };
           } },
         Case{ "DefectDirection",
           [=](P& p) {
             p.DefectDirection = { 0, nan, 1 };
           } },
         Case{ "NoiseLevel", [](P& p) { p.NoiseLevel = -1; } },
         Case{ "Center", [=](P& p) { p.Center[2] = nan; } } })
  {
    P p;
    c.Spoil(p);
    try
    {
      Skull skull(p);
      FAIL() << c.Name;
    }
    catch (const std::invalid_argument& e)
    {
      EXPECT_EQ(std::string(e.what()).find(c.Name), 0u) << e.what();
    }
  }
  P tiny;
  tiny.Spacing = { 1e-300, 1, 1 };
  EXPECT_EQ(Skull(tiny).GetDimensions()[0], 1000000001); // refused where memory is asked for
}
