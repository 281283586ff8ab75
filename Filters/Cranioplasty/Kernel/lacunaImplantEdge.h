// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The edge of an implant along a wall of bone, so that it can be put in along a direction.
#ifndef lacunaImplantEdge_h
#define lacunaImplantEdge_h

#include "lacunaBoneDistance.h"
#include "lacunaExecution.h"
#include "lacunaPlanarCurves.h"
#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
/// Steps of the edge are about so high, mm, so that it does not cut corners of bone.
constexpr double MostStep = 1.6;

/// The space between an outer and an inner surface over a grid of a chart.
struct ImplantSlab
{
  PlanarGrid Grid;
  std::vector<Vec3> Outer; ///< of each node, world mm
  std::vector<Vec3> Inner;
  std::vector<bool> IsKnown; ///< whether a node has both
  int Steps = 6;             ///< of the edge, from the outer to the inner surface

  double DepthOf(int level) const { return static_cast<double>(level) / this->Steps; }

  bool Covers(const Vec2& p) const;
  /// Bilinear; depth is 0 on the outer and 1 on the inner surface. Covers(p) has to be true.
  Vec3 GetPoint(const Vec2& p, double depth) const;
  /// Unit, of the outer surface, outwards when the chart is counterclockwise from outside.
  Vec3 GetNormal(const Vec2& p) const;
};

/// The way out of the skull along a straight line, against the direction of insertion.
class InsertionPath
{
public:
  /// direction: unit, the way in which an implant is put in. clearance: mm, that it keeps. Keeps a reference to bone.
  InsertionPath(const BoneDistance& bone, const Vec3& direction, double clearance);
  const Vec3& GetDirection() const { return this->Direction; }
  double GetLimit() const
  {
    return this->Limit;
  } ///< mm, of clearances: 3, and 2.5 more than is kept
  /// The least distance from bone of a point on its way out, mm, at most GetLimit(); negative where it starts in bone or
  /// meets it. Distances below -1 are not sought on.
  double GetClearance(const Vec3& x) const;

private:
  double GetWay(const Vec3& x) const; // mm until it is beyond all bone

  const BoneDistance& Bone;
  Vec3 Direction;
  double Limit;
  std::array<Vec3, 2> Bounds;
};

/// The way in, within 45 degrees of start, along which walls have the most taper: squares of what is missing of 10 degrees
/// are least. walls: unit normals out of bone.
Vec3 FindInsertionDirection(const std::vector<Vec3>& walls, const Vec3& start);

struct ImplantEdge
{
  /// For each level, from the outer to the inner surface, loops with as many points as the outline's.
  std::vector<std::vector<Loop>> Levels;
  double LeastTaper = 0; ///< degrees, least angle between the walls and the way in
  /// Free space beside the edge that cannot be filled: mm^3, its largest width (mm), and where.
  double UndercutVolume = 0;
  double UndercutWidth = 0;
  Vec3 UndercutPoint{ 0, 0, 0 };
};

/// Moves an outline outwards, on each level on its own, until the clearance (mm) on the way out is just kept. On
/// each level the outline has it already, but for half a mm. It does not grow over the outer table, into parts that
/// the outline leaves out, nor where the edge would fold.
ImplantEdge FollowWall(const ImplantSlab& slab, const BoneDistance& bone, const InsertionPath& path,
  const std::vector<Loop>& outline, double clearance, Execution& execution);
}
#endif
