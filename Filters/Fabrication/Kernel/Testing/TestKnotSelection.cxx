// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceFit.h"

#include "lacunaCubicSpline.h"
#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

using namespace lacuna;

namespace
{
struct Data
{
  std::vector<double> Sites;
  std::vector<double> Samples;
  std::int64_t Width;

  Data(int count, int width, const std::function<double(double, int)>& f)
    : Width(width)
  {
    for (int i = 0; i < count; ++i)
    {
      this->Sites.push_back(i);
      for (int k = 0; k < width; ++k)
      {
        this->Samples.push_back(f(i, k));
      }
    }
  }

  KnotSelection::Result Select(double tolerance) const
  {
    ThreadExecution execution(1);
    return KnotSelection(this->Sites, this->Samples, this->Width, 1).Select(execution, tolerance);
  }

  double Deviation(const std::vector<double>& interior) const
  {
    ThreadExecution execution(1);
    const CubicSplineFit fit(
      CubicSplineSpace(this->Sites.front(), interior, this->Sites.back()), this->Sites);
    double largest = 0;
    for (const double d : fit.Deviation(execution, this->Samples, this->Width, 1))
    {
      largest = std::max(largest, d);
    }
    return largest;
  }

  // As few equal intervals as the tolerance allows.
  std::size_t Uniform(double tolerance) const
  {
    for (std::size_t count = 0;; ++count)
    {
      std::vector<double> interior;
      for (std::size_t k = 1; k <= count; ++k)
      {
        interior.push_back(this->Sites.back() * static_cast<double>(k) / (count + 1.0));
      }
      if (this->Deviation(interior) <= tolerance)
      {
        return count;
      }
    }
  }
};
}

TEST(KnotSelection, CubicsNeedNoKnots)
{
  const Data data(
    50, 3, [](double x, int k) { return (k + 1) * (x * x * x / 1000 - x * x / 10 + 3); });
  const KnotSelection::Result result = data.Select(1e-9);
  EXPECT_TRUE(result.Interior.empty());
  EXPECT_LE(result.Deviation, 1e-9);
}

TEST(KnotSelection, KeepsTheTolerance)
{
  for (const double tolerance : { 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9 })
  {
    const Data data(121, 20,
      [](double x, int k)
      { return 10 * std::sin((x + k) / 15) * std::exp(-x / 80) + std::cos(x * k / 300); });
    const KnotSelection::Result result = data.Select(tolerance);
    EXPECT_LE(result.Interior.size(), 117u);
    EXPECT_LE(result.Deviation, tolerance);
    EXPECT_LE(data.Deviation(result.Interior), tolerance);
  }
}

TEST(KnotSelection, NotMoreThanEqualIntervalsNeed)
{
  const Data data(121, 20, [](double x, int k) { return 10 * std::sin((x + k) / 15); });
  for (const double tolerance : { 1e-1, 1e-2, 1e-3 })
  {
    EXPECT_LE(data.Select(tolerance).Interior.size(), data.Uniform(tolerance));
  }
}

TEST(KnotSelection, PutsKnotsWhereTheDetailIs)
{
  const Data data(
    121, 5, [](double x, int k) { return 3 * std::exp(-(x - 30 - k) * (x - 30 - k) / 40); });
  const std::vector<double> interior = data.Select(1e-3).Interior;
  EXPECT_LT(2 * interior.size(), data.Uniform(1e-3));
  std::size_t near = 0;
  for (const double x : interior)
  {
    near += x > 10 && x < 54;
  }
  EXPECT_GE(near, interior.size() - 2);
}

TEST(KnotSelection, NoiseNeedsAllKnots)
{
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  const Data data(40, 10, [&](double, int) { return noise(random); });
  EXPECT_EQ(data.Select(1e-6).Interior.size(), 36u);
}

TEST(KnotSelection, SelectCountUsesAsManyAsAskedFor)
{
  const Data data(60, 4, [](double x, int k) { return std::sin((x + k) / 9); });
  ThreadExecution execution(1);
  KnotSelection selection(data.Sites, data.Samples, data.Width, 1);
  double before = 1e9;
  for (const std::int64_t count : { 0, 3, 10, 30, 56 })
  {
    const KnotSelection::Result result = selection.SelectCount(execution, count);
    EXPECT_EQ(static_cast<std::int64_t>(result.Interior.size()), count);
    EXPECT_LT(result.Deviation, before);
    before = result.Deviation;
  }
  EXPECT_LT(before, 1e-12);
}
