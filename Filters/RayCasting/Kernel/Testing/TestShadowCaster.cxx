// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShadowCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{
using namespace lacuna;

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// The half-space x <= 10 is solid; the volume reaches from 0 to 29, 19 and 19.
struct Wall
{
  TestField Field{ { 30, 20, 20 }, Matrix4(), [](const Vec3& p) { return 10 - p[0]; } };
  ThreadExecution Execution{ 1 };
  VoxelVolume Volume = Field.View();
  IsoRayCaster Caster{ Volume, FieldInterpolation::BSpline, SolidSide::Above, Execution };
  ShadowCaster Shadows;

  Wall() { this->Shadows.Caster = &this->Caster; }

  bool IsShadowed(const Vec3& point, const Vec3& towards, double distance = Infinity) const
  {
    return ShadowProbe(this->Shadows).IsShadowed(point, Normalized(towards), distance);
  }
};

/// A ball of radius 8, exact in the volume: samples of r^2 give r^2 + 1.
struct Ball
{
  static constexpr double Radius = 8;
  Vec3 Centre{ 16, 14, 15 };
  TestField Field{ { 32, 30, 31 }, Matrix4(),
    [this](const Vec3& p)
    {
      const Vec3 d = p - this->Centre;
      return Radius * Radius + 1 - Dot(d, d);
    } };
  ThreadExecution Execution{ 1 };
  VoxelVolume Volume = Field.View();
  IsoRayCaster Caster{ Volume, FieldInterpolation::BSpline, SolidSide::Above, Execution };
};
}

TEST(ShadowCaster, NothingThrowsNoShadow)
{
  const ShadowCaster nothing;
  EXPECT_FALSE(ShadowProbe(nothing).IsShadowed({ 0, 0, 0 }, { 1, 0, 0 }, Infinity));
  TestField empty{ { 4, 4, 4 }, Matrix4(), [](const Vec3&) { return std::nan(""); } };
  ThreadExecution execution(1);
  const VoxelVolume volume = empty.View();
  const IsoRayCaster caster(volume, FieldInterpolation::BSpline, SolidSide::Above, execution);
  ShadowCaster shadows;
  shadows.Caster = &caster;
  EXPECT_FALSE(ShadowProbe(shadows).IsShadowed({ 1, 1, 1 }, { 1, 0, 0 }, Infinity));
}

TEST(ShadowCaster, OnlyWhatLiesBetweenThePointAndTheLight)
{
  Wall wall;
  // a point within the wall, 2 mm behind its face; the light is on the free side
  EXPECT_TRUE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }));
  EXPECT_TRUE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }, 2.01));
  EXPECT_FALSE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }, 1.99))
    << "the lamp is in the wall as well";
  wall.Shadows.Bias = 0.01;
  // the wall is behind a point of its face, whether the lamp is in the volume or not
  for (const double distance : { 0.0, 3.0, 12.0, 60.0, Infinity })
  {
    EXPECT_FALSE(wall.IsShadowed({ 10, 9, 9 }, { 1, 0.2, -0.1 }, distance)) << distance;
  }
  // a ray that misses the volume, and one that ends before it
  EXPECT_FALSE(wall.IsShadowed({ 8, 9, 40 }, { 1, 0, 0 }));
  EXPECT_FALSE(wall.IsShadowed({ 8, 9, 40 }, { 0, 0, 1 }));
}

TEST(ShadowCaster, BiasIsWhatBelongsToThePoint)
{
  Wall wall;
  wall.Shadows.Bias = 1.99;
  EXPECT_TRUE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }));
  wall.Shadows.Bias = 2.01;
  EXPECT_FALSE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }));
  EXPECT_FALSE(wall.IsShadowed({ 8, 9, 9 }, { 1, 0, 0 }, 2.005)) << "nearer than the bias";
}

TEST(ShadowCaster, LightThatStartsInTheSolidLeavesItFirst)
{
  Wall wall;
  const Vec3 point{ 20, 9, 9 };
  // from behind the wall, which the volume cuts open; from within it; from before it
  EXPECT_FALSE(wall.IsShadowed(point, { -1, 0, 0 }));
  EXPECT_FALSE(wall.IsShadowed(point, { -1, 0, 0 }, 15));
  EXPECT_FALSE(wall.IsShadowed(point, { -1, 0, 0 }, 5));
  wall.Shadows.CapBoundary = true;
  EXPECT_TRUE(wall.IsShadowed(point, { -1, 0, 0 }));
  EXPECT_TRUE(wall.IsShadowed(point, { -1, 0, 0 }, 25)) << "a lamp outside of the volume";
  EXPECT_FALSE(wall.IsShadowed(point, { -1, 0, 0 }, 15)) << "a lamp in the wall, behind its cap";
  EXPECT_FALSE(wall.IsShadowed(point, { 0, 1, 0 })) << "where the volume ends empty";
}

TEST(ShadowCaster, ACutBallThrowsTheShadowOfWhatIsLeft)
{
  const Ball ball;
  // all above the middle is cut away
  const ConvexRegion upper(Matrix4(), { { ball.Centre, { 0, 0, -1 } } });
  const ShadowCaster shadows{ &ball.Caster, 0, 0, &upper, true, false };
  ShadowCaster open = shadows;
  open.CapCutAway = false;
  const ShadowProbe capped(shadows);
  const ShadowProbe uncapped(open);
  const Vec3 towards[] = { { 0, 0, 1 }, { -1, 0.3, 0.5 }, { 0.4, 1, 0.2 }, { 1, -1, 3 } };
  int differs = 0;
  for (const Vec3& towardsLight : towards)
  {
    const Vec3 l = Normalized(towardsLight);
    for (double x = 0; x < 32; x += 0.53)
    {
      for (double y = 0; y < 30; y += 0.47)
      {
        const Vec3 p{ x, y, 2 };
        const Vec3 d = ball.Centre - p;
        const double middle = Dot(d, l);
        const double gap = Norm(d - middle * l);
        if (std::abs(gap - Ball::Radius) < 1e-6)
        {
          continue;
        }
        const double half =
          gap < Ball::Radius ? std::sqrt(Ball::Radius * Ball::Radius - gap * gap) : -1;
        const double cut = d[2] / l[2];
        const bool lower = half > 0 && middle - half < cut;
        const bool throughCap = lower && middle + half > cut;
        if (std::abs(middle + half - cut) < 1e-6 || std::abs(middle - half - cut) < 1e-6)
        {
          continue;
        }
        ASSERT_EQ(capped.IsShadowed(p, l, Infinity), lower) << x << " " << y;
        ASSERT_EQ(uncapped.IsShadowed(p, l, Infinity), lower && !throughCap) << x << " " << y;
        differs += half > 0 && !lower;
      }
    }
  }
  EXPECT_GT(differs, 30) << "the upper half has a shadow of its own";
}
