// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include <gtest/gtest.h>

#include <random>

using namespace lacuna;

namespace
{
using Bytes = std::vector<unsigned char>;

// Start of image, of frame (lossless), of scan.
Bytes MakeJpeg(unsigned char marker, unsigned char predictor)
{
  return { 0xFF, 0xD8, 0xFF, 0xE0, 0, 4, 1, 2, 0xFF, marker, 0, 11, 12, 0, 20, 0, 30, 1, 1, 0x11, 0,
    0xFF, 0xFF, 0xDA, 0, 8, 1, 1, 0, predictor, 0, 0, 99, 99, 0xFF, 0xD9 };
}

// One byte for each of 8 pixels of 16 bits: a run and a literal, high bytes first.
Bytes MakeRuns()
{
  Bytes stream(64);
  stream[0] = 2;
  stream[4] = 64;
  stream[8] = 66;
  const Bytes data = { 0xF9, 7, 0xFD, 1, 0x80, 3, 10, 11, 12, 13 };
  stream.insert(stream.end(), data.begin(), data.end());
  return stream;
}
}

TEST(CompressedImage, SizeOfJpeg)
{
  const auto why =
    [](const Bytes& stream, const std::string& syntax, int columns, int rows, int bits)
  { return WhyNotImage(stream, "1.2.840.10008.1.2.4." + syntax, columns, rows, bits); };
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "70", 30, 20, 16), "");
  EXPECT_EQ(why(MakeJpeg(0xF7, 0), "80", 30, 20, 16), "");
  EXPECT_NE(why(MakeJpeg(0xC3, 0), "70", 30, 20, 16), "");
  EXPECT_NE(why(MakeJpeg(0xC3, 8), "70", 30, 20, 16), "");
  EXPECT_NE(why(MakeJpeg(0xC3, 1), "70", 31, 20, 16), "");
  EXPECT_NE(why(MakeJpeg(0xC3, 1), "70", 30, 21, 16), "");
  EXPECT_NE(why({}, "70", 30, 20, 16), "");
  EXPECT_NE(why(Bytes(500, 0xFF), "70", 30, 20, 16), "");
  // as many bytes of a pixel as the codec writes, neither fewer nor more
  EXPECT_NE(why(MakeJpeg(0xC3, 1), "70", 30, 20, 8), "");
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "70", 30, 20, 32),
    "are of 30 x 20 pixels of 1 times 12 bits, not of 30 x 20 of 25 to 32 (Bits Allocated, "
    "0028,0100)");
  // the codec is the transfer syntax's
  EXPECT_EQ(why(MakeJpeg(0xF7, 0), "57", 30, 20, 16), "are JPEG-LS, not JPEG");
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "81", 30, 20, 16), "are JPEG, not JPEG-LS");
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "90", 30, 20, 16), "are JPEG, not JPEG 2000");
}

// A few bytes cannot claim gigabytes, whatever the codec makes of them. A large image that is alike everywhere
// can be small.
TEST(CompressedImage, Bombs)
{
  const auto why = [](Bytes stream, const std::string& syntax, int edge)
  {
    for (int i = 13; i < 17; i += 2)
    {
      stream[i] = static_cast<unsigned char>(edge >> 8);
      stream[i + 1] = static_cast<unsigned char>(edge & 0xFF);
    }
    return WhyNotImage(stream, "1.2.840.10008.1.2.4." + syntax, edge, edge, 16);
  };
  const std::string bomb =
    "are 36 bytes, too few for an image of 1800000000 (at most 1000 times as "
    "many, or 32 MiB); the file is damaged, or no CT";
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "70", 30000), bomb);
  EXPECT_EQ(why(MakeJpeg(0xF7, 0), "80", 30000), bomb);
  EXPECT_EQ(why(MakeJpeg(0xC3, 1), "70", 4096), "");
  EXPECT_NE(why(MakeJpeg(0xC3, 1), "70", 4097), "");
  Bytes large = MakeJpeg(0xC3, 1);
  large.resize(1800000);
  EXPECT_EQ(why(large, "70", 30000), "");

  Bytes blocks = { 0xFF, 0x4F, 0xFF, 0x51, 0, 41, 0, 0, 0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30 };
  blocks.resize(46);
  blocks[41] = 1;
  blocks[42] = 11;
  blocks[43] = blocks[44] = 1;
  EXPECT_EQ(
    WhyNotImage(blocks, "1.2.840.10008.1.2.4.90", 30000, 30000, 16), "are 46" + bomb.substr(6));
}

TEST(CompressedImage, RunLength)
{
  Bytes pixels(16);
  ASSERT_TRUE(DecodeRunLength(MakeRuns(), 2, pixels));
  EXPECT_EQ(pixels, (Bytes{ 1, 7, 1, 7, 1, 7, 1, 7, 10, 7, 11, 7, 12, 7, 13, 7 }));
  pixels.resize(18);
  EXPECT_FALSE(DecodeRunLength(MakeRuns(), 2, pixels));
  pixels.resize(14);
  EXPECT_FALSE(DecodeRunLength(MakeRuns(), 2, pixels));
  EXPECT_FALSE(DecodeRunLength(MakeRuns(), 1, pixels));
}

// Neither crash nor a byte beyond the buffers (under the sanitizers).
TEST(CompressedImage, Damaged)
{
  std::mt19937 random(7);
  for (int trial = 0; trial < 20000; ++trial)
  {
    Bytes runs = MakeRuns();
    Bytes jpeg = MakeJpeg(0xC3, 1);
    for (int i = 0; i < 2; ++i)
    {
      runs[random() % runs.size()] = static_cast<unsigned char>(random());
      jpeg[random() % jpeg.size()] = static_cast<unsigned char>(random());
    }
    runs.resize(random() % runs.size() + 1);
    Bytes pixels(16);
    DecodeRunLength(runs, 2, pixels);
    WhyNotImage(jpeg, "1.2.840.10008.1.2.4.70", 30, 20, 16);
  }
}
