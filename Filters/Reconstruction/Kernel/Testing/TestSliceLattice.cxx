// SPDX-License-Identifier: BSD-3-Clause
/// Lattices of slices: what is shown of a picture with too many pixels.
#include "lacunaSliceLattice.h"

#include <gtest/gtest.h>

using namespace lacuna;

TEST(SliceLattice, LinearPicturesAreReproduced)
{
  for (const int width : { 1, 2, 7, 20 })
  {
    for (const int height : { 1, 5, 16 })
    {
      std::vector<double> pixels;
      for (int y = 0; y < height; ++y)
      {
        for (int x = 0; x < width; ++x)
        {
          pixels.push_back(3 + 2 * x - 5 * y);
        }
      }
      for (const int step : { 1, 2, 3, 4, 7, 30 })
      {
        const SliceLattice lattice(width, height, step);
        EXPECT_EQ(lattice.GetColumns().front(), 0);
        EXPECT_EQ(lattice.GetColumns().back(), width - 1);
        EXPECT_EQ(lattice.GetRows().back(), height - 1);
        std::vector<float> levels(lattice.GetNumberOfPoints());
        lattice.Reduce(ScalarType::Float64, pixels.data(), levels.data());
        std::size_t i = 0;
        for (const int y : lattice.GetRows())
        {
          for (const int x : lattice.GetColumns())
          {
            ASSERT_NEAR(levels[i++], 3 + 2 * x - 5 * y, 1e-4);
          }
        }
      }
    }
  }
}

TEST(SliceLattice, AveragesOverTheStep)
{
  // single bright pixels: the weights of a box
  std::vector<std::uint8_t> pixels(81, 0);
  pixels[4 * 9 + 4] = 200;
  std::vector<float> levels(9);
  SliceLattice(9, 9, 4).Reduce(ScalarType::UInt8, pixels.data(), levels.data());
  EXPECT_FLOAT_EQ(levels[4], 200.0F / 16);
  pixels[4 * 9 + 4] = 0;
  pixels[4 * 9 + 6] = 200; // on the border of the middle box
  SliceLattice(9, 9, 4).Reduce(ScalarType::UInt8, pixels.data(), levels.data());
  EXPECT_FLOAT_EQ(levels[4], 200.0F / 32);
  levels.resize(16);
  SliceLattice(9, 9, 3).Reduce(ScalarType::UInt8, pixels.data(), levels.data());
  EXPECT_FLOAT_EQ(levels[4 + 2], 200.0F / 9);
  // step 1 is the picture
  levels.resize(81);
  SliceLattice(9, 9, 1).Reduce(ScalarType::UInt8, pixels.data(), levels.data());
  for (int i = 0; i < 81; ++i)
  {
    EXPECT_EQ(levels[i], pixels[i]);
  }
}

TEST(SliceLattice, StepKeepsTheLimit)
{
  EXPECT_EQ(SliceLattice::ChooseStep(640, 480, 1, 4000000), 1);
  EXPECT_EQ(SliceLattice::ChooseStep(640, 480, 13, 640 * 480 * 13), 1);
  EXPECT_EQ(SliceLattice::ChooseStep(640, 480, 13, 640 * 480 * 13 - 1), 2);
  const int step = SliceLattice::ChooseStep(640, 480, 200, 4000000);
  EXPECT_EQ(step, 4); // 161 x 121 x 200
  EXPECT_LE(SliceLattice(640, 480, step).GetNumberOfPoints() * 200, 4000000);
  EXPECT_GT(SliceLattice(640, 480, step - 1).GetNumberOfPoints() * 200, 4000000);
  // the corners stay, whatever the limit
  EXPECT_EQ(SliceLattice::ChooseStep(640, 480, 1 << 30, 4), 639);
  EXPECT_EQ(SliceLattice(640, 480, 639).GetNumberOfPoints(), 4);
  EXPECT_EQ(SliceLattice::ChooseStep(2147483647, 2, 1, 4), 2147483646);
  EXPECT_THROW(SliceLattice(0, 4, 1), std::invalid_argument);
}
