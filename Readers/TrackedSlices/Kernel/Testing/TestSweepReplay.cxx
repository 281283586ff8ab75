// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepReplay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace lacuna;

namespace
{
const double None = std::nan("");
using Times = std::vector<double>;
}

TEST(SweepReplay, GrowsWithTime)
{
  const SweepReplay replay({ 10.5, 11, 12.25 }, 0, 1, 3);
  EXPECT_EQ(replay.GetTimes(), (Times{ 10.5, 11, 12.25 }));
  EXPECT_TRUE(replay.HasTimestamps());
  const std::pair<double, int> cases[] = { { 10.5, 1 }, { 10.999, 1 }, { 11, 2 }, { 12.2499, 2 },
    { 12.25, 3 }, { 1e9, 3 }, { 0, 1 }, { -std::numeric_limits<double>::infinity(), 1 },
    { std::numeric_limits<double>::infinity(), 3 } };
  for (const auto& [time, count] : cases)
  {
    EXPECT_EQ(replay.GetNumberOfSlices(time), count) << time;
  }
  EXPECT_EQ(replay.GetTimeBefore(11.9), 11);
  EXPECT_EQ(replay.GetTimeBefore(11), 11);
  EXPECT_EQ(replay.GetTimeBefore(3), 10.5);
  EXPECT_EQ(replay.GetTimeBefore(99), 12.25);
}

TEST(SweepReplay, SlicesKeepTheirOrderWhateverTheClock)
{
  // jumps back, stands still, fails
  const SweepReplay replay({ 5, 7, 6, 6.5, 8, 8, None, 9 }, 0, 1, 8);
  EXPECT_EQ(replay.GetTimes(), (Times{ 5, 7, 8, 9 }));
  EXPECT_EQ(replay.GetNumberOfSlices(6.9), 1); // slice 2 is not shown before slice 1
  EXPECT_EQ(replay.GetNumberOfSlices(7), 4);
  EXPECT_EQ(replay.GetNumberOfSlices(8), 7);
  EXPECT_EQ(replay.GetNumberOfSlices(9), 8);
}

TEST(SweepReplay, NoTimestampAtFirstOrAtAll)
{
  const SweepReplay late({ None, None, 3, 4 }, 0, 1, 4);
  EXPECT_EQ(late.GetTimes(), (Times{ 3, 4 }));
  EXPECT_EQ(late.GetNumberOfSlices(3), 3);
  for (const Times& times : { Times{}, Times{ None, None, None, None, None } })
  {
    const SweepReplay numbers(times, 1, 2, 2);
    EXPECT_FALSE(numbers.HasTimestamps());
    EXPECT_EQ(numbers.GetTimes(), (Times{ 1, 3 }));
    EXPECT_EQ(numbers.GetNumberOfSlices(2.9), 1);
    EXPECT_EQ(numbers.GetNumberOfSlices(3), 2);
  }
}

TEST(SweepReplay, OnlyTheSlicesOfTheStackCount)
{
  const SweepReplay replay({ 1, 2, 99, 4, 5, 6 }, 1, 2, 3); // frames 1, 3, 5
  EXPECT_EQ(replay.GetTimes(), (Times{ 2, 4, 6 }));
  EXPECT_EQ(replay.GetNumberOfSlices(5), 2);
  const SweepReplay one({ 7 }, 0, 1, 1);
  EXPECT_EQ(one.GetNumberOfSlices(0), 1);
}
