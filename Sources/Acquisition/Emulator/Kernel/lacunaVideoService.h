// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An emulated scanner's video, in real time.
#ifndef lacunaVideoService_h
#define lacunaVideoService_h

#include "lacunaClock.h"
#include "lacunaFastrakEmulator.h"
#include "lacunaMatrix4.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoSender.h"

#include <cstdint>
#include <functional>
#include <string>

namespace lacuna
{
/// A probe with a receiver on it, some 75 mm above the transducer's face and turned against the
/// image about all three axes; moved as the receiver is.
///
/// The scene stays where it is: its origin lies in the middle of what the probe sees, and its x, y
/// and z along columns, rows and their cross product, at one instant of the motion.
class EmulatedProbe
{
public:
  /// imageToFace: see ScannerScreen. depth: mm that the probe sees. aim: that instant, s.
  EmulatedProbe(FastrakEmulator::PoseScript motion, int station, const Matrix4& imageToFace,
    double depth, double aim);

  /// (column, row, 0, 1) to mm of the receiver: what a calibration finds.
  const Matrix4& GetImageToReceiver() const { return this->ImageToReceiver; }
  /// (column, row, 0, 1) to mm of the scene at a time.
  Matrix4 ImageToScene(double time) const;
  /// A calibration file, as an acquisition, PLUS, 3D Slicer and Tracked Slice Reader take it: Image
  /// to Probe, and Tracker to Reference, which is the scene's frame.
  std::string FormatCalibration() const;

private:
  FastrakEmulator::PoseScript Motion;
  int Station;
  Matrix4 ImageToReceiver;
  Matrix4 TransmitterToScene;
};

struct VideoServiceSettings
{
  VideoSenderSettings Sender;
  /// s by which a frame is sent after the instant that it shows; 0 ... 1.
  double Latency = 0.04;
};

/// What a client got.
struct VideoServiceCounts
{
  std::int64_t Sent = 0;
  /// Frames left out between the first and the last one, because the client (or this computer) did
  /// not keep up by more than 0.2 s. In the stream's times they are missing.
  std::int64_t LeftOut = 0;
};

/// Frame n is sent at begin + n / Rate and shows the probe Latency earlier, whatever the time that
/// rendering takes: it is done ahead. Frames are only made while there is a client.
class VideoService
{
public:
  /// Throws as VideoSender, and std::invalid_argument. All must live longer.
  VideoService(const UltrasoundEmulator& emulator, const EmulatedProbe& probe, const Clock& clock,
    const VideoServiceSettings& settings, std::function<bool()> stopped);

  /// Serves clients until stopped, or ends with the stream where there can be but one. begin: the
  /// clock's time of time 0 of the motion. left is called when a client is gone.
  void Run(double begin, const std::function<void(const VideoServiceCounts&)>& left);

private:
  void ServeClient(double begin, VideoServiceCounts& counts);
  void WaitUntil(double time) const;

  const UltrasoundEmulator& Emulator;
  const EmulatedProbe& Probe;
  const Clock& Time;
  VideoServiceSettings Settings;
  std::function<bool()> Stopped;
  VideoSender Sender;
};
}
#endif
