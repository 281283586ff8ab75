// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

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

  std::vector<std::uint8_t> changed(static_cast<const std::uint8_t*>(slice.Pixels),
    static_cast<const std::uint8_t*>(slice.Pixels) + 37 * 11);
  other = slice;
  other.Pixels = changed.data();
  EXPECT_TRUE(print == Get(other));
  changed.back() ^= 1;
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
