// SPDX-License-Identifier: BSD-3-Clause
// Occlusion Surface, one parameter set, beside CGAL's alpha wraps and Poisson reconstruction, for
// each case with the settings that come nearest to the truth, on the same voxels of closed shapes
// of which most is missing. Prints errors in voxels.
//
//   BenchmarkClosedSurfaces [case ...]   (default: all of sphere90 cube60 cube20 kumara kumara_noise)
//
// The peers get what they need and the filter does not: estimated normals (Poisson), outliers
// removed, the offset of the wrap taken away again.
#include "lacunaSurfaceComparison.h"
#include "vtkLacunaIncompleteShape.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkLacunaOcclusionSurface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>
#include <CGAL/remove_outliers.h>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

using namespace lacunaSurfaceComparison;

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oriented = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Cloud = std::vector<Oriented>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
const CGAL::First_of_pair_property_map<Oriented> Places;
const CGAL::Second_of_pair_property_map<Oriented> Normals;

Mesh ToMesh(const SurfaceMesh& surface)
{
  Mesh mesh;
  std::vector<vtkIdType> id(surface.number_of_vertices() + surface.number_of_removed_vertices());
  for (const auto vertex : surface.vertices())
  {
    const auto& p = surface.point(vertex);
    id[vertex] = static_cast<vtkIdType>(mesh.Points.size());
    mesh.Points.push_back({ p.x(), p.y(), p.z() });
  }
  for (const auto face : surface.faces())
  {
    std::array<vtkIdType, 3> triangle{};
    int corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(surface.halfedge(face), surface))
    {
      triangle[corner++ % 3] = id[vertex];
    }
    mesh.Triangles.push_back(triangle);
  }
  return mesh;
}

/// Runs that are compared, the best one of them kept.
class Trials
{
public:
  Trials(std::string method, Truth& truth)
    : Method(std::move(method))
    , Complete(truth)
  {
  }

  void Add(const std::string& settings, const std::function<Mesh()>& reconstruct)
  {
    const std::clock_t start = std::clock();
    const Mesh mesh = reconstruct();
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (mesh.Triangles.size() < 10)
    {
      return;
    }
    const Score score = this->Complete.Compare(mesh);
    if (score.Mean < this->Best.Mean)
    {
      this->Best = score;
      this->Settings = settings;
      this->Seconds = seconds;
    }
  }

  void Print() const
  {
    if (this->Settings.empty())
    {
      std::printf("  %-22s no surface\n", this->Method.c_str());
      return;
    }
    std::printf("  %-22s volume %+6.2f %%, mean %.3f, largest %.2f voxels, %.1f s (%s)\n",
      this->Method.c_str(), this->Best.Volume, this->Best.Mean, this->Best.Largest, this->Seconds,
      this->Settings.c_str());
    std::fflush(stdout);
  }

private:
  std::string Method;
  Truth& Complete;
  Score Best;
  std::string Settings;
  double Seconds = 0;
};

Mesh Poisson(Cloud cloud, unsigned int neighbors)
{
  const auto parameters = CGAL::parameters::point_map(Places).normal_map(Normals);
  CGAL::pca_estimate_normals<CGAL::Sequential_tag>(cloud, neighbors, parameters);
  cloud.erase(CGAL::mst_orient_normals(cloud, neighbors, parameters), cloud.end());
  const double spacing = CGAL::compute_average_spacing<CGAL::Sequential_tag>(
    cloud, 6, CGAL::parameters::point_map(Places));
  SurfaceMesh surface;
  const bool done = CGAL::poisson_surface_reconstruction_delaunay(
    cloud.begin(), cloud.end(), Places, Normals, surface, spacing, 20, 20, 0.25);
  return done ? ToMesh(surface) : Mesh();
}

Mesh Wrap(const Cloud& cloud, double alpha, double offset)
{
  std::vector<Kernel::Point_3> points;
  for (const Oriented& p : cloud)
  {
    points.push_back(p.first);
  }
  SurfaceMesh surface;
  CGAL::alpha_wrap_3(points, alpha, offset, surface);
  Mesh mesh = ToMesh(surface);
  mesh.MoveInwards(offset);
  return mesh;
}

