// SPDX-License-Identifier: BSD-3-Clause
#include "OcclusionCases.h"
#include "lacunaOcclusionSurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>

namespace lacuna
{
namespace
{
// A sphere of which a tenth of the voxels is seen, off centre, on voxels that are no cubes, with the
// angle of the closed form (Carr 1996, section 5.3).
struct Ball
{
  static constexpr double Radius = 15;
  std::array<std::int64_t, 3> Dimensions{ 42, 60, 36 };
  Vec3 Spacing{ 1, 0.8, 1.25 };
  Vec3 Centre{ 20.3, 23.1, 22.2 };
  std::vector<float> Angle;
  std::vector<unsigned char> Object;
  std::vector<unsigned char> Data;

  explicit Ball(double present = 0.1, std::uint64_t seed = 1)
  {
    Numbers number(seed);
    for (std::int64_t k = 0; k < this->Dimensions[2]; ++k)
    {
      for (std::int64_t j = 0; j < this->Dimensions[1]; ++j)
      {
        for (std::int64_t i = 0; i < this->Dimensions[0]; ++i)
        {
          const double r =
            Norm(Vec3{ i * this->Spacing[0], j * this->Spacing[1], k * this->Spacing[2] } -
              this->Centre);
          const double x = std::min(1.0, Radius / std::max(r, 1e-9));
          this->Angle.push_back(
            static_cast<float>(r < Radius ? 4 * Pi : 2 * Pi * (1 - std::sqrt(1 - x * x))));
          this->Object.push_back(r <= Radius + 0.5);
          this->Data.push_back(std::abs(r - Radius) <= 0.5 && number() < present);
        }
      }
    }
  }

  OcclusionImages Get() const
  {
    return { this->Dimensions, this->Spacing, this->Angle.data(), this->Object.data(),
      this->Data.data() };
  }
  std::size_t At(std::int64_t i, std::int64_t j, std::int64_t k) const
  {
    return i + this->Dimensions[0] * (j + this->Dimensions[1] * k);
  }
};

// Points on the surface, out of directions through the centre.
std::vector<OcclusionSurface::Point> Probe(const OcclusionSurface& surface, const Ball& ball,
  std::vector<OcclusionSurface::Point>& normals, Execution& execution)
{
  std::vector<OcclusionSurface::Point> points;
  Numbers number(7);
  while (points.size() < 500)
  {
    const Vec3 d{ number() - 0.5, number() - 0.5, number() - 0.5 };
    if (Norm(d) > 0.05 && Norm(d) < 0.5)
    {
      points.push_back((ball.Centre + (Ball::Radius + 0.6) * Normalized(d)).Elements);
    }
  }
  surface.Project(execution, points, normals);
  return points;
}

// The largest change of the curvature (1 / mm) between neighbouring steps (mm) on paths over the
// surface that pass the feet of data, where the radial functions have their centres.
double GetCurvatureJump(
  const OcclusionSurface& surface, const Ball& ball, double step, Execution& execution)
{
  const int half = static_cast<int>(std::lround(1.5 / step));
  std::vector<OcclusionSurface::Point> points;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(ball.Data.size()); i += 7)
  {
    const auto& n = ball.Dimensions;
    const Vec3 datum{ i % n[0] * ball.Spacing[0], i / n[0] % n[1] * ball.Spacing[1],
      i / (n[0] * n[1]) * ball.Spacing[2] };
    const Vec3 along = Normalized(Cross(datum - ball.Centre, Vec3{ 0.3, 0.5, 0.8 }));
    for (int k = -half; k <= half && ball.Data[i]; ++k)
    {
      points.push_back((datum + k * step * along).Elements);
    }
  }
  std::vector<OcclusionSurface::Point> normals;
  surface.Project(execution, points, normals);
  const auto getCurvature = [&](std::size_t at)
  {
    return (1 / Norm(Vec3{ points[at] } - Vec3{ points[at - 1] })) *
      (Vec3{ normals[at] } - Vec3{ normals[at - 1] });
  };
  double jump = 0;
  const std::size_t size = 2 * half + 1;
  EXPECT_GT(points.size(), 30 * size);
  for (std::size_t path = 0; path < points.size(); path += size)
  {
    for (std::size_t k = path + 2; k < path + size; ++k)
    {
      jump = std::max(jump, Norm(getCurvature(k) - getCurvature(k - 1)));
    }
  }
  return jump;
}

std::string GetError(const OcclusionImages& images, const OcclusionSurfaceOptions& options = {})
{
  ThreadExecution execution(1);
  try
  {
    OcclusionSurface(execution, images, options);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return {};
}
}

TEST(OcclusionSurface, SphereIsFoundToATenthOfAVoxel)
{
  const Ball ball;
  ThreadExecution execution(1);
  const OcclusionSurface surface(execution, ball.Get(), {});
  std::vector<OcclusionSurface::Point> normals;
  const auto points = Probe(surface, ball, normals, execution);
  double mean = 0;
  double bias = 0;
  double alignment = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Vec3 out = Vec3{ points[i] } - ball.Centre;
    mean += std::abs(Norm(out) - Ball::Radius) / static_cast<double>(points.size());
    bias += (Norm(out) - Ball::Radius) / static_cast<double>(points.size());
    alignment += Dot(Normalized(out), Vec3{ normals[i] }) / static_cast<double>(points.size());
    EXPECT_NEAR(Norm(Vec3{ normals[i] }), 1, 1e-12);
  }
  EXPECT_LT(mean, 0.15);
  EXPECT_LT(std::abs(bias), 0.05);
  EXPECT_GT(alignment, 0.998);
  EXPECT_EQ(surface.GetReport().DataVoxels, std::count(ball.Data.begin(), ball.Data.end(), 1));
  EXPECT_EQ(surface.GetReport().Outliers, 0);
  EXPECT_LT(surface.GetReport().Residual, 0.35);
}

