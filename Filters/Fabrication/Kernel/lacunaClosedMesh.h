// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangles that bound a body.
#ifndef lacunaClosedMesh_h
#define lacunaClosedMesh_h

#include "lacunaVector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Triangles are counter-clockwise seen from outside of the body, so clockwise on the walls of a cavity
/// seen from in there. All lengths in mm.
struct ClosedMesh
{
  using Triangle = std::array<std::int32_t, 3>;

  std::vector<Vec3> Points;
  std::vector<Triangle> Triangles;

  /// mm^3. Negative when the surface is inside out.
  double GetVolume() const;
};

/// Triangles that edges connect.
struct MeshPieces
{
  std::vector<std::int32_t> Of; ///< of each triangle its piece
  std::vector<double> Volumes;  ///< of each piece, mm^3; of a cavity negative
};

/// Throws std::runtime_error with a sentence for the user unless every edge has two triangles, once each
/// way, no triangle has a corner twice, all points are finite, and the whole volume is above 0.
void CheckClosed(const ClosedMesh& mesh);

/// Gives each fan of triangles around a point that several fans share a point of its own, and leaves out
/// points without triangles. mesh is closed.
void SeparateFans(ClosedMesh& mesh);

MeshPieces FindPieces(const ClosedMesh& mesh);

/// Of each piece with a negative volume the least positive piece around it, of others -1. Throws
/// std::runtime_error for a cavity that nothing encloses.
std::vector<std::int32_t> FindHosts(const ClosedMesh& mesh, const MeshPieces& pieces);
}
#endif
