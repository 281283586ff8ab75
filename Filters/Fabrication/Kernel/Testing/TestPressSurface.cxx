// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressSurface.h"

#include "lacunaPressScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace lacuna;
using lacunaPress::Degrees;
using lacunaPress::Disc20;
using lacunaPress::ExpectRotation;
using lacunaPress::Pi;

namespace
{
double Dish(double x, double y) // bulges away from the viewer
{
  return 60 - PlateScene::Ball(x, y);
}
}

//------------------------------------------------------------------------------
// On a ball of radius 60 the faces of the plate are balls, and where the mould is the true surface
// its points lie on them to rounding and the accuracy of the spline.
TEST(PressSurface, BallsForEveryMouldAndSeating)
{
  for (const bool outward : { true, false })
  {
    PressScene scene(outward ? PlateScene::Ball : Dish, Disc20);
    for (const PressMould mould : { PressMould::Female, PressMould::Male })
    {
      for (const PlateSeating seating : { PlateSeating::Onlay, PlateSeating::Inlay })
      {
        PressOptions options;
        options.Mould = mould;
        options.Seating = seating;
        options.PlateThickness = 2;
        options.FlangeWidth = 8;
        options.Spacing = 0.7;
        const PressSurface press = scene.Press(options);
        EXPECT_EQ(scene.Layout.ConvexOutward, outward);
        ExpectRotation(press.PressToRelief);
        // the plate's convex face is in the female mould
        const bool convex = mould == PressMould::Female;
        const bool towardsViewer = convex == outward;
        const double offset =
          seating == PlateSeating::Onlay ? (towardsViewer ? 2 : 0) : (towardsViewer ? 0 : -2);
        EXPECT_EQ(scene.Layout.Offset, offset);
        const double radius = outward ? 60 + offset : 60 - offset;
        const Vec3 centre = PressScene::At(0, 0, outward ? 60 : 0);
        double off = 0;
        std::size_t plate = 0;
        for (std::size_t k = 0; k < press.Points.size(); ++k)
        {
          const double z = press.Points[k][2];
          EXPECT_TRUE(mould == PressMould::Female ? z <= 0 : z >= 0);
          if (press.Regions[k] == PressRegion::Plate)
          {
            ++plate;
            const double r = Norm(press.PressToRelief.Point(press.Points[k]) - centre);
            off = std::max(off, std::abs(r - radius));
          }
          if (press.Regions[k] == PressRegion::Plane)
          {
            EXPECT_EQ(z, 0);
            EXPECT_EQ(press.WallAngles[k], 0);
          }
        }
        EXPECT_LT(off, 1e-6);
        // 5 mm around the defect as the mill sees it
        const double disc = 20 * radius / 60 + 5;
        EXPECT_GE(plate * 0.49, 0.98 * Pi * disc * disc);
        // a mould that the mill reaches: its side of the surface is the plate's
        const Vec3 up = press.PressToRelief.Vector({ 0, 0, 1 });
        EXPECT_NEAR(up[2], towardsViewer ? 1 : -1, 1e-12);
      }
    }
  }
}

//------------------------------------------------------------------------------
// The nodes are the true offset and no vertical one: the foot's normal goes through them.
TEST(PressSurface, NodesAreTheTrueOffsetOfATurnedRelief)
{
  PressScene scene(PlateScene::Skull, [](double x, double y) { return std::hypot(x + 4, y) < 17; });
  PressOptions options;
  options.PlateThickness = 1.5;
  options.FlangeWidth = 6;
  const PressSurface press = scene.Press(options, { 0.31, -0.22, -1 });
  const Matrix4 toRelief = press.PressToRelief;
  std::size_t checked = 0;
  for (std::size_t k = 0; k < press.Points.size(); k += 7)
  {
    if (press.Regions[k] != PressRegion::Plate)
    {
      continue;
    }
    const Vec3 p = toRelief.Point(press.Points[k]);
    Vec2 foot;
    double offset = 0;
    ASSERT_TRUE(FindFoot(scene.Surface, p, foot, offset));
    EXPECT_NEAR(offset, scene.Layout.Offset, 1e-8);
    ++checked;
  }
  EXPECT_GT(checked, 200U);
  EXPECT_NE(scene.Layout.Offset, 0);
}

