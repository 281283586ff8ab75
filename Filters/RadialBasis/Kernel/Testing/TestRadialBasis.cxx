// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialBasis.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using lacuna::RadialKernel;
using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;
constexpr RadialKernel Kernels[] = { RadialKernel::ThinPlate, RadialKernel::Linear,
  RadialKernel::Cubic };

// function(element) of each element.
template <class Element, class Function>
auto Transformed(const std::vector<Element>& from, const Function& function)
{
  std::vector<decltype(function(from[0]))> to;
  to.reserve(from.size());
  std::transform(from.begin(), from.end(), std::back_inserter(to), function);
  return to;
}

double Fraction(double x)
{
  return x - std::floor(x);
}

// n quasi-random points in [0, 1)^3.
std::vector<Point3> Scatter(int n)
{
  std::vector<Point3> points;
  for (int i = 1; i <= n; ++i)
  {
    points.push_back({ Fraction(i * 0.7548776662466927), Fraction(i * 0.5698402909980532),
      Fraction(i * 0.8191725133961645) });
  }
  return points;
}

std::vector<Point2> Scatter2(int n, double width = 1, double height = 1)
{
  std::vector<Point2> points = Transformed(Scatter(n),
    [&](const Point3& p) {
      return Point2{ width * p[0], height * p[1] };
    });
  return points;
}

template <int Dimension>
lacuna::RadialBasis<Dimension> Fit(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<double>& values, lacuna::RadialBasisOptions options = {}, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::RadialBasis<Dimension>(execution, nodes, values, options);
}

template <int Dimension>
std::vector<double> Evaluate(const lacuna::RadialBasis<Dimension>& s,
  const std::vector<std::array<double, Dimension>>& points, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  std::vector<double> values;
  s.Evaluate(execution, points, values);
  return values;
}

// Data of the comparison with scipy: 40 nodes in 80 x 50 x 30 mm.
std::vector<double> ReferenceValues(const std::vector<Point3>& nodes)
{
  std::vector<double> values;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    values.push_back(100 * nodes[i][0] / (80 + nodes[i][1]) +
      3 * Fraction(static_cast<double>(i + 1) * 0.3819660112501051));
  }
  return values;
}

std::vector<Point3> ReferenceNodes()
{
  std::vector<Point3> nodes = Scatter(40);
  for (Point3& p : nodes)
  {
    p = { 80 * p[0], 50 * p[1], 30 * p[2] };
  }
  return nodes;
}

std::vector<Point3> ReferencePoints()
{
  return Transformed(std::vector<double>{ 0, 1, 2, 3, 4, 5, 6, 7 },
    [](double k) {
      return Point3{ 12 * k - 5, 9 * k - 6, 33 - 5 * k };
    });
}

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

TEST(RadialBasis, AgreesWithScipyIn2D)
{
  // scipy 1.10.1, RBFInterpolator(..., degree=1, smoothing=0 or 50), points (12 k - 5, 9 k - 6)
  struct Case
  {
    RadialKernel Kernel;
    double Smoothing; // scipy's: on the diagonal, for nodes in their own unit
    double Values[8];
  };
  const Case cases[] = {
    { RadialKernel::ThinPlate, 0,
      { -0.678655355389798, 8.93862835393478, 21.2405077942396, 31.7763994534309, 40.8288740984248,
        48.8800729296956, 52.6556946949403, 57.8792749059984 } },
    { RadialKernel::ThinPlate, 50,
      { -0.192645326018322, 9.40182866168088, 21.46333714131, 32.0078257224993, 40.8873078657476,
        48.5929984706919, 53.0403116993781, 58.9986782448802 } },
    { RadialKernel::Linear, 0,
      { 2.91527707864838, 9.89162404172187, 21.5013748867553, 31.8747992749728, 40.9149840302041,
        48.6104683837481, 52.7462932684988, 61.787691704386 } },
    { RadialKernel::Linear, 50,
      { 5.39571020886955, 13.2136984249988, 22.8624624896759, 32.6520252915044, 41.2341041004175,
        48.4867689669802, 55.3971961380841, 64.3361968918948 } },
    { RadialKernel::Cubic, 0,
      { -3.97375699450769, 8.54912457672951, 21.0957623876342, 31.7507065051712, 40.7974130289724,
        48.9353499863187, 52.7212367306091, 53.6362268148826 } },
    { RadialKernel::Cubic, 50,
      { -3.95226230101882, 8.59251898780377, 21.1543107948047, 31.8099685960777, 40.8029073973235,
        48.8948797622167, 52.7710154339524, 53.964284238702 } },
  };
  const std::vector<Point3> nodes3 = ReferenceNodes();
  std::vector<Point2> nodes = Transformed(nodes3,
    [&](const Point3& p) {
      return Point2{ p[0], p[1] };
    });
  const std::vector<Point2> points = Transformed(ReferencePoints(),
    [](const Point3& p) {
      return Point2{ p[0], p[1] };
    });
  for (const Case& c : cases)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = c.Kernel;
    options.Smoothing = c.Smoothing / lacuna::GetRadialEnergyFactor(c.Kernel);
    const std::vector<double> values =
      Evaluate<2>(Fit<2>(nodes, ReferenceValues(nodes3), options), points);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(values[k], c.Values[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
    }
  }
}

