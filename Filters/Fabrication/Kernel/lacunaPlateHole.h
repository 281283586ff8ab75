// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Round holes through a plate.
#ifndef lacunaPlateHole_h
#define lacunaPlateHole_h

#include "lacunaPlanarCurves.h"
#include "lacunaReliefSurface.h"

namespace lacuna
{
/// The faces of a plate as offsets of its surface towards the viewer, mm.
struct PlateLevels
{
  double Outer = 0; ///< the face that the viewer sees
  double Inner = 0;
};

/// What a hole looks like.
struct HoleShape
{
  double Diameter = 2;
  double CountersinkDiameter = 0; ///< on the outer face; 0: none
  double CountersinkAngle = 90;   ///< degrees, between opposite sides of the cone
};

/// A circular cylinder along the normal at its foot, with an exact cone at the outer face. Rings run
/// clockwise in (x, y) and have equally many points at the same angles.
struct PlateHole
{
  Vec2 Foot{};
  Vec3 Centre{};     ///< where the axis meets the outer face
  Vec3 Axis{};       ///< unit, towards the viewer
  double Radius = 0; ///< the larger one
  /// The points of the surface whose offsets are the rings on the two faces.
  Loop OuterFeet;
  Loop InnerFeet;
  /// From the outer face to the inner one.
  std::vector<std::vector<Vec3>> Rings;
  /// mm of cylinder below the countersink, or the least thickness at the hole.
  double Land = 0;
};

/// The point of the surface on whose normal p lies, and p's offset from it towards the viewer.
/// Returns false when there is none.
bool FindFoot(const ReliefSurface& surface, const Vec3& p, Vec2& foot, double& offset);

/// Throws std::runtime_error when the hole does not fit the plate there.
PlateHole MakePlateHole(const ReliefSurface& surface, const Vec2& foot, const PlateLevels& levels,
  const HoleShape& shape, double spacing);
}
#endif
