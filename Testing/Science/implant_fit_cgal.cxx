// SPDX-License-Identifier: BSD-3-Clause
// What CGAL says of a solid in an STL file, for implant_fit.py, which compiles this where CGAL is installed.
//   implant_fit_cgal FILE.stl: "closed manifold outward intersecting-pairs volume", 1 or 0 each, mm^3
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <cstdio>
#include <iterator>
#include <utility>
#include <vector>

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
namespace PMP = CGAL::Polygon_mesh_processing;

int main(int count, char* arguments[])
{
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> triangles;
  if (count != 2 || !CGAL::IO::read_polygon_soup(arguments[1], points, triangles))
  {
    std::fprintf(stderr, "give one STL file\n");
    return 1;
  }
  PMP::merge_duplicate_points_in_polygon_soup(points, triangles); // STL has no topology
  if (!PMP::is_polygon_soup_a_polygon_mesh(triangles))
  {
    std::printf("0 0 0 0 0\n");
    return 0;
  }
  Mesh mesh;
  PMP::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  PMP::self_intersections(mesh, std::back_inserter(pairs));
  const bool closed = CGAL::is_closed(mesh);
  std::printf("%d 1 %d %zu %.6f\n", closed, closed && PMP::is_outward_oriented(mesh), pairs.size(),
    closed ? PMP::volume(mesh) : 0);
  return 0;
}
