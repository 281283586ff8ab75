// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceSpline.h"

#include "lacunaExecution.h"
#include "lacunaOutlines.h"
#include "lacunaSurfaceBasis.h"
#include "lacunaTestShapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

namespace
{
using lacuna::TestShape;
using lacuna::Vec3;

lacuna::SurfaceSpline Fit(const lacuna::OrientedPoints& data,
  const lacuna::SurfaceSplineOptions& options = {}, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return { execution, data, options };
}

double GetError(const lacuna::SurfaceSpline& spline, const TestShape& shape)
{
  return lacuna::GetSurfaceError(spline, shape.Sample(2000, 99));
}
}

TEST(SurfaceSpline, ExactPointsGiveTheShape)
{
  // bent and tapered, without symmetry in x and y
  const TestShape shape(TestShape::Kumara);
  const auto spline = Fit(shape.SampleNoisy(4000, 0, false, 1));
  EXPECT_LT(GetError(spline, shape), 0.01);
  EXPECT_LT(spline.GetReport().HeldOutError, 0.02);
}

TEST(SurfaceSpline, RecoversTheErrorsOfItsData)
{
  const TestShape shape(TestShape::Ellipsoid);
  for (const double sigma : { 0.2, 0.5 })
  {
    const auto spline = Fit(shape.SampleNoisy(4000, sigma, false, 2));
    EXPECT_NEAR(spline.GetReport().PointError, sigma, 0.12 * sigma);
    EXPECT_NEAR(spline.GetReport().NormalError, 5 * std::atan(1.0) / 45 / std::sqrt(2.0), 0.015);
    // noise of 4000 points is averaged by far more than a local mean of ten would
    EXPECT_LT(GetError(spline, shape), 0.15 * sigma);
  }
}

TEST(SurfaceSpline, CrossesPatchesWithoutPoints)
{
  const TestShape shape(TestShape::Torus);
  const auto spline = Fit(shape.SampleNoisy(5000, 0, true, 3));
  EXPECT_LT(GetError(spline, shape), 0.03);
}

TEST(SurfaceSpline, GradientsAreThoseOfTheValues)
{
  for (const auto kernel : { lacuna::RadialKernel::Cubic, lacuna::RadialKernel::Linear })
  {
    lacuna::SurfaceSplineOptions options;
    options.Kernel = kernel;
    const auto spline = Fit(TestShape(TestShape::Kumara).SampleNoisy(1500, 0.1, false, 4), options);
    lacuna::ThreadExecution execution(1);
    constexpr double step = 1e-4;
    const std::vector<Vec3> at{ { 10, 5, 8 }, { 10 - step, 5, 8 }, { 10 + step, 5, 8 },
      { 10, 5 - step, 8 }, { 10, 5 + step, 8 }, { 10, 5, 8 - step }, { 10, 5, 8 + step } };
    std::vector<double> values(at.size());
    std::vector<Vec3> gradients(at.size());
    spline.Evaluate(execution, at, values, &gradients);
    for (int c = 0; c < 3; ++c)
    {
      EXPECT_NEAR(gradients[0][c], (values[2 * c + 2] - values[2 * c + 1]) / (2 * step), 1e-5);
    }
    std::vector<double> alone(at.size());
    spline.Evaluate(execution, at, alone, nullptr);
    EXPECT_EQ(alone, values);
  }
}

TEST(SurfaceSpline, UnitsOfLengthDoNotMatter)
{
  const TestShape shape(TestShape::Ellipsoid);
  const auto data = shape.SampleNoisy(1000, 0.3, false, 5);
  auto moved = data;
  for (Vec3& p : moved.Points)
  {
    p = 1000.0 * p + Vec3{ 5e5, -2e5, 1e5 };
  }
  const auto spline = Fit(data);
  const auto scaled = Fit(moved);
  EXPECT_NEAR(scaled.GetReport().PointError, 1000 * spline.GetReport().PointError, 0.1);
  lacuna::ThreadExecution execution(1);
  std::vector<double> a(20);
  std::vector<double> b(20);
  spline.Evaluate(execution, { data.Points.begin(), data.Points.begin() + 20 }, a, nullptr);
  scaled.Evaluate(execution, { moved.Points.begin(), moved.Points.begin() + 20 }, b, nullptr);
  for (int i = 0; i < 20; ++i)
  {
    EXPECT_NEAR(b[i], 1000 * a[i], 0.1);
  }
}

