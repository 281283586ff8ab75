// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCTGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

using namespace lacuna;

TEST(SliceSpacing, Equal)
{
  std::vector<double> positions;
  for (int k = 0; k < 400; ++k)
  {
    positions.push_back(-812.4 + 0.6 * k);
  }
  const SliceSpacing found = FindSliceSpacing(positions, 0.05);
  EXPECT_EQ(found.Planes, 400);
  EXPECT_NEAR(found.Spacing, 0.6, 1e-12);
  EXPECT_EQ(found.First, positions[0]);
  EXPECT_EQ(found.Deviation, 0);
  EXPECT_TRUE(found.Missing.empty() && found.UnequalGaps.empty());
}

// Rounded positions: the fit is nearer to the truth than any two of them.
TEST(SliceSpacing, Rounded)
{
  std::vector<double> positions;
  for (int k = 0; k < 200; ++k)
  {
    positions.push_back(std::round(10 * (3.03 + 0.625 * k)) / 10);
  }
  const SliceSpacing found = FindSliceSpacing(positions, 0.06);
  EXPECT_EQ(found.Planes, 200);
  EXPECT_NEAR(found.Spacing, 0.625, 1e-4);
  EXPECT_NEAR(found.First, 3.03, 0.02);
  EXPECT_GT(found.Deviation, 0.02);
  EXPECT_FALSE(FindSliceSpacing(positions, 0.01).UnequalGaps.empty());
}

TEST(SliceSpacing, Missing)
{
  const SliceSpacing found = FindSliceSpacing({ 0, 2, 4, 8, 10, 12, 20, 22 }, 0.05);
  EXPECT_EQ(found.Spacing, 2);
  EXPECT_EQ(found.Planes, 12);
  EXPECT_EQ(found.Missing, (std::vector<std::int64_t>{ 3, 7, 8, 9 }));
  EXPECT_EQ(found.GetPosition(3), 6);
}

TEST(SliceSpacing, Displaced)
{
  const SliceSpacing found = FindSliceSpacing({ 0, 2, 4, 6.15, 8, 10 }, 0.05);
  EXPECT_EQ(found.Spacing, 2);
  EXPECT_EQ(found.Usual, 2);
  EXPECT_EQ(found.Planes, 6);
  EXPECT_EQ(found.UnequalGaps, (std::vector<std::size_t>{ 2, 3 }));
}

// Planes at a part of the usual distance hold every slice.
TEST(SliceSpacing, Parts)
{
  const SliceSpacing thick =
    FindSliceSpacing({ 0, 1, 2, 3, 4, 6.5, 9, 11.5, 14, 16.5, 19, 21.5 }, 0.05);
  EXPECT_EQ(thick.Spacing, 0.5);
  EXPECT_EQ(thick.Usual, 1);
  EXPECT_EQ(thick.Planes, 44);
  EXPECT_EQ(thick.UnequalGaps, (std::vector<std::size_t>{ 4, 5, 6, 7, 8, 9, 10 }));
  EXPECT_TRUE(thick.Missing.empty());
  const SliceSpacing wide =
    FindSliceSpacing({ 0, 7.5, 15, 22.5, 30, 37.5, 45, 57.5, 65, 72.5, 80, 87.5 }, 0.05);
  EXPECT_EQ(wide.Spacing, 2.5);
  EXPECT_EQ(wide.Planes, 36);
  EXPECT_EQ(wide.GetPosition(35), 87.5);
  const SliceSpacing fifth = FindSliceSpacing({ 0, 5, 10, 15, 23, 31 }, 0.05);
  EXPECT_EQ(fifth.Spacing, 1);
}

// Where no such planes hold all, first and last slice are planes.
TEST(SliceSpacing, KeepsBothEnds)
{
  for (const double last : { 10.9, 11.1, 11.37 })
  {
    const SliceSpacing found = FindSliceSpacing({ -1, 1, 3, 5.13, 7, 9, last }, 0.05);
    EXPECT_EQ(found.Usual, 2);
    EXPECT_EQ(found.Planes, 7);
    EXPECT_EQ(found.First, -1);
    EXPECT_NEAR(found.GetPosition(6), last, 1e-12);
  }
}

TEST(SliceSpacing, TwoSlices)
{
  const SliceSpacing found = FindSliceSpacing({ -3, 4.5 }, 0.05);
  EXPECT_EQ(found.Spacing, 7.5);
  EXPECT_EQ(found.Planes, 2);
}

TEST(SliceSpacing, Impossible)
{
  EXPECT_THROW(FindSliceSpacing({ 0, 1, 2, 3, 1e12 }, 0.05), std::runtime_error);
  EXPECT_THROW(FindSliceSpacing({ 0, 1, 2, 3, 1e300 }, 0.05), std::runtime_error);
}
