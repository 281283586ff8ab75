// SPDX-License-Identifier: BSD-3-Clause
// VideoSender of a build without FFmpeg.
#include "lacunaVideoSender.h"

namespace lacuna
{
struct VideoSender::Stream
{
};

// NOLINTNEXTLINE(performance-unnecessary-value-param): declared for those that keep it
VideoSender::VideoSender(const VideoSenderSettings& settings, std::function<bool()>)
{
  throw VideoError(VideoError::Kind::Unsupported,
    "The video '" + settings.URL +
      "' cannot be sent: this Lacuna was built without FFmpeg (LACUNA_WITH_FFMPEG=OFF)");
}

VideoSender::~VideoSender() = default;

void VideoSender::Open() {}

bool VideoSender::IsServer() const
{
  return false;
}

bool VideoSender::Send(const std::uint8_t*, std::int64_t)
{
  return false;
}

void VideoSender::Close() {}
}
