// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfacePoints.h"

#include "lacunaDepthMap.h"
#include "lacunaPointNormals.h"
#include "lacunaTriangleSurface.h"
#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataNormals.h"
#include "vtkStripper.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace
{
constexpr std::size_t MostOutlinePoints = 400;

std::string Describe(const lacuna::Vec3& p)
{
  std::ostringstream text;
  text << "(" << p[0] << ", " << p[1] << ", " << p[2] << ") mm";
  return text.str();
}

lacuna::Vec3 GetPoint(vtkDataSet* data, vtkIdType i)
{
  lacuna::Vec3 x;
  data->GetPoint(i, x.data());
  return x;
}

vtkDataArray* FindErrors(vtkDataSet* data, const std::string& array, const std::string& name)
{
  if (array.empty())
  {
    return nullptr;
  }
  vtkDataArray* errors = data->GetPointData()->GetArray(array.c_str());
  if (!errors || errors->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(
      "ErrorArray: " + name + " has no point array '" + array + "' of one component");
  }
  return errors;
}

// Normals that belong to points, by the name that all filters give them or as the active ones.
vtkDataArray* FindNormals(vtkDataSet* data)
{
  vtkDataArray* normals = data->GetPointData()->GetNormals();
  normals = normals ? normals : data->GetPointData()->GetArray("Normals");
  return normals && normals->GetNumberOfComponents() == 3 ? normals : nullptr;
}

// Triangles, large ones divided so that points cover them.
void MakeFine(vtkPolyData* mesh, vtkPolyData* result)
{
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(mesh);
  triangles->PassLinesOff();
  triangles->PassVertsOff();
  vtkNew<vtkAdaptiveSubdivisionFilter> fine;
  fine->SetInputConnection(triangles->GetOutputPort());
  constexpr double longest = 0.1; // edge, of the diagonal
  fine->SetMaximumEdgeLength(longest * mesh->GetLength());
  fine->SetMaximumTriangleArea(std::numeric_limits<double>::max());
  fine->SetMaximumNumberOfPasses(8);
  fine->Update();
  result->ShallowCopy(fine->GetOutput());
}

// A closed mesh whose triangles are seen from inside, or turned against each other, is mended here:
// which side is out is then certain.
void MakeMeshNormals(vtkPolyData* result)
{
  vtkNew<vtkPolyData> mesh;
  mesh->ShallowCopy(result);
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(mesh);
  normals->SplittingOff();
  normals->ConsistencyOn();
  normals->NonManifoldTraversalOff();
  normals->Update();
  result->ShallowCopy(normals->GetOutput());
  lacuna::TriangleSurface surface;
  for (vtkIdType i = 0; i < result->GetNumberOfPoints(); ++i)
  {
    surface.Points.push_back(GetPoint(result, i));
  }
  vtkNew<vtkIdList> cell;
  for (vtkIdType t = 0; t < result->GetNumberOfCells(); ++t)
  {
    result->GetCellPoints(t, cell);
    if (cell->GetNumberOfIds() == 3)
    {
      surface.Triangles.push_back({ static_cast<std::int32_t>(cell->GetId(0)),
        static_cast<std::int32_t>(cell->GetId(1)), static_cast<std::int32_t>(cell->GetId(2)) });
    }
  }
  vtkDataArray* array = result->GetPointData()->GetNormals();
  if (array && lacuna::FindTopology(surface).IsClosed() && surface.GetVolume() < 0)
  {
    for (vtkIdType i = 0; i < 3 * array->GetNumberOfTuples(); ++i)
    {
      array->SetComponent(
        i / 3, static_cast<int>(i % 3), -array->GetComponent(i / 3, static_cast<int>(i % 3)));
    }
  }
}

bool LieInPlane(const std::vector<lacuna::Vec3>& points, const lacuna::Vec3& across)
{
  double size = 0;
  double leaves = 0;
  double farthest = 0; // from the origin: coordinates have 32 bits
  for (const lacuna::Vec3& x : points)
  {
    size = std::max(size, lacuna::Norm(x - points[0]));
    leaves = std::max(leaves, std::abs(lacuna::Dot(x - points[0], across)));
    farthest = std::max(farthest, lacuna::Norm(x));
  }
  return leaves <= 1e-6 * size + std::numeric_limits<float>::epsilon() * farthest;
}

struct Outline
{
  std::vector<lacuna::Vec3> Points;
  std::vector<vtkIdType> Ids;
  lacuna::Vec3 Across; // unit
};

// Whether an outline lies in the plane of another one and inside of it: by rays in that plane.
bool IsWithin(const Outline& inner, const Outline& outer)
{
  const lacuna::Vec3& x = inner.Points[0];
  const lacuna::Vec3& n = outer.Across;
  double size = 0;
  for (const lacuna::Vec3& p : outer.Points)
  {
    size = std::max(size, lacuna::Norm(p - outer.Points[0]));
  }
  constexpr double parallel = 0.999;
  constexpr double same = 1e-3; // of the size
  if (std::abs(lacuna::Dot(n, inner.Across)) < parallel ||
    std::abs(lacuna::Dot(x - outer.Points[0], n)) > same * size)
  {
    return false;
  }
  const lacuna::Vec3 axis =
    std::abs(n[0]) < 0.7 ? lacuna::Vec3{ 1, 0, 0 } : lacuna::Vec3{ 0, 1, 0 };
  const lacuna::Vec3 u = lacuna::Normalized(lacuna::Cross(n, axis));
  const lacuna::Vec3 v = lacuna::Cross(n, u);
  bool inside = false;
  for (std::size_t i = 0; i < outer.Points.size(); ++i)
  {
    const lacuna::Vec3 a = outer.Points[i] - x;
    const lacuna::Vec3 b = outer.Points[(i + 1) % outer.Points.size()] - x;
    const double av = lacuna::Dot(a, v);
    const double bv = lacuna::Dot(b, v);
    if ((av > 0) != (bv > 0))
    {
      const double t = av / (av - bv);
      inside = inside != (lacuna::Dot(a, u) + t * lacuna::Dot(b - a, u) > 0);
    }
  }
  return inside;
}

void LeaveOutRepeated(std::vector<lacuna::Vec3>& points, std::vector<vtkIdType>& ids)
{
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto less = [&](std::size_t a, std::size_t b)
  {
    return std::lexicographical_compare(
      points[a].data(), points[a].data() + 3, points[b].data(), points[b].data() + 3);
  };
  std::stable_sort(order.begin(), order.end(), less);
  order.erase(std::unique(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return points[a] == points[b]; }),
    order.end());
  if (order.size() < 2)
  {
    return; // all in one place: said elsewhere
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    points[i] = points[order[i]];
    ids[i] = ids[order[i]];
  }
  points.resize(order.size());
  ids.resize(order.size());
}

