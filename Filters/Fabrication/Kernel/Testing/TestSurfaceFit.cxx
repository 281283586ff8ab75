// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceFit.h"

#include "lacunaExecution.h"
#include "lacunaGridChecks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace lacuna;

namespace
{
const double NaN = std::numeric_limits<double>::quiet_NaN();

// A dome with a bump on one side only: no mirror image of it is the same.
double Dome(double x, double y)
{
  return 60 - std::sqrt(80 * 80 - x * x - 1.2 * y * y) +
    4 * std::exp(-((x - 12) * (x - 12) + (y + 7) * (y + 7)) / 150);
}

struct Grid
{
  GridSize Size;
  std::vector<double> Heights;
  Matrix4 ToWorld;
  std::vector<Vec3> Points;

  Grid(std::int64_t columns, std::int64_t rows, double (*f)(double, double) = Dome)
    : Size{ columns, rows }
    , ToWorld(Matrix4::Translation({ 20, -130, 700 }) * Matrix4::Rotation({ 1, 2, -3 }, 1.1) *
        Matrix4::Scaling({ 0.7, 0.9, 1 }))
  {
    for (std::int64_t j = 0; j < rows; ++j)
    {
      for (std::int64_t i = 0; i < columns; ++i)
      {
        const std::int64_t x = i - columns / 2;
        const std::int64_t y = j - rows / 2;
        this->Heights.push_back(f(0.7 * double(x), 0.9 * double(y)));
        this->Points.push_back(this->ToWorld.Point({ double(i), double(j), this->Heights.back() }));
      }
    }
  }
};

double LargestDeviation(const SurfaceFit& fit, const Grid& grid)
{
  double largest = 0;
  auto point = grid.Points.begin();
  for (std::int64_t j = 0; j < grid.Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < grid.Size.Columns; ++i)
    {
      largest = std::max(largest, Norm(fit.Surface.Evaluate(double(i), double(j)) - *point++));
    }
  }
  return largest;
}

std::string MessageOf(const std::function<void()>& f)
{
  try
  {
    f();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "no error";
}
}

TEST(SurfaceFit, InterpolatesAtToleranceZero)
{
  ThreadExecution execution(1);
  const Grid grid(50, 41);
  SurfaceFitOptions options;
  options.Tolerance = 0;
  for (const SurfaceFit& fit :
    { FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld, options),
      FitPoints(execution, grid.Size, grid.Points, options) })
  {
    EXPECT_EQ(fit.Surface.U.GetSize(), 50);
    EXPECT_EQ(fit.Surface.V.GetSize(), 41);
    EXPECT_EQ(fit.Decimals, 17);
    EXPECT_LT(LargestDeviation(fit, grid), 2e-12);
    EXPECT_LT(fit.MaximumDeviation, 2e-12);
    // between the samples too: fourth order
    const Vec3 p = fit.Surface.Evaluate(20.5, 17.25);
    const Vec3 truth =
      grid.ToWorld.Point({ 20.5, 17.25, Dome(0.7 * (20.5 - 25), 0.9 * (17.25 - 20)) });
    EXPECT_LT(Norm(p - truth), 1e-5);
  }
}

TEST(SurfaceFit, KeepsTheToleranceWithFewControlPoints)
{
  ThreadExecution execution(1);
  const Grid grid(121, 111);
  std::int64_t before = 0;
  for (const double tolerance : { 0.1, 0.01, 0.001, 0.0001, 1e-6 })
  {
    SurfaceFitOptions options;
    options.Tolerance = tolerance;
    const SurfaceFit heights =
      FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld, options);
    const SurfaceFit points = FitPoints(execution, grid.Size, grid.Points, options);
    for (const SurfaceFit& fit : { heights, points })
    {
      EXPECT_LE(fit.MaximumDeviation, tolerance);
      EXPECT_NEAR(LargestDeviation(fit, grid), fit.MaximumDeviation, 1e-10);
      EXPECT_GT(fit.MaximumDeviation, 0.3 * tolerance); // it is made use of
      EXPECT_LE(std::pow(10, -fit.Decimals), 0.1001 * tolerance);
    }
    const auto size = static_cast<std::int64_t>(heights.Surface.ControlPoints.size());
    EXPECT_GT(size, before);
    before = size;
    if (tolerance == 0.001)
    {
      EXPECT_LT(size, 1000); // of 13 431 samples
    }
  }
}

TEST(SurfaceFit, ControlPointsAreRoundedAsStated)
{
  ThreadExecution execution(1);
  const Grid grid(60, 60);
  const SurfaceFit fit = FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld);
  EXPECT_EQ(fit.Decimals, 4);
  for (const Vec3& p : fit.Surface.ControlPoints)
  {
    for (const double x : p.Elements)
    {
      EXPECT_EQ(x, std::round(x * 1e4) / 1e4);
    }
  }
}

