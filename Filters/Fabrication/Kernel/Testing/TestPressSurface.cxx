// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressSurface.h"

#include "lacunaFlangeBlend.h"
#include "lacunaPressScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double Degrees = 180 / Pi;

bool Disc20(double x, double y)
{
  return std::hypot(x, y) <= 20;
}

double Dish(double x, double y) // bulges away from the viewer
{
  return 60 - PlateScene::Ball(x, y);
}

std::string ErrorOf(const std::function<void()>& body)
{
  try
  {
    body();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return {};
}

void ExpectRotation(const Matrix4& m)
{
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      EXPECT_NEAR(Dot(m.Column(a), m.Column(b)), a == b ? 1 : 0, 1e-14);
    }
  }
  EXPECT_NEAR(m.Determinant3(), 1, 1e-14);
}
}

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
    options.Spacing = 0.5;
    // one point of the middle in all grids, and even numbers of equal steps to it
    options.BlockSize = { 96, 96, 0 };
    const PressSurface fine = skull.Press(options, { 0.1, 0.05, -1 });
    const std::int64_t columns = skull.Layout.Grid.Columns;
    for (const int step : { 2, 3 })
    {
      options.Spacing = 0.5 * step;
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
    }
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
TEST(PressSurface, BlockAsGivenOrAsSmallAsItTakes)
{
  PressScene scene(PlateScene::Ball, Disc20);
  PressOptions options;
  options.FlangeWidth = 6;
  options.Spacing = 0.7;
  options.BlockSize = { 100, 80, 40 };
  const PressSurface press = scene.Press(options);
  EXPECT_EQ(press.BlockSize, options.BlockSize);
  EXPECT_NEAR(press.Points.front()[0], -50, 1e-12);
  EXPECT_NEAR(press.Points.front()[1], -40, 1e-12);
  EXPECT_NEAR(press.Points.back()[0], 50, 1e-12);
  EXPECT_NEAR(press.Points.back()[1], 40, 1e-12);
  EXPECT_LE(scene.Layout.Grid.Spacing[0], 0.7);
  options.BlockSize = { 100, 60, 40 };
  EXPECT_NE(
    ErrorOf([&] { scene.Press(options); }).find("60 mm along y, and plate and flange need 63"),
    std::string::npos);
  options.BlockSize = { 100, 80, 5 };
  EXPECT_NE(ErrorOf([&] { scene.Press(options); }).find("5 mm along z"), std::string::npos);
}

//------------------------------------------------------------------------------
TEST(PressSurface, UndercutsAreSeen)
{
  // a slope of 50 degrees, laid flat by a plane of -50: 100 degrees
  const double slope = std::tan(50 / Degrees);
  PressScene scene([&](double x, double) { return 60 + slope * x; }, Disc20);
  PressOptions options;
  options.FlangeWidth = 5;
  const PressLayout layout = PlanPress(scene.Execution, scene.Surface, scene.Size, scene.Spacing,
    scene.Mask, { -slope, 0, -1 }, options);
  EXPECT_FALSE(layout.SingleValued);
  EXPECT_NEAR(layout.SteepestAngle, 100, 1e-6);
  EXPECT_EQ(layout.Grid.Columns, 0);
  const PressLayout flat = PlanPress(scene.Execution, scene.Surface, scene.Size, scene.Spacing,
    scene.Mask, { slope, 0, -1 }, options);
  EXPECT_TRUE(flat.SingleValued);
  EXPECT_NEAR(flat.SteepestAngle, 0, 1e-5);
}

//------------------------------------------------------------------------------
// The view that faces a part squarely is told by its rim, whatever the surface does inside.
TEST(PressSurface, TheFacingViewDependsOnTheRim)
{
  const auto plane = [](double x, double y) { return 60 + 0.9 * x - 0.4 * y; };
  const auto swinging = [&](double x, double y)
  {
    const double r = std::hypot(x - 3, y + 2);
    return plane(x, y) + (r < 15 ? 9 * std::pow(std::cos(r * Pi / 30), 4) * (1 + 0.1 * x) : 0);
  };
  const Vec3 expected = Normalized({ -0.9, 0.4, 1 });
  for (const double margin : { 0.0, 5.0 })
  {
    PressScene flat(plane, Disc20);
    const Vec3 view = FindFacingView(flat.Surface, flat.Size, flat.Spacing, flat.Mask, margin);
    EXPECT_LT(Norm(view - expected), 1e-9);
    PressScene scene(swinging, Disc20);
    const Vec3 same = FindFacingView(scene.Surface, scene.Size, scene.Spacing, scene.Mask, margin);
    EXPECT_LT(Norm(same - expected), 0.002); // a tenth of a degree
    const Vec3 ofPlane =
      FitPlaneNormal(scene.Size, scene.Depths, scene.Spacing, scene.Mask); // is another
    EXPECT_GT(Norm(ofPlane + expected), 0.02);
  }
  // the margin counts: a rim that turns away on one side
  const auto bent = [](double x, double) { return 60 + (x > 20 ? (x - 20) * (x - 20) : 0); };
  PressScene scene(bent, Disc20);
  const auto view = [&](double margin)
  { return FindFacingView(scene.Surface, scene.Size, scene.Spacing, scene.Mask, margin); };
  EXPECT_LT(std::abs(view(0)[0]), 0.01);
  EXPECT_LT(view(5)[0], -0.05);
}

