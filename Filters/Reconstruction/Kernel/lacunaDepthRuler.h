// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ruler that a scanner draws beside its image: how many pixels lie from tick to tick.
///
/// How many millimetres a tick is, the screen does not say (often 10, with small ticks 5 or 1); who
/// knows it gets the pixel scale from GetSpacing.
#ifndef lacunaDepthRuler_h
#define lacunaDepthRuler_h

#include "lacunaFanDetection.h"

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
/// Equally spaced ticks along one side of the scan region.
struct TickRow
{
  bool IsFound = false;
  double Pitch = 0; ///< pixels from tick to tick, of the finest ticks
  /// Standard deviation of Pitch, pixels; what ticks drawn at whole pixels allow, at the least.
  double PitchError = 0;
  std::vector<double> Ticks; ///< rows (of the depth) or columns (of the width) of their middles
  /// First and last column (of the depth) or row (of the width) that all ticks cross.
  std::array<int, 2> Across{ 0, 0 };
  int LongEvery = 0; ///< every so manyth tick is longer; 0: all are alike
  int FirstLong = 0; ///< the first of these in Ticks
  std::string Text;  ///< for the user: what was found, or why nothing was

  /// mm a pixel when a tick is so many mm.
  double GetSpacing(double tick) const { return tick / this->Pitch; }
};

struct DepthRuler
{
  TickRow Depth; ///< ticks from row to row, at the left or the right
  TickRow Width; ///< ticks from column to column, above or below
};

/// Ticks are short bright strokes on what is darker, one above the other in at least two columns,
/// equally spaced, at least 5 of them (one in five may be missing), along a third of the region's
/// side or more, with hardly anything else between them in these columns, which tells them from
/// texts. They are looked for outside of the region in the mean of the frames (at most 32).
///
/// frames: as for FindScanRegion; region: what it found; pixelSpacing: as there.
DepthRuler FindDepthRuler(
  const std::vector<SliceImage>& frames, const DetectedFan& region, const Vec2& pixelSpacing);
}
#endif
