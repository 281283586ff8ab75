// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the emulator's program is told on its command line.
#ifndef lacunaEmulatorSettings_h
#define lacunaEmulatorSettings_h

#include "lacunaFastrakEmulator.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoService.h"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
struct VideoOptions
{
  VideoServiceSettings Service; ///< without URL: no video
  UltrasoundSettings Picture;
  std::string Scene = "Ellipsoids";
  std::string Calibration; ///< file to write; empty: none
  std::optional<double> Aim;
  std::string First; ///< option that was given first; empty: none
};

using NextWord = std::function<const std::string&()>;
using NextNumber = std::function<double(double minimum, double maximum, const char* what)>;

/// Takes an option with its values. False: it is none of the video's.
bool ReadVideoOption(
  const std::string& option, const NextWord& word, const NextNumber& number, VideoOptions& options);

/// Throws std::runtime_error when there are options but no video.
void CheckVideoOptions(const VideoOptions& options);

/// Throws std::runtime_error for a name that is no scene's.
std::unique_ptr<PhantomScene> MakeEmulatedScene(const std::string& name);

/// Something that happens to the unit; time is s from the start.
struct EmulatorEvent
{
  double Time = 0;
  std::function<void(FastrakEmulator& emulator, double now)> Apply;
};

struct EmulatorSettings
{
  FastrakEmulatorOptions Options;
  FastrakEmulator::PoseScript Motion;
  VideoOptions Video;
  std::string Link;
  std::vector<EmulatorEvent> Events; ///< in order of time
  double Duration = std::numeric_limits<double>::infinity();
  bool Help = false;
};

extern const char* const EmulatorHelp;

/// Throws std::runtime_error or std::invalid_argument saying what a word should be.
EmulatorSettings ReadEmulatorSettings(const std::vector<std::string>& words);
}
#endif
