// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCubicSpline.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
double Value(const CubicSplineSpace& space, const std::vector<double>& c, double x, int order = 0)
{
  const CubicSplineSpace::Values b = space.Evaluate(x, order);
  double sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    sum += b.Weights[k] * c[b.First + k];
  }
  return sum;
}

double Cubic(double x, int order = 0)
{
  const double values[] = { 2 - x + 0.5 * x * x - 0.25 * x * x * x, -1 + x - 0.75 * x * x,
    1 - 1.5 * x };
  return values[order];
}

std::vector<double> Fit(const CubicSplineSpace& space, const std::vector<double>& sites,
  const std::vector<double>& samples, std::int64_t width = 1, int threads = 1)
{
  ThreadExecution execution(threads);
  std::vector<double> coefficients;
  CubicSplineFit(space, sites).Solve(execution, samples, width, coefficients);
  return coefficients;
}

std::vector<double> UnevenSites(int count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.2, 2);
  std::vector<double> sites{ -3 };
  while (static_cast<int>(sites.size()) < count)
  {
    sites.push_back(sites.back() + step(random));
  }
  return sites;
}
}

TEST(CubicSplineSpace, BSplinesArePositiveAndAddUpToOne)
{
  const CubicSplineSpace space(-1, { 0, 0.5, 2, 2.25 }, 3);
  EXPECT_EQ(space.GetSize(), 8);
  for (double x = -1.5; x <= 3.5; x += 0.01)
  {
    double sums[3] = {};
    for (int order = 0; order < 3; ++order)
    {
      const CubicSplineSpace::Values b = space.Evaluate(x, order);
      EXPECT_GE(b.First, 0);
      EXPECT_LE(b.First, 4);
      for (const double w : b.Weights)
      {
        sums[order] += w;
        EXPECT_TRUE(order > 0 || w >= 0);
      }
    }
    EXPECT_NEAR(sums[0], 1, 1e-15);
    EXPECT_NEAR(sums[1], 0, 1e-13);
    EXPECT_NEAR(sums[2], 0, 1e-11);
  }
  EXPECT_EQ(space.Evaluate(-1).Weights[0], 1);
  EXPECT_EQ(space.Evaluate(3).Weights[3], 1);
}

// The textbook's uniform segment (Carr 1996, chapter 3).
TEST(CubicSplineSpace, AgreesWithTheUniformSegment)
{
  const CubicSplineSpace space(0, { 1, 2, 3, 4, 5, 6 }, 7);
  for (const double x : { 0.0, 0.3, 0.9 })
  {
    const CubicSplineSpace::Values b = space.Evaluate(3 + x);
    EXPECT_EQ(b.First, 3);
    EXPECT_NEAR(b.Weights[0], (1 - x) * (1 - x) * (1 - x) / 6, 1e-15);
    EXPECT_NEAR(b.Weights[1], (3 * x * x * x - 6 * x * x + 4) / 6, 1e-15);
    EXPECT_NEAR(b.Weights[2], (-3 * x * x * x + 3 * x * x + 3 * x + 1) / 6, 1e-15);
    EXPECT_NEAR(b.Weights[3], x * x * x / 6, 1e-15);
  }
}

TEST(CubicSplineSpace, IdentityCoefficientsGiveTheIdentity)
{
  const CubicSplineSpace space(-1, { 0, 0.5, 2, 2.25 }, 3);
  std::vector<double> c(space.GetSize());
  for (std::int64_t i = 0; i < space.GetSize(); ++i)
  {
    c[i] = space.GetIdentityCoefficient(i);
  }
  for (double x = -1; x <= 3; x += 0.1)
  {
    EXPECT_NEAR(Value(space, c, x), x, 1e-14);
    EXPECT_NEAR(Value(space, c, x, 1), 1, 1e-13);
    EXPECT_NEAR(Value(space, c, x, 2), 0, 1e-12);
  }
}

