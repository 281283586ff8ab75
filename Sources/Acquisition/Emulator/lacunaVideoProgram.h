// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The scanner's part of the emulator's program.
#ifndef lacunaVideoProgram_h
#define lacunaVideoProgram_h

#include "lacunaEmulatorSettings.h"

#include <atomic>
#include <exception>
#include <memory>
#include <thread>

namespace lacuna
{
/// Serves the video on a thread of its own, and says on standard output who came and went.
class VideoProgram
{
public:
  /// Writes the calibration, and listens from now on. begin: the clock's time at which the motion
  /// began. Throws std::runtime_error and std::invalid_argument.
  VideoProgram(const EmulatorSettings& settings, const Clock& clock, double begin);
  ~VideoProgram();
  VideoProgram(const VideoProgram&) = delete;
  VideoProgram& operator=(const VideoProgram&) = delete;

  bool HasFailed() const { return this->Failed; }
  /// Ends the video; throws what it failed with.
  void Finish();

private:
  UltrasoundEmulator Emulator;
  EmulatedProbe Probe;
  std::atomic<bool> Stopped{ false };
  std::atomic<bool> Failed{ false };
  std::exception_ptr Failure;
  std::unique_ptr<VideoService> Service;
  std::thread Thread;
};
}
#endif
