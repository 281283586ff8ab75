// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice that an acquisition has taken.
#ifndef lacunaAcquiredSlice_h
#define lacunaAcquiredSlice_h

#include "lacunaMatrix4.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lacuna
{
/// Times are s. What is not known is NaN.
struct AcquiredSlice
{
  std::shared_ptr<const std::vector<std::uint8_t>> Pixels; ///< of the window, the top line first
  std::int64_t FrameNumber = 0; ///< in the video, counted from the beginning of the acquisition
  double Timestamp = 0;         ///< when the probe saw it, since the beginning of the acquisition
  Matrix4 ProbeToTracker;       ///< mm; all NaN when there is no pose
  unsigned char Status = 0;     ///< SliceFlags, but for what PixelSpacing tells
  std::optional<Vec2> PixelSpacing; ///< mm of a column and a row, as the video says
  double Residual = 0; ///< from the slice's instant to the nearest measurement of the tracker
  double Gap = 0;      ///< between the measurements on either side
  bool Held = false;   ///< the pose is that of the last measurement, Residual before
  double Speed = 0;    ///< mm/s of the fastest extreme point since the frame before
  double Delay = 0;    ///< from the frame's arrival until the slice was there
};

/// What is the same for the slices of a sweep.
struct SweepFrame
{
  /// First column, first row, columns and rows of the window that is kept of a frame.
  std::array<int, 4> Window{ 0, 0, 0, 0 };
  bool Calibrated = false;
  Matrix4 ImageToProbe; ///< (column, row, 0, 1) of the whole frame to mm
  Matrix4 TrackerToReference;
};
}
#endif
