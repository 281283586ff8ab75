// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The line that a flat floor or wall is in a B-scan.
#ifndef lacunaWallDetection_h
#define lacunaWallDetection_h

#include "lacunaGreyImage.h"
#include "lacunaVector.h"

#include <array>
#include <optional>

namespace lacuna
{
struct WallLine
{
  /// (column, row) of two points of the line, a tenth of the seen part from its ends.
  std::array<Vec2, 2> Points;
  double Support = 0; ///< part of the columns whose first strong echo lies on the line
};

/// In each column the wall is the first strong echo: the brightest place of the first stretch, from
/// the transducer (row 0) downwards, of levels above half of what is bright in the image (its 99.5th
/// percentile). Echoes of particles before it lie off the line and are not counted, nor is what comes
/// behind the wall (reverberations). The line is the one on which, within a hundredth of the image's
/// height, most columns agree. Nothing when fewer than half of the columns have an echo, fewer than
/// 60 % of those agree, more than a fifth of the image is that bright (tissue, noise), it is all of one
/// grey, or it is smaller than 16 x 16.
std::optional<WallLine> FindWall(const GreyImage& image);
}
#endif
