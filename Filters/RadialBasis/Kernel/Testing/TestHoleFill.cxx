// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFill.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using lacuna::HoleFillInput;
using lacuna::HoleFillOptions;
using lacuna::HoleFillResult;

constexpr std::size_t Width = 71;
constexpr std::size_t Height = 61;

// mm
double GetX(std::size_t pixel)
{
  return 1.5 * static_cast<double>(pixel % Width);
}

double GetY(std::size_t pixel)
{
  const std::size_t row = pixel / Width;
  return static_cast<double>(row);
}

// A map of 71 x 61 pixels of 1.5 x 1 mm from a surface, with an off-centre disc as defect.
template <class Surface>
HoleFillInput MakeMap(const Surface& surface, double radius = 15)
{
  HoleFillInput input;
  input.Grid.Width = Width;
  input.Grid.Height = Height;
  input.Grid.Spacing = { 1.5, 1 };
  for (std::size_t i = 0; i < input.Grid.GetSize(); ++i)
  {
    const double x = GetX(i);
    const double y = GetY(i);
    input.Depth.push_back(surface(x, y));
    input.Valid.push_back(1);
    input.Defect.push_back(std::hypot(x - 45, y - 27) <= radius);
  }
  return input;
}

double Plane(double x, double y)
{
  return 30 + 0.25 * x - 0.5 * y;
}

double Sphere(double x, double y)
{
  return 100 - std::sqrt(90 * 90 - (x - 50) * (x - 50) - (y - 30) * (y - 30));
}

HoleFillResult Fill(
  const HoleFillInput& input, const HoleFillOptions& options = {}, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::HoleFiller().Fill(execution, input, options);
}

std::string ErrorOf(const HoleFillInput& input, const HoleFillOptions& options = {})
{
  try
  {
    Fill(input, options);
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "";
}

void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "' lacks '" << part << "'";
}
}

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

  // what is missing of it is named
  input.Prior.Points[27 * Width + 30][2] = std::nan("");
  ExpectContains(ErrorOf(input), "missing at 1 pixels of the defect, first at column 30, row 27");
  input.Prior = own;
  input.Prior.Points[27 * Width + 44][2] = std::nan("");
  const HoleFillResult lacking = Fill(input);
  ASSERT_EQ(lacking.Warnings.size(), 1u);
  ExpectContains(lacking.Warnings[0], "first at column 44, row 27, the prior surface is missing");
  EXPECT_EQ(lacking.Use[27 * Width + 44], lacuna::SupportUse::NoPrior);
  for (lacuna::Vec3& p : input.Prior.Points)
  {
    p[0] += 1000;
  }
  ExpectContains(ErrorOf(input), "nowhere around the defect");
  options.Trend = lacuna::HoleTrend::Ellipsoid;
  ExpectContains(ErrorOf(input, options), "exclude each other");
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