TEST(SurfaceSpline, PointsWithLargeErrorsCountLess)
{
  const TestShape shape(TestShape::Sphere);
  auto data = shape.SampleNoisy(2000, 0.05, false, 6);
  data.Errors.assign(data.Points.size(), 1.0);
  for (std::size_t i = 0; i < data.Points.size(); i += 3)
  {
    // a third is 1 mm too far out on one side
    data.Points[i] = data.Points[i] + (data.Points[i][0] > 0 ? 1.0 : 0.0) * data.Normals[i];
    data.Errors[i] = 20;
  }
  const double weighted = GetError(Fit(data), shape);
  data.Errors.clear();
  const double alike = GetError(Fit(data), shape);
  EXPECT_LT(weighted, 0.03);
  EXPECT_GT(alike, 5 * weighted);
}

// Slices of a tilted ellipsoid: normals within their planes are not those of the surface.
TEST(SurfaceSpline, OutlinesGiveTheVolume)
{
  const Vec3 axes{ 40, 28, 20 };
  const double pi = std::acos(-1.0);
  // slices across a direction that is none of the axes
  const Vec3 across = lacuna::Normalized({ 0.8, 0.5, 0.33 });
  const Vec3 u = lacuna::Normalized(lacuna::Cross(across, { 0, 0, 1 }));
  const Vec3 v = lacuna::Cross(across, u);
  const auto scaled = [&](const Vec3& x) -> Vec3 {
    return { x[0] / axes[0], x[1] / axes[1], x[2] / axes[2] };
  };
  const double half =
    lacuna::Norm({ axes[0] * across[0], axes[1] * across[1], axes[2] * across[2] });
  lacuna::OrientedPoints data;
  for (const double at : { -0.9, -0.45, 0.0, 0.45, 0.9 })
  {
    // |scaled(p + a u + b v)|^2 = 1 with p on the line of the slices' centres
    const Vec3 p = (at / half) *
      Vec3{ axes[0] * axes[0] * across[0], axes[1] * axes[1] * across[1],
        axes[2] * axes[2] * across[2] };
    for (int k = 0; k < 40; ++k)
    {
      const double angle = 2 * pi * k / 40;
      const Vec3 ray = std::cos(angle) * u + std::sin(angle) * v;
      const double length =
        std::sqrt(1 - at * at) / lacuna::Norm(scaled(ray)); // p is the centre of the slice
      const Vec3 x = p + length * ray;
      const Vec3 gradient{ x[0] / axes[0] / axes[0], x[1] / axes[1] / axes[1],
        x[2] / axes[2] / axes[2] };
      ASSERT_NEAR(lacuna::Norm(scaled(x)), 1, 1e-9);
      data.Points.push_back(x);
      data.Normals.push_back(lacuna::Normalized(gradient - lacuna::Dot(gradient, across) * across));
      data.Free.push_back(across);
    }
  }
  lacuna::ThreadExecution execution(2);
  lacuna::SurfaceSplineOptions how;
  how.LeastNormalError = lacuna::OutlineNormalError;
  lacuna::FindOutlineNormals(execution, data, how);
  const lacuna::SurfaceSpline spline(execution, data, how);
  lacuna::SurfaceFollowerOptions options;
  options.EdgeLength = 1;
  options.Bounds = { -60, 60, -60, 60, -60, 60 };
  const auto followed = lacuna::FollowSurface(execution, spline, data.Points, options);
  EXPECT_TRUE(lacuna::FindTopology(followed.Surface).IsClosed());
  const double truth = 4 * pi / 3 * axes[0] * axes[1] * axes[2];
  EXPECT_NEAR(followed.Surface.GetVolume(), truth, 0.003 * truth);
  EXPECT_LT(lacuna::EstimateVolumeError(execution, data, how, spline.GetReport(), followed.Surface),
    0.02 * truth);
}

