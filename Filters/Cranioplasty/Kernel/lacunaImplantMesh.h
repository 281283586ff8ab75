// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The closed mesh of an implant, with holes through it and text in its inner face.
#ifndef lacunaImplantMesh_h
#define lacunaImplantMesh_h

#include "lacunaExecution.h"
#include "lacunaImplantEdge.h"
#include "lacunaPlanarCurves.h"
#include "lacunaSkullChart.h"
#include "lacunaSkullImplant.h"
#include "lacunaSkullRays.h"
#include "lacunaVector.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace lacuna
{
/// A straight round hole along the normal of the outer surface at its middle.
struct ImplantHole
{
  Vec2 Middle{};     ///< on the outer surface, in the chart
  double Radius = 0; ///< mm
};

/// Loops of a hole as points of the chart, one on each level (clockwise), about so far apart (mm). Empty: it does not
/// stay on the slab.
std::vector<Loop> FindTunnel(const ImplantSlab& slab, const ImplantHole& hole, double spacing);

/// Distances (mm, in space) to the rim of an implant or of its part.
class ImplantRim
{
public:
  /// Keeps a reference to slab. levels: of ImplantEdge.
  ImplantRim(const ImplantSlab& slab, const std::vector<std::vector<Loop>>& levels);
  /// Of a hole's axis, which starts at p, the least distance to the rim on each level, at most limit; negative outside of
  /// the rim. inner: where it ends.
  double Find(const Vec2& p, double limit, Vec2& inner) const;
  /// Of a place on the inner surface; the same.
  double FindInner(const Vec2& p, double limit) const;

private:
  double FindOn(int level, const Vec2& p, double limit) const;

  const ImplantSlab& Slab;
  std::vector<std::vector<Loop>> Levels;
  std::vector<CurveIndex> Rims;
};

/// A rectangle of the chart that text fills on the inner surface.
struct TextPlace
{
  Vec2 Middle{};
  Vec2 Up{};              ///< unit
  double HalfWidth = 0;   ///< mm of the chart
  double HalfHeight = 0;  ///< the same
  bool IsGood = false;    ///< false: there is no place
  std::vector<Loop> Text; ///< in the chart: what is engraved is on the left
  /// mm from the rectangle, 0 within.
  double GetDistance(const Vec2& p) const;
  /// mm of the chart from the middle, as the text is read: x to the right, y up.
  Vec2 At(double x, double y) const;
};

/// The place of text (loops, mm, as read: x to the right, y up) that is farthest from the rim. It can be read from within,
/// its top towards up. The surface below stays as thick as leastThickness (mm).
TextPlace PlaceText(const ImplantSlab& slab, const ImplantRim& rim,
  const std::vector<Loop>& outline, const std::vector<Loop>& text, const Vec3& up,
  double leastThickness);

/// Where plates fasten the implant: about evenly along the rim, where bone is thick if there is such. rays: of the skull.
/// hasRoom: whether a screw at a place of the outer surface is off the cuts between parts.
std::vector<ImplantPlateScrews> PlacePlates(const ImplantSlab& slab, const SkullRays& rays,
  const Chart& chart, const std::vector<std::vector<Loop>>& levels,
  const SkullImplantOptions& options, const std::function<bool(const Vec3&)>& hasRoom);

/// Of holes along the rim, mm from it to their middles.
double GetLeastToRim(const SkullImplantOptions& options, double diameter);

/// Suture holes along the rim, screws of plates, then drainage holes; each keeps off the rim, the text and those before it.
std::vector<ImplantHole> PlaceHoles(const ImplantSlab& slab, const ImplantRim& rim,
  const std::vector<Loop>& outline, const std::vector<Vec2>& screws, const TextPlace& text,
  const SkullImplantOptions& options, Execution& execution);

/// Adds points, triangles, faces and thickness to an implant. levels: of ImplantEdge, with the loops of holes. Returns the
/// chart's points of those that were added.
std::vector<Vec2> AddImplantMesh(const ImplantSlab& slab,
  const std::vector<std::vector<Loop>>& levels, const std::vector<Loop>& text, double triangleSize,
  Execution& execution, SkullImplant& implant);

constexpr double EngravedDepth = 0.4; ///< mm
}
#endif
