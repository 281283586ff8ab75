// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Signed distance from a surface of even triangles.
#ifndef lacunaSurfaceDistance_h
#define lacunaSurfaceDistance_h

#include "lacunaPointNormals.h"
#include "lacunaTriangleSurface.h"
#include "lacunaVector.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
/// Of triangles as FollowSurface makes them: the nearest is one around one of the nearest points. (VTK's
/// vtkImplicitPolyDataDistance serves any triangles, on one thread, at fifty times the time.)
class SurfaceDistance
{
public:
  /// Keeps a reference to surface. Throws std::invalid_argument when it has no points.
  explicit SurfaceDistance(const TriangleSurface& surface);

  /// mm, negative on the side from which triangles are seen clockwise: inside. May be called by many
  /// threads.
  double Get(const Vec3& x) const;

private:
  const TriangleSurface& Surface;
  PointNeighbors Neighbors;
  std::vector<std::size_t> Firsts; // of each point, in Around
  std::vector<std::size_t> Around; // triangles
};
}
#endif
