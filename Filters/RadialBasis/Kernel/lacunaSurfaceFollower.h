// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangles on the zero set of a function, made by following the set from seeds.
#ifndef lacunaSurfaceFollower_h
#define lacunaSurfaceFollower_h

#include "lacunaPointNormals.h"
#include "lacunaTriangleSurface.h"
#include "lacunaVector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// A continuous function of space whose zero set is a surface; negative inside.
class ImplicitFunction
{
public:
  virtual ~ImplicitFunction() = default;
  /// Sets values, and where gradients is not null these, of as many elements as there are points.
  /// Each result must depend on its own point only.
  virtual void Evaluate(Execution& execution, const std::vector<Vec3>& points,
    std::vector<double>& values, std::vector<Vec3>* gradients) const = 0;
};

struct SurfaceFollowerOptions
{
  /// About the mean edge of the triangles, mm, above 0.
  double EdgeLength = 1;
  /// Largest distance |s|/|grad s| of a vertex from the zero set, mm, above 0.
  double Tolerance = 0.001;
  /// xmin xmax ymin ymax zmin zmax, mm: what lies outside is not followed.
  std::array<double, 6> Bounds{};
  /// Closes the surface where it reaches the bounds. Otherwise it ends there, up to EdgeLength
  /// beyond.
  bool Cap = true;
};

struct FollowedSurface
{
  TriangleSurface Surface;   ///< a manifold, seen counter-clockwise from outside
  std::vector<Vec3> Normals; ///< of its points: unit gradients; outwards of the bounds on a cap
  std::vector<char> IsCap;   ///< of its points: 1 on a cap
  bool ReachesBounds = false;
  std::int64_t Evaluations = 0; ///< of the function, with and without gradient
  double LargestDistance = 0;   ///< |s|/|grad s| of the worst vertex, mm
};

/// Follows all parts of the zero set that come near a seed (a point within a few EdgeLength of the
/// set; others are ignored). The function is evaluated at the nodes of cells that the surface passes
/// through and their neighbours, nowhere else.
///
/// Method: marching tetrahedra on a body-centred cubic lattice, which have no ambiguous case, so
/// that the surface is a manifold by construction. Then short edges collapse, edges flip and points
/// move along the surface, which evens the triangles and keeps it a manifold. Newton steps on the
/// gradient end each pass. Thinner parts than EdgeLength can be missed.
///
/// Results do not depend on the number of threads. Throws std::invalid_argument for options out of
/// range, MemoryExceeded when there is no room for so many triangles, std::runtime_error when the
/// function has a value that is not finite or when no seed leads to the zero set.
FollowedSurface FollowSurface(Execution& execution, const ImplicitFunction& function,
  const std::vector<Vec3>& seeds, const SurfaceFollowerOptions& options);

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