//------------------------------------------------------------------------------
// Second differences across the seams of plate, flange and plane: jumps vanish with the step.
TEST(PressSurface, CurvatureIsContinuousAcrossTheSeams)
{
  double jumps[2] = { 0, 0 };
  double largest[2] = { 0, 0 };
  for (const int fine : { 0, 1 })
  {
    PressScene scene(PlateScene::Ball, PlateScene::Kidney);
    PressOptions options;
    options.Seating = PlateSeating::Inlay;
    options.PlateMargin = 2;
    options.FlangeWidth = 9;
    options.Spacing = fine ? 0.1 : 0.2;
    const PressSurface press = scene.Press(options, { 0.1, 0.05, -1 });
    const std::int64_t columns = scene.Layout.Grid.Columns;
    const auto count = static_cast<std::int64_t>(press.Points.size());
    const double h = options.Spacing;
    const auto z = [&](std::int64_t k) { return press.Points[k][2]; };
    for (const std::int64_t step : { std::int64_t{ 1 }, columns })
    {
      for (std::int64_t k = step; k + 2 * step < count; ++k)
      {
        const std::int64_t i = k % columns;
        if (step == 1 && (i == 0 || i + 2 >= columns))
        {
          continue;
        }
        const double here = (z(k - step) - 2 * z(k) + z(k + step)) / (h * h);
        const double next = (z(k) - 2 * z(k + step) + z(k + 2 * step)) / (h * h);
        jumps[fine] = std::max(jumps[fine], std::abs(next - here));
        largest[fine] = std::max(largest[fine], std::abs(here));
      }
    }
  }
  EXPECT_GT(largest[0], 0.1); // there is a fillet
  EXPECT_NEAR(largest[1], largest[0], 0.05 * largest[0]);
  EXPECT_LT(jumps[1], 0.6 * jumps[0]); // of a step in curvature they would stay
}

//------------------------------------------------------------------------------
// Coarser nodes are fewer points of the same mould.
TEST(PressSurface, TheGridDoesNotMoveTheMould)
{
  PressScene skull(PlateScene::Skull, PlateScene::Kidney);
  PressScene ball(PlateScene::Ball, Disc20);
  for (const PressMould mould : { PressMould::Female, PressMould::Male })
  {
    PressOptions options;
    options.Mould = mould;
    options.Seating = mould == PressMould::Female ? PlateSeating::Inlay : PlateSeating::Onlay;
    options.FlangeWidth = 12;
    options.Spacing = 0.75;
    // one point of the middle in both grids, and even numbers of equal steps to it
    options.BlockSize = { 96, 96, 0 };
    const PressSurface fine = skull.Press(options, { 0.1, 0.05, -1 });
    const std::int64_t columns = skull.Layout.Grid.Columns;
    constexpr int step = 2;
    options.Spacing *= step;
    const PressSurface coarse = skull.Press(options, { 0.1, 0.05, -1 });
    for (int a = 0; a < 4; ++a)
    {
      EXPECT_EQ(coarse.PressToRelief.Column(a), fine.PressToRelief.Column(a));
    }
    EXPECT_NEAR(coarse.Depth, fine.Depth, 0.01);
    EXPECT_NEAR(coarse.DraftAngle, fine.DraftAngle, 0.5);
    double off = 0;
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(coarse.Points.size()); ++k)
    {
      const std::int64_t width = skull.Layout.Grid.Columns;
      const std::int64_t at = (k % width) * step + (k / width) * step * columns;
      off = std::max(off, std::abs(coarse.Points[k][2] - fine.Points[at][2]));
      if (fine.Regions[at] == PressRegion::Plate)
      {
        EXPECT_EQ(coarse.Regions[k], PressRegion::Plate);
      }
    }
    EXPECT_LT(off, 1e-9);
    // the press plane is an eighth of the flange beyond the highest point of plate and margin
    options.BlockSize = { 0, 0, 0 };
    options.Spacing = 1.5;
    const double depth = ball.Press(options).Depth;
    const auto fall = [](double r) { return 60 - std::sqrt(3600 - r * r); };
    const double outline = PlateScene::Pixel / 2; // of pixels
    if (mould == PressMould::Female)
    {
      EXPECT_GT(depth, fall(25 - outline) + 1.5);
      EXPECT_LT(depth, fall(25 + outline + 0.18 * PlateScene::Pixel) + 1.5);
    }
  }
}

