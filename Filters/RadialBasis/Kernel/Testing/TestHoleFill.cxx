// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFillTest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace lacunaHoleFillTest;

TEST(HoleFill, ReproducesAPlane)
{
  HoleFillInput input = MakeMap(Plane);
  for (std::size_t i = 0; i < input.Depth.size(); ++i)
  {
    if (input.Defect[i])
    {
      input.Valid[i] = 0;
      input.Depth[i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  const HoleFillResult result = Fill(input);
  for (std::size_t i = 0; i < input.Depth.size(); ++i)
  {
    if (input.Defect[i])
    {
      EXPECT_NEAR(result.Fitted[i], Plane(GetX(i), GetY(i)), 1e-9);
      EXPECT_TRUE(std::isnan(result.Deviation[i])) << "nothing was measured there";
    }
  }
  EXPECT_NEAR(result.Plane[0], 30, 1e-8);
  EXPECT_NEAR(result.Plane[1], 0.25, 1e-10);
  EXPECT_NEAR(result.Plane[2], -0.5, 1e-10);
  ASSERT_EQ(result.Filled.size(), result.Gradients.size());
  for (const auto& g : result.Gradients)
  {
    EXPECT_NEAR(g[0], 0.25, 1e-9);
    EXPECT_NEAR(g[1], -0.5, 1e-9);
  }
  EXPECT_NEAR(result.DefectArea,
    1.5 * static_cast<double>(result.Filled.size()) * std::sqrt(1 + 0.0625 + 0.25), 1e-6);
  EXPECT_TRUE(result.Warnings.empty());
}

TEST(HoleFill, RestoresASphere)
{
  // Removed data are compared with the fit; nodes are restored exactly.
  const HoleFillInput input = MakeMap(Sphere);
  HoleFillOptions options;
  options.Accuracy = 0;
  const HoleFillResult result = Fill(input, options);
  double worst = 0;
  std::size_t nodes = 0;
  for (std::size_t i = 0; i < input.Depth.size(); ++i)
  {
    if (input.Defect[i])
    {
      worst = std::max(worst, std::abs(result.Deviation[i]));
      EXPECT_NEAR(result.Deviation[i], result.Fitted[i] - input.Depth[i], 1e-12);
    }
    else if (result.Use[i] == lacuna::SupportUse::Used)
    {
      nodes += std::abs(result.Deviation[i]) < 1e-10;
    }
    else
    {
      EXPECT_TRUE(std::isnan(result.Deviation[i]));
    }
  }
  EXPECT_LT(worst, 0.15); // of a cap 1.3 mm high
  EXPECT_EQ(nodes, result.Fit.NodeCount);
  // The default is within its accuracy, of the range of depths.
  const HoleFillResult quick = Fill(input);
  const auto depths = std::minmax_element(input.Depth.begin(), input.Depth.end());
  for (const std::size_t i : result.Filled)
  {
    EXPECT_NEAR(quick.Fitted[i], result.Fitted[i], 2e-4 * (*depths.second - *depths.first));
  }
  EXPECT_LT(result.Fit.Residual, 1e-10);
}

TEST(HoleFill, FittedIsCompleteOnItsRectangle)
{
  const HoleFillInput input = MakeMap(Sphere);
  HoleFillOptions options;
  options.SupportMargin = 6;
  for (const int margin : { 0, 4, 30 })
  {
    options.OutputMargin = margin;
    const HoleFillResult result = Fill(input, options);
    // the map grows by whole pixels
    EXPECT_EQ(result.Grid.FirstColumn, -(2 * margin / 3));
    EXPECT_EQ(result.Grid.Width, 71 + 2 * (2 * margin / 3));
    EXPECT_EQ(result.Grid.FirstRow, -margin);
    EXPECT_EQ(result.Grid.Height, 61 + 2 * margin);
    // defect 30..60 x 12..42 mm, support 6 mm around
    const int grow[2] = { (2 * margin + 2) / 3, margin };
    const int column = result.Grid.FirstColumn;
    const int row = result.Grid.FirstRow;
    EXPECT_EQ(result.Rectangle[0], 16 - grow[0] - column);
    EXPECT_EQ(result.Rectangle[1], 44 + grow[0] - column);
    EXPECT_EQ(result.Rectangle[2], 6 - grow[1] - row);
    EXPECT_EQ(result.Rectangle[3], 48 + grow[1] - row);
    for (std::size_t i = 0; i < result.Fitted.size(); ++i)
    {
      const int c = static_cast<int>(i % result.Grid.Width);
      const int r = static_cast<int>(i / result.Grid.Width);
      const bool inside = c >= result.Rectangle[0] && c <= result.Rectangle[1] &&
        r >= result.Rectangle[2] && r <= result.Rectangle[3];
      EXPECT_EQ(std::isfinite(result.Fitted[i]), inside);
    }
  }
}

TEST(HoleFill, OutputOfAnotherSpacing)
{
  const HoleFillInput input = MakeMap(Plane);
  const HoleFillResult same = Fill(input);
  HoleFillOptions options;
  options.OutputSpacing = { 0.4, 0.7 };
  const HoleFillResult fine = Fill(input, options);
  EXPECT_EQ(fine.Grid.Width, 263); // 105 mm
  EXPECT_EQ(fine.Grid.Height, 86); // 60 mm
  std::size_t filled = 0;
  for (std::size_t i = 0; i < fine.Depth.size(); ++i)
  {
    const double x = 0.4 * static_cast<double>(i % 263);
    const double y = 0.7 * static_cast<double>(i / 263);
    EXPECT_NEAR(fine.Depth[i], Plane(x, y), 1e-9);
    // nearest pixel of the map
    const auto nearest =
      static_cast<std::size_t>(std::lround(x / 1.5) + static_cast<long>(Width) * std::lround(y));
    EXPECT_EQ(fine.Nearest[i], static_cast<std::int64_t>(nearest)) << x << " " << y;
    EXPECT_EQ(fine.Use[i], same.Use[nearest]);
    filled += input.Defect[nearest];
  }
  EXPECT_EQ(fine.Filled.size(), filled);
  const double area = 3.14159265358979 * 15 * 15 * std::sqrt(1 + 0.0625 + 0.25); // of the disc
  EXPECT_NEAR(fine.DefectArea, area, 0.005 * area);
  options.OutputSpacing = { 1e-9, 0 };
  ExpectContains(ErrorOf(input, options), "raise OutputSpacing");
  options.OutputSpacing = { 0, -1 };
  ExpectContains(ErrorOf(input, options), "OutputSpacing is -1");
}

TEST(HoleFill, OldDepthsOfTheDefectDoNotLeakOut)
{
  // Beside the defect a finer lattice lies between sound pixels and replaced ones.
  for (const double old : { -3.0, std::numeric_limits<double>::quiet_NaN() })
  {
    HoleFillInput input = MakeMap(Plane);
    for (std::size_t i = 0; i < input.Depth.size(); ++i)
    {
      input.Depth[i] += input.Defect[i] ? old : 0;
      input.Valid[i] = std::isfinite(input.Depth[i]);
    }
    HoleFillOptions options;
    options.OutputSpacing = { 0.4, 0.7 };
    const HoleFillResult fine = Fill(input, options);
    std::size_t open = 0;
    for (std::size_t i = 0; i < fine.Depth.size(); ++i)
    {
      const double x = 0.4 * static_cast<double>(i % 263);
      const double y = 0.7 * static_cast<double>(i / 263);
      EXPECT_NEAR(fine.Depth[i], Plane(x, y), 1e-9) << x << " " << y << " " << old;
      if (fine.Use[i] == lacuna::SupportUse::Used)
      {
        open += std::isnan(fine.Deviation[i]);
        EXPECT_FALSE(std::abs(fine.Deviation[i]) > 1e-9) << x << " " << y << " " << old;
      }
    }
    EXPECT_GT(open, 0U);
    EXPECT_LT(open, fine.Filled.size() / 5);
  }
}

TEST(HoleFill, MeasuredDepthIsNotInterpolatedOverSteps)
{
  HoleFillInput input = MakeMap([](double x, double) { return x < 80 ? 10 : 50; });
  HoleFillOptions options;
  options.OutputSpacing = { 0.75, 1 };
  const HoleFillResult result = Fill(input, options);
  for (std::size_t i = 0; i < result.Depth.size(); ++i)
  {
    const double x = 0.75 * static_cast<double>(i % result.Grid.Width);
    EXPECT_EQ(std::isnan(result.Depth[i]), x == 79.5 + 0.75) << x; // between 79.5 and 81
  }
}

TEST(HoleFill, SaysWhichBoneItUsed)
{
  // A cliff on one side: nothing to fit there within the margin.
  HoleFillInput input = MakeMap([](double x, double y) { return Plane(x, y) + (x > 50 ? 60 : 0); });
  const HoleFillResult result = Fill(input);
  ASSERT_EQ(result.Warnings.size(), 2u);
  ExpectContains(result.Warnings[0], "beyond a depth step of up to");
  ExpectContains(result.Warnings[1], "% of its edge, first at column");
  bool beyond = false;
  for (std::size_t i = 0; i < result.Use.size(); ++i)
  {
    EXPECT_TRUE(result.Use[i] != lacuna::SupportUse::Used || GetX(i) <= 50);
    beyond = beyond || result.Use[i] == lacuna::SupportUse::BeyondStep;
  }
  EXPECT_TRUE(beyond);
}

TEST(HoleFill, IsTheSameForAnyNumberOfThreads)
{
  const HoleFillInput input = MakeMap(Sphere);
  const HoleFillResult one = Fill(input, {}, 1);
  for (const int threads : { 2, 5 })
  {
    const HoleFillResult other = Fill(input, {}, threads);
    EXPECT_EQ(std::memcmp(one.Fitted.data(), other.Fitted.data(), one.Fitted.size() * 8), 0);
    EXPECT_EQ(one.Gradients, other.Gradients);
    EXPECT_EQ(one.DefectArea, other.DefectArea);
  }
}

TEST(HoleFill, UsesPaintedSupportOnly)
{
  // An artefact beside the defect spoils the fit unless only sound surface is painted.
  HoleFillInput input = MakeMap(Plane);
  HoleFillInput painted = input;
  painted.Painted.assign(input.Grid.GetSize(), 0);
  for (std::size_t i = 0; i < input.Depth.size(); ++i)
  {
    const double x = GetX(i);
    const bool artefact = x > 62;
    painted.Depth[i] = input.Depth[i] += artefact ? 0.5 * (x - 62) : 0;
    painted.Painted[i] = !artefact && x > 20;
  }
  const HoleFillResult spoilt = Fill(input);
  const HoleFillResult sound = Fill(painted);
  const std::size_t right = 27 * Width + 38; // in the defect, near the artefact
  EXPECT_GT(std::abs(spoilt.Deviation[right]), 0.1);
  EXPECT_NEAR(sound.Deviation[right], 0, 1e-9);
}

TEST(HoleFill, WarnsOfAStepAndFitsTheLargerPart)
{
  // a floor is seen 40 mm below in a part of the surroundings
  HoleFillInput input = MakeMap(Plane);
  for (std::size_t i = 0; i < input.Depth.size(); ++i)
  {
    if (i % Width > 45)
    {
      input.Depth[i] += 40;
    }
  }
  const HoleFillResult result = Fill(input);
  ASSERT_EQ(result.Warnings.size(), 1u);
  ExpectContains(result.Warnings[0], "beyond a depth step");
  EXPECT_NEAR(result.Fitted[27 * Width + 30], Plane(45, 27), 1e-9);
}

TEST(HoleFill, WarnsOfADefectAtTheBorder)
{
  HoleFillInput input = MakeMap(Plane);
  for (std::size_t j = 20; j < 30; ++j)
  {
    input.Defect[j * Width] = 1;
  }
  const HoleFillResult result = Fill(input);
  ASSERT_EQ(result.Warnings.size(), 1u);
  ExpectContains(result.Warnings[0], "border");
  EXPECT_NEAR(result.Fitted[25 * Width], Plane(0, 25), 1e-9);
}

TEST(HoleFill, SmoothingSuppressesRipple)
{
  const HoleFillInput input = MakeMap(
    [](double x, double y) { return Sphere(x, y) + 0.2 * std::sin(2 * x) * std::cos(3 * y); });
  const auto worst = [&](double smoothing)
  {
    HoleFillOptions options;
    options.Smoothing = smoothing;
    const HoleFillResult result = Fill(input, options);
    double error = 0;
    for (const std::size_t i : result.Filled)
    {
      error = std::max(error, std::abs(result.Fitted[i] - Sphere(GetX(i), GetY(i))));
    }
    return error;
  };
  EXPECT_LT(worst(20), 0.5 * worst(0));
}

TEST(HoleFill, WarnsOfASteepRim)
{
  lacuna::ThreadExecution execution(2);
  const auto getWarnings = [&](double slope)
  {
    return lacuna::HoleFiller()
      .Fill(execution, MakeMap([&](double x, double) { return 10 + slope * x; }), HoleFillOptions())
      .Warnings;
  };
  EXPECT_TRUE(getWarnings(2.1).empty());                      // 64.5 degrees
  const std::vector<std::string> warnings = getWarnings(2.2); // 65.6 degrees, no step of 79
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("steeper than 65 degrees"), std::string::npos) << warnings[0];
}

// A long wave in a wide frame around a small defect: half of its amplitude is left at the cut-off,
// for any kernel and node spacing.
TEST(HoleFill, CutoffWavelengthHalvesTheAmplitude)
{
  constexpr double wavelength = 15;
  constexpr double pi = 3.14159265358979323846;
  const auto wave = [](double x, double) { return 20 + 0.1 * std::cos(2 * pi * x / wavelength); };
  lacuna::ThreadExecution execution(2);
  for (const auto kernel :
    { lacuna::RadialKernel::ThinPlate, lacuna::RadialKernel::Linear, lacuna::RadialKernel::Cubic })
  {
    for (const double spacing : { 1.5, 3.0 })
    {
      HoleFillInput input = MakeMap(wave, 1);
      HoleFillOptions options;
      options.Kernel = kernel;
      options.SupportMargin = 200;
      options.NodeSpacing = spacing;
      options.CutoffWavelength = wavelength;
      const HoleFillResult result = lacuna::HoleFiller().Fill(execution, input, options);
      double product = 0;
      double square = 0;
      for (std::size_t i = 0; i < input.Grid.GetSize(); ++i)
      {
        const double x = GetX(i);
        const double y = GetY(i);
        if (x >= 30 && x < 75 && y > 15 && y < 45) // three waves, away from the border
        {
          const double c = std::cos(2 * pi * x / wavelength);
          product += c * (result.Fitted[i] - 20);
          square += c * c;
        }
      }
      EXPECT_NEAR(product / square, 0.05, 0.003) << static_cast<int>(kernel) << " " << spacing;
    }
  }

  HoleFillInput input = MakeMap(wave);
  HoleFillOptions both;
  both.Smoothing = 1;
  both.CutoffWavelength = 5;
  EXPECT_THROW(lacuna::HoleFiller().Fill(execution, input, both), std::invalid_argument);
}

TEST(HoleFill, RefusesBadInput)
{
  const HoleFillInput good = MakeMap(Plane);
  EXPECT_EQ(ErrorOf(good), "");
  HoleFillOptions options;
  options.SupportMargin = 0;
  ExpectContains(ErrorOf(good, options), "SupportMargin is 0");
  options.SupportMargin = std::numeric_limits<double>::quiet_NaN();
  ExpectContains(ErrorOf(good, options), "SupportMargin");
  options = {};
  options.NodeSpacing = -1;
  ExpectContains(ErrorOf(good, options), "NodeSpacing is -1");
  options = {};
  options.OutputMargin = -2;
  ExpectContains(ErrorOf(good, options), "OutputMargin is -2");
  options = {};
  options.Smoothing = HUGE_VAL;
  ExpectContains(ErrorOf(good, options), "Smoothing");
  options = {};
  options.MaximumBytes = 1000;
  options.Solver = lacuna::RadialSolver::Direct;
  ExpectContains(ErrorOf(good, options), "raise NodeSpacing");
  options = {};
  for (const double accuracy : { -1.0, 1.0, std::numeric_limits<double>::quiet_NaN() })
  {
    options.Accuracy = accuracy;
    EXPECT_EQ(ErrorOf(good, options).find("Accuracy is "), 0U);
  }
  options.Accuracy = 0;
  options.Solver = lacuna::RadialSolver::Fast;
  EXPECT_EQ(ErrorOf(good, options).find("Solver Fast"), 0U);
  options = {};
  options.Kernel = lacuna::RadialKernel::Multiquadric;
  options.CutoffWavelength = 10;
  EXPECT_EQ(ErrorOf(good, options).find("CutoffWavelength needs a kernel"), 0U);
  options = {};
  options.NodeSpacing = 500;
  ExpectContains(ErrorOf(good, options), "lower NodeSpacing");

  HoleFillInput bare = good;
  bare.Valid = bare.Defect; // only the defect has a depth
  ExpectContains(ErrorOf(bare), "raise SupportMargin");
  bare.Painted.assign(bare.Grid.GetSize(), 1);
  ExpectContains(ErrorOf(bare), "marked as support");

  HoleFillInput line = good;
  for (std::size_t i = 0; i < line.Valid.size(); ++i)
  {
    line.Valid[i] = i / Width == 5;
  }
  line.Painted.assign(line.Grid.GetSize(), 1);
  ExpectContains(ErrorOf(line), "one line");
}
