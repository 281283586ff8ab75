// SPDX-License-Identifier: BSD-3-Clause
// Occlusion Surface, one parameter set, beside CGAL's alpha wraps and Poisson reconstruction and
// VTK's reconstruction after Hoppe and by signed distances, on the same voxels of closed shapes of
// which most is missing. The peers get, for each case, the settings that come nearest to the truth,
// which a label names, and what they need and the filter does not: estimated normals, outliers
// removed (_cleaned), the offset of the wrap taken away again.
//
// Counters: volume, its error in %; mean and largest, distances from the truth in voxels; seconds, s
// of processor time, of the settings that are best (the times of a row are of all that were tried,
// with their comparison); closed, 1 where no edge is open; voxels.
#include "lacunaBenchmark.h"
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
#include <vtkExtractSurface.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSignedDistance.h>
#include <vtkSmartPointer.h>
#include <vtkSurfaceReconstructionFilter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
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
  explicit Trials(Truth& truth)
    : Complete(truth)
  {
  }

  void Add(const std::string& settings, const std::function<Mesh()>& reconstruct)
  {
    const double start = lacunaBenchmark::GetProcessSeconds();
    const Mesh mesh = reconstruct();
    const double seconds = lacunaBenchmark::GetProcessSeconds() - start;
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
      this->IsClosed = mesh.IsClosed();
    }
  }

  void Report(benchmark::State& state) const
  {
    if (this->Settings.empty())
    {
      state.SkipWithError("no surface");
      return;
    }
    state.SetLabel(this->Settings);
    state.counters["volume"] = this->Best.Volume;
    state.counters["mean"] = this->Best.Mean;
    state.counters["largest"] = this->Best.Largest;
    state.counters["seconds"] = this->Seconds;
    state.counters["closed"] = this->IsClosed;
  }

private:
  Truth& Complete;
  Score Best;
  std::string Settings;
  double Seconds = 0;
  bool IsClosed = false;
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

