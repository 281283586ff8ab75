// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthPlane.h"

#include <gtest/gtest.h>

#include <vector>

using namespace lacuna;

namespace
{
DepthPlane Fit(const std::vector<Vec3>& points)
{
  return FitDepthPlane(
    [&](const auto& body)
    {
      for (const Vec3& p : points)
      {
        body(p);
      }
    });
}
}

TEST(DepthPlane, IsNearestAlongZ)
{
  // errors of +-1 at the corners of a parallelogram, of which the first two and the last two cancel
  const auto depth = [](double x, double y) { return 7 + 0.5 * x - 2 * y; };
  const DepthPlane plane = Fit({ { 10, 20, depth(10, 20) + 1 }, { 13, 21, depth(13, 21) - 1 },
    { 12, 25, depth(12, 25) - 1 }, { 15, 26, depth(15, 26) + 1 } });
  EXPECT_TRUE(plane.IsUnique);
  EXPECT_NEAR(plane.Coefficients[0], 7, 1e-11);
  EXPECT_NEAR(plane.Coefficients[1], 0.5, 1e-12);
  EXPECT_NEAR(plane.Coefficients[2], -2, 1e-12);
}

TEST(DepthPlane, OfPointsOnALineIsLevel)
{
  for (const double slope : { 0.0, 1.0, 1 / 3.0, 1e3 })
  {
    std::vector<Vec3> points;
    for (int i = 0; i < 10; ++i)
    {
      points.push_back({ 100 + i / 7.0, 50 + slope * i / 7.0, 3.0 + i });
    }
    const DepthPlane plane = Fit(points);
    EXPECT_FALSE(plane.IsUnique) << slope;
    EXPECT_EQ(plane.Coefficients, (std::array<double, 3>{ 7.5, 0, 0 })) << slope;
  }
  EXPECT_FALSE(Fit({}).IsUnique);
  EXPECT_EQ(Fit({}).Coefficients, (std::array<double, 3>{}));
  EXPECT_EQ(Fit({ { 1, 2, 5 } }).Coefficients[0], 5);
}
