// SPDX-License-Identifier: BSD-3-Clause
/// The floor of a water bath is found in B-scans, and nothing is found where there is none.
#include "lacunaWallDetection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace lacuna;

namespace
{
// A bath: specks, the floor with its echo, and a weaker second echo behind it.
struct Bath
{
  int Width = 320, Height = 240;
  double Offset = 120, Slope = 0.1;
  int FirstColumn = 0, LastColumn = 319;
  std::vector<unsigned char> Pixels;

  void Draw(unsigned seed, int specks)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(0, 1);
    this->Pixels.resize(std::size_t(this->Width * this->Height));
    for (int row = 0; row < this->Height; ++row)
    {
      for (int column = 0; column < this->Width; ++column)
      {
        double level = 20 * part(random);
        if (column >= this->FirstColumn && column <= this->LastColumn)
        {
          const double floor = this->Offset + this->Slope * column;
          level += 220 * std::exp(-std::pow((row - floor) / 2.5, 2));
          level += 150 * std::exp(-std::pow((row - floor - 40) / 4, 2));
        }
        this->Pixels[std::size_t(row * this->Width + column)] =
          static_cast<unsigned char>(std::min(255.0, level));
      }
    }
    for (int speck = 0; speck < specks; ++speck)
    {
      const int column = int(part(random) * (this->Width - 4));
      const int row = int(part(random) * 80);
      for (int i = 0; i < 16; ++i)
      {
        this->Pixels[std::size_t((row + i / 4) * this->Width + column + i % 4)] = 250;
      }
    }
  }
  GreyImage Get() const
  {
    return { ScalarType::UInt8, this->Pixels.data(), this->Width, this->Width, this->Height };
  }
};
}

TEST(WallDetection, FloorIsFoundWithinAThirdOfAPixel)
{
  for (const double slope : { 0.0, 0.1, -0.35 })
  {
    for (unsigned seed = 0; seed < 5; ++seed)
    {
      Bath bath;
      bath.Slope = slope;
      bath.Draw(seed, 12);
      const std::optional<WallLine> wall = FindWall(bath.Get());
      ASSERT_TRUE(wall);
      EXPECT_LT(wall->Points[0][0], wall->Points[1][0] - 200);
      for (const Vec2& point : wall->Points)
      {
        EXPECT_NEAR(point[1], bath.Offset + slope * point[0], 0.34);
      }
      EXPECT_GT(wall->Support, 0.7);
    }
  }
}

TEST(WallDetection, FloorSeenInPartOfTheImage)
{
  Bath bath;
  bath.FirstColumn = 90;
  bath.LastColumn = 280;
  bath.Draw(1, 5);
  const std::optional<WallLine> wall = FindWall(bath.Get());
  ASSERT_TRUE(wall);
  EXPECT_GT(wall->Points[0][0], 85);
  EXPECT_LT(wall->Points[1][0], 285);
  EXPECT_NEAR(wall->Points[0][1], bath.Offset + bath.Slope * wall->Points[0][0], 0.34);
}

TEST(WallDetection, NothingWhereThereIsNone)
{
  Bath bath;
  bath.FirstColumn = bath.LastColumn = -1;
  bath.Draw(1, 0);
  EXPECT_FALSE(FindWall(bath.Get())); // noise
  bath.Draw(1, 40);
  EXPECT_FALSE(FindWall(bath.Get())); // specks
  std::fill(bath.Pixels.begin(), bath.Pixels.end(), static_cast<unsigned char>(7));
  EXPECT_FALSE(FindWall(bath.Get())); // one grey
  GreyImage tiny = bath.Get();
  tiny.Width = 8;
  EXPECT_FALSE(FindWall(tiny));
  // a wavy surface is no flat floor
  for (int row = 0; row < bath.Height; ++row)
  {
    for (int column = 0; column < bath.Width; ++column)
    {
      const double distance = row - 120 - 30 * std::sin(column / 20.0);
      bath.Pixels[std::size_t(row * bath.Width + column)] =
        static_cast<unsigned char>(255 * std::exp(-distance * distance / 6));
    }
  }
  EXPECT_FALSE(FindWall(bath.Get()));
}
