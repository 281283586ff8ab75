// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which pixels of a depth map carry the surface that fills a hole: rules about masks.
///
/// Masks and depths are arrays of width x height pixels, row after row; a mask is 0 or 1.
#ifndef lacunaHoleSupport_h
#define lacunaHoleSupport_h

#include "lacunaVector.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// Where the pixels of a map are: pixel (i, j), 0 <= i < Width, 0 <= j < Height, has its centre at
/// x = (FirstColumn + i) Spacing[0], y = (FirstRow + j) Spacing[1], the map's axes, mm.
struct MapGrid
{
  int Width = 0;
  int Height = 0;
  Vec2 Spacing{ 1, 1 };
  int FirstColumn = 0;
  int FirstRow = 0;

  std::size_t GetSize() const
  {
    return static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  }
  /// Column and row of a pixel of the arrays, counted from x = 0 and y = 0.
  std::int64_t GetColumn(std::size_t pixel) const
  {
    return this->FirstColumn + static_cast<std::int64_t>(pixel % this->Width);
  }
  std::int64_t GetRow(std::size_t pixel) const
  {
    return this->FirstRow + static_cast<std::int64_t>(pixel / this->Width);
  }
};

using MapMask = std::vector<unsigned char>;

/// Pixels outside of mask that cannot be reached from the border of the map over edges between
/// pixels outside of mask: its interior holes.
MapMask FindInteriorHoles(const MapGrid& grid, const MapMask& mask);

/// Pixels around whose centres a closed polygon winds, in whichever sense: where it crosses itself all
/// that it encloses. Its corners are x, y in the map's axes, mm; the last is joined to the first. Of
/// centres on the polygon those on its left and upper sides count.
MapMask FindEnclosed(const MapGrid& grid, const std::vector<Vec2>& polygon);

/// Pixels of candidates whose centres are at most margin mm from the centre of a pixel of region.
MapMask SelectWithin(Execution& execution, const MapGrid& grid, const MapMask& region,
  double margin, const MapMask& candidates);

/// The holes that a map shows: what its main surface encloses, valid or not (through a hole one
/// mostly sees the other side), grown by rim mm. The main surface is the largest piece of valid
/// pixels that are connected over edges without a depth step (see RemoveBeyondSteps), of equal ones
/// the one with the first pixel.
MapMask FindHoles(Execution& execution, const MapGrid& grid, const std::vector<double>& depth,
  double maximumSlope, double rim, const MapMask& valid);

/// What RemoveBeyondSteps did.
struct StepReport
{
  std::size_t RemovedPixels = 0;
  double LargestStep = 0;     ///< mm, between pixels of kept and removed pieces
  std::size_t FirstPixel = 0; ///< the first removed one
};

/// From which difference of depths, times the distance in the map, two pixels of the support are
/// taken to lie on different surfaces.
struct StepSlopes
{
  double Touching = 0; ///< of edge neighbours
  double OverGap = 0;  ///< of pixels that face each other over others that are not support
};

/// Removes from support what lies beyond a depth step. A step is between two edge neighbours of
/// support whose depths differ by more than slopes.Touching times their distance. Steps divide the
/// support into connected pieces (over edges without a step). Taken from the largest piece to the
/// smallest (of equal ones the one with the first pixel), a piece is removed when a step divides it
/// from one that was kept. Then the same with pieces that do not touch but face each other over
/// pixels that are not support: the step is between the two pixels where they are nearest, and
/// steeper than slopes.OverGap.
StepReport RemoveBeyondSteps(const MapGrid& grid, const std::vector<double>& depth,
  const StepSlopes& slopes, MapMask& support);

/// Thins support to a lattice of nodeSpacing mm through x = y = 0: for each lattice point the
/// nearest pixel of support is kept, the first one of equals, if one lies in the square of that
/// size around the point. Returns the pixels, ascending. Where nodeSpacing is at most the pixel
/// spacing of an axis, no pixel is dropped along it.
std::vector<std::size_t> ThinNodes(const MapGrid& grid, const MapMask& support, double nodeSpacing);
}
#endif
