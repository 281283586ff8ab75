// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoGrey.h"

#include "lacunaLuminance.h"
#include "lacunaTestVideo.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

extern "C"
{
#include <libavutil/pixdesc.h>
}

using namespace lacuna;
using namespace lacunaTest;

namespace
{
using Bytes = std::vector<std::uint8_t>;

Bytes Convert(const AVFrame& frame)
{
  VideoGrey grey;
  Bytes levels;
  grey.Convert(frame, levels);
  return levels;
}

// All colours on a coarse lattice, or all greys, in an RGB24 frame.
FramePointer MakeColours(bool neutral)
{
  FramePointer frame = MakeFrame(AV_PIX_FMT_RGB24, 256, 16);
  for (int row = 0; row < 16; ++row)
  {
    for (int column = 0; column < 256; ++column)
    {
      std::uint8_t* pixel = frame->data[0] + row * frame->linesize[0] + 3 * column;
      pixel[0] = static_cast<std::uint8_t>(column);
      pixel[1] = static_cast<std::uint8_t>(neutral ? column : 17 * row);
      pixel[2] = static_cast<std::uint8_t>(neutral ? column : 37 * column + 11 * row);
    }
  }
  return frame;
}

Bytes Luminances(const AVFrame& rgb)
{
  Bytes levels(static_cast<std::size_t>(rgb.width * rgb.height));
  for (int row = 0; row < rgb.height; ++row)
  {
    MakeLuminance<std::uint8_t>(
      rgb.data[0] + row * rgb.linesize[0], rgb.width, 3, levels.data() + row * rgb.width);
  }
  return levels;
}

int LargestDifference(const Bytes& a, const Bytes& b)
{
  EXPECT_EQ(a.size(), b.size());
  int largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    largest = std::max(largest, std::abs(int(a[i]) - int(b[i])));
  }
  return largest;
}

// A frame of one line from bytes of its first plane.
FramePointer MakeLine(AVPixelFormat format, int width, std::initializer_list<int> bytes)
{
  FramePointer frame = MakeFrame(format, width, 1);
  std::uint8_t* at = frame->data[0];
  for (const int byte : bytes)
  {
    *at++ = static_cast<std::uint8_t>(byte);
  }
  return frame;
}
}

TEST(VideoGrey, RgbIsTheProjectsLuminanceToTheLastBit)
{
  const FramePointer rgb = MakeColours(false);
  const Bytes expected = Luminances(*rgb);
  for (const AVPixelFormat format : { AV_PIX_FMT_RGB24, AV_PIX_FMT_BGR24, AV_PIX_FMT_RGBA,
         AV_PIX_FMT_ABGR, AV_PIX_FMT_BGR0, AV_PIX_FMT_GBRP, AV_PIX_FMT_GBRAP })
  {
    EXPECT_EQ(LargestDifference(Convert(*ConvertFrame(*rgb, format)), expected), 0)
      << av_get_pix_fmt_name(format);
  }
}

TEST(VideoGrey, GreysStayInEveryFormat)
{
  const FramePointer rgb = MakeColours(true);
  const Bytes expected = Luminances(*rgb);
  int formats = 0;
  for (const AVPixFmtDescriptor* format = av_pix_fmt_desc_next(nullptr); format;
       format = av_pix_fmt_desc_next(format))
  {
    const AVPixelFormat id = av_pix_fmt_desc_get_id(format);
    if (!sws_isSupportedOutput(id) || format->comp[0].depth < 4 || id == AV_PIX_FMT_GRAYF32LE ||
      id == AV_PIX_FMT_GRAYF32BE)
    {
      continue; // few levels are dithered; of floats FFmpeg makes a limited range
    }
    int depth = 16;
    for (int i = 0; i < std::min<int>(format->nb_components, 3); ++i)
    {
      depth = std::min(depth, format->comp[i].depth);
    }
    // one and a half levels of the format for FFmpeg's dither, and its rounding
    const bool coarse = std::strncmp(format->name, "xyz", 3) == 0;
    const int bound = 3 + (depth < 8 ? 383 / ((1 << depth) - 1) : coarse ? 1 : 0);
    EXPECT_LE(LargestDifference(Convert(*ConvertFrame(*rgb, id)), expected), bound) << format->name;
    ++formats;
  }
  EXPECT_GT(formats, 100);
}