vtkSmartPointer<vtkPolyData> ToPolyData(const Cloud& cloud)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetName("Normals");
  for (const auto& [p, n] : cloud)
  {
    points->InsertNextPoint(p.x(), p.y(), p.z());
    normals->InsertNextTuple3(n.x(), n.y(), n.z());
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->GetPointData()->SetNormals(normals);
  return data;
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

// Hoppe 1992: distances from tangent planes.
Mesh Hoppe(const Cloud& cloud, int neighbors)
{
  vtkNew<vtkSurfaceReconstructionFilter> distances;
  distances->SetInputData(ToPolyData(cloud));
  distances->SetNeighborhoodSize(neighbors);
  distances->SetSampleSpacing(1);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputConnection(distances->GetOutputPort());
  contour->SetValue(0, 0);
  contour->Update();
  return Mesh::From(contour->GetOutput());
}

Mesh SignedDistance(Cloud cloud, double radius)
{
  const auto parameters = CGAL::parameters::point_map(Places).normal_map(Normals);
  CGAL::pca_estimate_normals<CGAL::Sequential_tag>(cloud, 18, parameters);
  cloud.erase(CGAL::mst_orient_normals(cloud, 18, parameters), cloud.end());
  vtkSmartPointer<vtkPolyData> points = ToPolyData(cloud);
  double box[6];
  points->GetBounds(box);
  vtkNew<vtkSignedDistance> distances;
  distances->SetInputData(points);
  distances->SetRadius(radius);
  int size[3];
  for (int a = 0; a < 3; ++a)
  {
    box[2 * a] -= radius;
    box[2 * a + 1] += radius;
    size[a] = static_cast<int>(std::ceil(box[2 * a + 1] - box[2 * a])) + 1;
  }
  distances->SetBounds(box);
  distances->SetDimensions(size);
  vtkNew<vtkExtractSurface> surface;
  surface->SetInputConnection(distances->GetOutputPort());
  surface->SetRadius(radius);
  surface->SetHoleFilling(true);
  surface->Update();
  return Mesh::From(surface->GetOutput());
}

Cloud GetCloud(vtkLacunaIncompleteShape* shape)
{
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
  return cloud;
}

/// A shape and what is left of it.
struct Case
{
  vtkSmartPointer<vtkLacunaIncompleteShape> Shape;
  Cloud Voxels;
  Cloud Cleaned; ///< without the outliers
  std::unique_ptr<Truth> Complete;

  void Make()
  {
    if (this->Complete)
    {
      return;
    }
    this->Shape->Update();
    this->Voxels = GetCloud(this->Shape);
    this->Cleaned = this->Voxels;
    if (this->Shape->GetOutlierFraction() > 0)
    {
      this->Cleaned.erase(CGAL::remove_outliers<CGAL::Sequential_tag>(this->Cleaned, 8,
                            CGAL::parameters::point_map(Places).threshold_percent(2.)),
        this->Cleaned.end());
    }
    this->Complete = std::make_unique<Truth>(this->Shape);
  }
};

using Method = std::function<void(Trials&, Case&)>;

void Register(const std::string& name, const std::shared_ptr<Case>& shape, const Method& method)
{
  benchmark::RegisterBenchmark(name.c_str(),
    [=](benchmark::State& state)
    {
      shape->Make();
      Trials trials(*shape->Complete);
      for (auto _ : state)
      {
        method(trials, *shape);
      }
      trials.Report(state);
      state.counters["voxels"] = static_cast<double>(shape->Voxels.size());
    })
    ->Iterations(1)
    ->Apply(lacunaBenchmark::Measure);
}

void TryPoisson(Trials& trials, const Cloud& cloud)
{
  for (const unsigned int neighbors : { 8U, 12U, 18U, 30U })
  {
    trials.Add(
      std::to_string(neighbors) + " neighbours", [&] { return Poisson(cloud, neighbors); });
  }
}

void TryWraps(Trials& trials, const Cloud& cloud)
{
  for (const double alpha : { 3.0, 5.0, 8.0, 12.0 })
  {
    for (const double offset : { 0.2, 0.5 })
    {
      char settings[64];
      std::snprintf(settings, sizeof settings, "alpha %.0f, offset %.1f", alpha, offset);
      trials.Add(settings, [&] { return Wrap(cloud, alpha, offset); });
    }
  }
}

void TryHoppe(Trials& trials, const Cloud& cloud)
{
  for (const int neighbors : { 10, 20, 40 })
  {
    trials.Add(std::to_string(neighbors) + " neighbours", [&] { return Hoppe(cloud, neighbors); });
  }
}

void TrySignedDistance(Trials& trials, const Cloud& cloud)
{
  for (const double radius : { 3.0, 5.0, 8.0 })
  {
    char settings[64];
    std::snprintf(settings, sizeof settings, "radius %.0f", radius);
    trials.Add(settings, [&] { return SignedDistance(cloud, radius); });
  }
}

void RegisterAll(const std::string& name, const std::shared_ptr<Case>& shape)
{
  Register(name + "/OcclusionSurface", shape,
    [](Trials& trials, Case& c) { trials.Add("defaults", [&] { return Refine(c.Shape); }); });
  const bool outliers = shape->Shape->GetOutlierFraction() > 0;
  const std::string suffix = outliers ? "_cleaned" : "";
  // CGAL 5.5's Poisson reconstruction crashes on outliers
  Register(name + "/CGALPoisson" + suffix, shape,
    [](Trials& trials, Case& c) { TryPoisson(trials, c.Cleaned); });
  if (outliers)
  {
    Register(
      name + "/CGALAlphaWrap", shape, [](Trials& trials, Case& c) { TryWraps(trials, c.Voxels); });
  }
  Register(name + "/CGALAlphaWrap" + suffix, shape,
    [](Trials& trials, Case& c) { TryWraps(trials, c.Cleaned); });
  Register(name + "/VTKHoppe" + suffix, shape,
    [](Trials& trials, Case& c) { TryHoppe(trials, c.Cleaned); });
  Register(name + "/VTKSignedDistance" + suffix, shape,
    [](Trials& trials, Case& c) { TrySignedDistance(trials, c.Cleaned); });
}

std::shared_ptr<Case> MakeCase(int kind, std::array<int, 3> dimensions, double present)
{
  auto made = std::make_shared<Case>();
  made->Shape = vtkSmartPointer<vtkLacunaIncompleteShape>::New();
  made->Shape->SetShape(kind);
  made->Shape->SetDimensions(dimensions.data());
  made->Shape->SetPresentFraction(present);
  return made;
}
}

int main(int argc, char* argv[])
{
  using Shape = vtkLacunaIncompleteShape;
  RegisterAll("sphere90", MakeCase(Shape::Sphere, { 65, 65, 65 }, 0.1));
  RegisterAll("cube60", MakeCase(Shape::Cube, { 84, 84, 84 }, 0.1));
  RegisterAll("cube20", MakeCase(Shape::Cube, { 44, 44, 44 }, 0.1));
  for (const double outliers : { 0.0, 0.02 })
  {
    const auto kumara = MakeCase(Shape::Kumara, { 105, 75, 53 }, 0.4);
    kumara->Shape->SetPatches(true);
    kumara->Shape->SetPatchRadii(2, 5);
    kumara->Shape->SetOutlierFraction(outliers);
    RegisterAll(outliers > 0 ? "kumara_noise" : "kumara", kumara);
  }
  return lacunaBenchmark::RunRows(argc, argv);
}
