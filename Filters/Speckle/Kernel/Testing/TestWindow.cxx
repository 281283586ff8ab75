// SPDX-License-Identifier: BSD-3-Clause
#include "SpeckleOracle.h"
#include "lacunaOrderedKey.h"
#include "lacunaWindow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using lacuna::Extent;
using lacuna::Window;
using lacuna::WindowShape;

TEST(SpeckleWindow, IsCentredWhenOddAndReachesDownwardsWhenEven)
{
  const Window window({ 5, 4, 1 }, WindowShape::Box);
  EXPECT_EQ(window.Lower(0), 2);
  EXPECT_EQ(window.Upper(0), 2);
  EXPECT_EQ(window.Lower(1), 2);
  EXPECT_EQ(window.Upper(1), 1);
  EXPECT_EQ(window.Lower(2) + window.Upper(2), 0);
  EXPECT_EQ(window.GetNumberOfSamples(), 20);
  const Window reflected = window.Reflect();
  EXPECT_EQ(reflected.Lower(1), 1);
  EXPECT_EQ(reflected.Upper(1), 2);
  EXPECT_EQ(reflected.Grow({ 0, 9, 0, 9, 3, 3 }), (Extent{ -2, 11, -1, 11, 3, 3 }));
}

TEST(SpeckleWindow, GrowsNoFurtherThanTheIntegers)
{
  constexpr int least = std::numeric_limits<int>::min();
  constexpr int greatest = std::numeric_limits<int>::max();
  const Window window({ 5, 4, 3 }, WindowShape::Box);
  EXPECT_EQ(window.Grow({ least, 9, least + 1, greatest, 3, greatest - 1 }),
    (Extent{ least, 11, least, greatest, 2, greatest }));
}

TEST(SpeckleWindow, EllipsoidsHaveTheKernelSizeAsDiameters)
{
  EXPECT_EQ(Window({ 1, 1, 1 }, WindowShape::Ellipsoid).GetNumberOfSamples(), 1);
  EXPECT_EQ(Window({ 3, 3, 1 }, WindowShape::Ellipsoid).GetNumberOfSamples(), 9);
  EXPECT_EQ(Window({ 5, 5, 1 }, WindowShape::Ellipsoid).GetNumberOfSamples(), 21);
  EXPECT_EQ(Window({ 3, 3, 3 }, WindowShape::Ellipsoid).GetNumberOfSamples(), 19);
  // The more samples, the nearer pi/6 of the box.
  const Window large({ 41, 41, 41 }, WindowShape::Ellipsoid);
  EXPECT_NEAR(large.GetNumberOfSamples() / std::pow(41.0, 3), 3.14159265 / 6, 0.003);
}

TEST(SpeckleWindow, RefusesOtherSizes)
{
  for (const std::array<int, 3>& size :
    std::vector<std::array<int, 3>>{ { 0, 1, 1 }, { 3, -5, 1 }, { 1, 1, 256 } })
  {
    try
    {
      const Window window(size, WindowShape::Box);
      FAIL();
    }
    catch (const std::invalid_argument& e)
    {
      EXPECT_NE(std::string(e.what()).find("must be 1 to 255"), std::string::npos);
    }
  }
}

TEST(SpeckleWindow, DivideCoversABoxOnce)
{
  const Extent box{ -3, 40, 5, 5, 0, 12 };
  std::int64_t samples = 0;
  for (const Extent& part : lacuna::Divide(box, { 16, 16, 5 }))
  {
    EXPECT_TRUE(lacuna::Contains(box, part));
    EXPECT_FALSE(lacuna::IsEmpty(part));
    samples += lacuna::NumberOfSamples(part);
  }
  EXPECT_EQ(samples, lacuna::NumberOfSamples(box));
  EXPECT_TRUE(lacuna::Divide({ 0, -1, 0, -1, 0, -1 }, { 1, 1, 1 }).empty());
}

template <class T>
class OrderedKeyTest : public testing::Test
{
};
TYPED_TEST_SUITE(OrderedKeyTest, oracle::AllTypes);

TYPED_TEST(OrderedKeyTest, KeepsOrderAndValue)
{
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  std::vector<T> values{ Limits::lowest(), static_cast<T>(Limits::lowest() / 2), T(0), T(1), T(2),
    T(3), static_cast<T>(Limits::max() / 2), Limits::max() };
  if (Limits::has_infinity)
  {
    values.insert(values.begin(), -Limits::infinity());
    values.push_back(Limits::infinity());
    values.push_back(Limits::quiet_NaN());
  }
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const auto key = lacuna::OrderedKey<T>::From(values[i]);
    const T back = lacuna::OrderedKey<T>::To(key);
    EXPECT_TRUE(back == values[i] || back != back);
    if (i > 0 && values[i] != values[i - 1])
    {
      EXPECT_LT(lacuna::OrderedKey<T>::From(values[i - 1]), key) << i;
    }
  }
}
