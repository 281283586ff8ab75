// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A body with flat faces, as CAD programs take it.
#ifndef lacunaFacetedSolid_h
#define lacunaFacetedSolid_h

#include "lacunaClosedMesh.h"
#include "lacunaExecution.h"
#include "lacunaProperties.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
/// Of the faces' distance from the surface.
constexpr ValueRange FaceTolerances = ValueRange::AtLeast(0, "mm");

/// Flat faces that share points and edges. All lengths in mm.
struct FacetedSolid
{
  /// A polygon in a plane, perhaps with holes.
  struct Face
  {
    Vec3 Origin; ///< a point of the plane
    Vec3 Normal; ///< unit, out of the body
    /// Numbers of points. The first loop is the outer one, counter-clockwise seen from outside; the others,
    /// around holes, are clockwise.
    std::vector<std::vector<std::int32_t>> Loops;
  };
  /// One body: the first shell is around it, the others are around its cavities.
  struct Body
  {
    std::vector<std::vector<Face>> Shells;
    double Volume = 0; ///< mm^3, less the cavities
  };

  std::vector<Vec3> Points;
  std::vector<Body> Bodies;
  double Volume = 0;   ///< of all bodies
  double Flatness = 0; ///< points are at most this far from the planes of their faces
  double Deviation =
    0; ///< the largest distance, both ways, that was measured between this and the mesh
  /// Where the surface passes through itself, which the mesh does, too.
  std::optional<Vec3> Crossing;

  std::size_t GetNumberOfFaces() const;
};

/// The body that mesh bounds, with as few faces as a search finds of which none is further than tolerance
/// (mm, not below 0; 0: all points stay) from mesh, or mesh from them. That is measured at corners, on edges and within
/// triangles; the volume differs by at most 0.05 %, and the surface does not pass through itself unless mesh does.
/// Where one of these is not kept the search is repeated with half the tolerance, and at last all points stay. Triangles in one plane become one
/// face. Several closed pieces become several bodies, cavities belong to the body around them. Throws
/// std::invalid_argument for a tolerance that is none, and std::runtime_error for a mesh that is not closed
/// (CheckClosed) or needs more than MostFaces.
FacetedSolid MakeFacetedSolid(ClosedMesh mesh, double tolerance, Execution& execution);

/// CAD programs take minutes for more.
constexpr std::size_t MostFaces = 100000;
}
#endif
