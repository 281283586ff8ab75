// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialBasisTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace lacunaRadialBasisTest;

namespace
{
double Franke(double x, double y)
{
  const auto square = [](double a) { return a * a; };
  return 0.75 * std::exp(-(square(9 * x - 2) + square(9 * y - 2)) / 4) +
    0.75 * std::exp(-square(9 * x + 1) / 49 - (9 * y + 1) / 10) +
    0.5 * std::exp(-(square(9 * x - 7) + square(9 * y - 3)) / 4) -
    0.2 * std::exp(-square(9 * x - 4) - square(9 * y - 7));
}

template <class Function>
std::string ErrorOf(const Function& function)
{
  try
  {
    function();
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

TEST(RadialBasis, ReproducesPlanes)
{
  // far from the origin, in a small and in a large unit
  for (const double unit : { 1e-3, 1.0, 1e4 })
  {
    for (const RadialKernel kernel : Kernels)
    {
      std::vector<Point2> nodes = Scatter2(60, 40 * unit, 25 * unit);
      std::vector<double> values;
      for (Point2& p : nodes)
      {
        p[0] += 300 * unit;
        values.push_back(50 + (0.4 * p[0] - 0.7 * p[1]) / unit);
      }
      lacuna::RadialBasisOptions options;
      options.Kernel = kernel;
      const auto s = Fit<2>(nodes, values, options);
      EXPECT_NEAR(s.GetPolynomial()[0], 50, 1e-9);
      EXPECT_NEAR(s.GetPolynomial()[1] * unit, 0.4, 1e-11);
      EXPECT_NEAR(s.GetPolynomial()[2] * unit, -0.7, 1e-11);
      // rounding of values of about 30 over 40 units
      const double energyUnit = lacuna::GetRadialEnergyFactor(kernel) * 30 * 30 *
        std::pow(40 * unit, -lacuna::GetRadialPower(kernel));
      EXPECT_NEAR(s.GetReport().Energy, 0, 1e-13 * energyUnit);
      EXPECT_NEAR(Evaluate<2>(s, { { 1000 * unit, -900 * unit } })[0], 50 + 400 + 630, 1e-8);
    }
  }
}

TEST(RadialBasis, InterpolatesItsNodes)
{
  const std::vector<Point3> nodes = ReferenceNodes();
  const std::vector<double> values = ReferenceValues(nodes);
  for (const RadialKernel kernel : Kernels)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = kernel;
    const auto s = Fit<3>(nodes, values, options);
    const std::vector<double> at = Evaluate<3>(s, nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      EXPECT_NEAR(at[i], values[i], 1e-10 * 80);
    }
    EXPECT_LT(s.GetReport().Residual, 1e-10);
    EXPECT_EQ(s.GetReport().NodeCount, nodes.size());
  }
}

TEST(RadialBasis, DoesNotChangeUnderSimilarities)
{
  const std::vector<Point2> nodes = Scatter2(80, 60, 40);
  const std::vector<Point2> points = { { 10, 10 }, { 33, 21 }, { -20, 50 }, { 90, 5 } };
  std::vector<double> values =
    Transformed(nodes, [&](const Point2& p) { return Franke(p[0] / 60, p[1] / 40); });
  const auto move = [](const Point2& p) -> Point2
  {
    // turned by 0.7, seven times as large, elsewhere
    const double c = 7 * std::cos(0.7);
    const double s = 7 * std::sin(0.7);
    return { c * p[0] - s * p[1] - 500, s * p[0] + c * p[1] + 120 };
  };
  std::vector<Point2> movedNodes;
  std::vector<Point2> movedPoints;
  std::transform(nodes.begin(), nodes.end(), std::back_inserter(movedNodes), move);
  std::transform(points.begin(), points.end(), std::back_inserter(movedPoints), move);
  for (const RadialKernel kernel : Kernels)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = kernel;
    const auto s = Fit<2>(nodes, values, options);
    const auto t = Fit<2>(movedNodes, values, options);
    const std::vector<double> a = Evaluate<2>(s, points);
    const std::vector<double> b = Evaluate<2>(t, movedPoints);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      EXPECT_NEAR(a[i], b[i], 1e-9);
    }
    // energy scales with length^-Power
    EXPECT_NEAR(t.GetReport().Energy * std::pow(7, lacuna::GetRadialPower(kernel)),
      s.GetReport().Energy, 1e-8 * s.GetReport().Energy);
  }
}

