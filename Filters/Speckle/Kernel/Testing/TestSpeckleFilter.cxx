// SPDX-License-Identifier: BSD-3-Clause
#include "ScipyTables.h"
#include "SpeckleOracle.h"
#include "lacunaSpeckleFilter.h"

#include <gtest/gtest.h>

using lacuna::Extent;
using lacuna::SpeckleOperation;
using lacuna::SpeckleParameters;
using lacuna::WindowShape;
using oracle::Image;

namespace
{
const std::vector<SpeckleOperation> Operations{ SpeckleOperation::Median, SpeckleOperation::Rank,
  SpeckleOperation::Minimum, SpeckleOperation::Maximum, SpeckleOperation::Opening,
  SpeckleOperation::Closing, SpeckleOperation::OpenClose, SpeckleOperation::CloseOpen,
  SpeckleOperation::Mode, SpeckleOperation::AdaptiveMedian, SpeckleOperation::Mean,
  SpeckleOperation::Gaussian, SpeckleOperation::TopHat };

template <class T>
Image<T> Filtered(const Image<T>& image, const SpeckleParameters& parameters, int threads = 2)
{
  Image<T> result(image.Box);
  lacuna::ThreadExecution execution(threads);
  lacuna::FilterSpeckle<T>(image.View(), result.View(), parameters, execution);
  return result;
}

template <class T>
Image<lacuna::LaplacianType<T>> Laplacian(
  const Image<T>& image, const SpeckleParameters& parameters)
{
  Image<lacuna::LaplacianType<T>> result(image.Box);
  lacuna::ThreadExecution execution(2);
  lacuna::FilterSpeckleLaplacian<T>(image.View(), result.View(), parameters, execution);
  return result;
}

SpeckleParameters Make(
  SpeckleOperation operation, const std::array<int, 3>& size, WindowShape shape = WindowShape::Box)
{
  SpeckleParameters parameters;
  parameters.Operation = operation;
  parameters.KernelSize = size;
  parameters.Shape = shape;
  parameters.Percentile = 30;
  parameters.AdaptiveStrength = 0.5;
  parameters.StandardDeviation = 0.9;
  return parameters;
}
}

// Tables made by scipy.ndimage (ScipyTables.py), mode 'nearest'.
TEST(SpeckleFilter, EqualsScipy)
{
  Image<std::uint8_t> image(scipyTables::Size[0], scipyTables::Size[1], scipyTables::Size[2]);
  image.Samples.assign(std::begin(scipyTables::Input), std::end(scipyTables::Input));
  for (const scipyTables::Table& table : scipyTables::Tables)
  {
    SpeckleParameters parameters =
      Make(static_cast<SpeckleOperation>(table.Operation), table.KernelSize);
    parameters.StandardDeviation = 1.3;
    parameters.Spacing = table.Spacing;
    if (parameters.Operation == SpeckleOperation::LaplacianOfGaussian)
    {
      const auto result = Laplacian(image, parameters);
      for (std::size_t i = 0; i < image.Samples.size(); ++i)
      {
        ASSERT_NEAR(result.Samples[i], table.Values[i], 2e-3) << table.Name << " at " << i;
      }
    }
    else
    {
      const Image<std::uint8_t> result = Filtered(image, parameters);
      for (std::size_t i = 0; i < image.Samples.size(); ++i)
      {
        ASSERT_EQ(result.Samples[i], table.Values[i]) << table.Name << " at " << i;
      }
    }
  }
}

