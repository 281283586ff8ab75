// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <set>

using namespace lacuna;

namespace
{
SyntheticSweep<std::uint8_t> MakeSweep(int count, int width = 37)
{
  SyntheticSweep<std::uint8_t> sweep(width, 11, ScalarType::UInt8);
  std::mt19937 random(1);
  for (const Matrix4& pose : MakeRandomPoses(count, 1, 0.3))
  {
    sweep.Add(pose, [&](int, int) { return random() % 256; });
  }
  return sweep;
}

SliceFingerprint Get(const SliceImage& slice)
{
  ThreadExecution execution(1);
  return GetFingerprints({ slice }, execution)[0];
}
}

TEST(SliceFingerprint, WhatMattersMatters)
{
  const auto sweep = MakeSweep(1);
  const SliceImage& slice = sweep.Slices[0];
  const SliceFingerprint print = Get(slice);
  EXPECT_TRUE(print == Get(slice));

  SliceImage other = slice;
  other.Type = ScalarType::Int8;
  EXPECT_TRUE(print != Get(other));
  other = slice;
  --other.Width;
  EXPECT_TRUE(print != Get(other));
  other = slice;
  --other.Height;
  EXPECT_TRUE(print != Get(other));
  other = slice;
  other.PixelToReference(2, 3) += 1e-9;
  EXPECT_TRUE(print != Get(other));
  other = slice;
  other.Fan =
    std::make_shared<FanMask>(Fan{ { 18, -5 }, { -40, 45 }, { 2, 30 } }, 37, 11, Vec2{ 1, 1 });
  EXPECT_TRUE(print != Get(other));

  // where the pixels lie, and what is between the rows, does not
  std::vector<std::uint8_t> moved(100 * 11, 77);
  for (int y = 0; y < 11; ++y)
  {
    std::copy_n(static_cast<const std::uint8_t*>(slice.Pixels) + 37 * y, 37, &moved[100 * y + 3]);
  }
  other = slice;
  other.Pixels = &moved[3];
  other.RowStride = 100;
  other.Label = "another name";
  EXPECT_TRUE(print == Get(other));
  moved[2] = moved[40] = 1;
  EXPECT_TRUE(print == Get(other));
}

TEST(SliceFingerprint, EveryBitOfEveryPixelMatters)
{
  const auto sweep = MakeSweep(1);
  const auto* source = static_cast<const std::uint8_t*>(sweep.Slices[0].Pixels);
  std::vector<std::uint8_t> pixels(source, source + 37 * 11);
  SliceImage slice = sweep.Slices[0];
  slice.Pixels = pixels.data();
  std::set<std::uint64_t> hashes{ Get(slice).Hash };
  for (std::uint8_t& pixel : pixels)
  {
    for (int bit = 0; bit < 8; ++bit)
    {
      pixel = static_cast<std::uint8_t>(pixel ^ (1 << bit));
      hashes.insert(Get(slice).Hash);
      pixel = static_cast<std::uint8_t>(pixel ^ (1 << bit));
    }
  }
  // also the order of pixels that are alike
  std::swap(pixels[0], pixels[32]);
  hashes.insert(Get(slice).Hash);
  std::swap(pixels[0], pixels[32]);
  std::swap(pixels[1], pixels[9]);
  hashes.insert(Get(slice).Hash);
  EXPECT_EQ(hashes.size(), 1U + 37 * 11 * 8 + 2);
}

TEST(SliceFingerprint, Continued)
{
  const auto sweep = MakeSweep(6);
  ThreadExecution execution(3);
  const auto all = GetFingerprints(sweep.Slices, execution);
  ASSERT_EQ(all.size(), 6U);
  const std::vector<SliceFingerprint> some(all.begin(), all.begin() + 4);
  EXPECT_TRUE(IsContinued(some, all));
  EXPECT_TRUE(IsContinued(all, all));
  EXPECT_TRUE(IsContinued({}, some));
  EXPECT_FALSE(IsContinued(all, some));
  const std::vector<SliceFingerprint> later(all.begin() + 1, all.end());
  EXPECT_FALSE(IsContinued(some, later));
}