TEST(RadialBasis, SmoothingDoesNotDependOnTheUnitOfLength)
{
  // Thin plate: E has no unit when values and nodes have the same, so mu grows with its square.
  const std::vector<Point2> nodes = Scatter2(50, 60, 40);
  std::vector<Point2> centimetres;
  std::vector<double> values;
  std::vector<double> centimetreValues;
  for (const Point2& p : nodes)
  {
    values.push_back(20 * Franke(p[0] / 60, p[1] / 40));
    centimetreValues.push_back(values.back() / 10);
    centimetres.push_back({ p[0] / 10, p[1] / 10 });
  }
  lacuna::RadialBasisOptions options;
  options.Smoothing = 3;
  const auto s = Fit<2>(nodes, values, options);
  options.Smoothing = 3.0 / 100;
  const auto t = Fit<2>(centimetres, centimetreValues, options);
  EXPECT_NEAR(Evaluate<2>(s, { { 31, 17 } })[0], 10 * Evaluate<2>(t, { { 3.1, 1.7 } })[0], 1e-9);
  EXPECT_NEAR(s.GetReport().Energy, t.GetReport().Energy, 1e-9 * s.GetReport().Energy);
  options.Smoothing = 0;
  EXPECT_GT(Fit<2>(nodes, values, options).GetReport().Energy, 1.1 * s.GetReport().Energy);
}

TEST(RadialBasis, GradientsAreDerivatives)
{
  const std::vector<Point3> nodes = ReferenceNodes();
  std::vector<Point3> points = { { 20, 30, 10 }, { 61, 12, 4 }, { -10, 70, 20 } };
  for (const RadialKernel kernel : Kernels)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = kernel;
    const auto s = Fit<3>(nodes, ReferenceValues(nodes), options);
    lacuna::ThreadExecution execution(2);
    std::vector<double> values;
    std::vector<Point3> gradients;
    s.Evaluate(execution, points, values, gradients);
    EXPECT_EQ(values, Evaluate<3>(s, points));
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      for (int c = 0; c < 3; ++c)
      {
        constexpr double h = 1e-4;
        std::vector<Point3> beside(2, points[i]);
        beside[0][c] -= h;
        beside[1][c] += h;
        const std::vector<double> v = Evaluate<3>(s, beside);
        EXPECT_NEAR(gradients[i][c], (v[1] - v[0]) / (2 * h), 1e-6);
      }
    }
  }
}

TEST(RadialBasis, PolynomialIsThePlaneFarAway)
{
  // The gradient tends to that of p, while s - p grows like (sum a_i |x_i|^2) log |x|.
  const std::vector<Point2> nodes = Scatter2(80, 60, 40);
  std::vector<double> values = Transformed(
    nodes, [&](const Point2& p) { return 10 * Franke(p[0] / 60, p[1] / 40) + 0.2 * p[0]; });
  const auto s = Fit<2>(nodes, values);
  lacuna::ThreadExecution execution(1);
  std::vector<double> at;
  std::vector<Point2> gradients;
  s.Evaluate(execution, { { 1e6, 2e6 }, { -3e6, 1e6 } }, at, gradients);
  for (const Point2& g : gradients)
  {
    EXPECT_NEAR(g[0], s.GetPolynomial()[1], 1e-5);
    EXPECT_NEAR(g[1], s.GetPolynomial()[2], 1e-5);
  }
  // The constant belongs to r^2 log r in the unit of the nodes: the same problem in half the unit
  // must have a constant that differs by the known term.
  std::vector<Point2> doubled = Transformed(nodes,
    [&](const Point2& p) {
      return Point2{ 2 * p[0], 2 * p[1] };
    });
  const auto t = Fit<2>(doubled, values);
  // s(x) = t(2x), so p_s(0) - p_t(0) = m log 2, m = sum a_i |x_i|^2, which the growth of s shows.
  std::vector<double> far;
  s.Evaluate(execution, { { 1e5, 0 }, { 2e5, 0 }, { -1e5, 0 }, { -2e5, 0 } }, far);
  const double atOnce = far[0] + far[2];
  const double atTwice = far[1] + far[3];
  const double moment = (atTwice - atOnce) / (2 * std::log(2.0));
  EXPECT_NEAR(
    s.GetPolynomial()[0] - t.GetPolynomial()[0], moment * std::log(2.0), 1e-3 * std::abs(moment));
}

