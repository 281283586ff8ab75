// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangulates a depth map, without skins between what is near and what is far.
#ifndef lacunaDepthMapMesher_h
#define lacunaDepthMapMesher_h

#include "lacunaExecution.h"
#include "lacunaMatrix4.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// The depths of a part of a map and where its pixels lie.
struct DepthGrid
{
  const double* Depth = nullptr; ///< mm, row-major over Extent; not finite where there is none
  std::array<int, 4> Extent{};   ///< first and last column, first and last row
  /// (column, row, mm along the view direction, 1) to world mm.
  Matrix4 ImageToWorld;
  bool Perspective = false; ///< rays go out from Eye instead of along the view direction
  Vec3 Eye{ 0, 0, 0 };
};

/// When neighbours are not joined, with the angles of the nine-case method (Carr 1996, 3.3.2). The
/// angle of an edge is that between it and the plane perpendicular to the view. An edge steeper
/// than MaximumAngle is kept only if the surface goes on alike beyond both of its ends: the next
/// edge on the same line differs by less than MaximumAngleChange or is steeper than MaximumAngle
/// the same way, and its step of depth is at least a third of this one's; or there is no next edge.
/// So a steep side that bends smoothly stays whole (towards the rim of a ball steps grow by a
/// factor of 1 + sqrt(2) at most), while a jump from one steep side to another is seen.
struct DiscontinuityRule
{
  bool Break = true;              ///< false: all neighbours are joined
  double MaximumAngle = 65;       ///< degrees
  double MaximumAngleChange = 20; ///< degrees
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
  std::int64_t PixelOf(int column, int row) const;
  bool IsDefined(int column, int row) const;
  Vec3 PointOf(int column, int row) const;
  double Angle(int column, int row, int right, int down) const;
  bool GoesOn(double angle, int column, int row, int right, int down) const;
  bool IsJoined(int column, int row, int right, int down) const;
  unsigned char ChooseTriangles(int column, int row) const;

  DepthGrid Grid;
  DiscontinuityRule Rule;
  int FirstRow;
  int LastRow;
  std::vector<unsigned char> Triangles; ///< flags for each square
  std::vector<std::int64_t> PointOffsets;
  std::vector<std::int64_t> TriangleOffsets;
};
}
#endif
