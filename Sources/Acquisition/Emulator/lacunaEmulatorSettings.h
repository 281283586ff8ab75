// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the emulator's program is told on its command line.
#ifndef lacunaEmulatorSettings_h
#define lacunaEmulatorSettings_h

#include "lacunaFastrakEmulator.h"
#include "lacunaVideoOptions.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace lacuna
{
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
