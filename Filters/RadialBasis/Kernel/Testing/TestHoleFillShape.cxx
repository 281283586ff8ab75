// SPDX-License-Identifier: BSD-3-Clause
// What shapes the filling besides the surface around it: control points, a prior surface, a trend.
#include "lacunaHoleFillTest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

using namespace lacunaHoleFillTest;

TEST(HoleFill, PassesThroughControlPoints)
{
  for (const auto solver : { lacuna::RadialSolver::Direct, lacuna::RadialSolver::Fast })
  {
    HoleFillInput input = MakeMap(Sphere);
    HoleFillOptions options;
    options.Solver = solver;
    options.Smoothing = 1;
    options.Accuracy = 1e-6;
    lacuna::ThreadExecution execution(2);
    lacuna::HoleFiller filler;
    const HoleFillResult before = filler.Fill(execution, input, options);
    const std::size_t pixel = 27 * Width + 30; // the middle of the defect, and 4 mm beside it
    const std::size_t other = 27 * Width + 34;
    input.ControlPoints = { { 45, 27, before.Fitted[pixel] + 2 }, { 60, 27, 11 } };
    HoleFillResult result;
    for (int step = 0; step < 3; ++step) // the user drags the first one deeper
    {
      input.ControlPoints[0][2] += 0.5;
      input.ControlPoints[1][1] += 0.25;
      result = filler.Fill(execution, input, options);
      EXPECT_EQ(result.Reused, step > 0);
    }
    EXPECT_NEAR(result.Fitted[pixel], input.ControlPoints[0][2], 1e-5);
    EXPECT_GT(result.Fitted[other], before.Fitted[other] + 0.5); // the surface follows
    EXPECT_NEAR(result.Fit.NodeCount, before.Fit.NodeCount, 4);
    const HoleFillResult fresh = Fill(input, options);
    EXPECT_EQ(std::memcmp(fresh.Fitted.data(), result.Fitted.data(), fresh.Fitted.size() * 8), 0);
    EXPECT_EQ(fresh.Gradients, result.Gradients);
    // and back
    input.ControlPoints.clear();
    const HoleFillResult after = filler.Fill(execution, input, options);
    EXPECT_EQ(std::memcmp(before.Fitted.data(), after.Fitted.data(), after.Fitted.size() * 8), 0);
  }
}

TEST(HoleFill, RefusesBadControlPoints)
{
  HoleFillInput input = MakeMap(Plane);
  input.ControlPoints = { { 45, 27, 30 }, { 200, 27, 30 } };
  ExpectContains(ErrorOf(input), "control point 1 lies beside the map");
  input.ControlPoints[1] = { 45, 27, 31 };
  ExpectContains(ErrorOf(input), "lie at the same place");
  input.ControlPoints[1] = { 45, 27, 30 };
  EXPECT_EQ(ErrorOf(input), "");
  input.ControlPoints[1] = { 45, std::nan(""), 30 };
  ExpectContains(ErrorOf(input), "not a finite number");
}

namespace
{
// The prior's own lattice is inclined and shifted against the map, and coarser.
lacuna::SurfaceSheet MakeSheet(double (*surface)(double, double))
{
  lacuna::SurfaceSheet sheet;
  sheet.Width = 130;
  sheet.Height = 120;
  for (int j = 0; j < sheet.Height; ++j)
  {
    for (int i = 0; i < sheet.Width; ++i)
    {
      const double x = -12.3 + 1.1 * i - 0.2 * j;
      const double y = -15.1 + 0.1 * i + 0.9 * j;
      sheet.Points.push_back({ x, y, surface(x, y) });
    }
  }
  return sheet;
}

double Bump(double x, double y)
{
  return 2 * std::exp(-(std::pow(x - 42, 2) + std::pow(y - 25, 2)) / 60);
}

double BumpedSphere(double x, double y)
{
  return Sphere(x, y) + Bump(x, y);
}

// Nearer and inclined: what the residual's polynomial takes up.
double Prior(double x, double y)
{
  return BumpedSphere(x, y) - 7 + 0.1 * x;
}

double GetWorst(const HoleFillResult& result)
{
  double worst = 0;
  for (const std::size_t pixel : result.Filled)
  {
    worst = std::max(worst, std::abs(result.Deviation[pixel]));
  }
  return worst;
}
}

