// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The outlines of defects from the pixels that are marked.
#ifndef lacunaDefectContours_h
#define lacunaDefectContours_h

#include "lacunaPlanarCurves.h"
#include "lacunaSurfaceFit.h"

namespace lacuna
{
/// The half-way contours of the mask (not 0: defect), blurred by a Gaussian of one pixel, in mm from
/// the first pixel; the defect is on their left. Throws std::runtime_error when the defect reaches the
/// border, where its outline is not known.
std::vector<Loop> FindDefectContours(
  GridSize size, const Vec2& spacing, const std::vector<unsigned char>& mask);

/// Takes the staircase of pixels out of a loop: a Gaussian along it, of the fourth order, with sigma 3
/// pixels, so that curves of constant curvature stay where they are. Points are about half a pixel
/// apart.
Loop SmoothStaircase(const Loop& loop, double pixel);
}
#endif