TEST(SpeckleFilter, DoesNotDependOnThreadsAndPieces)
{
  Image<float> floats = oracle::Random<float>(75, 41, 19, 1);
  oracle::SprinkleNaN(floats, 50);
  const Image<std::uint8_t> bytes = oracle::Random<std::uint8_t>(75, 41, 19, 2);
  const auto check = [](const auto& image, const SpeckleParameters& parameters)
  {
    using T = std::decay_t<decltype(image.Samples[0])>;
    const auto whole = Filtered(image, parameters, 1);
    EXPECT_EQ(oracle::Differences(Filtered(image, parameters, 2), whole), 0u);
    EXPECT_EQ(oracle::Differences(Filtered(image, parameters, 5), whole), 0u);
    // A piece, from the part of the image that it says it needs.
    const Extent piece{ 20, 38, 0, 17, 9, 18 };
    const Extent needed = lacuna::Intersect(lacuna::GetSpeckleInput(parameters, piece), image.Box);
    Image<T> part(needed);
    for (int z = needed[4]; z <= needed[5]; ++z)
    {
      for (int y = needed[2]; y <= needed[3]; ++y)
      {
        for (int x = needed[0]; x <= needed[1]; ++x)
        {
          *part.View().At(x, y, z) = image.At(x, y, z);
        }
      }
    }
    Image<T> result(piece);
    lacuna::ThreadExecution execution(2);
    lacuna::FilterSpeckle<T>(std::as_const(part).View(), result.View(), parameters, execution);
    for (int z = piece[4]; z <= piece[5]; ++z)
    {
      for (int y = piece[2]; y <= piece[3]; ++y)
      {
        for (int x = piece[0]; x <= piece[1]; ++x)
        {
          ASSERT_TRUE(oracle::Same(result.At(x, y, z), whole.At(x, y, z)))
            << "operation " << int(parameters.Operation) << " at " << x << " " << y << " " << z;
        }
      }
    }
  };
  for (const SpeckleOperation operation : Operations)
  {
    for (const std::array<int, 3>& size :
      std::vector<std::array<int, 3>>{ { 5, 5, 1 }, { 4, 5, 3 } })
    {
      check(floats, Make(operation, size));
      check(bytes, Make(operation, size));
      check(bytes, Make(operation, size, WindowShape::Ellipsoid));
    }
  }
}

TEST(SpeckleFilter, OpeningAndClosingBehaveAsTheyShould)
{
  const Image<std::int16_t> image = oracle::Random<std::int16_t>(40, 31, 17, 3);
  for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
  {
    for (const std::array<int, 3>& size :
      std::vector<std::array<int, 3>>{ { 3, 3, 1 }, { 4, 2, 2 }, { 5, 5, 3 } })
    {
      const auto opened = Filtered(image, Make(SpeckleOperation::Opening, size, shape));
      const auto closed = Filtered(image, Make(SpeckleOperation::Closing, size, shape));
      for (int z = 0; z < 17; ++z)
      {
        for (int y = 0; y < 31; ++y)
        {
          for (int x = 0; x < 40; ++x)
          {
            ASSERT_LE(opened.At(x, y, z), image.At(x, y, z));
            ASSERT_GE(closed.At(x, y, z), image.At(x, y, z));
          }
        }
      }
      // Nothing more to remove: openings are idempotent away from the border, where repeated
      // samples take part.
      const auto twice = Filtered(opened, Make(SpeckleOperation::Opening, size, shape));
      for (int y = 9; y < 22; ++y)
      {
        for (int x = 9; x < 30; ++x)
        {
          ASSERT_EQ(twice.At(x, y, 8), opened.At(x, y, 8));
        }
      }
      EXPECT_EQ(oracle::Differences(Filtered(image, Make(SpeckleOperation::OpenClose, size, shape)),
                  Filtered(opened, Make(SpeckleOperation::Closing, size, shape))),
        0u);
      EXPECT_EQ(oracle::Differences(Filtered(image, Make(SpeckleOperation::CloseOpen, size, shape)),
                  Filtered(closed, Make(SpeckleOperation::Opening, size, shape))),
        0u);
    }
  }
}

TEST(SpeckleFilter, OpeningRemovesWhatIsSmallerThanTheWindowAndShiftsNothing)
{
  Image<std::uint8_t> image(24, 12, 1);
  for (int x = 3; x < 7; ++x) // a 4 x 4 square stays
  {
    for (int y = 2; y < 6; ++y)
    {
      *image.View().At(x, y, 0) = 200;
    }
  }
  const Image<std::uint8_t> square = image;
  for (int x = 12; x < 15; ++x) // a 3 x 5 one goes
  {
    for (int y = 4; y < 9; ++y)
    {
      *image.View().At(x, y, 0) = 150;
    }
  }
  EXPECT_EQ(Filtered(image, Make(SpeckleOperation::Opening, { 4, 4, 1 })).Samples, square.Samples);
}

