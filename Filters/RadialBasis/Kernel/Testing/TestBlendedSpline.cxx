// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBlendedSpline.h"

#include "lacunaExecution.h"
#include "lacunaTestShapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace
{
using lacuna::TestShape;
using lacuna::Vec3;

// A sphere of 40 mm with waves of about 12 mm, other ones along each axis.
class Waves : public lacuna::ImplicitFunction
{
public:
  static double GetValue(const Vec3& x)
  {
    return lacuna::Norm(x) - 40 -
      0.5 * std::sin(0.5 * x[0]) * std::cos(0.4 * x[1] + 0.3) * std::sin(0.45 * x[2] + 1);
  }

  static Vec3 GetGradient(const Vec3& x)
  {
    Vec3 gradient{};
    for (int c = 0; c < 3; ++c)
    {
      constexpr double h = 1e-5;
      Vec3 low = x;
      Vec3 high = x;
      low[c] -= h;
      high[c] += h;
      gradient[c] = (GetValue(high) - GetValue(low)) / (2 * h);
    }
    return gradient;
  }

  // 1 mm too small
  void Evaluate(lacuna::Execution&, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override
  {
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      values[i] = GetValue(points[i]) + 1;
      if (gradients)
      {
        (*gradients)[i] = GetGradient(points[i]);
      }
    }
  }
};

lacuna::OrientedPoints MakeWaves(std::size_t count, unsigned seed)
{
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  lacuna::OrientedPoints data;
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 ray = lacuna::Normalized({ normal(random), normal(random), normal(random) });
    double r = 40;
    for (int step = 0; step < 30; ++step)
    {
      r -= Waves::GetValue(r * ray);
    }
    const Vec3 x = r * ray;
    data.Points.push_back(x);
    data.Normals.push_back(lacuna::Normalized(Waves::GetGradient(x)));
  }
  return data;
}
}

TEST(BlendedSpline, FollowsDetailThatOneSplineCannot)
{
  lacuna::ThreadExecution execution(2);
  const auto data = MakeWaves(15000, 1);
  const auto truth = MakeWaves(2000, 2);
  const lacuna::BlendedSpline fit(execution, data, {});
  EXPECT_GT(lacuna::GetSurfaceError(lacuna::SurfaceSpline(execution, data, {}), truth), 0.05);
  EXPECT_LT(lacuna::GetSurfaceError(fit, truth), 0.005);
  EXPECT_GT(fit.GetReport().LocalSplines, 100u);
  EXPECT_LT(fit.GetReport().PointError, 0.02);
}

TEST(BlendedSpline, KeepsAPriorIfThatPredictsBetter)
{
  lacuna::ThreadExecution execution(2);
  const auto data = MakeWaves(500, 3);
  const auto truth = MakeWaves(2000, 2);
  const Waves prior;
  const lacuna::BlendedSpline fit(execution, data, {}, &prior);
  EXPECT_TRUE(fit.GetReport().UsesPrior);
  EXPECT_GT(lacuna::GetSurfaceError(lacuna::BlendedSpline(execution, data, {}), truth), 0.05);
  EXPECT_LT(lacuna::GetSurfaceError(fit, truth), 0.002);
  // waves say nothing of a torus
  const TestShape torus(TestShape::Torus);
  const auto other = torus.SampleNoisy(2000, 0, false, 1);
  const lacuna::BlendedSpline alone(execution, other, {}, &prior);
  EXPECT_FALSE(alone.GetReport().UsesPrior);
  EXPECT_LT(lacuna::GetSurfaceError(alone, torus.Sample(1000, 99)), 0.02);
}

TEST(BlendedSpline, FollowsCreases)
{
  lacuna::ThreadExecution execution(2);
  const TestShape cup(TestShape::Cup);
  const auto data = cup.SampleNoisy(10000, 0, false, 1);
  const auto truth = cup.Sample(2000, 99);
  EXPECT_GT(lacuna::GetSurfaceError(lacuna::SurfaceSpline(execution, data, {}), truth), 0.2);
  EXPECT_LT(lacuna::GetSurfaceError(lacuna::BlendedSpline(execution, data, {}), truth), 0.08);
}

