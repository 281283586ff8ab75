// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds the part of its images that a probe sees.
///
/// What the probe sees changes from slice to slice; what is around it, black or a ruler, does not
/// (lacunaActivityMap.h). The largest changing part is compared with two shapes: the rectangle of a
/// linear probe, and the sector of a curved or phased one, whose two sides are lines that meet in
/// the point in which the two arcs are centred. The probe may be at the top or at the bottom of the
/// image, and the sector may be cut off by the image's edges.
///
/// Sides and arcs are found by consensus: the line, or radius, that most points of the part's
/// border agree with (within 1.5 pixels), where points outside of it count against it. So dark
/// parts within the sector and bits of text beside it do no harm.
///
/// A shape is trusted when 98 % of the part lie in it, the part covers at least half of it, and
/// each side and arc is confirmed by a third of its length (of a rectangle by two fifths), unless
/// the image ends there. The smallest
/// change that counts is tried from none at all (recordings that are exactly black around the
/// sector) up to a sixteenth of the largest one (noisy ones). The first trusted shape that is
/// smaller than the image wins; a rectangle that reaches to the left or the right edge only before
/// it is found that all of the image changes, since it may as well be a shadow that cuts it short.
#ifndef lacunaFanDetection_h
#define lacunaFanDetection_h

#include "lacunaFan.h"
#include "lacunaSliceImage.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// What the probe sees.
struct DetectedFan
{
  bool IsSector = false;
  /// In pixels of the slices' windows, degrees and mm, when IsSector.
  Fan Sector;
  /// Column and row of the first pixel, and columns and rows, that hold what the probe sees: of the
  /// rectangle, or of the box around the sector.
  std::array<int, 4> Rectangle{ 0, 0, 0, 0 };
  /// How well the image shows it, 0 to 1: the part of their length by which the least certain of the
  /// sides and arcs is confirmed. Those at the image's edge are not asked.
  double Support = 0;
};

class ActivityMap;

/// slices: of one sweep, all with windows of one size; fans that they have are not heeded.
/// pixelSpacing: mm from column to column and from row to row.
/// Throws std::runtime_error, with a text for the user, when the slices are fewer than 3 or no
/// shape can be trusted.
DetectedFan DetectFan(const std::vector<SliceImage>& slices, const Vec2& pixelSpacing);

/// The same in a map of where it is; of the largest parts the first that has the shape. verb: what
/// the pixels in it do, in texts: "change".
DetectedFan DetectFan(
  const ActivityMap& map, const Vec2& pixelSpacing, const std::string& verb, std::size_t parts);
}
#endif