// Normal of the plane through a closed line by its area (Newell), of that length.
lacuna::Vec3 GetAreaVector(const std::vector<lacuna::Vec3>& loop)
{
  lacuna::Vec3 area{};
  for (std::size_t i = 0; i < loop.size(); ++i)
  {
    area = area + 0.5 * lacuna::Cross(loop[i] - loop[0], loop[(i + 1) % loop.size()] - loop[0]);
  }
  return area;
}

// A line without points that repeat the one before. A closed one ends where it starts.
Outline ReadOutline(vtkPolyData* lines, vtkIdType number, const std::string& name)
{
  Outline outline;
  vtkNew<vtkIdList> cell;
  lines->GetCellPoints(number, cell);
  for (vtkIdType k = 0; k < cell->GetNumberOfIds(); ++k)
  {
    const lacuna::Vec3 x = GetPoint(lines, cell->GetId(k));
    if (!lacuna::IsFinite(x))
    {
      throw std::runtime_error("a point of an outline of " + name + " is not finite");
    }
    if (outline.Points.empty() || !(x == outline.Points.back()))
    {
      outline.Points.push_back(x);
      outline.Ids.push_back(cell->GetId(k));
    }
  }
  return outline;
}

// Leaves MostOutlinePoints and the last: the hand's errors are alike from point to point.
void ThinOut(Outline& outline)
{
  std::vector<lacuna::Vec3>& loop = outline.Points;
  std::vector<vtkIdType>& ids = outline.Ids;
  if (loop.size() > MostOutlinePoints)
  {
    const std::size_t step = (loop.size() + MostOutlinePoints - 1) / MostOutlinePoints;
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 1 < loop.size(); i += step, ++kept)
    {
      loop[kept] = loop[i];
      ids[kept] = ids[i];
    }
    loop[kept] = loop.back();
    ids[kept] = ids.back();
    loop.resize(kept + 1);
    ids.resize(kept + 1);
  }
}