TEST(HoleFill, KeepsTheShapeOfAPrior)
{
  HoleFillInput input = MakeMap(BumpedSphere); // the bump is in the defect
  HoleFillOptions options;
  options.OutputSpacing = { 0.75, 1 };
  options.Accuracy = 0;
  EXPECT_GT(GetWorst(Fill(input, options)), 1.5);
  input.Prior = MakeSheet(Prior);
  const HoleFillResult result = Fill(input, options);
  EXPECT_LT(GetWorst(result), 0.03); // the prior's triangles are flat
  double residual = 0;
  std::size_t met = 0;
  for (std::size_t i = 0; i < result.Use.size(); ++i)
  {
    if (result.Use[i] == lacuna::SupportUse::Used)
    {
      met += std::abs(result.Deviation[i]) < 1e-9;
      residual = std::max(residual, std::abs(result.Deviation[i]));
    }
  }
  EXPECT_GE(met, result.Fit.NodeCount); // the margin is met exactly at the nodes
  EXPECT_LT(residual, 0.03);
  // The gradients are those of the whole surface.
  for (std::size_t k = 0; k < result.Filled.size(); ++k)
  {
    const std::size_t i = result.Filled[k];
    EXPECT_NEAR(result.Gradients[k][0], (result.Fitted[i + 1] - result.Fitted[i - 1]) / 1.5, 0.03);
  }

  // on the map's own grid the prior is taken as it is
  lacuna::SurfaceSheet own;
  own.Width = Width;
  own.Height = Height;
  for (std::size_t i = 0; i < Width * Height; ++i)
  {
    own.Points.push_back({ GetX(i), GetY(i), Prior(GetX(i), GetY(i)) });
  }
  input.Prior = own;
  EXPECT_LT(GetWorst(Fill(input)), 1e-9);

  // what is missing of it is bridged and named
  input.Prior.Points[27 * Width + 30][2] = std::nan("");
  const HoleFillResult bridged = Fill(input);
  ASSERT_EQ(bridged.Warnings.size(), 1u);
  ExpectContains(
    bridged.Warnings[0], "pixels of the defect, first at column 30, row 27, the prior");
  EXPECT_LT(GetWorst(bridged), 0.05);
  input.Prior = own;
  input.Prior.Points[27 * Width + 44][2] = std::nan("");
  const HoleFillResult lacking = Fill(input);
  ASSERT_EQ(lacking.Warnings.size(), 1u);
  ExpectContains(lacking.Warnings[0], "first at column 44, row 27, the prior surface is missing");
  EXPECT_EQ(lacking.Use[27 * Width + 44], lacuna::SupportUse::NoPrior);
  EXPECT_LT(GetWorst(lacking), 1e-5);
  for (lacuna::Vec3& p : input.Prior.Points)
  {
    p[0] += 1000;
  }
  ExpectContains(ErrorOf(input), "nowhere around the defect");
  options.Trend = lacuna::HoleTrend::Ellipsoid;
  ExpectContains(ErrorOf(input, options), "exclude each other");
}