Mesh Refine(vtkLacunaIncompleteShape* shape)
{
  // lacuna.occlusion.GROW_AND_SNAP
  const double thresholds[] = { 0.32, 0.32, 2.67, 3.92, 3.92, 2.69, 2.69, 2.69, 2.69, 2.69, 2.69,
    2.52, 2.52, 2.52 };
  const double radii[] = { 1.5, 1.5, 0, 1.5, 1.5, 0, 0, 0, 0, 0, 0, 0, 0, 0 };
  vtkNew<vtkLacunaOccludedAngle> angle;
  angle->SetInputConnection(shape->GetOutputPort());
  angle->SetNumberOfDirections(200);
  angle->SetKeepData(true);
  angle->SetNumberOfThresholdsOverPi(14);
  angle->SetNumberOfLocalRadii(14);
  for (int i = 0; i < 14; ++i)
  {
    angle->SetThresholdsOverPi(i, thresholds[i]);
    angle->SetLocalRadii(i, radii[i]);
  }
  vtkNew<vtkLacunaOcclusionSurface> surface;
  surface->SetInputConnection(angle->GetOutputPort());
  surface->SetDataConnection(shape->GetOutputPort());
  surface->Update();
  return Mesh::From(surface->GetOutput());
}

void Run(const std::string& name, vtkLacunaIncompleteShape* shape)
{
  shape->Update();
  vtkImageData* image = shape->GetOutput();
  vtkDataArray* data = image->GetPointData()->GetScalars();
  Cloud cloud;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    if (data->GetTuple1(i) > 0)
    {
      const double* p = image->GetPoint(i);
      cloud.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), Kernel::Vector_3(0, 0, 0));
    }
  }
  std::printf("%s, %zu voxels\n", name.c_str(), cloud.size());
  Truth truth(shape);
  Trials ours("Occlusion Surface", truth);
  ours.Add("defaults", [&] { return Refine(shape); });
  ours.Print();
  const bool outliers = shape->GetOutlierFraction() > 0;
  for (const bool cleaned : { false, true })
  {
    if (cleaned && !outliers)
    {
      break;
    }
    const std::string suffix = cleaned ? ", cleaned" : "";
    if (cleaned)
    {
      cloud.erase(CGAL::remove_outliers<CGAL::Sequential_tag>(
                    cloud, 8, CGAL::parameters::point_map(Places).threshold_percent(2.)),
        cloud.end());
    }
    if (cleaned || !outliers) // else CGAL 5.5's Poisson reconstruction crashes
    {
      Trials poisson("Poisson" + suffix, truth);
      for (const unsigned int neighbors : { 8U, 12U, 18U, 30U })
      {
        poisson.Add(
          std::to_string(neighbors) + " neighbours", [&] { return Poisson(cloud, neighbors); });
      }
      poisson.Print();
    }
    Trials wraps("alpha wrap" + suffix, truth);
    for (const double alpha : { 3.0, 5.0, 8.0, 12.0 })
    {
      for (const double offset : { 0.2, 0.5 })
      {
        char settings[64];
        std::snprintf(settings, sizeof settings, "alpha %.0f, offset %.1f", alpha, offset);
        wraps.Add(settings, [&] { return Wrap(cloud, alpha, offset); });
      }
    }
    wraps.Print();
  }
}

vtkSmartPointer<vtkLacunaIncompleteShape> MakeShape(
  int kind, std::array<int, 3> dimensions, double present)
{
  auto shape = vtkSmartPointer<vtkLacunaIncompleteShape>::New();
  shape->SetShape(kind);
  shape->SetDimensions(dimensions.data());
  shape->SetPresentFraction(present);
  return shape;
}
}

int main(int argc, char* argv[])
{
  using Shape = vtkLacunaIncompleteShape;
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  std::vector<std::pair<std::string, vtkSmartPointer<Shape>>> cases{
    { "sphere90", MakeShape(Shape::SPHERE, { 65, 65, 65 }, 0.1) },
    { "cube60", MakeShape(Shape::CUBE, { 84, 84, 84 }, 0.1) },
    { "cube20", MakeShape(Shape::CUBE, { 44, 44, 44 }, 0.1) },
    { "kumara", MakeShape(Shape::KUMARA, { 105, 75, 53 }, 0.4) },
    { "kumara_noise", MakeShape(Shape::KUMARA, { 105, 75, 53 }, 0.4) }
  };
  for (int i : { 3, 4 })
  {
    cases[i].second->SetPatches(true);
    cases[i].second->SetPatchRadii(2, 5);
  }
  cases[4].second->SetOutlierFraction(0.02);
  for (const std::string& name : wanted)
  {
    if (std::none_of(cases.begin(), cases.end(), [&](const auto& c) { return c.first == name; }))
    {
      std::fprintf(stderr, "there is no case %s\n", name.c_str());
      return EXIT_FAILURE;
    }
  }
  for (const auto& [name, shape] : cases)
  {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end())
    {
      Run(name, shape);
    }
  }
  return EXIT_SUCCESS;
}
