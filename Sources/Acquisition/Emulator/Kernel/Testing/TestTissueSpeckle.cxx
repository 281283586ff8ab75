// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaUltrasoundEmulator.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace lacuna;

TEST(TissueSpeckle, HasTheMomentsOfARayleighDistribution)
{
  const TissueSpeckle speckle(5);
  double sums[4] = { 0, 0, 0, 0 };
  double lowest = 0;
  constexpr int count = 400000;
  for (int i = 0; i < count; ++i)
  {
    // incommensurable steps: all over the grid
    const double g = speckle.At({ 1.41421 * i, 1.73205 * i - 7000, 2.23607 * i });
    lowest = std::min(lowest, g);
    for (int power = 1; power < 4; ++power)
    {
      sums[power] += std::pow(g, power) / count;
    }
  }
  EXPECT_NEAR(sums[1], 0, 0.02);
  EXPECT_NEAR(sums[2], 1, 0.02);
  // 0.63, and more between the points of the grid, where its narrow dark places are filled in
  EXPECT_NEAR(sums[3], 0.8, 0.2);
  EXPECT_GT(lowest, -2.5);
}

TEST(TissueSpeckle, IsTheSameAtTheSamePlace)
{
  const TissueSpeckle speckle(1);
  const Vec3 start{ -31.7, 12.4, 3.3 };
  const Vec3 step{ 0.11, -0.03, 0.07 };
  std::vector<double> levels(700, 100);
  speckle.Apply(start, step, 700, 0.3, levels.data());
  for (int i = 0; i < 700; ++i)
  {
    const double g = speckle.At(start + static_cast<double>(i) * step);
    ASSERT_NEAR(levels[static_cast<std::size_t>(i)], 100 * std::max(0.0, 1 + 0.3 * g), 0.02) << i;
  }
  EXPECT_EQ(TissueSpeckle(1).At(start), speckle.At(start));
  EXPECT_NE(TissueSpeckle(2).At(start), speckle.At(start));
}

TEST(TissueSpeckle, IsCorrelatedOverAResolutionCell)
{
  const TissueSpeckle speckle(3);
  const auto correlate = [&](double distance, int axis)
  {
    double sum = 0;
    for (int i = 0; i < 100000; ++i)
    {
      Vec3 point{ 1.41421 * i, 1.73205 * i, 2.23607 * i };
      const double here = speckle.At(point);
      point[axis] += distance;
      sum += here * speckle.At(point) / 100000;
    }
    return sum;
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_GT(correlate(0.1, axis), 0.9);
    EXPECT_NEAR(correlate(0.35, axis), 0.55, 0.15);
    EXPECT_LT(std::abs(correlate(2, axis)), 0.05);
  }
}