//------------------------------------------------------------------------------
TEST(PressSurface, WallAnglesAreThoseOfTheNodes)
{
  PressScene scene(PlateScene::Skull, Disc20);
  PressOptions options;
  options.Mould = PressMould::Male;
  options.FlangeWidth = 8;
  options.Spacing = 0.1;
  const PressSurface press = scene.Press(options);
  const std::int64_t columns = scene.Layout.Grid.Columns;
  double largest = 0;
  double lowest = 0;
  for (std::int64_t k = 2 * columns + 2;
       k + 2 * columns + 2 < static_cast<std::int64_t>(press.Points.size()); k += 11)
  {
    if (k % columns < 2 || k % columns >= columns - 2)
    {
      continue;
    }
    // differences of the fourth order, which miss some at the knots of the weight
    const auto slope = [&](std::int64_t step)
    {
      return (8 * (press.Points[k + step][2] - press.Points[k - step][2]) -
               press.Points[k + 2 * step][2] + press.Points[k - 2 * step][2]) /
        1.2;
    };
    const double dx = slope(1);
    const double dy = slope(columns);
    EXPECT_NEAR(press.WallAngles[k], Degrees * std::atan(std::hypot(dx, dy)), 0.02);
  }
  for (std::size_t k = 0; k < press.Points.size(); ++k)
  {
    largest = std::max(largest, press.WallAngles[k]);
    lowest = std::max(lowest, press.Points[k][2]);
  }
  EXPECT_EQ(press.DraftAngle, largest);
  EXPECT_EQ(press.Depth, lowest);
  EXPECT_EQ(press.BlockSize[2], press.Depth + BlockFloor);
}

//------------------------------------------------------------------------------
TEST(PressSurface, DefectAndOutlineAreTheDefect)
{
  PressScene scene(PlateScene::Skull, PlateScene::Kidney);
  PressOptions options;
  options.PlateMargin = 3;
  const PressSurface press = scene.Press(options);
  double area = 0;
  for (std::size_t k = 0; k < press.Points.size(); ++k)
  {
    if (press.Defect[k])
    {
      EXPECT_EQ(press.Regions[k], PressRegion::Plate);
      // back along the normal to the pixel of the defect; a mirrored kidney is another
      Vec2 foot;
      double offset = 0;
      ASSERT_TRUE(
        FindFoot(scene.Surface, press.PressToRelief.Point(press.Points[k]), foot, offset));
      const double x = PlateScene::Pixel * std::round(foot[0] / PlateScene::Pixel);
      const double y = PlateScene::Pixel * std::round(foot[1] / PlateScene::Pixel);
      EXPECT_TRUE(PlateScene::Kidney(x - PlateScene::Middle, y - PlateScene::Middle));
      area += scene.Layout.Grid.Spacing[0] * scene.Layout.Grid.Spacing[1];
    }
  }
  double seen = 0;
  for (const unsigned char m : scene.Mask)
  {
    seen += m ? PlateScene::Pixel * PlateScene::Pixel : 0;
  }
  EXPECT_NEAR(area / seen, 1, 0.05);
}

//------------------------------------------------------------------------------
TEST(PressSurface, SameBitsForAnyNumberOfThreads)
{
  PressOptions options;
  options.PlateMargin = 2;
  PressScene one(PlateScene::Skull, PlateScene::Kidney, 1);
  const PressSurface first = one.Press(options);
  for (const int threads : { 2, 5 })
  {
    PressScene scene(PlateScene::Skull, PlateScene::Kidney, threads);
    const PressSurface other = scene.Press(options);
    ASSERT_EQ(other.Points.size(), first.Points.size());
    EXPECT_EQ(
      std::memcmp(other.Points.data(), first.Points.data(), sizeof(Vec3) * first.Points.size()), 0);
    EXPECT_EQ(std::memcmp(other.WallAngles.data(), first.WallAngles.data(),
                sizeof(double) * first.WallAngles.size()),
      0);
    EXPECT_EQ(std::memcmp(other.PressToRelief.Data(), first.PressToRelief.Data(), 128), 0);
  }
}
