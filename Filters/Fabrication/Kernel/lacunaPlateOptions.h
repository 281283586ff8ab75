// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a plate shall be like.
#ifndef lacunaPlateOptions_h
#define lacunaPlateOptions_h

#include "lacunaPlateHole.h"

#include <vector>

namespace lacuna
{
/// Which way the plate grows from the surface.
enum class PlateSide
{
  Inward, ///< away from the viewer: the surface is the plate's outer face
  Outward ///< towards the viewer: the surface is the plate's inner face
};

/// The form of the plate's edge.
enum class PlateEdge
{
  Square,
  Bevel, ///< a flat of 45 degrees
  Round  ///< a quarter of a circle
};

struct ImplantPlateOptions
{
  double Thickness = 3; ///< mm, > 0
  PlateSide Side = PlateSide::Inward;
  double EdgeClearance = 0.5; ///< mm, see PlateOutlineOptions
  double CornerRadius = 1;    ///< mm, >= 0
  PlateEdge Edge = PlateEdge::Round;
  /// mm of width and depth of bevel or rounding at the outer face; at most the thickness, half of
  /// it when at both faces.
  double EdgeSize = 0.5;
  bool BothFaces = false;
  double TriangleSize = 0.5;    ///< mm, > 0, of triangles seen along z
  std::vector<Vec3> HolePoints; ///< near the plate, in the surface's coordinates
  HoleShape Hole;
  double DrainageSpacing = 0; ///< mm between the middles of drainage holes, 0: none
  double DrainageDiameter = 2;
};

/// The least material between holes, and between a hole and the edge, mm.
constexpr double MinimumWeb = 0.5;

/// Throws std::invalid_argument that names the option, its value and what would be right.
void CheckPlateOptions(const ImplantPlateOptions& options);

/// The section of the plate's edge from the outer face to the inner one: mm inwards from the outline,
/// level.
std::vector<Vec2> GetEdgeProfile(const ImplantPlateOptions& options, const PlateLevels& levels);
}
#endif