TEST(CubicSplineSpace, DerivativesAreContinuousAtKnots)
{
  const CubicSplineSpace space(0, { 1, 1.5, 3 }, 4);
  const std::vector<double> c{ 3, -1, 4, 1, -5, 9, 2 };
  for (const double knot : { 1.0, 1.5, 3.0 })
  {
    for (int order = 0; order < 3; ++order)
    {
      EXPECT_NEAR(Value(space, c, knot - 1e-9, order), Value(space, c, knot, order), 1e-6);
    }
  }
  // and are what they are called
  for (double x = 0.1; x < 4; x += 0.37)
  {
    const double h = 1e-5;
    EXPECT_NEAR(
      Value(space, c, x, 1), (Value(space, c, x + h) - Value(space, c, x - h)) / (2 * h), 1e-6);
    EXPECT_NEAR(Value(space, c, x, 2),
      (Value(space, c, x + h, 1) - Value(space, c, x - h, 1)) / (2 * h), 1e-5);
  }
}

TEST(CubicSplineSpace, RefusesKnotsThatDoNotIncrease)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CubicSplineSpace(0, {}, 0), std::invalid_argument);
  EXPECT_THROW(CubicSplineSpace(0, { 2, 1 }, 3), std::invalid_argument);
  EXPECT_THROW(CubicSplineSpace(0, { 1, 1 }, 3), std::invalid_argument);
  EXPECT_THROW(CubicSplineSpace(0, { 0 }, 3), std::invalid_argument);
  EXPECT_THROW(CubicSplineSpace(0, { nan }, 3), std::invalid_argument);
  EXPECT_THROW(
    CubicSplineSpace(0, {}, std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(CubicSplineSpace::NotAKnot({ 0, 1, 2 }), std::invalid_argument);
}

TEST(CubicSplineFit, CubicsAreReproducedExactly)
{
  for (const int count : { 4, 5, 6, 30 })
  {
    const std::vector<double> sites = UnevenSites(count, count);
    std::vector<double> samples(sites.size());
    std::transform(sites.begin(), sites.end(), samples.begin(), [](double x) { return Cubic(x); });
    const CubicSplineSpace space = CubicSplineSpace::NotAKnot(sites);
    EXPECT_EQ(space.GetSize(), count);
    const std::vector<double> c = Fit(space, sites, samples);
    double scale = 1;
    for (const double s : samples)
    {
      scale = std::max(scale, std::abs(s));
    }
    for (double x = sites.front(); x <= sites.back(); x += 0.1)
    {
      for (int order = 0; order < 3; ++order)
      {
        EXPECT_NEAR(Value(space, c, x, order), Cubic(x, order), 1e-12 * scale);
      }
    }
  }
}

TEST(CubicSplineFit, InterpolationIsOfFourthOrderAlsoAtTheEnds)
{
  double before = 0;
  for (const int count : { 21, 41, 81 })
  {
    std::vector<double> sites;
    std::vector<double> samples;
    for (int i = 0; i < count; ++i)
    {
      sites.push_back(i * 5.0 / (count - 1));
      samples.push_back(std::exp(std::sin(sites.back())));
    }
    const CubicSplineSpace space = CubicSplineSpace::NotAKnot(sites);
    const std::vector<double> c = Fit(space, sites, samples);
    double worst = 0;
    for (double x = 0; x <= 5; x += 0.001)
    {
      worst = std::max(worst, std::abs(Value(space, c, x) - std::exp(std::sin(x))));
    }
    for (int i = 0; i < count; ++i)
    {
      EXPECT_NEAR(Value(space, c, sites[i]), samples[i], 1e-14);
    }
    if (before > 0)
    {
      EXPECT_GT(before / worst, 10); // 16 in the limit
    }
    before = worst;
  }
  EXPECT_LT(before, 3e-5);
}

// The least squares solution is the one whose residual is perpendicular to every B-spline.
TEST(CubicSplineFit, ResidualIsPerpendicularToTheSpace)
{
  std::mt19937 random(9);
  std::normal_distribution<double> noise;
  const std::vector<double> sites = UnevenSites(50, 4);
  std::vector<double> samples;
  for (std::size_t i = 0; i < sites.size(); ++i)
  {
    samples.push_back(100 + noise(random));
  }
  const CubicSplineSpace space(
    sites.front(), { sites[9], sites[20] + 0.1, sites[21] + 0.1, sites[40] }, sites.back());
  const std::vector<double> c = Fit(space, sites, samples);
  std::vector<double> product(space.GetSize(), 0.0);
  double largest = 0;
  for (std::size_t i = 0; i < sites.size(); ++i)
  {
    const CubicSplineSpace::Values b = space.Evaluate(sites[i]);
    const double residual = samples[i] - Value(space, c, sites[i]);
    largest = std::max(largest, std::abs(residual));
    for (int k = 0; k < 4; ++k)
    {
      product[b.First + k] += b.Weights[k] * residual;
    }
  }
  EXPECT_GT(largest, 0.5);
  for (const double p : product)
  {
    EXPECT_NEAR(p, 0, 1e-12);
  }
}

TEST(CubicSplineFit, DeviationIsTheDistanceOfPoints)
{
  ThreadExecution execution(1);
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  const std::vector<double> sites = UnevenSites(20, 6);
  const std::int64_t width = 111; // 37 points, more than a block
  std::vector<double> samples(sites.size() * width);
  for (double& s : samples)
  {
    s = noise(random);
  }
  const CubicSplineFit fit(CubicSplineSpace(sites.front(), { sites[7] }, sites.back()), sites);
  std::vector<double> coefficients;
  std::vector<double> values;
  fit.Solve(execution, samples, width, coefficients);
  fit.Evaluate(execution, coefficients, width, values);
  const std::vector<double> deviation = fit.Deviation(execution, samples, width, 3);
  ASSERT_EQ(deviation.size(), sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
  {
    double expected = 0;
    for (std::int64_t k = 0; k < width; k += 3)
    {
      const double* a = samples.data() + i * width + k;
      const double* b = values.data() + i * width + k;
      expected = std::max(expected, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    EXPECT_NEAR(deviation[i], expected, 1e-12);
  }
}

TEST(CubicSplineFit, RefusesKnotsWithoutSites)
{
  const std::vector<double> sites{ 0, 1, 2, 3, 4, 5, 6, 7 };
  const std::vector<double> nine{ 0, 1, 2, 3, 4, 5, 6, 7, 8 };
  EXPECT_NO_THROW(CubicSplineFit(CubicSplineSpace(0, { 2, 3, 4, 5 }, 7), sites));
  EXPECT_THROW(CubicSplineFit(CubicSplineSpace(0, { 3.1, 3.2, 3.3, 3.4, 3.5 }, 8), nine),
    std::invalid_argument);
  EXPECT_THROW(
    CubicSplineFit(CubicSplineSpace(0, { 1, 2, 3, 4, 5, 6 }, 7), sites), std::invalid_argument);
  EXPECT_THROW(CubicSplineFit(CubicSplineSpace(0, {}, 7), { 0, 0, 0, 7 }), std::invalid_argument);
}

TEST(CubicSplineFit, SameBitsForAnyNumberOfThreads)
{
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  const std::vector<double> sites = UnevenSites(200, 6);
  const std::int64_t width = 999;
  std::vector<double> samples(sites.size() * width);
  for (double& s : samples)
  {
    s = noise(random);
  }
  const CubicSplineSpace space(sites.front(), { sites[50], sites[99] }, sites.back());
  const CubicSplineFit fit(space, sites);
  const std::vector<double> expected = Fit(space, sites, samples, width, 1);
  ThreadExecution one(1);
  const std::vector<double> deviation = fit.Deviation(one, samples, width, 3);
  for (const int threads : { 2, 5 })
  {
    EXPECT_EQ(Fit(space, sites, samples, width, threads), expected);
    ThreadExecution execution(threads);
    EXPECT_EQ(fit.Deviation(execution, samples, width, 3), deviation);
  }
}