TEST(RadialBasis, BendingEnergyOfAGaussianIsTwoPi)
{
  // The thin plate bends least: its energy tends to that of f = exp(-|x|^2/2), 2 pi, from below.
  std::vector<Point2> nodes;
  std::vector<double> values;
  for (int j = -12; j <= 12; ++j)
  {
    for (int i = -12; i <= 12; ++i)
    {
      nodes.push_back({ 0.4 * i, 0.4 * j });
      values.push_back(std::exp(-0.08 * (i * i + j * j)));
    }
  }
  const double energy = Fit<2>(nodes, values).GetReport().Energy;
  EXPECT_LT(energy, 6.283185307179586);
  EXPECT_GT(energy, 0.98 * 6.283185307179586);
}

TEST(RadialBasis, ErrorsOnFrankesFunctionFall)
{
  // Root mean squares on a 41 x 41 grid, from scipy 1.10.1 for the same nodes.
  const int counts[3] = { 50, 200, 800 };
  const double expected[3][3] = { { 0.01407, 0.001711, 0.0004219 }, { 0.03562, 0.005972, 0.001088 },
    { 0.01493, 0.002365, 0.0002282 } };
  std::vector<Point2> grid;
  for (int j = 0; j <= 40; ++j)
  {
    for (int i = 0; i <= 40; ++i)
    {
      grid.push_back({ i / 40.0, j / 40.0 });
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    for (int c = 0; c < 3; ++c)
    {
      const std::vector<Point2> nodes = Scatter2(counts[c]);
      std::vector<double> values =
        Transformed(nodes, [&](const Point2& p) { return Franke(p[0], p[1]); });
      lacuna::RadialBasisOptions options;
      options.Kernel = Kernels[k];
      const std::vector<double> s = Evaluate<2>(Fit<2>(nodes, values, options), grid);
      double sum = 0;
      for (std::size_t i = 0; i < grid.size(); ++i)
      {
        const double e = s[i] - Franke(grid[i][0], grid[i][1]);
        sum += e * e;
      }
      EXPECT_NEAR(
        std::sqrt(sum / static_cast<double>(grid.size())), expected[k][c], 0.001 * expected[k][c]);
    }
  }
}

TEST(RadialBasis, IsAsWellConditionedAsPublished)
{
  // Carr 1996, section 6.4: about 700 nodes around a hole, scaled to the unit square: condition
  // number "typically around 6e6", initial relative residual around 2e-13.
  std::vector<Point2> nodes;
  std::vector<double> values;
  for (int j = -30; j <= 30; ++j)
  {
    for (int i = -30; i <= 30; ++i)
    {
      const double r2 = i * i + j * j;
      if (r2 > 15 * 15 && r2 <= 21 * 21)
      {
        nodes.push_back({ 1.0 * i, 1.0 * j });
        values.push_back(std::sqrt(90 * 90 - r2));
      }
    }
  }
  ASSERT_NEAR(static_cast<double>(nodes.size()), 683, 20);
  const lacuna::RadialBasisReport report = Fit<2>(nodes, values).GetReport();
  EXPECT_GT(report.ConditionEstimate, 6e5);
  EXPECT_LT(report.ConditionEstimate, 6e7);
  EXPECT_LT(report.Residual, 2e-13 * 90);

  // The cubic is worse conditioned: one step of refinement brings its residual down, too.
  lacuna::RadialBasisOptions options;
  options.Kernel = RadialKernel::Cubic;
  const lacuna::RadialBasisReport cubic = Fit<2>(nodes, values, options).GetReport();
  EXPECT_TRUE(cubic.Refined);
  EXPECT_LT(cubic.Residual, 2e-14 * 90);
}

TEST(RadialBasis, DoesNotDependOnThreadsOrInstructionSet)
{
  const std::vector<Point2> nodes = Scatter2(300, 60, 40);
  const std::vector<Point2> points = Scatter2(1001, 90, 70);
  std::vector<double> values =
    Transformed(nodes, [&](const Point2& p) { return Franke(p[0] / 60, p[1] / 40); });
  for (const RadialKernel kernel : Kernels)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = kernel;
    const std::vector<double> one = Evaluate<2>(Fit<2>(nodes, values, options, 1), points, 1);
    for (const int threads : { 2, 5 })
    {
      EXPECT_EQ(Evaluate<2>(Fit<2>(nodes, values, options, threads), points, threads), one);
    }
    auto s = Fit<2>(nodes, values, options);
    s.SetInstructionSet(lacuna::InstructionSet::Baseline);
    EXPECT_EQ(Evaluate<2>(s, points), one);
  }
}

