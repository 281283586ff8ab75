// SPDX-License-Identifier: BSD-3-Clause
// CGAL's reconstructions of surfaces, for surface_peers.py, which compiles this where CGAL is installed.
//   poisson IN.ply OUT.ply EDGE DISTANCE   points with normals; triangles' edges and distance, mm
//   front IN.ply OUT.ply                   advancing front: the points are the mesh's
//   normals IN.ply OUT.ply NEIGHBOURS      points with normals by principal components, spanning tree
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/read_points.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oriented = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Cloud = std::vector<Oriented>;
const CGAL::First_of_pair_property_map<Oriented> Places;
const CGAL::Second_of_pair_property_map<Oriented> Normals;

bool WriteMesh(const std::string& path, const std::vector<Kernel::Point_3>& points,
  const std::vector<std::array<std::size_t, 3>>& triangles)
{
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file)
  {
    return false;
  }
  std::fprintf(file,
    "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\nproperty double y\n"
    "property double z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
    points.size(), triangles.size());
  for (const auto& p : points)
  {
    std::fprintf(file, "%.9g %.9g %.9g\n", p.x(), p.y(), p.z());
  }
  for (const auto& t : triangles)
  {
    std::fprintf(file, "3 %zu %zu %zu\n", t[0], t[1], t[2]);
  }
  return std::fclose(file) == 0;
}

bool Poisson(const Cloud& cloud, const std::string& out, double edge, double distance)
{
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  // an equilateral triangle's edge is the square root of 3 times the radius of its circle
  if (!CGAL::poisson_surface_reconstruction_delaunay(
        cloud.begin(), cloud.end(), Places, Normals, mesh, 1.0, 20.0, edge / 1.7320508, distance))
  {
    return false;
  }
  std::vector<Kernel::Point_3> points;
  for (const auto vertex : mesh.vertices())
  {
    points.push_back(mesh.point(vertex));
  }
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto face : mesh.faces())
  {
    std::array<std::size_t, 3> triangle{};
    int corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
    {
      triangle[corner++ % 3] = vertex.idx();
    }
    triangles.push_back(triangle);
  }
  return WriteMesh(out, points, triangles);
}

bool Front(const Cloud& cloud, const std::string& out)
{
  std::vector<Kernel::Point_3> points;
  for (const Oriented& p : cloud)
  {
    points.push_back(p.first);
  }
  std::vector<std::array<std::size_t, 3>> triangles;
  CGAL::advancing_front_surface_reconstruction(
    points.begin(), points.end(), std::back_inserter(triangles));
  return WriteMesh(out, points, triangles);
}

bool EstimateNormals(Cloud cloud, const std::string& out, unsigned int neighbors)
{
  const auto parameters = CGAL::parameters::point_map(Places).normal_map(Normals);
  CGAL::pca_estimate_normals<CGAL::Sequential_tag>(cloud, neighbors, parameters);
  cloud.erase(CGAL::mst_orient_normals(cloud, neighbors, parameters), cloud.end());
  std::FILE* file = std::fopen(out.c_str(), "w");
  if (!file)
  {
    return false;
  }
  std::fprintf(file,
    "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\nproperty double y\n"
    "property double z\nproperty double nx\nproperty double ny\nproperty double nz\nend_header\n",
    cloud.size());
  for (const auto& [p, n] : cloud)
  {
    std::fprintf(file, "%.9g %.9g %.9g %.9g %.9g %.9g\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
  return std::fclose(file) == 0;
}
}

int main(int argc, char* argv[])
{
  const std::string task = argc > 3 ? argv[1] : "";
  Cloud cloud;
  if (task.empty() ||
    !CGAL::IO::read_points(
      argv[2], std::back_inserter(cloud), CGAL::parameters::point_map(Places).normal_map(Normals)))
  {
    std::fprintf(stderr, "surface_peers_cgal poisson|front|normals IN.ply OUT.ply [...]\n");
    return EXIT_FAILURE;
  }
  const auto number = [&](int i, double otherwise)
  { return argc > i ? std::atof(argv[i]) : otherwise; };
  const bool done = task == "poisson" ? Poisson(cloud, argv[3], number(4, 1), number(5, 0.02))
    : task == "front"                 ? Front(cloud, argv[3])
    : task == "normals" ? EstimateNormals(cloud, argv[3], static_cast<unsigned int>(number(4, 18)))
                        : false;
  return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
