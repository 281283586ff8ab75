// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the emulator's program is told about the scanner.
#ifndef lacunaVideoOptions_h
#define lacunaVideoOptions_h

#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoService.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

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
}
#endif