TEST(RadialBasis, MergesEqualNodesAndNamesContradictions)
{
  std::vector<Point2> nodes = Scatter2(20);
  std::vector<double> values =
    Transformed(nodes, [&](const Point2& p) { return Franke(p[0], p[1]); });
  const std::vector<double> before = Evaluate<2>(Fit<2>(nodes, values), Scatter2(30));
  nodes.push_back(nodes[4]);
  values.push_back(values[4]);
  const auto s = Fit<2>(nodes, values);
  EXPECT_EQ(s.GetReport().NodeCount, 20u);
  EXPECT_EQ(Evaluate<2>(s, Scatter2(30)), before);
  values.back() += 1e-9;
  ExpectContains(ErrorOf([&] { Fit<2>(nodes, values); }), "nodes 4 and 20 lie at the same place");
}

// A smoothing fit to nodes at one place is that to nodes side by side, whatever their values.
TEST(RadialBasis, AveragesEqualNodesWithSmoothing)
{
  for (const bool weighted : { false, true })
  {
    lacuna::RadialBasisOptions options;
    options.Smoothing = 0.01;
    std::vector<Point2> together = Scatter2(40);
    std::vector<double> values =
      Transformed(together, [&](const Point2& p) { return Franke(p[0], p[1]); });
    std::vector<Point2> apart = together;
    for (const double noise : { 0.3, -0.1, 0.0 })
    {
      together.push_back(together[4]);
      apart.push_back({ apart[4][0] + 1e-7 * (1 + noise), apart[4][1] - 1e-7 * noise });
      values.push_back(values[4] + noise);
    }
    if (weighted)
    {
      options.Errors.assign(values.size(), 1);
      options.Errors[4] = 0.5;
      options.Errors[40] = 3;
      options.Errors[41] = 0.2;
    }
    const auto fit = Fit<2>(together, values, options);
    EXPECT_EQ(fit.GetReport().NodeCount, 40u);
    const std::vector<double> one = Evaluate<2>(fit, Scatter2(30));
    const std::vector<double> other = Evaluate<2>(Fit<2>(apart, values, options), Scatter2(30));
    values.resize(40); // the noise counts
    together.resize(40);
    options.Errors.clear();
    const std::vector<double> without =
      Evaluate<2>(Fit<2>(together, values, options), Scatter2(30));
    double worst = 0;
    double effect = 0;
    for (std::size_t i = 0; i < one.size(); ++i)
    {
      worst = std::max(worst, std::abs(one[i] - other[i]));
      effect = std::max(effect, std::abs(one[i] - without[i]));
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_GT(effect, 1e-3);
  }
}

TEST(RadialBasis, RefusesWhatDoesNotDetermineAFunction)
{
  const auto error = [](const std::vector<Point2>& nodes, const std::vector<double>& values)
  { return ErrorOf([&] { Fit<2>(nodes, values); }); };
  ExpectContains(error({}, {}), "at least 3");
  ExpectContains(error({ { 0, 0 }, { 1, 0 } }, { 1, 2 }), "at least 3");
  ExpectContains(error({ { 0, 0 }, { 1, 0 }, { 1, 0 } }, { 1, 2, 2 }), "2 nodes");
  ExpectContains(
    error({ { 0, 0.1 }, { 1, 0.3 }, { 2, 0.5 }, { 5, 1.1 } }, { 1, 2, 3, 4 }), "one line");
  ExpectContains(error({ { 0, 0 }, { 1, 0 }, { 0, 1 } }, { 1, 2 }), "one value for each node");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectContains(error({ { 0, 0 }, { 1, 0 }, { 0, 1 } }, { 1, nan, 3 }), "node 1 ");
  ExpectContains(error({ { 0, 0 }, { 1, 0 }, { 0, HUGE_VAL } }, { 1, 2, 3 }), "node 2 ");
  ExpectContains(error({ { -1e308, 0 }, { 1e308, 0 }, { 0, 1 } }, { 1, 2, 3 }), "out of range");
  EXPECT_EQ(error({ { 0, 0 }, { 1, 0 }, { 0, 1 } }, { 1, 2, 3 }), "");

  const std::vector<Point3> flat = { { 0, 0, 1 }, { 1, 0, 2 }, { 0, 1, 3 }, { 1, 1, 4 },
    { 3, 2, 8 } };
  ExpectContains(ErrorOf([&] { Fit<3>(flat, { 1, 2, 3, 4, 5 }); }), "one plane");
}

TEST(RadialBasis, RefusesNodesThatAreTooClose)
{
  std::vector<Point2> nodes = Scatter2(20);
  std::vector<double> values(20, 1.0);
  nodes.push_back({ nodes[3][0] + 1e-13, nodes[3][1] });
  values.push_back(2);
  ExpectContains(ErrorOf([&] { Fit<2>(nodes, values); }), "too close together");
}

TEST(RadialBasis, SaysWhatHelpsAgainstSingularEquations)
{
  const std::vector<Point2> nodes = Scatter2(120);
  const std::vector<double> values(nodes.size(), 1.5);
  const auto error = [&](RadialKernel kernel, double shape, double smoothing)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = kernel;
    options.Shape = shape;
    options.Smoothing = smoothing;
    return ErrorOf([&] { Fit<2>(nodes, values, options); });
  };
  const std::string smooth = error(RadialKernel::ThinPlate, 0, 1e30);
  ExpectContains(smooth, "lower Smoothing");
  // of RBF Hole Filler only
  EXPECT_EQ(smooth.find("CutoffWavelength"), std::string::npos) << smooth;
  EXPECT_EQ(smooth.find("too close"), std::string::npos) << smooth;
  EXPECT_EQ(smooth.find("000000"), std::string::npos) << smooth;
  ExpectContains(error(RadialKernel::Gaussian, 1e6, 0), "change KernelLength");
  const std::string narrow = error(RadialKernel::Multiquadric, 1e-9, 0);
  ExpectContains(narrow, "change KernelLength");
  EXPECT_EQ(narrow.find("too close"), std::string::npos) << narrow;
}