TEST(VideoGrey, LumaIsSpreadFromItsRange)
{
  const auto yuyv = MakeLine(AV_PIX_FMT_YUYV422, 4, { 16, 128, 235, 128, 0, 0, 125, 255 });
  EXPECT_EQ(Convert(*yuyv), (Bytes{ 0, 255, 0, 127 })); // 109 / 219 * 255 = 126.9
  yuyv->color_range = AVCOL_RANGE_JPEG;
  EXPECT_EQ(Convert(*yuyv), (Bytes{ 16, 235, 0, 125 }));
  const auto ten = MakeLine(AV_PIX_FMT_YUV422P10LE, 2, { 64, 0, 172, 3 }); // 940
  EXPECT_EQ(Convert(*ten), (Bytes{ 0, 255 }));
  const auto jpeg = MakeLine(AV_PIX_FMT_YUVJ444P, 3, { 0, 16, 255 });
  EXPECT_EQ(Convert(*jpeg), (Bytes{ 0, 16, 255 }));
  const auto grey = MakeLine(AV_PIX_FMT_GRAY8, 3, { 0, 16, 255 });
  EXPECT_EQ(Convert(*grey), (Bytes{ 0, 16, 255 }));
  grey->color_range = AVCOL_RANGE_MPEG;
  EXPECT_EQ(Convert(*grey), (Bytes{ 0, 0, 255 }));
  const auto deep = MakeLine(AV_PIX_FMT_GRAY16LE, 2, { 255, 255, 128, 128 });
  EXPECT_EQ(Convert(*deep), (Bytes{ 255, 128 }));
  const FramePointer floats = MakeFrame(AV_PIX_FMT_GRAYF32, 5, 1);
  const std::array<float, 5> values{ 0.5F, -3, 7, 0.1F, NAN };
  std::memcpy(floats->data[0], values.data(), sizeof(values));
  EXPECT_EQ(Convert(*floats), (Bytes{ 128, 0, 255, 26, 0 }));
}

TEST(VideoGrey, BitsAndPalettes)
{
  EXPECT_EQ(Convert(*MakeLine(AV_PIX_FMT_MONOBLACK, 4, { 0xa0 })), (Bytes{ 255, 0, 255, 0 }));
  EXPECT_EQ(Convert(*MakeLine(AV_PIX_FMT_MONOWHITE, 4, { 0xa0 })), (Bytes{ 0, 255, 0, 255 }));
  const auto palette = MakeLine(AV_PIX_FMT_PAL8, 3, { 2, 0, 255 });
  const std::array<std::uint32_t, 3> colours{ 0xff4080c0, 0xff000000, 0xffffffff };
  for (const int i : { 0, 2, 255 })
  {
    std::memcpy(palette->data[1] + 4 * i, &colours[i == 2 ? 0 : i == 0 ? 1 : 2], 4);
  }
  EXPECT_EQ(Convert(*palette), (Bytes{ 116, 0, 255 })); // 0.299 64 + 0.587 128 + 0.114 192
}

TEST(VideoGrey, OtherMatricesGiveTheSameGreyForTheSameColour)
{
  // R'G'B' (200, 60, 30) by Rec. 709 in limited range
  const double red = 200, green = 60, blue = 30;
  const double luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  const FramePointer frame = MakeFrame(AV_PIX_FMT_YUV444P, 8, 2);
  const std::array<double, 3> values{ 16 + 219 * luma / 255,
    128 + 224 * (blue - luma) / 1.8556 / 255, 128 + 224 * (red - luma) / 1.5748 / 255 };
  for (int plane = 0; plane < 3; ++plane)
  {
    std::memset(frame->data[plane], static_cast<int>(std::lround(values[plane])),
      2 * static_cast<std::size_t>(frame->linesize[plane]));
  }
  frame->colorspace = AVCOL_SPC_BT709;
  const double expected = 0.299 * red + 0.587 * green + 0.114 * blue;
  for (const std::uint8_t level : Convert(*frame))
  {
    EXPECT_NEAR(level, expected, 1.5);
  }
  EXPECT_GT(std::abs(expected - luma), 8); // what taking the luma would be off
}

TEST(VideoGrey, KeepsTheOrderOfLinesAndColumns)
{
  for (const AVPixelFormat format : { AV_PIX_FMT_GRAY8, AV_PIX_FMT_RGB24, AV_PIX_FMT_NV12 })
  {
    FramePointer rgb = MakeFrame(AV_PIX_FMT_RGB24, 6, 4);
    for (int i = 0; i < 24; ++i)
    {
      std::memset(rgb->data[0] + i / 6 * rgb->linesize[0] + 3 * (i % 6), 10 * i, 3);
    }
    const FramePointer frame = ConvertFrame(*rgb, format);
    Bytes expected(24);
    for (int i = 0; i < 24; ++i)
    {
      expected[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(10 * i);
    }
    EXPECT_LE(LargestDifference(Convert(*frame), expected), 1);
    // stored from the bottom up
    const int lines = frame->height;
    frame->data[0] += (lines - 1) * frame->linesize[0];
    frame->linesize[0] = -frame->linesize[0];
    const Bytes turned = Convert(*frame);
    EXPECT_NEAR(turned[0], 180, 1);
    EXPECT_NEAR(turned[23], 50, 1);
    frame->linesize[0] = -frame->linesize[0];
    frame->data[0] -= (lines - 1) * frame->linesize[0];
  }
}

TEST(VideoGrey, RefusesFramesOfGraphicsCards)
{
  FramePointer frame(av_frame_alloc());
  frame->format = AV_PIX_FMT_VAAPI;
  frame->width = frame->height = 16;
  VideoGrey grey;
  Bytes levels;
  EXPECT_THROW(grey.Convert(*frame, levels), std::runtime_error);
}
