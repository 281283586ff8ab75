// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth maps on other grids.
#ifndef lacunaMapResampling_h
#define lacunaMapResampling_h

#include "lacunaHoleSupport.h"
#include "lacunaVector.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// A surface seen from elsewhere: a lattice of points, row after row, in the axes of the map where it
/// is wanted (x, y, depth, mm). Points that are not finite are missing.
struct SurfaceSheet
{
  int Width = 0;
  int Height = 0;
  std::vector<Vec3> Points;
};

/// Depths of sheet at the pixels of grid, NaN where it is not. Each square of four neighbouring
/// points is two triangles (one if a point is missing); a triangle with an edge steeper than
/// maximumSlope along the depth is a tear and left out. Where the sheet lies over itself the part
/// nearest to the viewer counts.
std::vector<double> ProjectSheet(
  Execution& execution, const SurfaceSheet& sheet, double maximumSlope, const MapGrid& grid);

/// How the pixels of a map come from those of another one with the same axes and x = y = 0.
struct GridTransfer
{
  /// For each pixel of the new grid the nearest one of the old, -1 outside (more than half a pixel
  /// beyond the outermost).
  std::vector<std::int64_t> Nearest;
  /// Bilinear depth; NaN when one of the old pixels it needs has none or a step of more than
  /// maximumSlope is between two of them. At old pixels it is their depth, exactly.
  std::vector<double> Depth;
};
GridTransfer TransferMap(const MapGrid& from, const std::vector<double>& depth,
  const MapMask& valid, double maximumSlope, const MapGrid& to);
}
#endif
