// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth map as kernels see it: depths, where their points lie, and how edges between neighbouring
/// points run against the rays.
#ifndef lacunaDepthGrid_h
#define lacunaDepthGrid_h

#include "lacunaDepthDiscontinuity.h"
#include "lacunaExecution.h"
#include "lacunaMatrix4.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace lacuna
{
/// From one point of a depth map to a neighbour, seen along the ray at its middle.
struct DepthEdge : DepthStep
{
  Vec3 Step{ 0, 0, 0 }; ///< world mm

  static DepthEdge Missing()
  {
    DepthEdge edge;
    static_cast<DepthStep&>(edge) = DepthStep::Missing();
    return edge;
  }
};

/// The depths of a part of a map and where its pixels lie. Does not own the depths.
struct DepthGrid
{
  const double* Depth = nullptr; ///< mm, row-major over Extent; not finite where there is none
  std::array<int, 4> Extent{};   ///< first and last column, first and last row
  /// (column, row, mm along the view direction, 1) to world mm.
  Matrix4 ImageToWorld;
  bool Perspective = false; ///< rays go out from Eye instead of along the view direction
  Vec3 Eye{ 0, 0, 0 };

  /// Position of a pixel in Depth.
  std::int64_t PixelOf(int column, int row) const
  {
    const auto& e = this->Extent;
    return (static_cast<std::int64_t>(row) - e[2]) * (static_cast<std::int64_t>(e[1]) - e[0] + 1) +
      (static_cast<std::int64_t>(column) - e[0]);
  }

  /// True for pixels of this part that have a depth.
  bool IsDefined(int column, int row) const
  {
    const auto& e = this->Extent;
    return column >= e[0] && column <= e[1] && row >= e[2] && row <= e[3] &&
      std::isfinite(this->Depth[this->PixelOf(column, row)]);
  }

  /// Unit, world, away from the viewer.
  Vec3 RayOf(int column, int row) const;
  /// World mm, of a pixel that has a depth.
  Vec3 PointOf(int column, int row) const;
  /// The edge from one point to another.
  DepthEdge EdgeBetween(const Vec3& from, const Vec3& to) const;
  /// The edge from a pixel to the one that is right columns and down rows on; either may be
  /// undefined or not in this part.
  DepthEdge EdgeFrom(int column, int row, int right, int down) const;
};

struct Sphere
{
  Vec3 Centre{ 0, 0, 0 };
  double Radius = 0; ///< mm
};

/// The sphere around the box, along the world's axes, of all points of a map. Radius 0 when there is
/// none.
Sphere CircumscribedSphere(const DepthGrid& grid, Execution& execution);
}
#endif