TEST(OcclusionSurface, FunctionIsADistanceWithOneSurface)
{
  const Ball ball;
  ThreadExecution execution(1);
  const OcclusionSurface surface(execution, ball.Get(), {});
  const std::vector<float> values = surface.EvaluateGrid(execution);
  constexpr std::int64_t margin = OcclusionSurface::GridMargin;
  std::size_t at = 0;
  for (std::int64_t k = -margin; k < ball.Dimensions[2] + margin; ++k)
  {
    for (std::int64_t j = -margin; j < ball.Dimensions[1] + margin; ++j)
    {
      for (std::int64_t i = -margin; i < ball.Dimensions[0] + margin; ++i, ++at)
      {
        const double truth =
          Norm(
            Vec3{ i * ball.Spacing[0], j * ball.Spacing[1], k * ball.Spacing[2] } - ball.Centre) -
          Ball::Radius;
        if (std::abs(truth) > 0.6)
        {
          ASSERT_EQ(values[at] > 0, truth > 0) << i << " " << j << " " << k;
        }
        if (std::abs(truth) < 2)
        {
          ASSERT_NEAR(values[at], truth, 1) << i << " " << j << " " << k;
        }
      }
    }
  }
  EXPECT_EQ(at, values.size());
}

TEST(OcclusionSurface, WhatIsSeenOrHiddenFromEverywhereDoesNotCount)
{
  const Ball clean;
  Ball ball;
  ball.Data[ball.At(2, 3, 4)] = 1; // seen, and kept as object by KeepData
  ball.Object[ball.At(2, 3, 4)] = 1;
  ball.Data[ball.At(20, 28, 18)] = 1; // hidden
  ball.Data[ball.At(39, 55, 33)] = 1; // seen, no object
  ThreadExecution execution(1);
  const OcclusionSurface expected(execution, clean.Get(), {});
  const OcclusionSurface surface(execution, ball.Get(), {});
  EXPECT_EQ(surface.GetReport().Outliers, 3);
  EXPECT_EQ(surface.EvaluateGrid(execution), expected.EvaluateGrid(execution));
}

// Data inside that lie together are a cavity's wall, not outliers here and there.
TEST(OcclusionSurface, OutliersTogetherAreReported)
{
  ThreadExecution execution(1);
  {
    Ball ball(0.3);
    Numbers number(3);
    std::int64_t wall = 0;
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(ball.Data.size()); ++i)
    {
      const auto& n = ball.Dimensions;
      const Vec3 p{ i % n[0] * ball.Spacing[0], i / n[0] % n[1] * ball.Spacing[1],
        i / (n[0] * n[1]) * ball.Spacing[2] };
      const Vec3 fromAxis{ p[0] - ball.Centre[0], p[1] - ball.Centre[1], 0 };
      if (std::abs(Norm(fromAxis) - 4) <= 0.5 && std::abs(p[2] - ball.Centre[2]) < 6 &&
        number() < 0.4)
      {
        ball.Data[i] = 1;
        ++wall;
      }
    }
    const OcclusionSurface surface(execution, ball.Get(), {});
    EXPECT_EQ(surface.GetReport().Outliers, wall);
    EXPECT_EQ(surface.GetReport().Together, wall);
    const auto& at = surface.GetReport().TogetherAt;
    EXPECT_EQ(ball.Data[ball.At(at[0], at[1], at[2])], 1);
    EXPECT_LT(std::abs(at[0] * ball.Spacing[0] - ball.Centre[0]), 5);
  }
  // scattered
  Ball ball(0.3);
  Numbers number(3);
  for (std::size_t i = 0; i < ball.Data.size(); ++i)
  {
    ball.Data[i] = ball.Data[i] || (ball.Angle[i] > 3 * Pi && number() < 0.004);
  }
  const OcclusionSurface surface(execution, ball.Get(), {});
  EXPECT_GT(surface.GetReport().Outliers, 20);
  EXPECT_EQ(surface.GetReport().Together, 0);
}