TEST(SurfaceFit, HeightFieldsAreLinearInUAndV)
{
  ThreadExecution execution(1);
  const Grid grid(30, 40);
  SurfaceFitOptions options;
  options.Tolerance = 0;
  const SurfaceFit fit = FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld, options);
  const Matrix4 toMap = grid.ToWorld.Inverse();
  for (double u = 0; u <= 29; u += 0.7)
  {
    for (double v = 0; v <= 39; v += 0.9)
    {
      const Vec3 p = toMap.Point(fit.Surface.Evaluate(u, v));
      EXPECT_NEAR(p[0], u, 1e-11);
      EXPECT_NEAR(p[1], v, 1e-11);
    }
  }
}

TEST(SurfaceFit, IsNotMirrored)
{
  ThreadExecution execution(1);
  const Grid grid(40, 40);
  const SurfaceFit fit = FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld);
  const Vec3 view = grid.ToWorld.Column(2);
  EXPECT_GT(Dot(fit.Surface.Normal(10, 10), view), 0); // away from the viewer
  EXPECT_GT(
    Dot(Cross(fit.Surface.Evaluate(20, 20, 1, 0), fit.Surface.Evaluate(20, 20, 0, 1)), view), 0);
  // The bump is where it was: at map coordinates 12, -7 mm and not at its mirror images.
  const auto height = [&](double x, double y)
  { return grid.ToWorld.Inverse().Point(fit.Surface.Evaluate(20 + x / 0.7, 20 + y / 0.9))[2]; };
  for (const double sx : { -1, 1 })
  {
    for (const double sy : { -1, 1 })
    {
      EXPECT_NEAR(height(12 * sx, 7 * sy), Dome(12 * sx, 7 * sy), 0.002);
    }
  }
  EXPECT_THROW(FitHeights(execution, grid.Size, grid.Heights, Matrix4::Scaling({ -1, 1, 1 })),
    std::invalid_argument);
  EXPECT_THROW(FitHeights(execution, grid.Size, grid.Heights, Matrix4::Scaling({ 1, 1, 2 })),
    std::invalid_argument);
}

TEST(SurfaceFit, PlanesNeedOnePatch)
{
  ThreadExecution execution(1);
  const Grid grid(300, 200, [](double x, double y) { return 0.3 * x - 0.1 * y + 5; });
  for (const SurfaceFit& fit : { FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld),
         FitPoints(execution, grid.Size, grid.Points) })
  {
    EXPECT_EQ(fit.Surface.ControlPoints.size(), 16u);
    EXPECT_LE(fit.MaximumDeviation, 1e-4);
  }
}

TEST(SurfaceFit, SmallestGrid)
{
  ThreadExecution execution(1);
  const Grid grid(4, 4);
  EXPECT_EQ(FitPoints(execution, grid.Size, grid.Points).Surface.ControlPoints.size(), 16u);
  const Grid narrow(4, 30);
  EXPECT_EQ(FitPoints(execution, narrow.Size, narrow.Points).Surface.U.GetSize(), 4);
}

TEST(SurfaceFit, UnevenColumnsGetChordLengthParameters)
{
  // A cylinder whose columns come in two densities: uniform parameters would ripple.
  ThreadExecution execution(1);
  std::vector<Vec3> points;
  for (int j = 0; j < 20; ++j)
  {
    double angle = 0;
    for (int i = 0; i < 40; ++i)
    {
      points.push_back({ 50 * std::cos(angle), 50 * std::sin(angle), 2.0 * j });
      angle += i < 20 ? 0.01 : 0.05;
    }
  }
  SurfaceFitOptions options;
  options.Tolerance = 0;
  const SurfaceFit fit = FitPoints(execution, { 40, 20 }, points, options);
  EXPECT_LT(fit.MaximumDeviation, 1e-12);
  double worst = 0;
  for (double u = 0; u <= 39; u += 0.01)
  {
    const Vec3 p = fit.Surface.Evaluate(u, 10);
    worst = std::max(worst, std::abs(std::hypot(p[0], p[1]) - 50));
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_FALSE(fit.Surface.IsClosedU());
}

TEST(SurfaceFit, BadInput)
{
  ThreadExecution execution(1);
  Grid grid(10, 12);
  EXPECT_NE(MessageOf(
              [&] {
                FitHeights(execution, { 3, 40 }, std::vector<double>(120), Matrix4());
              })
              .find("4 x 4"),
    std::string::npos);
  EXPECT_THROW(FitPoints(execution, { 10, 11 }, grid.Points), std::invalid_argument);
  EXPECT_THROW(FitPoints(execution, { -10, -12 }, grid.Points), std::invalid_argument);
  for (const double tolerance : { -1.0, NaN, std::numeric_limits<double>::infinity() })
  {
    SurfaceFitOptions options;
    options.Tolerance = tolerance;
    EXPECT_THROW(FitPoints(execution, grid.Size, grid.Points, options), std::invalid_argument);
    EXPECT_THROW(
      FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld, options), std::invalid_argument);
  }
  SurfaceFitOptions tooFine;
  tooFine.Tolerance = 1e-17;
  EXPECT_THROW(FitPoints(execution, grid.Size, grid.Points, tooFine), std::runtime_error);
  for (const double none : { 1e300, -9e99, 1e9 })
  {
    grid.Heights[34] = grid.Points[34][2] = none;
    EXPECT_NE(MessageOf([&] { FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld); })
                .find("more than a kilometre away"),
      std::string::npos);
    EXPECT_NE(MessageOf([&] { FitPoints(execution, grid.Size, grid.Points); })
                .find("more than a kilometre away"),
      std::string::npos);
  }
  grid.Heights[34] = NaN;
  EXPECT_NE(MessageOf([&] { FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld); })
              .find("column 4, row 3"),
    std::string::npos);
  grid.Points[34][2] = NaN;
  EXPECT_NE(
    MessageOf([&] { FitPoints(execution, grid.Size, grid.Points); }).find("column 4, row 3"),
    std::string::npos);
  EXPECT_THROW(FitPoints(execution, grid.Size, std::vector<Vec3>(120)), std::invalid_argument);
}

