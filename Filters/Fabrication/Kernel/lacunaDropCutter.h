// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far down a tool can go: exact against facets, edges and vertices of a surface.
#ifndef lacunaDropCutter_h
#define lacunaDropCutter_h

#include "lacunaMillSurface.h"
#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
enum class ToolShape
{
  Ball = 0, ///< ball end
  Flat = 1  ///< square end
};

/// An upright tool. Its place is its tip, the lowest point of its axis.
struct MillTool
{
  ToolShape Shape = ToolShape::Ball;
  double Radius = 4; ///< mm
};

/// Drops a tool onto a surface. A ball touches where its centre lies on the offset of the surface:
/// of a facet a plane, of an edge a cylinder, of a vertex a ball; a square end touches with its rim
/// or, on level ground, its face. All are solved in closed form; what cannot be higher than what was
/// found already is passed over in blocks. The shank above a ball end is as thick as the ball.
class DropCutter
{
public:
  /// allowance: mm of stock to leave on the surface (along the normal for a ball, at least this
  /// along z and sideways for a square end). surface is not owned.
  DropCutter(const MillSurface& surface, const MillTool& tool, double allowance = 0);

  /// Memory of a thread, so that no call allocates.
  struct Scratch
  {
    struct Candidate
    {
      double Bound;
      const MillSurface::Block* Block;
    };
    std::vector<Candidate> Candidates;
  };

  /// Lowest z of the tip at x, y at which the tool does not cut the surface; -infinity where the
  /// surface is not below it. Within 1e-9 mm.
  double Drop(double x, double y, Scratch& scratch) const;

  /// As Drop, but outside of the rectangle around the surface the tool does not go lower than the
  /// extension of its own way: level where it is level or rises at the nearest point of the
  /// rectangle's border, and where it goes down there, twice as steep, so that a ball reaches the
  /// lowest part of a border that slopes down. Never lower than Drop, and never lower than the tip
  /// has to be to touch an edge as high as the surface's lowest point: at most a radius below it.
  double DropBeyond(double x, double y, Scratch& scratch) const;

  struct Excess
  {
    double Height;   ///< mm, by which the motion is too low where it is lowest; -infinity: nowhere
    double Fraction; ///< 0..1, where from start to end
  };
  /// How much too low the straight motion of the tip from a to b is anywhere strictly between
  /// them, apart from where that is at an end (see Drop). Exact: found as the stationary points of
  /// the height of the tool over each edge and vertex, not by sampling. What is not larger than
  /// tolerance may be passed over.
  Excess FindExcess(const Vec3& a, const Vec3& b, double tolerance) const;

private:
  struct Dropping;
  struct Sweeping;

  const MillSurface& Surface;
  bool Ball;
  double Radius;    ///< with the allowance
  double TipOffset; ///< from the reference point (centre of the ball, middle of the face)
};
}
#endif