// Twice continuously differentiable: changes of the curvature are as small as the steps. (r^2 log r,
// which has no second derivative at its centres: 2 instead of 5.)
TEST(OcclusionSurface, CurvatureIsContinuous)
{
  for (const double present : { 0.1, 0.3 }) // direct and fast solution
  {
    const Ball ball(present);
    ThreadExecution execution(1);
    const OcclusionSurface surface(execution, ball.Get(), {});
    const double coarse = GetCurvatureJump(surface, ball, 0.1, execution);
    const double fine = GetCurvatureJump(surface, ball, 0.02, execution);
    EXPECT_NEAR(coarse / fine, 5, 0.3) << present;
  }
}

TEST(OcclusionSurface, DoesNotDependOnThreads)
{
  const Ball ball(0.25); // enough nodes for the fast solution
  ThreadExecution one(1);
  const OcclusionSurface expected(one, ball.Get(), {});
  EXPECT_GT(expected.GetReport().Nodes, 1500);
  const std::vector<float> values = expected.EvaluateGrid(one);
  ThreadExecution five(5);
  EXPECT_EQ(OcclusionSurface(five, ball.Get(), {}).EvaluateGrid(five), values);
}

TEST(OcclusionSurface, SmoothingStiffens)
{
  const Ball ball;
  ThreadExecution execution(1);
  double before = 0;
  for (const double smoothing : { 0.001, 1.0, 1000.0 })
  {
    OcclusionSurfaceOptions options;
    options.Smoothing = smoothing;
    const double residual = OcclusionSurface(execution, ball.Get(), options).GetReport().Residual;
    EXPECT_GT(residual, before);
    before = residual;
  }
}

TEST(OcclusionSurface, ScalesWithTheVoxels)
{
  const Ball ball;
  OcclusionImages large = ball.Get();
  large.Spacing = 16 * large.Spacing;
  ThreadExecution execution(1);
  const OcclusionSurface a(execution, ball.Get(), {});
  const OcclusionSurface b(execution, large, {});
  EXPECT_NEAR(b.GetReport().Residual, 16 * a.GetReport().Residual, 1e-6);
}

TEST(OcclusionSurface, RefusesWhatHasNoSurface)
{
  Ball ball;
  OcclusionSurfaceOptions options;
  options.Smoothing = 0;
  EXPECT_NE(GetError(ball.Get(), options).find("Smoothing"), std::string::npos);
  options.Smoothing = 1;
  options.Tolerance = 1;
  EXPECT_NE(GetError(ball.Get(), options).find("Tolerance"), std::string::npos);
  const std::vector<unsigned char> data = ball.Data;
  std::fill(ball.Data.begin(), ball.Data.end(), 0);
  EXPECT_NE(GetError(ball.Get()).find("only 0 of 0 data voxels"), std::string::npos);
  ball.Data = data;
  std::fill(ball.Object.begin(), ball.Object.end(), 0);
  EXPECT_NE(GetError(ball.Get()).find("no voxel of the angle image is object"), std::string::npos);
  std::fill(ball.Object.begin(), ball.Object.end(), 1); // all of them hidden
  EXPECT_NE(GetError(ball.Get()).find("lie on the surface"), std::string::npos);
}

TEST(OcclusionSurface, Stops)
{
  const Ball ball;
  double last = 0;
  ThreadExecution watched(1,
    [&last](double progress)
    {
      EXPECT_GE(progress, last - 1e-9);
      last = progress;
      return progress < 0.3;
    });
  EXPECT_THROW(OcclusionSurface(watched, ball.Get(), {}), Aborted);
}
}
