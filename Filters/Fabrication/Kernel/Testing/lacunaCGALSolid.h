// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What another library says of solids.
#ifndef lacunaCGALSolid_h
#define lacunaCGALSolid_h

#include "lacunaVector.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <gtest/gtest.h>

using SolidMesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

template <class Solid>
SolidMesh MakeMesh(const Solid& solid)
{
  SolidMesh mesh;
  for (const lacuna::Vec3& p : solid.Points)
  {
    mesh.add_vertex({ p[0], p[1], p[2] });
  }
  for (const auto& t : solid.Triangles)
  {
    // a null face would mean that the mesh is not manifold
    EXPECT_NE(mesh.add_face(SolidMesh::Vertex_index(t[0]), SolidMesh::Vertex_index(t[1]),
                SolidMesh::Vertex_index(t[2])),
      SolidMesh::null_face());
  }
  return mesh;
}

/// Closed, manifold, outward, without self-intersection, and of the volume that it says.
template <class Solid>
void CheckSolid(const Solid& solid)
{
  const SolidMesh mesh = MakeMesh(solid);
  EXPECT_TRUE(mesh.is_valid());
  EXPECT_TRUE(CGAL::is_closed(mesh));
  EXPECT_FALSE(CGAL::Polygon_mesh_processing::does_self_intersect(mesh));
  EXPECT_TRUE(CGAL::Polygon_mesh_processing::is_outward_oriented(mesh));
  EXPECT_NEAR(CGAL::Polygon_mesh_processing::volume(mesh) / solid.Volume, 1, 1e-9);
}
#endif
