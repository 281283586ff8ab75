// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDropCutter.h"

#include "lacunaToolPathScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace lacuna;
using namespace lacunaMill;

namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();

// By many points of the triangles.
double SampledFlatDrop(const MillSurface& surface, double radius, double x, double y)
{
  double best = -Infinity;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c)
  {
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; i + j <= n; ++j)
      {
        const Vec3 v = a + (double(i) / n) * (b - a) + (double(j) / n) * (c - a);
        if (std::hypot(v[0] - x, v[1] - y) < radius)
        {
          best = std::max(best, v[2]);
        }
      }
    }
  };
  for (std::int64_t j = 0; j + 1 < surface.GetSize().Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < surface.GetSize().Columns; ++i)
    {
      add(surface.At(i, j), surface.At(i + 1, j), surface.At(i + 1, j + 1));
      add(surface.At(i, j), surface.At(i + 1, j + 1), surface.At(i, j + 1));
    }
  }
  return best;
}
}

//------------------------------------------------------------------------------
TEST(DropCutter, BallAgainstDistancesOfAllTriangles)
{
  std::mt19937 random(3);
  for (const MillTool tool :
    { Ball, MillTool{ ToolShape::Ball, 0.4 }, MillTool{ ToolShape::Ball, 9 } })
  {
    for (const bool bent : { false, true })
    {
      const MillSurface surface = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
      const DropCutter cutter(surface, tool);
      DropCutter::Scratch scratch;
      Judge judge(surface, tool);
      judge.Margin = 12;
      std::uniform_real_distribution<double> x(
        surface.GetLowest()[0] + 1, surface.GetHighest()[0] - 1);
      std::uniform_real_distribution<double> y(3, 12);
      int found = 0;
      for (int k = 0; k < 60; ++k)
      {
        const double px = x(random);
        const double py = y(random);
        const double z = cutter.Drop(px, py, scratch);
        if (!std::isfinite(z))
        {
          EXPECT_LE(judge.Depth({ px, py, -3.0 }), 0) << px << " " << py;
          continue;
        }
        // it touches, cuts when a little lower and is free everywhere above
        ++found;
        EXPECT_NEAR(judge.Depth({ px, py, z }), 0, 1e-9) << px << " " << py << " " << bent;
        EXPECT_GT(judge.Depth({ px, py, z - 1e-4 }), 0) << px << " " << py << " " << bent;
        for (int i = 1; i < 40; ++i)
        {
          EXPECT_LE(judge.Depth({ px, py, z + 0.3 * i }), 1e-9) << px << " " << py << " " << bent;
        }
      }
      EXPECT_GT(found, 30);
    }
  }
}

//------------------------------------------------------------------------------
TEST(DropCutter, FlatAgainstManyPoints)
{
  std::mt19937 random(3);
  const MillSurface surface = Bent(Noise);
  const DropCutter cutter(surface, Flat);
  DropCutter::Scratch scratch;
  std::uniform_real_distribution<double> x(3, 22);
  std::uniform_real_distribution<double> y(3, 12);
  for (int k = 0; k < 40; ++k)
  {
    const double px = x(random);
    const double py = y(random);
    const double z = cutter.Drop(px, py, scratch);
    const double sampled = SampledFlatDrop(surface, Flat.Radius, px, py);
    EXPECT_GE(z, sampled - 1e-9);
    EXPECT_LT(z, sampled + 0.05);
  }
}

//------------------------------------------------------------------------------
TEST(DropCutter, OnAPlane)
{
  const MillSurface plane = Surface(9, 7, 2, [](double x, double y) { return 0.3 * x - 0.4 * y; });
  DropCutter::Scratch scratch;
  // the ball's centre is a radius away from the plane, along its normal
  const double ball = 0.3 * 7 - 0.4 * 5 + 4 * std::sqrt(1.25) - 4;
  EXPECT_NEAR(DropCutter(plane, Ball).Drop(7, 5, scratch), ball, 1e-12);
  EXPECT_NEAR(DropCutter(plane, Flat).Drop(7, 5, scratch), 0.3 * 7 - 0.4 * 5 + 3 * 0.5, 1e-12);
  // allowance: along the normal for a ball, at least that for a flat end
  EXPECT_NEAR(
    DropCutter(plane, Ball, 0.5).Drop(7, 5, scratch), ball + 0.5 * std::sqrt(1.25), 1e-12);
  EXPECT_NEAR(DropCutter(plane, Flat, 0.5).Drop(7, 5, scratch), 0.1 + 3.5 * 0.5 + 0.5, 1e-12);
  EXPECT_EQ(DropCutter(plane, Ball).Drop(-4.1, 5, scratch), -Infinity);
  EXPECT_EQ(DropCutter(plane, Ball).Drop(1000, -1000, scratch), -Infinity);
}

//------------------------------------------------------------------------------
TEST(DropCutter, ExcessAgainstManyDrops)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(2, 24);
  std::uniform_real_distribution<double> y(2, 13);
  std::uniform_real_distribution<double> step(-1.5, 1.5);
  for (const MillTool& tool : { Ball, Flat })
  {
    for (const bool bent : { false, true })
    {
      const MillSurface surface = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
      const DropCutter cutter(surface, tool);
      DropCutter::Scratch scratch;
      for (int k = 0; k < 80; ++k)
      {
        Vec3 a{ x(random), y(random), 0 };
        Vec3 b = a + Vec3{ step(random), k % 5 == 0 ? 0 : step(random), 0 };
        a[2] = cutter.Drop(a[0], a[1], scratch);
        b[2] = cutter.Drop(b[0], b[1], scratch);
        if (!std::isfinite(a[2] + b[2]))
        {
          continue;
        }
        double sampled = 0;
        constexpr int n = 2000;
        for (int i = 1; i < n; ++i)
        {
          const Vec3 p = a + (double(i) / n) * (b - a);
          sampled = std::max(sampled, cutter.Drop(p[0], p[1], scratch) - p[2]);
        }
        const DropCutter::Excess excess = cutter.FindExcess(a, b, 1e-4);
        if (sampled > 1.5e-4 || excess.Height > 0)
        {
          EXPECT_GE(excess.Height, sampled - 1e-7) << k;
          // a wall may be met between two samples
          if (!bent)
          {
            continue;
          }
          EXPECT_LT(excess.Height, sampled + (tool.Shape == ToolShape::Ball ? 2e-4 : 0.02)) << k;
        }
      }
    }
  }
}
