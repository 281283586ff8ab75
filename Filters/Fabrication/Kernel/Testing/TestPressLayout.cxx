// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressLayout.h"

#include "lacunaFlangeBlend.h"
#include "lacunaPressScene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

using namespace lacuna;
using lacunaPress::Degrees;
using lacunaPress::Disc20;
using lacunaPress::ErrorOf;
using lacunaPress::Pi;

//------------------------------------------------------------------------------
TEST(PressLayout, BlockAsGivenOrAsSmallAsItTakes)
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
TEST(PressLayout, UndercutsAreSeen)
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
TEST(PressLayout, TheFacingViewDependsOnTheRim)
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
TEST(PressLayout, FoldsAreRefusedWithTheirPlace)
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
TEST(PressLayout, TheFlangeNeedsNoFit)
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
TEST(PressLayout, OptionsOutOfRangeAreRefused)
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
