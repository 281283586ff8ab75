// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Frames and files of video, made by FFmpeg.
#ifndef lacunaTestVideo_h
#define lacunaTestVideo_h

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

extern "C"
{
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace lacunaTest
{
struct FreeFrame
{
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
using FramePointer = std::unique_ptr<AVFrame, FreeFrame>;

inline FramePointer MakeFrame(AVPixelFormat format, int width, int height)
{
  FramePointer frame(av_frame_alloc());
  frame->format = format;
  frame->width = width;
  frame->height = height;
  EXPECT_EQ(av_frame_get_buffer(frame.get(), 0), 0);
  return frame;
}

/// A frame of another format from one of RGB24, by FFmpeg's own conversion.
inline FramePointer ConvertFrame(const AVFrame& rgb, AVPixelFormat format)
{
  FramePointer frame = MakeFrame(format, rgb.width, rgb.height);
  SwsContext* context = sws_getContext(rgb.width, rgb.height, AV_PIX_FMT_RGB24, rgb.width,
    rgb.height, format, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP,
    nullptr, nullptr, nullptr);
  EXPECT_NE(context, nullptr) << av_get_pix_fmt_name(format);
  EXPECT_EQ(sws_scale(context, rgb.data, rgb.linesize, 0, rgb.height, frame->data, frame->linesize),
    rgb.height);
  sws_freeContext(context);
  return frame;
}

struct EncoderSettings
{
  const char* Container = "matroska";
  const char* Codec = "ffv1";
  AVPixelFormat Format = AV_PIX_FMT_GRAY8;
  int BetweenFrames = 0; ///< most B frames in a row
};

/// A file of these images (all of columns x rows grey levels) at the times given, in 1/25 s.
inline void EncodeVideo(const std::string& path, const EncoderSettings& settings, int columns,
  int rows, const std::vector<std::vector<std::uint8_t>>& images, const std::vector<int>& times)
{
  const AVCodec* codec = avcodec_find_encoder_by_name(settings.Codec);
  ASSERT_NE(codec, nullptr);
  AVFormatContext* file = nullptr;
  ASSERT_GE(avformat_alloc_output_context2(&file, nullptr, settings.Container, path.c_str()), 0);
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = columns;
  encoder->height = rows;
  encoder->pix_fmt = settings.Format;
  encoder->time_base = { 1, 25 };
  encoder->framerate = { 25, 1 };
  encoder->max_b_frames = settings.BetweenFrames;
  encoder->bit_rate = 4000000;
  if (file->oformat->flags & AVFMT_GLOBALHEADER)
  {
    encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  }
  ASSERT_GE(avcodec_open2(encoder, codec, nullptr), 0);
  AVStream* stream = avformat_new_stream(file, nullptr);
  stream->time_base = encoder->time_base;
  stream->avg_frame_rate = encoder->framerate;
  ASSERT_GE(avcodec_parameters_from_context(stream->codecpar, encoder), 0);
  ASSERT_GE(avio_open(&file->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
  ASSERT_GE(avformat_write_header(file, nullptr), 0);
  AVPacket* packet = av_packet_alloc();
  for (std::size_t i = 0; i <= images.size(); ++i)
  {
    FramePointer frame;
    if (i < images.size())
    {
      frame = MakeFrame(settings.Format, columns, rows);
      for (int plane = 0; plane < 3 && frame->data[plane]; ++plane)
      {
        const int height = plane == 0 ? rows : rows / 2; // 4:2:0 or grey
        for (int row = 0; row < height; ++row)
        {
          std::uint8_t* line = frame->data[plane] + row * frame->linesize[plane];
          for (int column = 0; column < (plane == 0 ? columns : columns / 2); ++column)
          {
            line[column] =
              plane == 0 ? images[i][static_cast<std::size_t>(row * columns + column)] : 128;
          }
        }
      }
      frame->pts = times[i];
    }
    ASSERT_GE(avcodec_send_frame(encoder, frame.get()), 0);
    while (avcodec_receive_packet(encoder, packet) == 0)
    {
      av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      packet->duration = av_rescale_q(1, encoder->time_base, stream->time_base);
      ASSERT_GE(av_interleaved_write_frame(file, packet), 0);
    }
  }
  ASSERT_GE(av_write_trailer(file), 0);
  av_packet_free(&packet);
  avcodec_free_context(&encoder);
  avio_closep(&file->pb);
  avformat_free_context(file);
}
}
#endif
