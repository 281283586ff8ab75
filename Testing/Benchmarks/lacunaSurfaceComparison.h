// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangles and their distance to a complete shape, for the benchmark of closed surfaces.
#ifndef lacunaSurfaceComparison_h
#define lacunaSurfaceComparison_h

#include "vtkLacunaIncompleteShape.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace lacunaSurfaceComparison
{
using Point = std::array<double, 3>;

struct Mesh
{
  std::vector<Point> Points;
  std::vector<std::array<vtkIdType, 3>> Triangles;

  vtkSmartPointer<vtkPolyData> GetPolyData() const
  {
    auto data = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Point& p : this->Points)
    {
      points->InsertNextPoint(p.data());
    }
    vtkNew<vtkCellArray> cells;
    for (const auto& t : this->Triangles)
    {
      cells->InsertNextCell(3, t.data());
    }
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
  }

  static Mesh From(vtkPolyData* data)
  {
    Mesh mesh;
    mesh.Points.resize(data->GetNumberOfPoints());
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
    {
      data->GetPoint(i, mesh.Points[i].data());
    }
    vtkNew<vtkIdList> ids;
    for (vtkIdType i = 0; i < data->GetNumberOfCells(); ++i)
    {
      data->GetCellPoints(i, ids);
      mesh.Triangles.push_back({ ids->GetId(0), ids->GetId(1), ids->GetId(2) });
    }
    return mesh;
  }

  /// Twice the triangle's area, along its normal.
  Point GetNormal(const std::array<vtkIdType, 3>& t) const
  {
    Point a;
    Point b;
    Point normal;
    vtkMath::Subtract(this->Points[t[1]], this->Points[t[0]], a);
    vtkMath::Subtract(this->Points[t[2]], this->Points[t[0]], b);
    vtkMath::Cross(a.data(), b.data(), normal.data());
    return normal;
  }

  double GetVolume() const
  {
    double volume = 0;
    for (const auto& t : this->Triangles)
    {
      volume += vtkMath::Dot(this->Points[t[0]].data(), this->GetNormal(t).data()) / 6;
    }
    return std::abs(volume);
  }

  /// Whether each edge has as many triangles on one side as on the other.
  bool IsClosed() const
  {
    std::map<std::pair<vtkIdType, vtkIdType>, int> edges;
    for (const auto& t : this->Triangles)
    {
      for (int corner = 0; corner < 3; ++corner)
      {
        const vtkIdType a = t[corner];
        const vtkIdType b = t[(corner + 1) % 3];
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
    return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; });
  }

  /// Takes the offset of a wrap away again.
  void MoveInwards(double distance)
  {
    std::vector<Point> normals(this->Points.size(), Point{ 0, 0, 0 });
    for (const auto& t : this->Triangles)
    {
      const Point normal = this->GetNormal(t);
      for (const vtkIdType i : t)
      {
        vtkMath::Add(normals[i].data(), normal.data(), normals[i].data());
      }
    }
    for (std::size_t i = 0; i < normals.size(); ++i)
    {
      vtkMath::Normalize(normals[i].data());
      for (int c = 0; c < 3; ++c)
      {
        this->Points[i][c] -= distance * normals[i][c];
      }
    }
  }
};

/// The largest and the mean distance of a mesh's triangles.
struct Distances
{
  double Mean;
  double Largest;

  Distances(const Mesh& mesh, const std::function<double(const Point&)>& distance)
  {
    double sum = 0;
    double area = 0;
    this->Largest = 0;
    for (const auto& t : mesh.Triangles)
    {
      Point middle;
      for (int c = 0; c < 3; ++c)
      {
        middle[c] = (mesh.Points[t[0]][c] + mesh.Points[t[1]][c] + mesh.Points[t[2]][c]) / 3;
      }
      const double weight = vtkMath::Norm(mesh.GetNormal(t).data());
      const double d = distance(middle);
      sum += weight * d;
      area += weight;
      this->Largest = std::max(this->Largest, d);
    }
    this->Mean = sum / area;
  }
};

class Locator
{
public:
  explicit Locator(const Mesh& mesh)
    : Surface(mesh.GetPolyData())
  {
    this->Cells->SetDataSet(this->Surface);
    this->Cells->BuildLocator();
  }

  double GetDistance(const Point& p)
  {
    double closest[3];
    double square;
    vtkIdType id;
    int sub;
    this->Cells->FindClosestPoint(p.data(), closest, this->Cell, id, sub, square);
    return std::sqrt(square);
  }

private:
  vtkSmartPointer<vtkPolyData> Surface;
  vtkNew<vtkStaticCellLocator> Cells;
  vtkNew<vtkGenericCell> Cell;
};

struct Score
{
  double Volume = 0; ///< error, percent
  double Mean = 99;  ///< distance in voxels, the larger one of both directions
  double Largest = 99;
};

/// The complete shape, as a mesh of half a voxel's size moved onto its zeros.
class Truth
{
public:
  explicit Truth(vtkLacunaIncompleteShape* shape)
    : Complete(MakeMesh(shape))
    , Surface(Complete)
  {
  }

  Score Compare(const Mesh& mesh)
  {
    const Distances to(mesh, [&](const Point& p) { return this->Surface.GetDistance(p); });
    Locator locator(mesh);
    const Distances from(this->Complete, [&](const Point& p) { return locator.GetDistance(p); });
    return { 100 * (mesh.GetVolume() / this->Complete.GetVolume() - 1),
      std::max(to.Mean, from.Mean), std::max(to.Largest, from.Largest) };
  }

private:
  static Mesh MakeMesh(vtkLacunaIncompleteShape* shape)
  {
    int n[3];
    shape->GetDimensions(n);
    vtkNew<vtkImageData> image;
    image->SetDimensions(2 * n[0], 2 * n[1], 2 * n[2]);
    image->SetSpacing(0.5, 0.5, 0.5);
    image->SetOrigin(-0.5 * n[0] + 0.25, -0.5 * n[1] + 0.25, -0.5 * n[2] + 0.25);
    vtkNew<vtkDoubleArray> values;
    values->SetNumberOfTuples(image->GetNumberOfPoints());
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      const double* p = image->GetPoint(i);
      values->SetValue(i, shape->EvaluateDistance(p[0], p[1], p[2]));
    }
    image->GetPointData()->SetScalars(values);
    vtkNew<vtkFlyingEdges3D> contour;
    contour->SetInputData(image);
    contour->SetValue(0, 0);
    contour->Update();
    Mesh mesh = Mesh::From(contour->GetOutput());
    for (Point& p : mesh.Points)
    {
      Project(shape, p);
    }
    return mesh;
  }

  static void Project(vtkLacunaIncompleteShape* shape, Point& p)
  {
    const double step = 1e-4;
    for (int iteration = 0; iteration < 3; ++iteration)
    {
      Point gradient;
      for (int c = 0; c < 3; ++c)
      {
        Point a = p;
        Point b = p;
        a[c] += step;
        b[c] -= step;
        gradient[c] =
          (shape->EvaluateDistance(a[0], a[1], a[2]) - shape->EvaluateDistance(b[0], b[1], b[2])) /
          (2 * step);
      }
      const double square = vtkMath::Dot(gradient.data(), gradient.data());
      const double d = shape->EvaluateDistance(p[0], p[1], p[2]);
      for (int c = 0; c < 3 && square > 0.1; ++c)
      {
        p[c] -= d * gradient[c] / square;
      }
    }
  }

  Mesh Complete;
  Locator Surface;
};
}
#endif
