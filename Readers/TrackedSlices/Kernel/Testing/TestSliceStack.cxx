// SPDX-License-Identifier: BSD-3-Clause
#include "Compress.h"
#include "NrrdFile.h"
#include "SequenceFile.h"
#include "lacunaSliceStack.h"

#include <gtest/gtest.h>

#include <cstring>

using namespace lacuna;

namespace
{
template <class T>
std::vector<T> ReadRegion(const std::string& content, const SliceRegion& region)
{
  const TemporaryFile file("sweep.igs.mha", content);
  const SequenceHeader header = ReadSequenceHeader(file.GetPath());
  const auto pixels = PixelSource::Open(header);
  std::vector<T> values(static_cast<std::size_t>(
    region.Columns * region.Rows * std::max<std::int64_t>(0, region.Frames)));
  ThreadExecution execution;
  ReadSliceStack(header, *pixels, region, values.data(), execution);
  return values;
}

SliceRegion Region(
  int firstColumn, int columns, int firstRow, int rows, int firstFrame, int frames, int stride = 1)
{
  SliceRegion region;
  region.FirstColumn = firstColumn;
  region.Columns = columns;
  region.FirstRow = firstRow;
  region.Rows = rows;
  region.FirstFrame = firstFrame;
  region.Frames = frames;
  region.FrameStride = stride;
  return region;
}
}

TEST(SliceStack, EveryRegionOfEveryOrientation)
{
  for (const char* orientation : { "MF", "UF", "MN", "UN" })
  {
    SequenceFile file = MakeSequence(5);
    file.Set("UltrasoundImageOrientation", orientation);
    for (const bool compress : { false, true })
    {
      const std::string content = (compress ? Compressed(file) : file).GetContent();
      for (const SliceRegion& r : { Region(0, 5, 0, 4, 0, 5), Region(0, 5, 0, 4, 1, 2, 3),
             Region(1, 3, 0, 4, 0, 5), Region(0, 5, 2, 1, 4, 1), Region(4, 1, 3, 1, 0, 3, 2) })
      {
        const auto values = ReadRegion<std::uint8_t>(content, r);
        std::size_t i = 0;
        for (std::int64_t k = 0; k < r.Frames; ++k)
        {
          for (std::int64_t row = r.FirstRow; row < r.FirstRow + r.Rows; ++row)
          {
            for (std::int64_t column = r.FirstColumn; column < r.FirstColumn + r.Columns; ++column)
            {
              // stored at column 4 when the content is mirrored, shown at column 0
              const auto storedColumn =
                static_cast<int>(orientation[0] == 'U' ? 4 - column : column);
              const auto storedRow = static_cast<int>(orientation[1] == 'N' ? 3 - row : row);
              const auto frame = static_cast<int>(r.FirstFrame + k * r.FrameStride);
              ASSERT_EQ(values[i++], GetGrey(storedColumn, storedRow, frame)) << orientation;
            }
          }
        }
      }
    }
  }
}

TEST(SliceStack, ColoursBecomeLuminance)
{
  SequenceFile file = MakeSequence(1, 2, 1);
  file.Set("UltrasoundImageOrientation", "UF"); // the colours of a pixel stay together
  file.Set("UltrasoundImageType", "RGB_COLOR");
  file.Set("ElementNumberOfChannels", "3");
  file.Pixels = std::string("\xff\x00\x00\x0a\xc8\x32", 6); // red; (10, 200, 50)
  const SliceRegion region = Region(0, 2, 0, 1, 0, 1);
  // 0.299 * 10 + 0.587 * 200 + 0.114 * 50 = 126.09; 0.299 * 255 = 76.245
  EXPECT_EQ(
    ReadRegion<std::uint8_t>(file.GetContent(), region), (std::vector<std::uint8_t>{ 126, 76 }));

  file.Set("ElementNumberOfChannels", "4");
  file.Set("UltrasoundImageOrientation", "MF");
  file.Pixels = std::string("\xff\xff\xff\x00\x01\x01\x01\xff", 8); // alpha is not looked at
  EXPECT_EQ(
    ReadRegion<std::uint8_t>(file.GetContent(), region), (std::vector<std::uint8_t>{ 255, 1 }));

  file.Set("ElementNumberOfChannels", "3");
  file.Set("ElementType", "MET_DOUBLE");
  const double colours[6] = { 1, 1, 1, -0.5, 0.25, 4 };
  file.Pixels.assign(reinterpret_cast<const char*>(colours), sizeof(colours));
  const auto doubles = ReadRegion<double>(file.GetContent(), region);
  EXPECT_DOUBLE_EQ(doubles[0], 1);
  EXPECT_DOUBLE_EQ(doubles[1], -0.1495 + 0.14675 + 0.456);

  file.Set("ElementType", "MET_ULONG_LONG");
  const std::uint64_t most[6] = { ~0ull, ~0ull, ~0ull, 0, 0, 0 };
  file.Pixels.assign(reinterpret_cast<const char*>(most), sizeof(most));
  EXPECT_GE(ReadRegion<std::uint64_t>(file.GetContent(), region)[0], ~0ull - 4096); // no overflow
}

