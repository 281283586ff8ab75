// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressLayout.h"

#include "lacunaFlangeBlend.h"
#include "lacunaPressScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace lacuna;
using lacunaPress::Disc20;
using lacunaPress::ExpectRotation;

//------------------------------------------------------------------------------
TEST(PressFrame, AnglesLayThePlaneFlat)
{
  for (const double c1 : { -0.7, 0.0, 0.3 })
  {
    for (const double c2 : { -0.4, 0.0, 1.2 })
    {
      for (const PressSide side : { PressSide::IntoBody, PressSide::TowardsViewer })
      {
        const PressFrame frame = MakePressFrame({ c1, c2, -1 }, side);
        // Carr 1996, eq. 6.14
        EXPECT_NEAR(frame.Theta, std::atan(-c2 / std::sqrt(1 + c1 * c1)), 1e-15);
        EXPECT_NEAR(frame.Psi, std::atan(c1), 1e-15);
        ExpectRotation(frame.Rotation);
        // directions in the plane z = c1 x + c2 y are horizontal
        EXPECT_NEAR(frame.Rotation.Vector({ 1, 0, c1 })[2], 0, 1e-15);
        EXPECT_NEAR(frame.Rotation.Vector({ 0, 1, c2 })[2], 0, 1e-15);
        const double up = side == PressSide::IntoBody ? 1 : -1;
        EXPECT_NEAR(frame.Rotation.Vector(frame.Inwards)[2], up, 1e-15);
        EXPECT_GT(frame.Inwards[2], 0);
        // either sign and any length of the normal
        const PressFrame other = MakePressFrame({ -3 * c1, -3 * c2, 3 }, side);
        EXPECT_NEAR(other.Theta, frame.Theta, 1e-15);
        EXPECT_NEAR(other.Psi, frame.Psi, 1e-15);
      }
    }
  }
  EXPECT_THROW(MakePressFrame({ 1, 0, 0 }, PressSide::IntoBody), std::invalid_argument);
  EXPECT_THROW(MakePressFrame({ 0, 0, 0 }, PressSide::IntoBody), std::invalid_argument);
  EXPECT_THROW(MakePressFrame({ 0, std::nan(""), 1 }, PressSide::IntoBody), std::invalid_argument);
}

//------------------------------------------------------------------------------
TEST(PressFrame, LeastSquaresPlane)
{
  const Vec2 spacing{ 0.5, 0.8 };
  std::vector<double> depths;
  for (int j = 0; j < 31; ++j)
  {
    for (int i = 0; i < 20; ++i)
    {
      depths.push_back(12 + 0.3 * spacing[0] * i - 0.6 * spacing[1] * j);
    }
  }
  const Vec3 normal = FitPlaneNormal({ 20, 31 }, depths, spacing);
  EXPECT_NEAR(normal[0] / -normal[2], 0.3, 1e-13);
  EXPECT_NEAR(normal[1] / -normal[2], -0.6, 1e-13);
  EXPECT_LT(normal[2], 0);

  // of a part that is no rectangle; what lies beside it does not count
  std::vector<unsigned char> mask(depths.size(), 0);
  for (int j = 3; j < 25; ++j)
  {
    for (int i = 2; i < 3 + j / 3; ++i)
    {
      mask[i + 20 * j] = 1;
    }
  }
  for (std::size_t k = 0; k < depths.size(); ++k)
  {
    depths[k] = mask[k] ? depths[k] : std::nan("");
  }
  const Vec3 ofPart = FitPlaneNormal({ 20, 31 }, depths, spacing, mask);
  EXPECT_NEAR(ofPart[0] / -ofPart[2], 0.3, 1e-12);
  EXPECT_NEAR(ofPart[1] / -ofPart[2], -0.6, 1e-12);
  std::fill(mask.begin(), mask.end(), 0);
  mask[2] = mask[23] = mask[44] = 1;
  EXPECT_THROW(FitPlaneNormal({ 20, 31 }, depths, spacing, mask), std::invalid_argument);
}

//------------------------------------------------------------------------------
TEST(LoopDistance, MeasuresFromTheInsideOfOverlappingLoops)
{
  const Loop square{ { 0, 0 }, { 4, 0 }, { 4, 4 }, { 0, 4 } };
  const Loop inner{ { 1, 1 }, { 2, 1 }, { 2, 2 }, { 1, 2 } };
  const LoopDistance curves({ square, inner });
  EXPECT_EQ(curves.Find({ 1.5, 1.5 }, 9), 0);
  EXPECT_EQ(curves.Find({ 3, 3.5 }, 9), 0);
  EXPECT_NEAR(curves.Find({ 7, 8 }, 9), 5, 1e-14);
  EXPECT_NEAR(curves.Find({ 2, -3 }, 9), 3, 1e-14);
  EXPECT_EQ(curves.Find({ 2, -3 }, 2), 2);
  EXPECT_EQ(curves.Find({ 2, -30 }, 2), 2);
}