TEST(CheckRegular, FindsFoldsAndCoincidentPoints)
{
  const Grid good(20, 20);
  EXPECT_NO_THROW(CheckRegular(good.Size, good.Points));
  Grid grid = good;
  grid.Points[45] = grid.Points[46];
  EXPECT_NE(MessageOf([&] { CheckRegular(grid.Size, grid.Points); }).find("column 5, row 2"),
    std::string::npos);
  grid = good;
  std::swap(grid.Points[45], grid.Points[46]);
  EXPECT_THROW(CheckRegular(grid.Size, grid.Points), std::invalid_argument);
  // A point beyond the diagonal of its facet: only that corner turns over.
  grid = good;
  grid.Points[45] = 0.35 * (grid.Points[46] + grid.Points[65]) + 0.3 * grid.Points[24] +
    0.5 * (grid.Points[24] - grid.Points[66]);
  EXPECT_NE(
    MessageOf([&] { CheckRegular(grid.Size, grid.Points); }).find("folds"), std::string::npos);
  // The second half folded back over the first.
  for (int j = 0; j < 20; ++j)
  {
    for (int i = 0; i < 20; ++i)
    {
      grid.Points[20 * j + i] = { i < 10 ? i : 19.5 - i, double(j), i < 10 ? 0 : 0.1 };
    }
  }
  EXPECT_NE(
    MessageOf([&] { CheckRegular(grid.Size, grid.Points); }).find("folds"), std::string::npos);
  grid = good;
  grid.Points[45][1] = NaN;
  EXPECT_THROW(CheckRegular(grid.Size, grid.Points), std::invalid_argument);
  EXPECT_THROW(CheckRegular(grid.Size, std::vector<Vec3>(400)), std::invalid_argument);
}

TEST(SurfaceFit, SameBitsForAnyNumberOfThreads)
{
  const Grid grid(500, 320, [](double x, double y) { return Dome(0.2 * x, 0.2 * y); });
  ThreadExecution one(1);
  const SurfaceFit expected = FitPoints(one, grid.Size, grid.Points);
  for (const int threads : { 2, 5 })
  {
    ThreadExecution execution(threads);
    const SurfaceFit fit = FitPoints(execution, grid.Size, grid.Points);
    EXPECT_EQ(fit.Surface.U.GetKnots(), expected.Surface.U.GetKnots());
    EXPECT_EQ(fit.Surface.V.GetKnots(), expected.Surface.V.GetKnots());
    EXPECT_TRUE(fit.Surface.ControlPoints == expected.Surface.ControlPoints);
    EXPECT_EQ(fit.MaximumDeviation, expected.MaximumDeviation);
  }
}

TEST(SurfaceFit, StopsWhenAskedTo)
{
  const Grid grid(121, 121);
  ThreadExecution execution(1, [](double) { return false; });
  EXPECT_THROW(FitPoints(execution, grid.Size, grid.Points), Aborted);
}

// Noise cannot be economised: the fit must end at interpolation, quickly.
TEST(SurfaceFit, NoiseIsInterpolated)
{
  Grid grid(80, 70);
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  for (double& height : grid.Heights)
  {
    height = noise(random);
  }
  ThreadExecution execution(1);
  const SurfaceFit fit = FitHeights(execution, grid.Size, grid.Heights, grid.ToWorld);
  EXPECT_LE(fit.MaximumDeviation, 0.001);
  EXPECT_EQ(fit.Surface.ControlPoints.size(), 5600u);
}
