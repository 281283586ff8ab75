// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the probe sees on the screen of a scanner, from one frame of its video or a few.
///
/// Where frames change (lacunaFanDetection.h) needs several with a moving probe. On a still picture
/// the scan region is what differs from the background: the largest part of it that is dense, so
/// that letters, rulers and bars are none, in the shape of a rectangle or a sector, and with the
/// grain of ultrasound, which painted panels have not. Where it is a frame in which all but another
/// region is of one grey (the black window of a grey screen), that one is taken.
///
/// Both ways are tried when there are 3 frames or more; the region is the surer the better its borders
/// are confirmed, and surer still when both ways agree.
#ifndef lacunaScanRegion_h
#define lacunaScanRegion_h

#include "lacunaFanDetection.h"

namespace lacuna
{
struct ScanRegion
{
  bool IsFound = false;
  DetectedFan Fan; ///< when found
  /// 0 to 1. Of one way: DetectedFan::Support, the part of the least certain border that the image
  /// confirms. Of two that agree: 1 less the product of what both lack. Of two that do not agree: a
  /// half of that of the changes, which is the one taken.
  double Confidence = 0;
  /// For the user: how it was found, or why it was not and what to do.
  std::string Text;
};

/// frames: the screen, 1 or more, all windows of one size, at least 16 x 16; of more than 32 so many
/// are taken, evenly spread. pixelSpacing: width and height of a pixel; the sector's radii are in the
/// same unit (1, 1: pixels). Throws std::invalid_argument for what is not so.
ScanRegion FindScanRegion(const std::vector<SliceImage>& frames, const Vec2& pixelSpacing);
}
#endif
