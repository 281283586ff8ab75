// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangles of a plane region with holes.
#ifndef lacunaPlanarTriangulation_h
#define lacunaPlanarTriangulation_h

#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
using Triangle = std::array<std::int32_t, 3>;

/// Constrained Delaunay triangles of the region whose boundary are the given closed loops (indices
/// of points; the last is joined to the first): what an odd number of loops encloses. Every point
/// of the region is a vertex, every piece of a loop an edge. Triangles are counterclockwise. The
/// coordinates are first rounded to whole multiples of 2^-24 to 2^-23 of the extent, so that all
/// decisions are exact integer arithmetic; points itself is given back rounded. Throws
/// std::runtime_error when two points coincide or loops meet, std::invalid_argument when a
/// coordinate is not finite.
std::vector<Triangle> TriangulateRegion(
  std::vector<Vec2>& points, const std::vector<std::vector<std::int32_t>>& loops);
}
#endif