// Takes away the point that repeats the first, and finds Across. Throws when it is no outline of an area.
void CloseOutline(Outline& outline, const std::string& name)
{
  std::vector<lacuna::Vec3>& loop = outline.Points;
  if (loop.size() < 4 || !(loop.front() == loop.back()))
  {
    throw std::runtime_error("an outline of " + name + " that starts at " +
      Describe(loop.empty() ? lacuna::Vec3{} : loop.front()) +
      " is not closed, or has fewer than 3 points; join its ends");
  }
  loop.pop_back();
  const lacuna::Vec3 area = GetAreaVector(loop);
  outline.Across = lacuna::Normalized(area);
  double size = 0;
  double leaves = 0;
  for (const lacuna::Vec3& x : loop)
  {
    size = std::max(size, lacuna::Norm(x - loop[0]));
    leaves = std::max(leaves, std::abs(lacuna::Dot(x - loop[0], outline.Across)));
  }
  constexpr double flatness = 0.05;
  if (!(lacuna::Norm(area) > 1e-6 * size * size))
  {
    throw std::runtime_error("an outline of " + name + " that starts at " + Describe(loop[0]) +
      " encloses no area: it crosses itself, or goes back on its way; split it where it crosses");
  }
  if (leaves > flatness * size)
  {
    throw std::runtime_error("an outline of " + name + " that starts at " + Describe(loop[0]) +
      " does not lie in a plane (it leaves it by " + std::to_string(leaves) +
      " mm); outlines must be planar, and those of different planes must not share points");
  }
}
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::AddPoint(
  const double* x, const lacuna::Vec3& normal, const lacuna::Vec3& free, double error)
{
  if (!(error > 0) || !std::isfinite(error))
  {
    throw std::runtime_error("ErrorArray: '" + this->ErrorArray + "' is " + std::to_string(error) +
      " at " + Describe({ x[0], x[1], x[2] }) + "; it must be a finite number above 0");
  }
  this->Data.Points.push_back({ x[0], x[1], x[2] });
  this->Data.Normals.push_back(lacuna::Normalized(normal));
  this->Data.Free.push_back(free);
  this->Data.Errors.push_back(error);
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::AddSide(const lacuna::Vec3& place, double side, const std::string& name)
{
  if (!std::isfinite(side))
  {
    throw std::runtime_error("SideArray of " + name + " is not a finite number at " +
      Describe(place) + "; it must be below 0 inside, 0 on the surface and above 0 outside");
  }
  (side < 0 ? this->Inside : this->Outside).push_back(place);
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::RefuseSides(vtkDataSet* data, const std::string& name) const
{
  vtkDataArray* sides =
    this->SideArray.empty() ? nullptr : data->GetPointData()->GetArray(this->SideArray.c_str());
  double range[2] = { 0, 0 };
  if (sides)
  {
    sides->GetRange(range);
  }
  if (range[0] != 0 || range[1] != 0)
  {
    throw std::runtime_error("SideArray of " + name +
      " is not 0, but the input is a mesh, an outline or a depth map, which lies on the surface; "
      "give "
      "places inside or outside as points of their own");
  }
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::Add(lacuna::Execution& execution, vtkDataSet* data, int number)
{
  const std::string name = "input " + std::to_string(number);
  if (!data || data->GetNumberOfPoints() == 0)
  {
    this->Warnings.push_back(name + " has no points and does not count");
    return;
  }
  auto* poly = vtkPolyData::SafeDownCast(data);
  const bool isMap = vtkImageData::SafeDownCast(data) != nullptr;
  if (isMap || (poly && poly->GetNumberOfCells() > poly->GetNumberOfVerts()))
  {
    this->RefuseSides(data, name);
  }
  vtkDataArray* errors = FindErrors(data, this->ErrorArray, name);
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    this->AddMap(image, errors);
    return;
  }
  if (poly && poly->GetNumberOfPolys() + poly->GetNumberOfStrips() > 0)
  {
    vtkNew<vtkPolyData> mesh;
    const bool hasNormals = FindNormals(poly);
    MakeFine(poly, mesh);
    if (!hasNormals)
    {
      MakeMeshNormals(mesh);
    }
    this->AddPoints(execution, mesh, name, FindErrors(mesh, this->ErrorArray, name), !hasNormals);
  }
  else if (poly && poly->GetNumberOfLines() > 0)
  {
    this->AddOutlines(poly, name, errors);
  }
  else
  {
    this->AddPoints(execution, data, name, errors, false);
  }
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::AddMap(vtkImageData* image, vtkDataArray* errors)
{
  const lacuna::DepthMap map(image);
  vtkDataArray* normals = image->GetPointData()->GetArray(lacuna::DepthMap::NormalsName);
  if (!normals || normals->GetNumberOfComponents() != 3)
  {
    throw std::runtime_error("the depth map has no point array 'Normals' of 3 components; use the "
                             "output of B-Spline Iso Ray Caster, or apply Depth Map Shader");
  }
  const int* extent = image->GetExtent();
  vtkIdType i = 0;
  for (int row = extent[2]; row <= extent[3]; ++row)
  {
    for (int column = extent[0]; column <= extent[1]; ++column, ++i)
    {
      const double depth = map.GetDepth()->GetComponent(i, 0);
      lacuna::Vec3 normal;
      normals->GetTuple(i, normal.data());
      if (std::isfinite(depth) && lacuna::HasDirection(normal))
      {
        this->AddPoint(map.GetPoint(column, row, depth).data(), normal, {},
          errors ? errors->GetComponent(i, 0) : 1);
      }
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::AddPoints(lacuna::Execution& execution, vtkDataSet* data,
  const std::string& name, vtkDataArray* errors, bool someWithout)
{
  vtkDataArray* normals = FindNormals(data);
  std::vector<vtkIdType> ids;
  std::vector<lacuna::Vec3> points;
  this->FindPlaces(data, name, ids, points);
  if (!normals)
  {
    LeaveOutRepeated(points, ids); // which would be all the neighbours there are
  }
  if (points.empty())
  {
    return;
  }
  std::vector<lacuna::Vec3> estimated;
  if (!normals)
  {
    estimated = this->EstimateNormals(execution, points, name);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    lacuna::Vec3 normal = normals ? lacuna::Vec3{} : estimated[i];
    if (normals)
    {
      normals->GetTuple(ids[i], normal.data());
      if (!lacuna::HasDirection(normal) && someWithout)
      {
        continue; // in no triangle that has an area
      }
      if (!lacuna::HasDirection(normal))
      {
        throw std::runtime_error("the normal of point " + std::to_string(ids[i]) + " of " + name +
          " at " + Describe(points[i]) +
          " is zero or not finite; remove the point, or the array of "
          "normals");
      }
    }
    this->AddPoint(points[i].data(), normal, {}, errors ? errors->GetComponent(ids[i], 0) : 1);
  }
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::FindPlaces(vtkDataSet* data, const std::string& name,
  std::vector<vtkIdType>& ids, std::vector<lacuna::Vec3>& points)
{
  vtkDataArray* sides =
    this->SideArray.empty() ? nullptr : data->GetPointData()->GetArray(this->SideArray.c_str());
  if (sides && sides->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("SideArray: '" + this->SideArray + "' of " + name + " has " +
      std::to_string(sides->GetNumberOfComponents()) + " components; it must have one");
  }
  this->HasSides = this->HasSides || sides;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    const lacuna::Vec3 x = GetPoint(data, i);
    if (!lacuna::IsFinite(x))
    {
      throw std::runtime_error("point " + std::to_string(i) + " of " + name +
        " has a coordinate that is not a finite number; remove it (Threshold, or Clean to Grid)");
    }
    const double side = sides ? sides->GetComponent(i, 0) : 0;
    if (side != 0)
    {
      this->AddSide(x, side, name);
      continue;
    }
    ids.push_back(i);
    points.push_back(x);
  }
}

//------------------------------------------------------------------------------
std::vector<lacuna::Vec3> lacuna::SurfacePoints::EstimateNormals(
  lacuna::Execution& execution, const std::vector<lacuna::Vec3>& points, const std::string& name)
{
  if (std::all_of(
        points.begin(), points.end(), [&](const lacuna::Vec3& x) { return x == points[0]; }))
  {
    throw std::runtime_error("all points of " + name + " lie in one place, at " +
      Describe(points[0]) + "; check the coordinates and what made them");
  }
  lacuna::PointNormals estimated = lacuna::EstimateNormals(execution, points);
  this->HasEstimatedNormals = true;
  if (2 * estimated.Linear > static_cast<std::int64_t>(points.size()))
  {
    throw std::runtime_error("most points of " + name + " lie on lines (one at " +
      Describe(estimated.LinearAt) +
      "), so that normals cannot be estimated; give the points normals, or join those of "
      "outlines "
      "to closed polylines");
  }
  if (LieInPlane(points, estimated.Normals[0]))
  {
    throw std::runtime_error("the points of " + name +
      " lie in one plane, so that they do not say where the solid is; give them normals, or join "
      "those of an outline to a closed polyline");
  }
  if (estimated.Conflicts > 0)
  {
    this->Warnings.push_back("the sides of " + name + " are not certain at " +
      std::to_string(estimated.Conflicts) + " pairs of neighbouring points, first at " +
      Describe(estimated.ConflictAt) +
      ": the points are too sparse there, or sheets come too close; give the points normals");
  }
  if (estimated.Parts > 1)
  {
    this->Warnings.push_back(name + " has " + std::to_string(estimated.Parts) +
      " parts that do not touch; each was oriented for itself. Give the points normals if a part "
      "is inside out");
  }
  return std::move(estimated.Normals);
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::AddOutlines(
  vtkPolyData* lines, const std::string& name, vtkDataArray* errors)
{
  vtkNew<vtkPolyData> only;
  only->SetPoints(lines->GetPoints());
  only->SetLines(lines->GetLines());
  vtkNew<vtkStripper> joined;
  joined->SetInputData(only);
  joined->JoinContiguousSegmentsOn();
  joined->Update();
  vtkPolyData* loops = joined->GetOutput();
  std::vector<Outline> closed;
  for (vtkIdType c = 0; c < loops->GetNumberOfLines(); ++c)
  {
    closed.push_back(ReadOutline(loops, c, name));
    ThinOut(closed.back());
    CloseOutline(closed.back(), name);
  }
  for (const Outline& outline : closed)
  {
    const std::vector<lacuna::Vec3>& loop = outline.Points;
    // within another one of its plane it is the rim of a cavity
    const auto within = std::count_if(closed.begin(), closed.end(),
      [&](const Outline& other) { return &other != &outline && IsWithin(outline, other); });
    const double sign = within % 2 == 0 ? 1 : -1;
    const std::size_t n = loop.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      // the tangent of the circle through three points
      const lacuna::Vec3 before = loop[i] - loop[(i + n - 1) % n];
      const lacuna::Vec3 after = loop[(i + 1) % n] - loop[i];
      const double a = lacuna::Norm(before);
      const double b = lacuna::Norm(after);
      const lacuna::Vec3 tangent = (b / a) * before + (a / b) * after;
      const lacuna::Vec3 normal = sign * lacuna::Cross(tangent, outline.Across);
      this->AddPoint(loop[i].data(), normal, outline.Across,
        errors ? errors->GetComponent(outline.Ids[i], 0) : 1);
    }
  }
  this->HasOutlines = true;
}

//------------------------------------------------------------------------------
void lacuna::SurfacePoints::Check() const
{
  if (!this->SideArray.empty() && !this->HasSides)
  {
    throw std::runtime_error(
      "SideArray: no input of points has a point array '" + this->SideArray + "' of one component");
  }
  const bool onlyOutlines = std::all_of(this->Data.Free.begin(), this->Data.Free.end(),
    [](const lacuna::Vec3& across) { return lacuna::HasDirection(across); });
  if (this->HasOutlines && onlyOutlines && LieInPlane(this->Data.Points, this->Data.Free[0]))
  {
    throw std::runtime_error("all outlines lie in one plane, at " + Describe(this->Data.Points[0]) +
      ", so that the solid has no height; add outlines in other planes");
  }
}

//------------------------------------------------------------------------------
std::array<double, 6> lacuna::SurfacePoints::GetBounds() const
{
  const Vec3& first = this->Data.Points[0];
  std::array<double, 6> bounds{ first[0], first[0], first[1], first[1], first[2], first[2] };
  for (const std::vector<Vec3>* list : { &this->Data.Points, &this->Inside })
  {
    for (const Vec3& x : *list)
    {
      for (int c = 0; c < 3; ++c)
      {
        bounds[2 * c] = std::min(bounds[2 * c], x[c]);
        bounds[2 * c + 1] = std::max(bounds[2 * c + 1], x[c]);
      }
    }
  }
  return bounds;
}

//------------------------------------------------------------------------------
double lacuna::SurfacePoints::FindSpacing(Execution& execution) const
{
  std::vector<Vec3> points = this->Data.Points;
  std::sort(points.begin(), points.end(),
    [](const Vec3& a, const Vec3& b)
    { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return FindPointSpacing(execution, points);
}