TEST(SliceStack, ColoursAsVectorsAndChannels)
{
  // (10, 200, 50) is 126, see above
  NrrdFile file = MakeNrrd(1, 2, 1);
  file.Set("dimension", "4");
  file.Set("sizes", "3 2 1 1");
  file.Set("kinds", "vector domain domain list");
  file.SetPair("ultrasound image type", "RGB_COLOR");
  file.Pixels = std::string("\x01\x01\x01\x0a\xc8\x32", 6);
  const SliceRegion region = Region(0, 2, 0, 1, 0, 1);
  const std::vector<std::uint8_t> expected = { 1, 126 };
  EXPECT_EQ(ReadRegion<std::uint8_t>(file.GetContent(), region), expected);
  for (const char* kinds : { "vector domain domain list", "domain domain list" })
  {
    SequenceFile image = MakeSequence(1, 2, 1);
    image.Set("NDims", "4");
    image.Set("DimSize", "3 2 1 1");
    image.Set("Kinds", kinds);
    image.Set("ElementNumberOfChannels", "3");
    image.Pixels = file.Pixels;
    EXPECT_EQ(ReadRegion<std::uint8_t>(image.GetContent(), region), expected) << kinds;
  }
}

TEST(SliceStack, PosesWithoutPicturesAreBlankPixels)
{
  SequenceFile file = MakeSequence(3);
  file.Set("DimSize", "0 0 0");
  file.DataFile = "there-is-none.raw";
  EXPECT_EQ(ReadRegion<std::uint8_t>(file.GetContent(), Region(0, 1, 0, 1, 0, 3)),
    (std::vector<std::uint8_t>{ 0, 0, 0 }));
}

TEST(SliceStack, MissingFramesAreBlank)
{
  const SequenceFile file = MakeSequence(3);
  const auto values = ReadRegion<std::uint8_t>(
    file.GetContent().substr(0, file.GetContent().size() - 1), Region(0, 5, 0, 4, 1, 2));
  EXPECT_EQ(values[0], GetGrey(0, 0, 1));
  EXPECT_EQ(
    std::vector<std::uint8_t>(values.begin() + 20, values.end()), std::vector<std::uint8_t>(20, 0));
}

TEST(SliceStack, RegionsMustBeInside)
{
  const std::string content = MakeSequence().GetContent();
  for (const SliceRegion& region : { Region(-1, 2, 0, 1, 0, 1), Region(4, 2, 0, 1, 0, 1),
         Region(0, 1, 3, 2, 0, 1), Region(0, 1, 0, 1, 3, 1), Region(0, 1, 0, 1, 0, 4),
         Region(0, 1, 0, 1, 1, 2, 2), Region(0, 1, 0, 1, 0, 0), Region(0, 1, 0, 1, 0, 2, 0) })
  {
    EXPECT_THROW(ReadRegion<std::uint8_t>(content, region), std::out_of_range);
  }
}

TEST(SliceStack, ReportsProgressAndStops)
{
  const TemporaryFile file("sweep.igs.mha", MakeSequence(500).GetContent());
  const SequenceHeader header = ReadSequenceHeader(file.GetPath());
  const auto pixels = PixelSource::Open(header);
  std::vector<unsigned char> values(500 * 20);
  std::vector<double> reports;
  ThreadExecution watched(1,
    [&](double fraction)
    {
      reports.push_back(fraction);
      return true;
    });
  ReadSliceStack(header, *pixels, Region(0, 5, 0, 4, 0, 500), values.data(), watched);
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
  EXPECT_EQ(reports.back(), 1);
  EXPECT_GT(reports.size(), 50u);
  EXPECT_LE(reports.size(), 102u);
  ThreadExecution stopped(1, [](double fraction) { return fraction < 0.5; });
  EXPECT_THROW(
    ReadSliceStack(header, *pixels, Region(0, 5, 0, 4, 0, 500), values.data(), stopped), Aborted);
}
