// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoGrey.h"

#include "lacunaLuminance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

extern "C"
{
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace lacuna
{
namespace
{
constexpr int DeepestTable = 16; // bits

bool HasFlag(const AVPixFmtDescriptor& format, std::uint64_t flag)
{
  return (format.flags & flag) != 0;
}

bool IsColour(const AVPixFmtDescriptor& format)
{
  return format.nb_components >= 3;
}

// An even scale to 0..255; of limited range, from 16 and 235 times a power of two.
std::vector<std::uint8_t> MakeTable(int depth, bool limited, bool inverse)
{
  const int size = 1 << depth;
  const double black = limited ? std::ldexp(16, depth - 8) : 0;
  const double white = limited ? std::ldexp(235, depth - 8) : size - 1;
  std::vector<std::uint8_t> table(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i)
  {
    const double level = std::clamp((i - black) / (white - black), 0.0, 1.0);
    table[static_cast<std::size_t>(i)] =
      static_cast<std::uint8_t>(std::floor(255 * (inverse ? 1 - level : level) + 0.5));
  }
  return table;
}

bool IsLimited(const AVFrame& frame, const AVPixFmtDescriptor& format)
{
  if (HasFlag(format, AV_PIX_FMT_FLAG_RGB) || HasFlag(format, AV_PIX_FMT_FLAG_PAL))
  {
    return false;
  }
  if (frame.color_range != AVCOL_RANGE_UNSPECIFIED)
  {
    return frame.color_range == AVCOL_RANGE_MPEG && format.comp[0].depth >= 8;
  }
  return IsColour(format) && std::strncmp(format.name, "yuvj", 4) != 0;
}

bool NeedsScaler(const AVFrame& frame, const AVPixFmtDescriptor& format)
{
  if (HasFlag(format, AV_PIX_FMT_FLAG_BAYER) || std::strncmp(format.name, "xyz", 3) == 0 ||
    (format.comp[0].depth > DeepestTable && !HasFlag(format, AV_PIX_FMT_FLAG_FLOAT)))
  {
    return true;
  }
  const AVColorSpace matrix = frame.colorspace;
  return IsColour(format) && !HasFlag(format, AV_PIX_FMT_FLAG_RGB) &&
    !HasFlag(format, AV_PIX_FMT_FLAG_PAL) && matrix != AVCOL_SPC_UNSPECIFIED &&
    matrix != AVCOL_SPC_BT470BG && matrix != AVCOL_SPC_SMPTE170M;
}

// One component of a line as levels 0..255, every stride-th of them.
void ReadLine(const AVFrame& frame, const AVPixFmtDescriptor& format, int component, int row,
  const std::vector<std::uint8_t>& table, std::vector<std::uint32_t>& line, std::uint8_t* levels,
  std::size_t stride)
{
  const auto columns = static_cast<std::size_t>(frame.width);
  const AVComponentDescriptor& part = format.comp[component];
  if (part.depth == 8 && part.shift == 0 && !HasFlag(format, AV_PIX_FMT_FLAG_BITSTREAM))
  {
    const std::uint8_t* source = frame.data[part.plane] +
      static_cast<std::ptrdiff_t>(row) * frame.linesize[part.plane] + part.offset;
    const auto step = static_cast<std::size_t>(part.step);
    for (std::size_t i = 0; i < columns; ++i)
    {
      levels[i * stride] = table[source[i * step]];
    }
    return;
  }
  line.resize(columns);
  av_read_image_line2(line.data(), const_cast<const std::uint8_t**>(frame.data), frame.linesize,
    &format, 0, row, component, frame.width, 0, sizeof(line[0]));
  for (std::size_t i = 0; i < columns; ++i)
  {
    if (HasFlag(format, AV_PIX_FMT_FLAG_FLOAT))
    {
      float level = 0;
      std::memcpy(&level, &line[i], sizeof(level));
      // what is no number is black
      levels[i * stride] =
        level > 0 ? static_cast<std::uint8_t>(std::floor(255 * std::min(level, 1.0F) + 0.5F)) : 0;
    }
    else
    {
      levels[i * stride] = table[line[i]];
    }
  }
}

// A line of PAL8: colours 0xaarrggbb.
void ReadPalette(const AVFrame& frame, int row, std::uint8_t* colours)
{
  const std::uint8_t* source = frame.data[0] + static_cast<std::ptrdiff_t>(row) * frame.linesize[0];
  for (int column = 0; column < frame.width; ++column)
  {
    std::uint32_t colour = 0;
    std::memcpy(&colour, frame.data[1] + sizeof(colour) * source[column], sizeof(colour));
    for (int channel = 0; channel < 3; ++channel)
    {
      colours[3 * column + channel] = static_cast<std::uint8_t>(colour >> (16 - 8 * channel));
    }
  }
}
}

struct VideoGrey::Scaler
{
  ~Scaler() { sws_freeContext(this->Context); }
  SwsContext* Context = nullptr;
};

VideoGrey::VideoGrey()
  : Swscale(std::make_unique<Scaler>())
{
}

VideoGrey::~VideoGrey() = default;

void VideoGrey::Convert(const AVFrame& frame, std::vector<std::uint8_t>& grey)
{
  const AVPixFmtDescriptor* found = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  if (!found || HasFlag(*found, AV_PIX_FMT_FLAG_HWACCEL))
  {
    throw std::runtime_error(std::string("Pictures of the format ") +
      (found ? found->name : "unknown") + " are not in main memory and cannot be read");
  }
  const AVPixFmtDescriptor& format = *found;
  const auto columns = static_cast<std::size_t>(frame.width);
  grey.resize(columns * static_cast<std::size_t>(frame.height));
  if (NeedsScaler(frame, format))
  {
    this->ConvertByScaler(frame, grey);
    return;
  }
  const bool palette = HasFlag(format, AV_PIX_FMT_FLAG_PAL);
  const bool channels = IsColour(format) && HasFlag(format, AV_PIX_FMT_FLAG_RGB);
  std::array<std::vector<std::uint8_t>, 3> tables; // of floats, none
  for (int i = 0; i < (channels ? 3 : 1) && format.comp[i].depth <= DeepestTable; ++i)
  {
    tables[static_cast<std::size_t>(i)] = MakeTable(
      format.comp[i].depth, IsLimited(frame, format), frame.format == AV_PIX_FMT_MONOWHITE);
  }
  this->Colours.resize(3 * columns);
  for (int row = 0; row < frame.height; ++row)
  {
    std::uint8_t* levels = grey.data() + static_cast<std::size_t>(row) * columns;
    if (!channels && !palette)
    {
      ReadLine(frame, format, 0, row, tables[0], this->Line, levels, 1);
      continue;
    }
    if (palette)
    {
      ReadPalette(frame, row, this->Colours.data());
    }
    for (std::size_t i = 0; i < 3 && channels; ++i)
    {
      ReadLine(frame, format, static_cast<int>(i), row, tables[i], this->Line,
        this->Colours.data() + i, 3);
    }
    MakeLuminance(this->Colours.data(), frame.width, 3, levels);
  }
}

void VideoGrey::ConvertByScaler(const AVFrame& frame, std::vector<std::uint8_t>& grey)
{
  this->Swscale->Context = sws_getCachedContext(this->Swscale->Context, frame.width, frame.height,
    static_cast<AVPixelFormat>(frame.format), frame.width, frame.height, AV_PIX_FMT_RGB24,
    SWS_POINT | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP, nullptr, nullptr,
    nullptr);
  if (!this->Swscale->Context)
  {
    throw std::runtime_error(std::string("Pictures of the format ") +
      av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format)) + " cannot be made grey");
  }
  const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  const int matrix = frame.colorspace == AVCOL_SPC_UNSPECIFIED ? SWS_CS_DEFAULT : frame.colorspace;
  sws_setColorspaceDetails(this->Swscale->Context, sws_getCoefficients(matrix),
    IsLimited(frame, format) ? 0 : 1, sws_getCoefficients(SWS_CS_DEFAULT), 1, 0, 1 << 16, 1 << 16);
  const auto columns = static_cast<std::size_t>(frame.width);
  this->Colours.resize(3 * columns * static_cast<std::size_t>(frame.height) + 64);
  std::array<std::uint8_t*, 4> planes{ this->Colours.data() };
  const std::array<int, 4> sizes{ 3 * frame.width };
  sws_scale(this->Swscale->Context, frame.data, frame.linesize, 0, frame.height, planes.data(),
    sizes.data());
  MakeLuminance(this->Colours.data(), static_cast<std::int64_t>(grey.size()), 3, grey.data());
}
}
