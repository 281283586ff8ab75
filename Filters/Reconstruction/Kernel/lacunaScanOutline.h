// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Proposes a scan region where hardly anything changes: the outline of all that ever does.
///
/// In a dark bath (wires in water, the bottom of a tank) a few spots and streaks change, too few for
/// DetectFan and FindScanRegion. All slices together still show an outline. The proposal is the
/// smallest rectangle that holds what changes, or the part of this rectangle that is in the smallest
/// sector. The true region may be larger, since the probe may also see where nothing changed.
///
/// What belongs to the screen is left out:
/// - things that are bright in all slices (but one) and are thin, as small as letters, or small filled
///   boxes: letters, rulers, frames, bars;
/// - changes that are not larger than the flicker of these things, or than noise elsewhere;
/// - small changes in a line of text beside its letters, or that are as bright as letters and fill a
///   box: the figures of a clock.
/// The bright face of a curved transducer is none of these. It belongs to the region.
///
/// The sector's origin is the one for which the sector has the smallest area in the rectangle, of
/// those above what changes (or below: it may be upside down), not beside it. A sector is proposed
/// when this area is at most 83 % of the rectangle's, a third of the directions or more reach the far
/// arc before the rectangle ends, and what changes confirms the arc in two fifths of them.
#ifndef lacunaScanOutline_h
#define lacunaScanOutline_h

#include "lacunaScanRegion.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// What changes over slices that come one after the other; none is kept.
class ScanOutline
{
public:
  /// All slices have windows of one size, at least 16 x 16; else throws std::invalid_argument.
  void Put(const SliceImage& slice);

  /// From 3 slices on. pixelSpacing: width and height of a pixel, the unit of the sector's radii. Of a
  /// sector, Rectangle is the one that holds what changes, which may cut the sector short. Confidence
  /// is 0.45 times the part of the shape that lies between changes: always below one half.
  ScanRegion Propose(const Vec2& pixelSpacing) const;

private:
  struct Levels
  {
    float Lowest, SecondLowest, Highest;
  };
  int Width = 0, Height = 0;
  std::int64_t Count = 0;
  std::vector<Levels> Pixels;
};
}
#endif
