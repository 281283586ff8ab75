// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangulates a depth map, without skins between what is near and what is far.
#ifndef lacunaDepthMapMesher_h
#define lacunaDepthMapMesher_h

#include "lacunaDepthDiscontinuity.h"
#include "lacunaDepthGrid.h"
#include "lacunaExecution.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// When neighbours are not joined: when the nine cases, at either end of an edge, find a discontinuity
/// in it; or when a steep edge steps more than three times as far along the rays as the next edge on
/// the same line. The cases alone take a jump from one steep side to another for a steep side; one
/// that bends smoothly stays whole (towards the rim of a ball steps grow by a factor of 1 + sqrt(2) at
/// most).
struct DiscontinuityRule
{
  bool Break = true; ///< false: all neighbours are joined
  DiscontinuityLimits Limits;
};

/// One point per pixel with a depth, one or two triangles per square of pixels (split along the
/// shorter step of depth), front faces towards the viewer. Points and triangles are in the order of
/// the pixels.
class DepthMapMesher
{
public:
  /// Meshes the squares between the pixel rows firstRow..lastRow. The rule looks one row further
  /// where the grid has it. Keeps a reference to the depths. Throws std::invalid_argument when an
  /// angle is not within 0..90 (change: 0..180) or the rows are not within the grid.
  DepthMapMesher(const DepthGrid& grid, const DiscontinuityRule& rule, int firstRow, int lastRow,
    Execution& execution);

  std::int64_t GetNumberOfPoints() const { return this->PointOffsets.back(); }
  std::int64_t GetNumberOfTriangles() const { return this->TriangleOffsets.back(); }

  /// World coordinates x 3, and each point's position in the grid's array.
  void FillPoints(double* points, long long* pixels, Execution& execution) const;
  /// Point numbers x 3.
  void FillTriangles(long long* corners, Execution& execution) const;

private:
  bool IsJoined(int column, int row, int right, int down) const;
  unsigned char ChooseTriangles(int column, int row) const;

  DepthGrid Grid;
  bool Break;
  SlopeRule Cases;
  int FirstRow;
  std::vector<unsigned char> Triangles; ///< flags for each square
  std::vector<std::int64_t> PointOffsets;
  std::vector<std::int64_t> TriangleOffsets;
};
}
#endif