//------------------------------------------------------------------------------
TEST(PressSurface, FoldsAreRefusedWithTheirPlace)
{
  // a ridge of 1.25 mm radius at x = 5
  const auto ridge = [](double x, double) { return 50 - 3 * std::exp(-(x - 5) * (x - 5) / 7.5); };
  PressScene scene(ridge, Disc20);
  PressOptions options;
  options.PlateThickness = 2;
  options.Convex = ConvexSide::Outward;
  // outwards of a ridge there is room
  EXPECT_NO_THROW(scene.Press(options));
  options.Mould = PressMould::Male;
  options.Seating = PlateSeating::Inlay;
  const std::string error = ErrorOf([&] { scene.Press(options); });
  EXPECT_NE(error.find("radius below PlateThickness (2 mm) at (45.0"), std::string::npos) << error;
  options.PlateThickness = 1;
  EXPECT_NO_THROW(scene.Press(options));
}

//------------------------------------------------------------------------------
TEST(PressSurface, TheFlangeNeedsNoFit)
{
  PressScene scene(PlateScene::Skull, Disc20); // 20 mm around the disc
  PressOptions options;
  options.PlateMargin = 14;
  options.FlangeWidth = 15;
  const double steep = scene.Press(options).DraftAngle;
  options.FlangeWidth = 40;
  EXPECT_LT(scene.Press(options).DraftAngle, steep - 10);
  options.PlateMargin = 19.5;
  EXPECT_NE(
    ErrorOf([&] { scene.Press(options); }).find("raise OutputMargin of RBF Hole Filler by 2 mm"),
    std::string::npos);
}

//------------------------------------------------------------------------------
TEST(PressSurface, OptionsOutOfRangeAreRefused)
{
  PressScene scene(PlateScene::Ball, Disc20);
  const auto expect = [&](const std::function<void(PressOptions&)>& change, const char* text)
  {
    PressOptions options;
    change(options);
    const std::string error = ErrorOf([&] { scene.Press(options); });
    EXPECT_NE(error.find(text), std::string::npos) << error;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect([](PressOptions& o) { o.PlateThickness = 0; }, "PlateThickness is 0");
  expect([&](PressOptions& o) { o.PlateThickness = nan; }, "PlateThickness is nan");
  expect([](PressOptions& o) { o.PlateMargin = -1; }, "PlateMargin is -1");
  expect([](PressOptions& o) { o.FlangeWidth = -1; }, "FlangeWidth is -1");
  expect([](PressOptions& o) { o.Spacing = 0; }, "OutputSpacing is 0");
  expect([](PressOptions& o) { o.Spacing = 1e-4; }, "make it larger");
  const LoopDistance curves({ Loop{ { 0, 0 }, { 40, 0 }, { 40, 40 } } });
  EXPECT_NE(ErrorOf([&] { FlangeBlend(scene.Execution, curves, 5, 0.01); }).find("too narrow"),
    std::string::npos);
  expect([](PressOptions& o) { o.Spacing = 1.9; }, "at most an eighth of that, 1.875 mm");
  expect([](PressOptions& o) { o.FlangeWidth = 3; }, "coarse for a flange of 3 mm");
  expect([](PressOptions& o) { o.BlockSize[0] = -1; }, "BlockSize is -1");
  expect([&](PressOptions& o) { o.BlockSize[2] = nan; }, "BlockSize is nan");
  expect([](PressOptions& o) { o.BlockSize = { 1e9, 1e9, 0 }; }, "make it larger");
  PressScene none(PlateScene::Ball, [](double, double) { return false; });
  EXPECT_NE(ErrorOf([&] { none.Press({}); }).find("no sample"), std::string::npos);
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