TEST(SurfaceSpline, DoesNotDependOnThreads)
{
  const auto data = TestShape(TestShape::Kumara).SampleNoisy(1000, 0.2, false, 7);
  lacuna::ThreadExecution execution(1);
  std::vector<double> one(100);
  std::vector<double> three(100);
  const std::vector<Vec3> at(data.Points.begin(), data.Points.begin() + 100);
  Fit(data, {}, 1).Evaluate(execution, at, one, nullptr);
  Fit(data, {}, 3).Evaluate(execution, at, three, nullptr);
  EXPECT_EQ(one, three);
}

TEST(SurfaceSpline, RefusesBadData)
{
  const auto good = TestShape(TestShape::Sphere).Sample(200, 8);
  auto bad = good;
  bad.Points[7][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Fit(bad), std::invalid_argument);
  bad = good;
  bad.Normals[7] = {};
  EXPECT_THROW(Fit(bad), std::invalid_argument);
  bad = good;
  bad.Normals.pop_back();
  EXPECT_THROW(Fit(bad), std::invalid_argument);
  bad = good;
  bad.Errors.assign(200, 0.0);
  EXPECT_THROW(Fit(bad), std::invalid_argument);
  bad = good;
  bad.Points.assign(200, { 1, 2, 3 });
  EXPECT_THROW(Fit(bad), lacuna::SurfaceSpline::Unsolvable);
  EXPECT_THROW(Fit({}), std::invalid_argument);
  lacuna::SurfaceSplineOptions options;
  options.PointError = -1;
  EXPECT_THROW(Fit(good, options), std::invalid_argument);
  options = {};
  options.Kernel = lacuna::RadialKernel::ThinPlate;
  EXPECT_THROW(Fit(good, options), std::invalid_argument);
}

// LAPACK writes into the reflectors of a basis while it applies them.
TEST(SurfaceSpline, ThreadsThatShareABasisMakeTheSameRows)
{
  using Basis = lacuna::SurfaceBasis;
  using Clock = std::chrono::steady_clock;
  const TestShape shape(TestShape::Kumara);
  const std::vector<Vec3> nodes = shape.SampleNoisy(40, 0, false, 5).Points;
  const std::vector<Vec3> points = shape.SampleNoisy(1000, 0, false, 6).Points;
  lacuna::ThreadExecution execution(1);
  const auto make = [&](const Basis& basis)
  {
    const Basis::Matrix rows = basis.MakeRows(points, true);
    return std::vector<double>(rows.Column(0), rows.Column(0) + rows.GetRows() * rows.GetColumns());
  };
  const Clock::time_point start = Clock::now();
  const std::vector<double> expected = make({ execution, nodes, lacuna::RadialKernel::Cubic });
  const Clock::duration once = Clock::now() - start;
  constexpr int attempts = 300;
  int wrong = 0;
  for (int attempt = 0; attempt < attempts; ++attempt)
  {
    // a new one each time: only the first of its calls could be disturbed
    const Basis basis(execution, nodes, lacuna::RadialKernel::Cubic);
    std::atomic<int> ready{ 0 };
    std::vector<std::vector<double>> found(2);
    const auto run = [&](std::vector<double>& rows, Clock::duration delay)
    {
      ++ready;
      while (ready < 2)
      {
      }
      for (const Clock::time_point from = Clock::now(); Clock::now() - from < delay;)
      {
      }
      rows = make(basis);
    };
    std::thread other(run, std::ref(found[0]), Clock::duration(0));
    run(found[1], once / 2 * attempt / attempts);
    other.join();
    wrong += static_cast<int>(found[0] != expected) + static_cast<int>(found[1] != expected);
  }
  EXPECT_EQ(wrong, 0);
}