TEST(SpeckleFilter, TopHatKeepsNaNAndMakesNone)
{
  Image<float> image(9, 1, 1);
  image.Samples = { 1, 1, 5, std::numeric_limits<float>::quiet_NaN(), 1, 1,
    std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
    std::numeric_limits<float>::infinity() };
  const auto hat = Filtered(image, Make(SpeckleOperation::TopHat, { 3, 1, 1 }));
  EXPECT_EQ(hat.Samples[2], 4);
  EXPECT_TRUE(std::isnan(hat.Samples[3]));
  for (const std::size_t i : { 0, 1, 4, 5, 7, 8 })
  {
    EXPECT_EQ(hat.Samples[i], 0) << i;
  }
}

TEST(SpeckleFilter, TwoDimensionalWindowsKeepSlicesApart)
{
  const Image<std::uint16_t> stack = oracle::Random<std::uint16_t>(33, 22, 4, 4);
  for (const SpeckleOperation operation : Operations)
  {
    const auto whole = Filtered(stack, Make(operation, { 5, 3, 1 }));
    for (int z = 0; z < 4; ++z)
    {
      Image<std::uint16_t> slice(33, 22, 1);
      std::copy_n(
        stack.Samples.begin() + std::ptrdiff_t(z) * 33 * 22, 33 * 22, slice.Samples.begin());
      const auto alone = Filtered(slice, Make(operation, { 5, 3, 1 }));
      EXPECT_TRUE(std::equal(alone.Samples.begin(), alone.Samples.end(),
        whole.Samples.begin() + std::ptrdiff_t(z) * 33 * 22))
        << int(operation);
    }
  }
}

TEST(SpeckleFilter, GaussianWidthIsInMillimetres)
{
  // The same physical image on two grids: spacing 1, and spacing 0.5 along x.
  SpeckleParameters parameters = Make(SpeckleOperation::Gaussian, { 5, 1, 1 });
  parameters.StandardDeviation = 2;
  Image<double> coarse(41, 1, 1);
  coarse.Samples[20] = 1;
  parameters.Spacing = { 1, 1, 1 };
  const auto wide = Filtered(coarse, parameters);
  Image<double> fine(81, 1, 1);
  fine.Samples[40] = 2;
  parameters.Spacing = { 0.5, 1, 1 };
  const auto narrow = Filtered(fine, parameters);
  for (int i = 13; i < 28; ++i)
  {
    EXPECT_NEAR(wide.Samples[i], narrow.Samples[i + i], 2e-5);
  }
}

TEST(SpeckleFilter, FiltersComponentsThroughStrides)
{
  const Image<float> image = oracle::Random<float>(19, 14, 3, 5);
  std::vector<float> interleaved(3 * image.Samples.size(), -1);
  std::vector<float> output(interleaved);
  for (std::size_t i = 0; i < image.Samples.size(); ++i)
  {
    interleaved[3 * i + 1] = image.Samples[i];
  }
  for (const SpeckleOperation operation : Operations)
  {
    const SpeckleParameters parameters = Make(operation, { 3, 4, 3 });
    lacuna::ThreadExecution execution(2);
    lacuna::FilterSpeckle<float>(
      lacuna::ImageView<const float>(interleaved.data() + 1, image.Box, 3),
      lacuna::ImageView<float>(output.data() + 1, image.Box, 3), parameters, execution);
    const auto truth = Filtered(image, parameters);
    for (std::size_t i = 0; i < image.Samples.size(); ++i)
    {
      ASSERT_EQ(output[3 * i + 1], truth.Samples[i]) << int(operation);
      ASSERT_EQ(output[3 * i], -1);
      ASSERT_EQ(output[3 * i + 2], -1);
    }
  }
}

TEST(SpeckleFilter, StopsWhenAskedTo)
{
  const Image<std::uint8_t> image(600, 600, 40);
  Image<std::uint8_t> result(image.Box);
  lacuna::ThreadExecution execution(2, [](double) { return false; });
  for (const SpeckleOperation operation : Operations)
  {
    EXPECT_THROW(lacuna::FilterSpeckle<std::uint8_t>(
                   image.View(), result.View(), Make(operation, { 5, 5, 5 }), execution),
      lacuna::Aborted);
  }
}

