// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The outline of a plate from the pixels of a defect.
#ifndef lacunaPlateOutline_h
#define lacunaPlateOutline_h

#include "lacunaPlanarCurves.h"
#include "lacunaReliefSurface.h"
#include "lacunaSurfaceFit.h"

#include <string>

namespace lacuna
{
class Execution;
class ReliefSurface;

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

/// How an outline is drawn.
struct PlateOutlineOptions
{
  /// mm from the defect's outline inwards; negative: outwards.
  double Clearance = 0;
  /// mm: no corner is sharper.
  double CornerRadius = 1;
  /// mm between the points of the outline.
  double Spacing = 0.5;
};

/// A smooth closed curve on a surface, counterclockwise in (x, y), and the way inwards from each of
/// its points.
struct PlateOutline
{
  Loop Points;
  /// Where each point ends after going CornerRadius mm inwards.
  Loop Core;
  double CornerRadius = 0;
  /// Of the defect itself, before clearance.
  Loop Defect;
  double Length = 0; ///< mm, on the surface
  std::vector<std::string> Warnings;

  /// Point k after going distance mm inwards, up to CornerRadius.
  Vec2 GetInset(std::size_t k, double distance) const;
};

/// The defect's own outline is the half-way contour of the mask (not 0: defect), blurred by a
/// Gaussian of one pixel, then smoothed along itself by one of the fourth order with sigma 3 pixels:
/// straight edges and arcs stay in place, steps of pixels and corners vanish. Of several defects the one of the largest
/// area is taken, islands in it are covered; both with a warning. All further distances are those in
/// space between points of the surface: the outline is moved inwards by Clearance less a notch radius
/// and back by that, which rounds notches, then on inwards by CornerRadius and back, which rounds
/// corners; both change nothing else. The notch radius of an overlap is the overlap, at least Spacing
/// and at most CornerRadius; within the defect it is Spacing, at most Clearance, so that the plate
/// never comes onto the bone.
/// Throws std::runtime_error when no plate is left, or when it leaves the surface.
PlateOutline FindPlateOutline(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const PlateOutlineOptions& options);
}
#endif
