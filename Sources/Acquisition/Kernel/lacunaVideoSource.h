// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Video of a scanner, through FFmpeg.
#ifndef lacunaVideoSource_h
#define lacunaVideoSource_h

#include "lacunaClock.h"
#include "lacunaTrackedPose.h"
#include "lacunaVector.h"
#include "lacunaVideoFields.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
struct VideoSettings
{
  /// "/dev/video0" (a frame grabber), "lavfi:testsrc2=size=768x576:rate=25" (a test signal of
  /// FFmpeg's filters), a file, or the address of a stream ("rtsp://...", "udp://...", "http://...").
  std::string URL;
  /// For FFmpeg's demuxer or protocol, "standard=PAL:channel=1:video_size=768x576".
  std::string Options;
  VideoField Field = VideoField::Both;
  /// Gives the frames of files and test signals at the pace of their own times, as a device would.
  bool InRealTime = true;
  double OpenTime = 10; ///< s after which opening has failed
  double FrameTime = 3; ///< s without a frame after which the video has stopped
};

/// Why there is no video; the text says what to do.
class VideoError : public std::runtime_error
{
public:
  enum class Kind
  {
    NotFound,    ///< no such device, file or stream
    Permission,  ///< the user may not open it
    Busy,        ///< another program has it
    Unsupported, ///< it has no video, FFmpeg cannot read it, or this build
    Options,     ///< they cannot be
    Silent,      ///< nothing comes any more, or did at all
    Broken       ///< it was there and is gone
  };
  VideoError(Kind kind, const std::string& message)
    : std::runtime_error(message)
    , Reason(kind)
  {
  }
  Kind GetKind() const { return this->Reason; }

private:
  Kind Reason;
};

struct VideoFrame
{
  int Columns = 0;
  int Rows = 0;
  std::vector<std::uint8_t> Grey;   ///< the top line first (see lacunaVideoGrey.h for the rule)
  double PixelAspect = 1;           ///< width of a pixel by its height, where the stream says so
  double Arrival = 0;               ///< when its bytes were there, s of the clock; see FrameClock
  bool Timed = true;                ///< false: Arrival may be late, see TakeArrivals
  std::optional<double> StreamTime; ///< s of the stream's own clock
  ClockEpoch Epoch;                 ///< of Arrival
  bool Damaged = false;             ///< the decoder had to guess parts
  std::optional<Vec2> PixelSpacing; ///< mm of a column and a row, where and as the stream says
};

enum class VideoEvent
{
  Frame,
  NewSize, ///< a frame whose size is another than that of the one before
  End      ///< of the stream; there is no frame
};

/// An open video. All functions throw VideoError, and Aborted when stopped says so, which is asked
/// at least every 100 ms; the looking up of a host's name is the system's and cannot be cut short.
/// Pipes are refused, as they cannot be left. In a build without FFmpeg (LACUNA_WITH_FFMPEG) the
/// constructor throws.
class VideoSource
{
public:
  struct Counts
  {
    std::uint64_t Frames = 0;
    std::uint64_t Damaged = 0;     ///< frames the decoder had to guess parts of
    std::uint64_t Undecodable = 0; ///< packets that the decoder refused
    std::uint64_t Missing = 0;     ///< frames that the stream's times say were left out before
  };

  /// The clock goes on by itself and must live longer.
  VideoSource(
    const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped = {});
  ~VideoSource();
  VideoSource(const VideoSource&) = delete;
  VideoSource& operator=(const VideoSource&) = delete;

  /// Waits for the next frame.
  VideoEvent Read(VideoFrame& frame);
  /// Frames a second by the stream's own account; 0: it says nothing.
  double GetFrameRate() const;
  /// The arrivals of all frames that were not Timed, in order, once they are known (see FrameClock); of
  /// those that never are, nothing. To be asked for after each Read.
  std::vector<std::optional<double>> TakeArrivals();
  const Counts& GetCounts() const { return this->Count; }

private:
  struct Stream;
  std::unique_ptr<Stream> Input;
  Counts Count;
};
}
#endif
