// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDistanceTransform.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace
{
std::vector<double> BruteForce(
  int width, int height, const lacuna::Vec2& spacing, const std::vector<unsigned char>& feature)
{
  std::vector<double> result(feature.size(), std::numeric_limits<double>::infinity());
  for (int p = 0; p < width * height; ++p)
  {
    for (int q = 0; q < width * height; ++q)
    {
      if (feature[q])
      {
        const int columns = p % width - q % width;
        const int rows = p / width - q / width;
        const double dx = spacing[0] * columns;
        const double dy = spacing[1] * rows;
        result[p] = std::min(result[p], dx * dx + dy * dy);
      }
    }
  }
  return result;
}
}

TEST(DistanceTransform, AgreesWithBruteForce)
{
  std::mt19937 random(7);
  for (const double density : { 0.0, 0.002, 0.05, 0.6, 1.0 })
  {
    for (const lacuna::Vec2& spacing : { lacuna::Vec2{ 1, 1 }, lacuna::Vec2{ 0.3, 1.7 } })
    {
      constexpr int width = 41;
      constexpr int height = 23;
      std::vector<unsigned char> feature(static_cast<std::size_t>(width) * height);
      for (auto& f : feature)
      {
        f = std::uniform_real_distribution<double>(0, 1)(random) < density;
      }
      lacuna::ThreadExecution execution(3);
      const auto result =
        lacuna::SquaredDistanceTransform(execution, width, height, spacing, feature);
      const auto exact = BruteForce(width, height, spacing, feature);
      for (std::size_t i = 0; i < exact.size(); ++i)
      {
        if (std::isinf(exact[i]))
        {
          EXPECT_EQ(result[i], exact[i]);
        }
        else
        {
          EXPECT_NEAR(result[i], exact[i], 1e-12 * exact[i]);
        }
      }
    }
  }
}

TEST(DistanceTransform, WorksOnOneRowAndOneColumn)
{
  lacuna::ThreadExecution execution(2);
  const std::vector<unsigned char> feature{ 0, 0, 1, 0, 0, 0 };
  const std::vector<double> row{ 16, 4, 0, 4, 16, 36 };
  EXPECT_EQ(lacuna::SquaredDistanceTransform(execution, 6, 1, { 2, 5 }, feature), row);
  EXPECT_EQ(lacuna::SquaredDistanceTransform(execution, 1, 6, { 5, 2 }, feature), row);
}
