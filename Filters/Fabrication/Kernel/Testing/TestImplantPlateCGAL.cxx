// SPDX-License-Identifier: BSD-3-Clause
// What another library says of plates: closed, outward, without self-intersection.
#include "lacunaPlateScene.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <gtest/gtest.h>

using namespace lacuna;
namespace PMP = CGAL::Polygon_mesh_processing;

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

void Check(const ImplantPlate& plate)
{
  Mesh mesh;
  for (const Vec3& p : plate.Points)
  {
    mesh.add_vertex({ p[0], p[1], p[2] });
  }
  for (const Triangle& t : plate.Triangles)
  {
    // a null face would mean that the mesh is not manifold
    ASSERT_NE(
      mesh.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2])),
      Mesh::null_face());
  }
  EXPECT_TRUE(mesh.is_valid());
  EXPECT_TRUE(CGAL::is_closed(mesh));
  EXPECT_FALSE(PMP::does_self_intersect(mesh));
  EXPECT_TRUE(PMP::is_outward_oriented(mesh));
  EXPECT_NEAR(PMP::volume(mesh) / plate.Volume, 1, 1e-9);
}
}

TEST(ImplantPlateCGAL, PlatesOfEveryKind)
{
  PlateScene ball(PlateScene::Ball, PlateScene::Disc);
  PlateScene skull(PlateScene::Skull, PlateScene::Kidney);
  for (PlateScene* scene : { &ball, &skull })
  {
    for (const PlateSide side : { PlateSide::Inward, PlateSide::Outward })
    {
      for (const PlateEdge edge : { PlateEdge::Square, PlateEdge::Bevel, PlateEdge::Round })
      {
        ImplantPlateOptions options;
        options.Side = side;
        options.Edge = edge;
        options.EdgeSize = 1.2;
        options.BothFaces = side == PlateSide::Outward;
        options.EdgeClearance = side == PlateSide::Outward ? -3 : 0.5;
        options.TriangleSize = 0.8;
        options.HolePoints = { { 42, 40, 0 }, { 48, 33, 2 } };
        options.Hole.CountersinkDiameter = 4;
        options.DrainageSpacing = 7;
        Check(scene->Make(options));
      }
    }
  }
}
