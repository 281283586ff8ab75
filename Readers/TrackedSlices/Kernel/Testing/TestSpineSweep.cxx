// SPDX-License-Identifier: BSD-3-Clause
// The real sweep of a spine phantom, against what PLUS makes of it.
#include "lacunaSliceStack.h"
#include "lacunaSweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace lacuna;

namespace
{
const std::string Folder = std::string(LACUNA_TEST_DATA) + "/ultrasound_spine/";
const std::string SequenceName = Folder + "SpinePhantomFreehand.igs.mha";
const std::string CalibrationName =
  Folder + "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml";
}

TEST(SpineSweep, LiesWherePlusPutsIt)
{
  if (!std::filesystem::exists(SequenceName))
  {
    GTEST_SKIP() << "no data in " << LACUNA_TEST_DATA;
  }
  const SequenceHeader header = ReadSequenceHeader(SequenceName);
  EXPECT_EQ(header.Columns, 820);
  EXPECT_EQ(header.Rows, 616);
  EXPECT_EQ(header.Frames, 21);
  EXPECT_EQ(header.Encoding, PixelEncoding::Zlib);
  EXPECT_TRUE(IsTrackedSequence(SequenceName));
  SweepOptions options;
  options.CalibrationFileName = CalibrationName;
  const Sweep sweep = BuildSweep(header, options);
  // its calibration is a least squares fit that shears; poses have no fault
  ASSERT_EQ(sweep.Warnings.size(), 1u);
  EXPECT_NE(sweep.Warnings[0].find("transform ImageToProbe of the calibration file is skewed: rows "
                                   "and columns meet at 92.7"),
    std::string::npos)
    << sweep.Warnings[0];
  EXPECT_EQ(sweep.Status, std::vector<unsigned char>(21, 0));
  EXPECT_EQ(sweep.Transforms.size(), 3u);
  EXPECT_DOUBLE_EQ(sweep.Timestamps[0], 215.102186);

  double low[3] = { 1e30, 1e30, 1e30 };
  double high[3] = { -1e30, -1e30, -1e30 };
  for (const Matrix4& pose : sweep.ImageToReference)
  {
    for (const double column : { 0.0, 819.0 })
    {
      for (const double row : { 0.0, 615.0 })
      {
        const Vec3 corner = pose.Point({ column, row, 0 });
        for (int axis = 0; axis < 3; ++axis)
        {
          low[axis] = std::min(low[axis], corner[axis]);
          high[axis] = std::max(high[axis], corner[axis]);
        }
      }
    }
  }
  const double origin[3] = { -74.5217, 165.573, 29.072 };
  const int size[3] = { 147, 106, 105 };
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_NEAR(low[axis], origin[axis], 1e-3);
    EXPECT_EQ(std::lround((high[axis] - low[axis]) / 0.5) + 1, size[axis]);
  }
}

TEST(SpineSweep, ReadsThePixels)
{
  if (!std::filesystem::exists(SequenceName))
  {
    GTEST_SKIP() << "no data in " << LACUNA_TEST_DATA;
  }
  const SequenceHeader header = ReadSequenceHeader(SequenceName);
  const auto pixels = PixelSource::Open(header);
  ASSERT_EQ(pixels->GetNumberOfWholeFrames(), 21);
  ThreadExecution execution;
  SliceRegion all;
  all.Columns = 820;
  all.Rows = 616;
  all.Frames = 21;
  std::vector<unsigned char> stack(820 * 616 * 21);
  ReadSliceStack(header, *pixels, all, stack.data(), execution); // checks the check sum
  const auto [darkest, brightest] = std::minmax_element(stack.begin(), stack.end());
  EXPECT_EQ(*darkest, 0);
  EXPECT_GT(*brightest, 200);
  SliceRegion some = all;
  some.FirstColumn = 300;
  some.Columns = 100;
  some.FirstRow = 200;
  some.Rows = 50;
  some.FirstFrame = 3;
  some.FrameStride = 7;
  some.Frames = 3;
  std::vector<unsigned char> part(100 * 50 * 3);
  ReadSliceStack(header, *pixels, some, part.data(), execution);
  for (std::size_t i = 0; i < part.size(); ++i)
  {
    const std::size_t column = 300 + i % 100;
    const std::size_t row = 200 + i / 100 % 50;
    const std::size_t frame = 3 + 7 * (i / 5000);
    ASSERT_EQ(part[i], stack[column + 820 * (row + 616 * frame)]);
  }
}
