// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCGALSolid.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <gtest/gtest.h>

namespace
{
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

void CheckMesh(const SolidMesh& mesh, double volume)
{
  EXPECT_TRUE(mesh.is_valid());
  EXPECT_TRUE(CGAL::is_closed(mesh));
  EXPECT_FALSE(CGAL::Polygon_mesh_processing::does_self_intersect(mesh));
  EXPECT_TRUE(CGAL::Polygon_mesh_processing::is_outward_oriented(mesh));
  EXPECT_NEAR(CGAL::Polygon_mesh_processing::volume(mesh) / volume, 1, 1e-9);
}
}

void CheckSolid(const lacuna::ImplantPlate& plate)
{
  CheckMesh(MakeMesh(plate), plate.Volume);
}

void CheckSolid(const lacuna::DefectModel& model)
{
  CheckMesh(MakeMesh(model), model.Volume);
}

bool Intersect(const lacuna::ImplantPlate& plate, const lacuna::DefectModel& model)
{
  return CGAL::Polygon_mesh_processing::do_intersect(MakeMesh(plate), MakeMesh(model));
}
