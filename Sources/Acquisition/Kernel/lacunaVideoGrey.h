// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grey levels of decoded video frames.
#ifndef lacunaVideoGrey_h
#define lacunaVideoGrey_h

#include <cstdint>
#include <memory>
#include <vector>

struct AVFrame;

namespace lacuna
{
/// Makes 8-bit grey of every pixel format that is in main memory:
/// - grey formats: the level, scaled to 0..255, floats from 0..1;
/// - RGB and palettes: the luminance of lacunaLuminance.h of the channels, each scaled to 0..255;
/// - Y'CbCr: the luma Y', which by Rec. 601 is that luminance, with the levels 16..235 of limited
///   range (all but those marked as full) spread to 0..255;
/// - Y'CbCr of another matrix (Rec. 709, ...): the luminance of the RGB it stands for, so that the
///   same picture has the same grey; on grey pictures it is the luma all the same;
/// - Bayer and XYZ: the luminance of the RGB that FFmpeg makes of them.
/// Transparency is ignored. Levels are rounded to the nearest.
class VideoGrey
{
public:
  VideoGrey();
  ~VideoGrey();
  VideoGrey(const VideoGrey&) = delete;
  VideoGrey& operator=(const VideoGrey&) = delete;

  /// grey gets width x height levels, the top line first. Throws std::runtime_error for frames in
  /// a graphics card's memory.
  void Convert(const AVFrame& frame, std::vector<std::uint8_t>& grey);

private:
  struct Scaler;
  void ConvertByScaler(const AVFrame& frame, std::vector<std::uint8_t>& grey);

  std::unique_ptr<Scaler> Swscale;
  std::vector<std::uint8_t> Colours;
  std::vector<std::uint32_t> Line;
};
}
#endif
