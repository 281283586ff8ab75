// SPDX-License-Identifier: BSD-3-Clause
// VideoSource of a build without FFmpeg.
#include "lacunaVideoSource.h"

namespace lacuna
{
struct VideoSource::Stream
{
};

// NOLINTNEXTLINE(performance-unnecessary-value-param): declared for those that keep it
VideoSource::VideoSource(const VideoSettings& settings, const Clock&, std::function<bool()>)
{
  throw VideoError(VideoError::Kind::Unsupported,
    "The video '" + settings.URL +
      "' cannot be opened: this Lacuna was built without FFmpeg (LACUNA_WITH_FFMPEG=OFF)");
}

VideoSource::~VideoSource() = default;

VideoEvent VideoSource::Read(VideoFrame&)
{
  return VideoEvent::End;
}

double VideoSource::GetFrameRate() const
{
  return 0;
}
}