TEST(BlendedSpline, DoesNotFollowNoise)
{
  lacuna::ThreadExecution execution(2);
  const TestShape torus(TestShape::Torus);
  const auto data = torus.SampleNoisy(6000, 0.5, false, 3);
  const lacuna::BlendedSpline fit(execution, data, {});
  EXPECT_LT(lacuna::GetSurfaceError(fit, torus.Sample(2000, 99)), 0.06);
  EXPECT_NEAR(fit.GetReport().PointError, 0.5, 0.05);
}

TEST(BlendedSpline, IsSmoothAndItsGradientsAreThoseOfItsValues)
{
  lacuna::ThreadExecution execution(2);
  const auto data = TestShape(TestShape::Cup).SampleNoisy(3000, 0, false, 4);
  const lacuna::BlendedSpline fit(execution, data, {});
  ASSERT_GT(fit.GetReport().LocalSplines, 10u);
  // along a line that leaves the balls of the local splines on both sides of the wall
  constexpr double step = 1e-3;
  std::vector<Vec3> at;
  for (int i = 0; i < 60000; ++i)
  {
    at.push_back({ step * i, 3.3, 37.5 });
  }
  std::vector<double> values(at.size());
  std::vector<Vec3> gradients(at.size());
  fit.Evaluate(execution, at, values, &gradients);
  for (std::size_t i = 1; i + 1 < at.size(); ++i)
  {
    const double slope = (values[i + 1] - values[i - 1]) / (2 * step);
    ASSERT_NEAR(gradients[i][0], slope, 1e-4 * (1 + std::abs(slope))) << "at x = " << at[i][0];
  }
  std::vector<double> alone(at.size());
  fit.Evaluate(execution, at, alone, nullptr);
  EXPECT_EQ(alone, values);
}

// Half of the waves are missing. One place there is outside though the surface would pass above it, one
// inside though it would pass below; others lie where they would anyway.
TEST(BlendedSpline, KeepsPlacesOnTheirSides)
{
  lacuna::OrientedPoints data;
  const lacuna::OrientedPoints all = MakeWaves(4000, 5);
  for (std::size_t i = 0; i < all.Points.size(); ++i)
  {
    if (all.Points[i][2] < 10)
    {
      data.Points.push_back(all.Points[i]);
      data.Normals.push_back(all.Normals[i]);
    }
  }
  lacuna::ThreadExecution execution(2);
  const auto evaluate = [&](const lacuna::BlendedSpline& spline, const std::vector<Vec3>& places)
  {
    std::vector<double> values(places.size());
    spline.Evaluate(execution, places, values, nullptr);
    return values;
  };
  lacuna::BlendedSplineOptions options;
  const lacuna::BlendedSpline free(execution, data, options);
  const std::vector<Vec3> places{ { 5, 3, 36 }, { -22, 4, 37 } };
  const std::vector<double> before = evaluate(free, places);
  EXPECT_LT(before[0], -1);
  EXPECT_GT(before[1], 1);
  options.Outside = { { 60, 0, 0 }, { 0, -70, 5 } };
  options.Inside = { { 0, 0, 0 }, { 3, -20, -15 } };
  const lacuna::BlendedSpline same(execution, data, options);
  EXPECT_EQ(evaluate(same, places), before);
  options.Outside.push_back(places[0]);
  options.Inside.push_back(places[1]);
  const lacuna::BlendedSpline kept(execution, data, options);
  const std::vector<double> after = evaluate(kept, places);
  EXPECT_GT(after[0], 0.05);
  EXPECT_LT(after[1], -0.05);
  EXPECT_EQ(kept.GetReport().WrongSides, 0U);
  EXPECT_LT(lacuna::GetSurfaceError(kept, data), 1.1 * lacuna::GetSurfaceError(free, data));
}

TEST(BlendedSpline, DoesNotDependOnThreads)
{
  const auto data = TestShape(TestShape::Cup).SampleNoisy(3000, 0.1, false, 5);
  const auto evaluate = [&](int threads)
  {
    lacuna::ThreadExecution execution(threads);
    const lacuna::BlendedSpline fit(execution, data, {});
    std::vector<double> values(data.Points.size());
    fit.Evaluate(execution, data.Points, values, nullptr);
    return values;
  };
  EXPECT_EQ(evaluate(1), evaluate(3));
}
