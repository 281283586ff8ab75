// SPDX-License-Identifier: BSD-3-Clause
#include "SpeckleOracle.h"
#include "lacunaSpeckleFilter.h"

#include <gtest/gtest.h>

using lacuna::Extreme;
using lacuna::VectorUnit;
using lacuna::Window;
using lacuna::WindowShape;
using oracle::Image;

namespace
{
template <class T>
Image<T> Truth(const Image<T>& image, const Window& window, Extreme extreme)
{
  return oracle::Filter(image, window,
    [=](const auto& samples, T)
    {
      const auto less = [](const auto& a, const auto& b) { return a.Value < b.Value; };
      const auto range = std::minmax_element(samples.begin(), samples.end(), less);
      return extreme == Extreme::Least ? range.first->Value : range.second->Value;
    });
}

template <class T>
void ExpectExtremesAsDefined(const Image<T>& image, const Window& window)
{
  lacuna::ThreadExecution execution(2);
  for (const Extreme extreme : { Extreme::Least, Extreme::Greatest })
  {
    const Image<T> truth = Truth(image, window, extreme);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      Image<T> result(image.Box);
      lacuna::FilterExtreme<T>(image.View(), result.View(), window, extreme, set, execution);
      EXPECT_EQ(oracle::Differences(result, truth), 0u)
        << window.GetSize(0) << " " << window.GetSize(1) << " " << window.GetSize(2)
        << (window.IsBox() ? " box" : " ellipsoid") << " set " << int(set);
    }
  }
}
}

template <class T>
class MorphologyTest : public testing::Test
{
};
TYPED_TEST_SUITE(MorphologyTest, oracle::AllTypes);

TYPED_TEST(MorphologyTest, EqualsItsDefinition)
{
  const Image<TypeParam> image = oracle::Random<TypeParam>(73, 9, 6, 1);
  for (const std::array<int, 3>& size : std::vector<std::array<int, 3>>{ { 1, 1, 1 }, { 3, 3, 1 },
         { 2, 5, 1 }, { 7, 4, 3 }, { 6, 6, 6 }, { 1, 1, 5 }, { 31, 1, 1 }, { 1, 16, 1 } })
  {
    for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
    {
      ExpectExtremesAsDefined(image, Window(size, shape));
      ExpectExtremesAsDefined(image, Window(size, shape).Reflect());
    }
  }
}

TEST(Morphology, EqualsItsDefinitionAcrossBlocks)
{
  const Image<double> image = oracle::Random<double>(600, 70, 2, 2);
  for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
  {
    ExpectExtremesAsDefined(image, Window({ 5, 5, 1 }, shape));
    ExpectExtremesAsDefined(image, Window({ 3, 3, 2 }, shape));
  }
}

TEST(Morphology, CountsWindowsLargerThanTheImage)
{
  const Image<std::uint16_t> image = oracle::Random<std::uint16_t>(4, 3, 3, 3);
  ExpectExtremesAsDefined(image, Window({ 40, 30, 21 }, WindowShape::Box));
  ExpectExtremesAsDefined(image, Window({ 40, 30, 21 }, WindowShape::Ellipsoid));
}

TEST(Morphology, LeavesNaNOutAndInPlace)
{
  Image<float> image = oracle::Random<float>(41, 13, 4, 4);
  oracle::SprinkleNaN(image, 3);
  for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
  {
    ExpectExtremesAsDefined(image, Window({ 2, 2, 1 }, shape));
    ExpectExtremesAsDefined(image, Window({ 5, 5, 3 }, shape));
  }
}
