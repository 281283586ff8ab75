// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A plate of given thickness over the fitted part of a depth field, as a closed solid.
#ifndef lacunaImplantPlate_h
#define lacunaImplantPlate_h

#include "lacunaPlanarTriangulation.h"
#include "lacunaPlateOutline.h"
#include "lacunaProperties.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace lacuna
{
/// Which way the plate grows from the surface.
enum class PlateSide
{
  Inward, ///< away from the viewer: the surface is the plate's outer face
  Outward ///< towards the viewer: the surface is the plate's inner face
};
inline constexpr std::array<const char*, 2> PlateSideNames{ "Inward", "Outward" };

/// The form of the plate's edge.
enum class PlateEdge
{
  Square,
  Bevel, ///< a flat of 45 degrees
  Round  ///< a quarter of a circle
};
inline constexpr std::array<const char*, 3> PlateEdgeNames{ "Square", "Beveled", "Rounded" };

struct ImplantPlateOptions
{
  double Thickness = 3; ///< mm
  PlateSide Side = PlateSide::Inward;
  double EdgeClearance = 0.5; ///< mm, see PlateOutlineOptions
  double CornerRadius = 1;    ///< mm
  PlateEdge Edge = PlateEdge::Round;
  /// mm of width and depth of bevel or rounding at the outer face; at most the thickness, half of
  /// it when at both faces.
  double EdgeSize = 0.5;
  bool BothFaces = false;
  double TriangleSize = 0.5;    ///< mm, above 0, of triangles seen along z
  std::vector<Vec3> HolePoints; ///< near the plate, in the surface's coordinates
  HoleShape Hole;
  double DrainageSpacing = 0; ///< mm between the middles of drainage holes, 0: none
  double DrainageDiameter = 2;

  /// With the ranges, but for HolePoints. TriangleSize may be 0, which MakeImplantPlate does not take.
  void Describe(Properties& properties) const;
};

/// The least material between holes, and between a hole and the edge, mm.
constexpr double MinimumWeb = 0.5;

/// Throws std::invalid_argument that names the option, its value and what would be right.
void CheckPlateOptions(const ImplantPlateOptions& options);

/// The section of the plate's edge from the outer face to the inner one: mm inwards from the outline,
/// level.
std::vector<Vec2> GetEdgeProfile(const ImplantPlateOptions& options, const PlateLevels& levels);

/// What a triangle of the plate belongs to.
enum class PlateFace : unsigned char
{
  Outer, ///< towards the viewer
  Inner,
  Edge,
  ScrewHole,
  DrainageHole
};

/// A closed, oriented triangle mesh and what was measured on it.
struct ImplantPlate
{
  std::vector<Vec3> Points;        ///< in the surface's coordinates
  std::vector<Triangle> Triangles; ///< counterclockwise from outside
  std::vector<PlateFace> Faces;    ///< one per triangle
  PlateOutline Outline;
  std::vector<PlateHole> Holes; ///< in the order of HolePoints
  std::int64_t DrainageHoles = 0;
  double Volume = 0;    ///< mm^3
  double OuterArea = 0; ///< mm^2
  /// mm, the least distance of a point of one face, not at an edge or hole, to the other face.
  double MinimumThickness = std::numeric_limits<double>::infinity();
  /// mm, the least radius of curvature of the surface under the plate, and where.
  double MinimumRadius = std::numeric_limits<double>::infinity();
  Vec3 MinimumRadiusPoint{};
};

/// Both faces are true normal offsets: their vertices lie exactly on the offset surface. The faces
/// are constrained Delaunay triangulations of their outlines and a hexagonal lattice; walls run
/// along the normals. Throws std::invalid_argument when an option is out of range and
/// std::runtime_error when the plate cannot be made: the surface bends with a radius less than the
/// thickness on the side of the offset, a hole does not lie in the plate, and as FindPlateOutline.
/// toWorld only serves to name places in messages.
ImplantPlate MakeImplantPlate(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const ImplantPlateOptions& options,
  const Matrix4& toWorld = {});
}
#endif