TEST(SpeckleFilter, ProgressOnlyGrows)
{
  Image<float> image = oracle::Random<float>(60, 50, 12, 8);
  oracle::SprinkleNaN(image, 100);
  for (int o = 0; o <= static_cast<int>(SpeckleOperation::LaplacianOfGaussian); ++o)
  {
    std::vector<double> reports{ 0 };
    lacuna::ThreadExecution execution(2,
      [&](double fraction)
      {
        reports.push_back(fraction);
        return true;
      });
    const SpeckleParameters parameters = Make(static_cast<SpeckleOperation>(o), { 5, 5, 5 });
    Image<float> result(image.Box);
    execution.SetStage(0, 0.5);
    if (parameters.Operation == SpeckleOperation::LaplacianOfGaussian)
    {
      lacuna::FilterSpeckleLaplacian<float>(
        std::as_const(image).View(), result.View(), parameters, execution);
    }
    else
    {
      lacuna::FilterSpeckle<float>(
        std::as_const(image).View(), result.View(), parameters, execution);
    }
    EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end())) << "operation " << o;
    EXPECT_DOUBLE_EQ(reports.back(), 0.5) << "operation " << o;
  }
}

TEST(SpeckleFilter, TakesSinglePixelsAndWindowsBeyondTheImage)
{
  for (const Extent& box :
    std::vector<Extent>{ { 7, 7, -3, -3, 0, 0 }, { 0, 0, 0, 4, 0, 0 }, { -2, 1, 5, 5, 9, 11 } })
  {
    Image<std::int16_t> image(box);
    for (std::size_t i = 0; i < image.Samples.size(); ++i)
    {
      image.Samples[i] = static_cast<std::int16_t>(37 * i % 11 - 5);
    }
    for (const SpeckleOperation operation : Operations)
    {
      for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
      {
        const auto result = Filtered(image, Make(operation, { 30, 31, 32 }, shape));
        const auto range = std::minmax_element(image.Samples.begin(), image.Samples.end());
        const bool isDifference = operation == SpeckleOperation::TopHat;
        const int least = isDifference ? 0 : *range.first;
        const int greatest = isDifference ? *range.second - *range.first : *range.second;
        for (const std::int16_t sample : result.Samples)
        {
          EXPECT_GE(sample, least) << int(operation);
          EXPECT_LE(sample, greatest) << int(operation);
        }
      }
    }
    const auto flat = Laplacian(image, Make(SpeckleOperation::LaplacianOfGaussian, { 9, 9, 9 }));
    EXPECT_TRUE(std::all_of(
      flat.Samples.begin(), flat.Samples.end(), [](float value) { return std::isfinite(value); }));
  }
}

// Far from 0 and across it: results move with the image.
TEST(SpeckleFilter, DoesNotCareWhereAnImageLies)
{
  const Image<float> image = oracle::Random<float>(40, 13, 5, 11);
  for (const int shift : { -23, -1000000000, 1000000000 })
  {
    Image<float> moved(Extent{ shift, shift + 39, -shift, 12 - shift, shift / 2, shift / 2 + 4 });
    moved.Samples = image.Samples;
    for (const SpeckleOperation operation : Operations)
    {
      const SpeckleParameters parameters = Make(operation, { 4, 5, 3 });
      EXPECT_EQ(Filtered(moved, parameters).Samples, Filtered(image, parameters).Samples)
        << int(operation);
    }
  }
}

template <class T>
class SpeckleTypeTest : public testing::Test
{
};
TYPED_TEST_SUITE(SpeckleTypeTest, oracle::AllTypes);

TYPED_TEST(SpeckleTypeTest, ConstantsStayConstant)
{
  using Limits = std::numeric_limits<TypeParam>;
  for (const TypeParam value : { TypeParam(0), TypeParam(93), Limits::lowest(), Limits::max() })
  {
    Image<TypeParam> image(33, 12, 5);
    std::fill(image.Samples.begin(), image.Samples.end(), value);
    for (const SpeckleOperation operation : Operations)
    {
      const bool sums =
        operation == SpeckleOperation::Mean || operation == SpeckleOperation::Gaussian;
      const bool extreme = value == Limits::lowest() || value == Limits::max();
      if (std::is_floating_point_v<TypeParam> && sums && extreme)
      {
        continue; // their sums leave the type
      }
      const auto result = Filtered(image, Make(operation, { 7, 4, 3 }));
      if (std::is_floating_point_v<TypeParam> && operation == SpeckleOperation::Gaussian)
      {
        for (const TypeParam sample : result.Samples)
        {
          ASSERT_NEAR(sample, value, 4e-7 * static_cast<double>(value));
        }
        continue;
      }
      if (operation == SpeckleOperation::TopHat)
      {
        EXPECT_EQ(result.Samples, std::vector<TypeParam>(image.Samples.size())) << double(value);
        continue;
      }
      EXPECT_EQ(result.Samples, image.Samples) << int(operation) << " " << double(value);
    }
  }
}

