// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a milling path takes away and what it leaves.
#ifndef lacunaMaterialRemoval_h
#define lacunaMaterialRemoval_h

#include "lacunaToolPath.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// The space that a tool has swept on its straight motions, without approximation: a motion of a
/// ball end sweeps a capsule and what is above it, one of a flat end the hull of two cylinders. It
/// knows nothing of how the path was made, and so judges it.
class MaterialRemoval
{
public:
  /// Of all motions but rapid ones, in stock whose top is path.StockTop.
  MaterialRemoval(const ToolPath& path, const MillTool& tool);

  struct Result
  {
    double Height;   ///< z of what is left of the stock at x, y
    double LeftOver; ///< mm from the point to where material was taken away; below 0: the depth of
                     ///< the point within the tool, a gouge
  };
  /// nearest: the motion that is nearest to a point close by, -1 if none is known, to be faster;
  /// gets that of p. It does not change the result.
  Result At(const Vec3& p, std::int64_t& nearest) const;

private:
  struct Segment
  {
    Vec3 Start;    ///< of the ball's centre or the middle of the face
    double Hx, Hy; ///< unit direction seen along -z
    double Length; ///< seen along -z; 0 for upright ones
    double EndZ;
  };
  void AddToBins();
  double GetHeight(const Segment& s, const Vec3& p, double best) const;
  double GetDistance(const Segment& s, const Vec3& p, double best) const;
  // Looks at the motions of a bin that may change the result.
  void Visit(
    std::int64_t u, std::int64_t v, const Vec3& p, Result& result, std::int64_t& nearest) const;

  bool Ball;
  double Radius;
  double StockTop;
  std::vector<Segment> Segments;
  double Low[2] = { 0, 0 };
  double BinSize = 1;
  std::int64_t Bins[2] = { 1, 1 };
  std::vector<std::int64_t> BinStarts;
  std::vector<std::int64_t> BinSegments;
  std::vector<double> BinLowest; ///< z of Start or the end
};

/// A surface with what is left on it.
struct LeftOverMap
{
  GridSize Size;
  double Spacing = 0;              ///< mm, that its points are apart at most
  std::vector<Vec3> Points;        ///< on the triangles of the surface
  std::vector<double> LeftOver;    ///< mm, see MaterialRemoval::Result; not negative
  std::vector<double> Height;      ///< z of what is left
  std::vector<double> Unreachable; ///< mm, see FindUnreachable, linear between the surface's
  /// points; not more than LeftOver
  double LargestLeftOver = 0;
  double LargestGouge = 0; ///< mm
};

/// What a tool leaves at each point of the surface however dense the path, because it does not fit:
/// mm, 0 where it can touch. Found from the place where it would touch a plane with the normal of
/// the point and, if it cannot go there, from its lowest places above all points of the surface.
std::vector<double> FindUnreachable(
  Execution& execution, const MillSurface& surface, const MillTool& tool);

/// What is left on a surface, at points at most spacing apart (as cells are divided evenly); there
/// are no more than four millions of them, though: Spacing says how far they are apart.
LeftOverMap MapLeftOver(Execution& execution, const MillSurface& surface, const MillTool& tool,
  const ToolPath& path, double spacing);
}
#endif