// A prior of the true shape with a hole of its own, through which the far side is seen: wherever the
// hole lies, its rim is no surface to follow, and the place is told.
TEST(HoleFill, BridgesHolesOfThePrior)
{
  const HoleFillInput input = MakeMap(Sphere); // the defect: 15 mm around (45, 27)
  HoleFillOptions options;
  options.SupportStepMargin = 2;
  struct Case
  {
    double X, Y, Radius; // of the prior's hole, mm
    double Error;        // mm
    bool Rim;            // whether it comes into the rim
  };
  for (const Case& c : { Case{ 45, 27, 1.6, 0.03, false }, Case{ 38, 30, 5, 0.05, false },
         Case{ 60, 27, 12, 0.2, true }, Case{ 30, 36, 12, 0.2, true },
         Case{ 65, 27, 33, 0.3, true } }) // in most of the rim
  {
    for (const double depth : { 80.0, std::nan("") })
    {
      HoleFillInput own = input;
      own.Prior.Width = Width;
      own.Prior.Height = Height;
      for (std::size_t i = 0; i < Width * Height; ++i)
      {
        const double x = GetX(i);
        const double y = GetY(i);
        const bool hole = std::hypot(x - c.X, y - c.Y) <= c.Radius;
        own.Prior.Points.push_back(
          { x, y, hole ? 150 + 0.2 * depth : Sphere(x, y) - 3 + 0.05 * x });
      }
      const HoleFillResult result = Fill(own, options);
      EXPECT_LT(GetWorst(result), c.Error) << c.Radius << " at " << c.X << ", " << c.Y;
      std::string all;
      for (const std::string& warning : result.Warnings)
      {
        all += warning + "\n";
      }
      ExpectContains(all, "pixels of the defect, first at column ");
      ExpectContains(all, "the prior surface is missing or lies beyond a depth step");
      EXPECT_EQ(all.find("pixels around the defect") != std::string::npos, c.Rim) << all;
      std::size_t rim = 0;
      for (std::size_t i = 0; i < result.Use.size(); ++i)
      {
        if (result.Use[i] == lacuna::SupportUse::NoPrior)
        {
          ++rim;
          EXPECT_LT(std::abs(result.Deviation[i]), 0.1);
        }
      }
      EXPECT_EQ(rim > 0, c.Rim);
    }
  }
}

// Through a hole that is larger than the defect and its rim only a far wall is seen: nothing is to be bridged.
TEST(HoleFill, DoubtsAPriorThatIsFarAway)
{
  HoleFillInput input = MakeMap(Sphere);
  input.Prior.Width = Width;
  input.Prior.Height = Height;
  for (std::size_t i = 0; i < Width * Height; ++i)
  {
    input.Prior.Points.push_back({ GetX(i), GetY(i), 150 + 0.01 * GetX(i) });
  }
  const std::vector<std::string> warnings = Fill(input).Warnings;
  ASSERT_EQ(warnings.size(), 1u);
  ExpectContains(warnings[0], "the prior surface is 135 mm from the bone around the defect");
  for (lacuna::Vec3& point : input.Prior.Points)
  {
    point[2] = Sphere(point[0], point[1]) + 20;
  }
  EXPECT_TRUE(Fill(input).Warnings.empty());
}

// A drill hole that lies between the pixels of the map shows itself on a finer output.
TEST(HoleFill, BridgesPinholesBetweenPixels)
{
  HoleFillInput input = MakeMap(Sphere);
  input.Prior.Width = 420;
  input.Prior.Height = 220;
  for (int k = 0; k < input.Prior.Width * input.Prior.Height; ++k)
  {
    const double x = 0.25 * (k % input.Prior.Width);
    const double y = 0.25 * (k / input.Prior.Width);
    const bool hole = std::hypot(x - 45.75, y - 27.5) < 0.45;
    input.Prior.Points.push_back({ x, y, hole ? 150 : Sphere(x, y) });
  }
  HoleFillOptions options;
  options.OutputSpacing = { 0.25, 0.25 };
  EXPECT_LT(GetWorst(Fill(input, options)), 0.05);
}

