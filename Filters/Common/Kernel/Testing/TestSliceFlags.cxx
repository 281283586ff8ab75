// SPDX-License-Identifier: BSD-3-Clause
/// Flags of slices, counted for messages.
#include "lacunaSliceFlags.h"

#include <gtest/gtest.h>

using namespace lacuna;

TEST(SliceFlagCounts, CountsEachFlagAndEachSlice)
{
  SliceFlagCounts counts;
  counts.Add(SliceFlags::Valid);
  EXPECT_EQ(counts.GetNumberOfSlices(), 0);
  EXPECT_EQ(counts.Describe(), "");
  counts.Add(SliceFlags::PoseInvalid | SliceFlags::GatedOut);
  counts.Add(SliceFlags::PoseInvalid);
  EXPECT_EQ(counts.GetNumberOfSlices(), 2);
  EXPECT_EQ(counts.Describe(), "2 pose invalid (1), 1 gated out (8)");
  EXPECT_TRUE(counts.Has(SliceFlags::PoseInvalid));
  EXPECT_FALSE(counts.Has(SliceFlags::ImageInvalid));
  EXPECT_FALSE(counts.Has(SliceFlags::TooFast));
  EXPECT_TRUE(counts.Has(SliceFlags::GatedOut));
  counts.Add(SliceFlags::ImageInvalid | SliceFlags::TooFast);
  EXPECT_EQ(
    counts.Describe(), "2 pose invalid (1), 1 image invalid (2), 1 too fast (4), 1 gated out (8)");
}

TEST(SliceFlagCounts, FlagsToComeHaveNoName)
{
  SliceFlagCounts counts;
  counts.Add(16);
  EXPECT_EQ(counts.GetNumberOfSlices(), 1);
  EXPECT_EQ(counts.Describe(), "");
}
