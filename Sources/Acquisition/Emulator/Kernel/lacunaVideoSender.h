// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sends pictures as a video, through FFmpeg.
#ifndef lacunaVideoSender_h
#define lacunaVideoSender_h

#include "lacunaVideoSource.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace lacuna
{
struct VideoSenderSettings
{
  /// - "tcp://127.0.0.1:5004": waits there for a client; Matroska, pixels as they are (no loss);
  /// - "udp://127.0.0.1:5004": sends there, whoever listens; MPEG-2 pictures in a transport stream,
  ///   a few levels off;
  /// - else a file: without loss (.mkv, .avi, .nut), or as udp (.ts, .mpg).
  std::string URL;
  int Columns = 768;
  int Rows = 576;
  int Rate = 25; ///< frames a second; MPEG-2 knows 24, 25, 30, 50 and 60
};

/// One video for one client after the other. Functions throw VideoError, and Aborted when stopped
/// says so, which is asked at least every 100 ms. In a build without FFmpeg (LACUNA_WITH_FFMPEG) the
/// constructor throws.
class VideoSender
{
public:
  /// tcp: listens from now on.
  explicit VideoSender(const VideoSenderSettings& settings, std::function<bool()> stopped = {});
  ~VideoSender();
  VideoSender(const VideoSender&) = delete;
  VideoSender& operator=(const VideoSender&) = delete;

  /// tcp: waits for the next client. Begins a stream.
  void Open();
  /// Whether there can be another stream after this one: tcp only.
  bool IsServer() const;
  /// Sends a frame, all of it, of Columns x Rows levels, the top line first. Its time in the stream
  /// is number / Rate; numbers ascend. False when the client is gone.
  bool Send(const std::uint8_t* pixels, std::int64_t number);
  /// Ends the stream; throws when the end of a file cannot be written.
  void Close();

private:
  struct Stream;
  std::unique_ptr<Stream> Output;
};
}
#endif
