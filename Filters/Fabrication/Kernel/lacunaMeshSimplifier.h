// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The same body with fewer triangles.
#ifndef lacunaMeshSimplifier_h
#define lacunaMeshSimplifier_h

#include "lacunaClosedMesh.h"
#include "lacunaExecution.h"

namespace lacuna
{
/// Makes one point of two that an edge connects, again and again, where the points of mesh, and samples of its
/// edges and triangles, stay within tolerance (mm) of the triangles nearby, and the new point within tolerance
/// of mesh. The least change comes first (quadrics: Garland and Heckbert 1997), and the volume stays (Lindstrom and Turk
/// 1998). In planes and along straight edges one of the two points stays exactly where it was. At the end the volume is
/// corrected by moving new points by at most 0.3 tolerance. The topology stays. mesh is closed, and each of its points has
/// one fan of triangles (SeparateFans). Nobody looks here whether the result passes through itself, nor how
/// far it is from mesh between the samples.
/// fixed, one for each point or empty: points that stay, and the edges between them and others do not collapse.
ClosedMesh SimplifyMesh(const ClosedMesh& mesh, double tolerance, Execution& execution,
  const std::vector<char>& fixed = {});

/// Corners, and samples between them, of all triangles: at most spacing (mm) apart, but at most 32 along an edge.
std::vector<Vec3> SampleMesh(const ClosedMesh& mesh, double spacing);
}
#endif