TEST(RadialBasis, AgreesWithScipyForKernelsWithALength)
{
  // epsilon = 1/15, degree=1, smoothing 0 and 0.1; 2-D and 3-D as above
  struct Case
  {
    RadialKernel Kernel;
    double Smoothing;
    double In2D[8];
    double In3D[8];
  };
  const Case cases[] = {
    { RadialKernel::Gaussian, 0,
      { 5.56216136643894, 9.17831629655737, 21.1116920547309, 31.7400332417173, 41.0232889881519,
        49.1824286324345, 52.6492760587631, 61.8776412553371 },
      { 10.6114716592203, 17.5586817124308, 24.5531577296492, 33.0574522142688, 41.4412933981483,
        48.9282199043449, 53.0153404354986, 61.5872212490504 } },
    { RadialKernel::Gaussian, 0.1,
      { 6.13639008648213, 10.1684071299766, 21.4528133305727, 32.0624048734074, 40.8386261030583,
        48.8747935585192, 53.3234291029227, 63.5924278084337 },
      { 10.727920406838, 17.7728282206379, 24.7960645600204, 33.0737868627194, 41.5749020970324,
        48.8721310739911, 53.2574782382396, 62.0771762578205 } },
    { RadialKernel::Multiquadric, 0,
      { -0.0246895614505025, 8.6706976893438, 21.0298504985773, 31.7332681185497, 40.8256745417551,
        49.0336650636264, 52.6918030874923, 56.3796387819426 },
      { 5.70359022732377, 13.7213482886832, 23.5465200097424, 32.9427404799796, 41.0977727591233,
        48.7371366656099, 53.2488734283112, 58.5165653289918 } },
    { RadialKernel::Multiquadric, 0.1,
      { 1.22816328808854, 9.9550011019481, 21.6177451991337, 32.2117848747529, 40.9292754084277,
        48.3451983790275, 53.4923481502332, 60.4187307280803 },
      { 6.65409596798197, 14.6611879177078, 23.7185854276251, 32.9079602294481, 41.3562625606282,
        48.3951117687937, 53.4547118314893, 60.0060649995027 } },
  };
  const std::vector<Point3> nodes3 = ReferenceNodes();
  const std::vector<Point3> points3 = ReferencePoints();
  const auto flat = [](const Point3& p) { return Point2{ p[0], p[1] }; };
  const std::vector<Point2> nodes2 = Transformed(nodes3, flat);
  const std::vector<Point2> points2 = Transformed(points3, flat);
  for (const Case& c : cases)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = c.Kernel;
    options.Shape = 15;
    options.Smoothing = c.Smoothing;
    const std::vector<double> in2D =
      Evaluate<2>(Fit<2>(nodes2, ReferenceValues(nodes3), options), points2);
    const std::vector<double> in3D =
      Evaluate<3>(Fit<3>(nodes3, ReferenceValues(nodes3), options), points3);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(in2D[k], c.In2D[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
      EXPECT_NEAR(in3D[k], c.In3D[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
    }
  }
}

TEST(RadialBasis, AgreesWithScipyIn3D)
{
  // as in 2-D, points (12 k - 5, 9 k - 6, 33 - 5 k)
  const double expected[3][8] = {
    { 4.93262567166045, 13.7714421357928, 23.5101854556742, 32.815657744407, 41.2709081485725,
      48.7177977049631, 53.1098137255275, 58.5511283441737 },
    { 7.71821490009533, 15.4199171317895, 23.9694363372085, 33.0220125231671, 41.4852099286192,
      48.5873216293172, 53.1309677115243, 60.942359957944 },
    { 1.45529034757249, 12.1869690078542, 23.2783924912451, 32.8117653793574, 41.02700477362,
      48.6802458972429, 53.3155951917787, 56.2851044955532 },
  };
  const std::vector<Point3> nodes = ReferenceNodes();
  const std::vector<Point3> points = ReferencePoints();
  for (int i = 0; i < 3; ++i)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = Kernels[i];
    const std::vector<double> values =
      Evaluate<3>(Fit<3>(nodes, ReferenceValues(nodes), options), points);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(values[k], expected[i][k], 1e-10 * 60) << i << " " << k;
    }
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

TEST(RadialBasis, RefusesBadSmoothing)
{
  lacuna::RadialBasisOptions options;
  options.Smoothing = -1;
  ExpectContains(
    ErrorOf([&] { Fit<2>(Scatter2(9), std::vector<double>(9, 1.0), options); }), "smoothing");
}

TEST(RadialBasis, StopsWhenAsked)
{
  lacuna::ThreadExecution execution(2, [](double) { return false; });
  EXPECT_THROW(lacuna::RadialBasis<2>(execution, Scatter2(30), std::vector<double>(30, 1.0), {}),
    lacuna::Aborted);
}