TEST(RadialBasis, RefusesAMatrixAboveTheLimit)
{
  const std::vector<Point2> nodes = Scatter2(97);
  const std::vector<double> values(97, 1.0);
  lacuna::RadialBasisOptions options;
  options.MaximumBytes = 80000;
  EXPECT_EQ(Fit<2>(nodes, values, options).GetReport().NodeCount, 97u);
  options.MaximumBytes = 79999;
  EXPECT_THROW(Fit<2>(nodes, values, options), std::length_error);
  ExpectContains(ErrorOf([&] { Fit<2>(nodes, values, options); }), "80000 bytes");
}

TEST(RadialBasis, RefusesBadOptions)
{
  lacuna::RadialBasisOptions options;
  options.Smoothing = -1;
  ExpectContains(ErrorOf([&] { Fit<2>(Scatter2(9), std::vector<double>(9, 1.0), options); }),
    "Smoothing is -1; it must be 0 or more");
  options.Smoothing = 0;
  options.Accuracy = 1;
  ExpectContains(ErrorOf([&] { Fit<2>(Scatter2(9), std::vector<double>(9, 1.0), options); }),
    "Accuracy is 1; it must be less");
}

TEST(RadialBasis, StopsWhenAsked)
{
  lacuna::ThreadExecution execution(2, [](double) { return false; });
  EXPECT_THROW(lacuna::RadialBasis<2>(execution, Scatter2(30), std::vector<double>(30, 1.0), {}),
    lacuna::Aborted);
}
