// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangle surfaces, and operations that even their triangles and keep them manifolds.
#ifndef lacunaTriangleSurface_h
#define lacunaTriangleSurface_h

#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
struct TriangleSurface
{
  using Triangle = std::array<std::int32_t, 3>;

  std::vector<Vec3> Points; ///< mm
  std::vector<Triangle> Triangles;

  /// Enclosed volume of a closed surface, mm^3; positive when triangles are seen counter-clockwise
  /// from outside.
  double GetVolume() const;
  double GetArea() const; ///< mm^2
};

/// What the edges of a surface say about it.
struct SurfaceTopology
{
  std::int64_t Components = 0;    ///< that edges connect
  std::int64_t BoundaryEdges = 0; ///< of one triangle; 0: closed
  std::int64_t BadEdges = 0;      ///< of more than two triangles, or of two that disagree
  std::int64_t BadPoints = 0;     ///< whose triangles are not one fan, or that have none
  std::int64_t EulerNumber = 0;   ///< points - edges + triangles; 2 - 2 genus for a closed part
  bool IsManifold() const { return this->BadEdges == 0 && this->BadPoints == 0; }
  bool IsClosed() const { return this->BoundaryEdges == 0; }
};
SurfaceTopology FindTopology(const TriangleSurface& surface);

/// A part of a closed surface, that edges connect.
struct SurfacePart
{
  double Volume = 0; ///< mm^3; negative when it is seen clockwise from outside, as a cavity is
  int Depth =
    0;       ///< so many other parts enclose it: 0 and even ones shall be solid, odd ones cavities
  Vec3 At{}; ///< one of its points
  bool IsInsideOut() const { return (this->Volume > 0) != (this->Depth % 2 == 0); }
};
/// Parts of a closed manifold whose parts do not cut each other: the 64 largest, the largest first.
std::vector<SurfacePart> FindParts(const TriangleSurface& surface);

/// Collapses edges shorter than shortest unless this makes one longer than longest, turns a triangle
/// over or changes the topology. The new point is the middle of the edge. Points of boundary edges
/// stay. Unused points are removed. Returns the number of collapsed edges.
std::int64_t CollapseShortEdges(TriangleSurface& surface, double shortest, double longest);

/// Flips edges where the smallest angle of both triangles grows, where these lie in nearly one plane
/// and where the topology stays. Returns the number of flips.
std::int64_t FlipEdges(TriangleSurface& surface);

/// For each point that is not on a boundary the way to the mean of its neighbours; zero for others.
std::vector<Vec3> GetUmbrellas(const TriangleSurface& surface);
}
#endif