// What Fitted is needed for beyond the trend or the prior is there, and goes on without a kink.
TEST(HoleFill, FittedIsCompleteBeyondTrendAndPrior)
{
  const auto expectWhole = [](const HoleFillResult& result, double bend)
  {
    const auto width = static_cast<std::size_t>(result.Grid.Width);
    std::size_t count = 0;
    double worst = 0; // of slopes from pixel to pixel
    for (int j = result.Rectangle[2]; j <= result.Rectangle[3]; ++j)
    {
      for (int i = result.Rectangle[0]; i <= result.Rectangle[1]; ++i)
      {
        const std::size_t pixel = j * width + i;
        count += std::isfinite(result.Fitted[pixel]) ? 0 : 1;
        if (i > result.Rectangle[0] && i < result.Rectangle[1])
        {
          worst = std::max(worst,
            std::abs(
              result.Fitted[pixel + 1] + result.Fitted[pixel - 1] - 2 * result.Fitted[pixel]) /
              result.Grid.Spacing[0]);
        }
      }
    }
    EXPECT_EQ(count, 0u);
    EXPECT_LT(worst, bend);
    EXPECT_LT(GetWorst(result), 0.05);
  };
  HoleFillOptions options;
  options.Trend = lacuna::HoleTrend::Ellipsoid;
  options.OutputMargin = 70; // the sphere ends 90 mm from its middle
  expectWhole(Fill(MakeMap(Sphere), options), 0.5);

  options.Trend = lacuna::HoleTrend::None;
  HoleFillInput input = MakeMap(Sphere);
  input.Prior.Width = Width;
  input.Prior.Height = Height;
  for (std::size_t i = 0; i < Width * Height; ++i)
  {
    const double x = GetX(i);
    const double y = GetY(i);
    const bool none = x + y > 92 || x - y > 32; // corners of the rim's rectangle
    input.Prior.Points.push_back({ x, y, none ? std::nan("") : Sphere(x, y) });
  }
  for (const double margin : { 0.0, 20.0 })
  {
    options.OutputMargin = margin;
    options.OutputSpacing = { margin > 0 ? 0.75 : 0.0, 0 };
    expectWhole(Fill(input, options), 0.1);
  }
}

// With smoothing the ripple of the prior's voxels is not in the filling either.
TEST(HoleFill, SmoothsThePrior)
{
  HoleFillInput input = MakeMap(BumpedSphere);
  input.Prior.Width = Width;
  input.Prior.Height = Height;
  for (std::size_t i = 0; i < Width * Height; ++i)
  {
    const double ripple = i % Width % 2 == 0 ? 0.1 : -0.1;
    input.Prior.Points.push_back({ GetX(i), GetY(i), BumpedSphere(GetX(i), GetY(i)) + ripple });
  }
  const auto getRipple = [](const HoleFillResult& result)
  {
    double sum = 0;
    for (const std::size_t i : result.Filled)
    {
      sum += std::abs(result.Deviation[i + 1] + result.Deviation[i - 1] - 2 * result.Deviation[i]);
    }
    return 0.25 * sum / static_cast<double>(result.Filled.size());
  };
  HoleFillOptions options;
  EXPECT_GT(getRipple(Fill(input, options)), 0.08);
  options.CutoffWavelength = 10;
  const HoleFillResult smooth = Fill(input, options);
  EXPECT_LT(getRipple(smooth), 0.03); // 3 mm long; half of 5 mm would be left
  EXPECT_LT(GetWorst(smooth), 0.3);   // the bump's own bending
  options.CutoffWavelength = 0;
  options.Smoothing = 50;
  EXPECT_LT(getRipple(Fill(input, options)), 0.02);
}

TEST(HoleFill, EllipsoidTrend)
{
  const auto ellipsoid = [](double x, double y)
  { return 100 - 90 * std::sqrt(1 - std::pow((x - 50) / 80, 2) - std::pow((y - 30) / 100, 2)); };
  HoleFillOptions options;
  options.Trend = lacuna::HoleTrend::Ellipsoid;
  EXPECT_LT(GetWorst(Fill(MakeMap(Sphere), options)), 1e-8); // a sphere it is exactly
  const double plain = GetWorst(Fill(MakeMap(ellipsoid)));
  const double trend = GetWorst(Fill(MakeMap(ellipsoid), options));
  EXPECT_LT(trend, 0.1 * plain) << plain;
  // from the inside
  EXPECT_LT(
    GetWorst(Fill(MakeMap([](double x, double y) { return -Sphere(x, y); }), options)), 1e-8);
  ExpectContains(ErrorOf(MakeMap(Plane), options), "does not determine an ellipsoid");
  ExpectContains(
    ErrorOf(MakeMap([](double x, double y) { return 0.02 * (x - 45) * (y - 27); }), options),
    "does not determine an ellipsoid");
}