// White top-hat; int8 cannot hold 100 - (-100).
TYPED_TEST(SpeckleTypeTest, TopHatIsWhatOpeningTakes)
{
  const Image<TypeParam> image = oracle::Random<TypeParam>(40, 31, 5, 3);
  for (const std::array<int, 3>& size : { std::array<int, 3>{ 3, 3, 1 }, { 4, 2, 2 } })
  {
    const auto opened = Filtered(image, Make(SpeckleOperation::Opening, size));
    const auto hat = Filtered(image, Make(SpeckleOperation::TopHat, size));
    for (std::size_t i = 0; i < image.Samples.size(); ++i)
    {
      // exact: long double has the digits of all integer types; floating types round once
      using Exact = std::conditional_t<std::is_integral_v<TypeParam>, long double, TypeParam>;
      const Exact difference = Exact(image.Samples[i]) - Exact(opened.Samples[i]);
      const Exact most = Exact(std::numeric_limits<TypeParam>::max());
      ASSERT_EQ(hat.Samples[i], static_cast<TypeParam>(std::min(difference, most))) << i;
    }
  }
}

// Neighbouring integers that are one and the same double.
TEST(SpeckleFilter, RanksAndMeansOf64BitsAreExact)
{
  const std::int64_t large = (std::int64_t(1) << 60) + 1;
  Image<std::int64_t> image(9, 1, 1);
  for (int i = 0; i < 9; ++i)
  {
    image.Samples[i] = large + 7 * i % 9; // 0 7 5 3 1 8 6 4 2
  }
  const auto middle = [&](SpeckleOperation operation) {
    return Filtered(image, Make(operation, { 9, 1, 1 })).Samples[4] - large;
  };
  EXPECT_EQ(middle(SpeckleOperation::Median), 4);
  EXPECT_EQ(middle(SpeckleOperation::Rank), 2); // 30 % of 9
  EXPECT_EQ(middle(SpeckleOperation::Minimum), 0);
  EXPECT_EQ(middle(SpeckleOperation::Maximum), 8);
  EXPECT_EQ(middle(SpeckleOperation::Mode), 4);
  EXPECT_EQ(middle(SpeckleOperation::Mean), 4);
}

TEST(SpeckleFilter, SaysWhatIsWrongWithItsParameters)
{
  const auto message = [](SpeckleParameters parameters)
  {
    try
    {
      lacuna::GetSpeckleInput(parameters, { 0, 1, 0, 1, 0, 1 });
    }
    catch (const std::invalid_argument& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  SpeckleParameters parameters;
  EXPECT_EQ(message(parameters), "");
  parameters.KernelSize = { 5, 0, 1 };
  EXPECT_NE(message(parameters).find("KernelSize is 0 voxels; it must be from 1 to 255 voxels"),
    std::string::npos);
  parameters = Make(SpeckleOperation::Rank, { 3, 3, 1 });
  for (const double bad : { -1.0, 100.5, std::nan("") })
  {
    parameters.Percentile = bad;
    EXPECT_NE(message(parameters).find("Rank is "), std::string::npos);
  }
  parameters = Make(SpeckleOperation::Gaussian, { 3, 3, 1 });
  for (const double bad : { -1.0, 0.0, std::nan("") })
  {
    parameters.StandardDeviation = bad;
    EXPECT_NE(message(parameters).find("StandardDeviation is "), std::string::npos);
  }
  parameters.StandardDeviation = 1e6;
  EXPECT_NE(message(parameters).find("standard deviation"), std::string::npos);
  parameters = Make(SpeckleOperation::LaplacianOfGaussian, { 3, 3, 1 });
  parameters.Spacing[1] = 0;
  EXPECT_NE(message(parameters).find("spacing"), std::string::npos);
}