//------------------------------------------------------------------------------
TEST(LevelledRelief, TheReliefInItsCoreThenThePlane)
{
  PlateScene scene(PlateScene::Skull, Disc20);
  const ReliefSurface surface(scene.Execution, scene.Size, scene.Depths, scene.Spacing);
  const LevelledRelief levelled(surface, { 0.1, -0.2 }, { 20, 25 }, { 66, 70 });
  const auto same = [](const ReliefSurface::Frame& a, const ReliefSurface::Frame& b)
  { return a.Point == b.Point && a.Normal == b.Normal && a.NormalAlongX == b.NormalAlongX; };
  EXPECT_TRUE(same(levelled.GetFrame({ 30, 40 }), surface.GetFrame({ 30, 40 })));
  EXPECT_FALSE(same(levelled.GetFrame({ 70, 40 }), surface.GetFrame({ 70, 40 })));
  const Vec3 plane = Normalized({ 0.1, -0.2, -1 });
  EXPECT_LT(Norm(levelled.GetFrame({ 120, 130 }).Normal - plane), 1e-14);
  EXPECT_LT(Norm(levelled.GetFrame({ -50, -70 }).Normal - plane), 1e-14);
  // derivatives up to the second, also across the borders of the core
  const double h = 1e-4;
  for (double y = -60; y < 150; y += 7.3)
  {
    for (double x = -60; x < 150; x += 6.1)
    {
      const auto f = [&](double a, double b) { return levelled.GetFrame({ a, b }); };
      const auto here = f(x, y);
      const auto dx = 1 / (2 * h) * (f(x + h, y).Normal - f(x - h, y).Normal);
      const auto dy = 1 / (2 * h) * (f(x, y + h).Normal - f(x, y - h).Normal);
      EXPECT_LT(Norm(dx - here.NormalAlongX), 1e-5) << x << " " << y;
      EXPECT_LT(Norm(dy - here.NormalAlongY), 1e-5) << x << " " << y;
      EXPECT_NEAR(here.AlongX[2], (f(x + h, y).Point[2] - f(x - h, y).Point[2]) / (2 * h), 1e-6);
      EXPECT_NEAR(here.AlongY[2], (f(x, y + h).Point[2] - f(x, y - h).Point[2]) / (2 * h), 1e-6);
    }
  }
  const double e = 1e-9;
  for (const double x : { 20.0, 66.0, 94.0, -20.0 })
  {
    const auto left = levelled.GetFrame({ x - e, 72 });
    const auto right = levelled.GetFrame({ x + e, 72 });
    EXPECT_LT(Norm(left.NormalAlongX - right.NormalAlongX), 1e-7) << x;
    EXPECT_LT(Norm(left.NormalAlongY - right.NormalAlongY), 1e-7) << x;
  }
}

//------------------------------------------------------------------------------
TEST(FlangeBlend, OneInsideZeroOutsideAndSmooth)
{
  ThreadExecution execution(2);
  // an L, so that the distance has a crease
  const LoopDistance curves(
    { Loop{ { 0, 0 }, { 20, 0 }, { 20, 6 }, { 7, 6 }, { 7, 25 }, { 0, 25 } } });
  const double margin = 3;
  const double width = 8;
  const FlangeBlend blend(execution, curves, margin, width);
  double largestSlope = 0;
  for (double y = -14; y < 39; y += 0.37)
  {
    for (double x = -14; x < 34; x += 0.41)
    {
      const auto value = blend.Evaluate({ x, y });
      const double d = curves.Find({ x, y }, 20);
      if (d <= margin)
      {
        EXPECT_EQ(value.Weight, 1) << x << " " << y;
      }
      if (d >= margin + width)
      {
        EXPECT_EQ(value.Weight, 0) << x << " " << y;
      }
      EXPECT_GE(value.Weight, 0);
      EXPECT_LE(value.Weight, 1);
      const double h = 1e-5;
      for (int k = 0; k < 2; ++k)
      {
        const Vec2 e{ k == 0 ? h : 0, k == 1 ? h : 0 };
        const double slope = (blend.Evaluate({ x + e[0], y + e[1] }).Weight -
                               blend.Evaluate({ x - e[0], y - e[1] }).Weight) /
          (2 * h);
        EXPECT_NEAR(value.Gradient[k], slope, 1e-7);
      }
      largestSlope = std::max(largestSlope, std::hypot(value.Gradient[0], value.Gradient[1]));
    }
  }
  EXPECT_GT(largestSlope, 1 / width);
  EXPECT_LT(largestSlope, 3 / width); // no step anywhere
}
