// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantData.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCleanPolyData.h"
#include "vtkDelaunay2D.h"
#include "vtkDoubleArray.h"
#include "vtkFeatureEdges.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVectorText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
std::vector<Vec3> GetPoints(const SkullRays& rays)
{
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
  {
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      points.push_back(rays.Center + rays.Outer[i] * rays.Directions[i]);
    }
  }
  return points;
}

void AddArray(vtkPolyData* output, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  output->GetPointData()->AddArray(array);
}

// Closed polylines of the edges that bound letters.
std::vector<Loop> GetBoundaries(const std::string& text)
{
  vtkNew<vtkVectorText> letters;
  letters->SetText(text.c_str());
  vtkNew<vtkCleanPolyData> clean; // triangles of a letter share no points
  clean->SetInputConnection(letters->GetOutputPort());
  clean->ToleranceIsAbsoluteOn();
  clean->SetAbsoluteTolerance(1e-5);
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputConnection(clean->GetOutputPort());
  edges->FeatureEdgesOff();
  edges->NonManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  vtkPolyData* found = edges->GetOutput();
  std::map<vtkIdType, std::vector<vtkIdType>> next;
  for (vtkIdType c = 0; c < found->GetNumberOfCells(); ++c)
  {
    vtkIdList* ends = found->GetCell(c)->GetPointIds();
    next[ends->GetId(0)].push_back(ends->GetId(1));
    next[ends->GetId(1)].push_back(ends->GetId(0));
  }
  std::vector<Loop> loops;
  while (!next.empty())
  {
    loops.emplace_back();
    vtkIdType at = next.begin()->first;
    for (auto here = next.find(at); here != next.end(); here = next.find(at))
    {
      double x[3];
      found->GetPoint(at, x);
      loops.back().push_back({ x[0], x[1] });
      const std::vector<vtkIdType> ways = here->second;
      next.erase(here);
      at = next.count(ways[0]) ? ways[0] : ways.back();
    }
  }
  return loops;
}
}

//------------------------------------------------------------------------------
std::string NameOf(const Vec3& p)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(1);
  text << std::fixed << "(" << p[0] << ", " << p[1] << ", " << p[2] << ") mm";
  return text.str();
}

//------------------------------------------------------------------------------
std::string Rounded(double value, double steps)
{
  return FormatNumber(std::round(steps * value) / steps);
}

//------------------------------------------------------------------------------
SkullHoles::SkullHoles(const SkullRays& rays, std::vector<std::vector<int>> defects)
  : Rays(rays)
  , Defects(std::move(defects))
  , Ellipsoid(rays.Center, GetPoints(rays))
{
  for (const std::vector<int>& defect : this->Defects)
  {
    Vec3 middle{ 0, 0, 0 };
    double area = 0;
    for (const int ray : defect)
    {
      middle = middle + rays.Directions[ray];
      const double radius = this->GetRadius(rays.Directions[ray]);
      area += 0.866 * rays.Spacing * rays.Spacing * radius * radius;
    }
    const Vec3 direction = Normalized(middle);
    this->Centers.push_back(rays.Center + this->GetRadius(direction) * direction);
    this->Areas.push_back(area);
  }
}

//------------------------------------------------------------------------------
double SkullHoles::GetDistance(std::size_t defect, const Vec3& point) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const int ray : this->Defects[defect])
  {
    least = std::min(least, Norm(this->GetPoint(ray) - point));
  }
  return least;
}

//------------------------------------------------------------------------------
std::string SkullHoles::GetText(std::size_t defect) const
{
  return Rounded(this->Areas[defect] / 100) + " cm^2 around " + NameOf(this->Centers[defect]);
}

//------------------------------------------------------------------------------
std::string SkullHoles::GetText() const
{
  std::string text;
  for (std::size_t k = 0; k < this->Areas.size(); ++k)
  {
    text += (k ? "; " : "") + this->GetText(k);
  }
  return text;
}

//------------------------------------------------------------------------------
void SkullHoles::SetOutput(vtkPolyData* output, int first) const
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkIntArray> numbers;
  numbers->SetName("Defect");
  std::vector<std::int64_t> corners;
  for (std::size_t k = 0; k < this->Defects.size(); ++k)
  {
    this->AddTriangles(k, points, corners);
    while (numbers->GetNumberOfTuples() < static_cast<vtkIdType>(corners.size() / 3))
    {
      numbers->InsertNextValue(first + static_cast<int>(k));
    }
  }
  vtkNew<vtkTypeInt64Array> triangles;
  lacuna::Arrays::SetNumberOfTuples(triangles, static_cast<vtkIdType>(corners.size()));
  std::copy(corners.begin(), corners.end(), triangles->GetPointer(0));
  output->SetPoints(points);
  lacuna::Arrays::SetTriangles(output, triangles);
  output->GetCellData()->SetScalars(numbers);
  std::vector<double> centers;
  for (const Vec3& c : this->Centers)
  {
    centers.insert(centers.end(), c.data(), c.data() + 3);
  }
  lacuna::FieldData::Set(output, "DefectAreas", this->Areas, 1);
  lacuna::FieldData::Set(output, "DefectCenters", centers, 3);
}

//------------------------------------------------------------------------------
double SkullHoles::GetRadius(const Vec3& direction) const
{
  const double radius = this->Ellipsoid.GetRadius(direction);
  return radius > 0 && radius < 200 ? radius : 90;
}

//------------------------------------------------------------------------------
Vec3 SkullHoles::GetPoint(int ray) const
{
  const Vec3& d = this->Rays.Directions[ray];
  return this->Rays.Center + this->GetRadius(d) * d;
}

//------------------------------------------------------------------------------
void SkullHoles::AddTriangles(
  std::size_t k, vtkPoints* points, std::vector<std::int64_t>& corners) const
{
  const Vec3 axis = Normalized(this->Centers[k] - this->Rays.Center);
  const Vec3 u =
    Normalized(Cross(axis, std::abs(axis[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
  const Vec3 v = Cross(axis, u);
  vtkNew<vtkPoints> plane;
  plane->SetDataTypeToDouble();
  std::vector<int> used;
  for (const int ray : this->Defects[k])
  {
    const Vec3& d = this->Rays.Directions[ray];
    const double height = 1 + Dot(d, axis);
    if (height > 0.2)
    {
      plane->InsertNextPoint(2 * Dot(d, u) / height, 2 * Dot(d, v) / height, 0);
      used.push_back(ray);
    }
  }
  vtkNew<vtkPolyData> given;
  given->SetPoints(plane);
  vtkNew<vtkDelaunay2D> delaunay;
  delaunay->SetInputData(given);
  delaunay->SetAlpha(2 * this->Rays.Spacing);
  delaunay->Update();
  vtkPolyData* flat = delaunay->GetOutput();
  const auto before = static_cast<std::int64_t>(points->GetNumberOfPoints());
  for (const int ray : used)
  {
    points->InsertNextPoint(this->GetPoint(ray).data());
  }
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < flat->GetNumberOfCells(); ++c)
  {
    flat->GetCellPoints(c, ids);
    if (ids->GetNumberOfIds() == 3)
    {
      for (vtkIdType corner = 0; corner < 3; ++corner)
      {
        corners.push_back(before + ids->GetId(corner));
      }
    }
  }
}

//------------------------------------------------------------------------------
std::vector<Vec3> GetCurve(vtkPolyData* data)
{
  std::vector<Vec3> curve;
  int lines = 0;
  const auto add = [&](vtkIdType point)
  {
    curve.emplace_back();
    data->GetPoint(point, curve.back().data());
  };
  for (vtkIdType c = 0; c < data->GetNumberOfCells(); ++c)
  {
    if (data->GetCellType(c) == VTK_POLY_LINE || data->GetCellType(c) == VTK_POLYGON)
    {
      vtkCell* cell = data->GetCell(c);
      for (int k = 0; k < cell->GetNumberOfPoints(); ++k)
      {
        add(cell->GetPointId(k));
      }
      ++lines;
    }
  }
  for (vtkIdType k = 0; lines == 0 && k < data->GetNumberOfPoints(); ++k)
  {
    add(k);
  }
  if (lines > 1)
  {
    throw std::runtime_error(
      "the outline has " + std::to_string(lines) + " lines: give one closed curve");
  }
  if (!std::all_of(curve.begin(), curve.end(), [](const Vec3& x) { return IsFinite(x); }))
  {
    throw std::runtime_error("a point of the outline is not finite: draw it again");
  }
  return curve;
}

//------------------------------------------------------------------------------
std::vector<Loop> GetTextOutlines(const std::string& text, double height)
{
  for (const char letter : text)
  {
    if (letter < ' ' || letter > '~')
    {
      throw std::runtime_error("the text to engrave has letters that cannot be made: use those "
                               "of English, digits and signs");
    }
  }
  if (text.find_first_not_of(' ') == std::string::npos)
  {
    return {};
  }
  const auto [low, high] = [&]
  {
    const std::vector<Loop> capital = GetBoundaries("H");
    const auto range = std::minmax_element(capital[0].begin(), capital[0].end(),
      [](const Vec2& a, const Vec2& b) { return a[1] < b[1]; });
    return std::pair((*range.first)[1], (*range.second)[1]);
  }();
  std::vector<Loop> loops = GetBoundaries(text);
  for (Loop& loop : loops)
  {
    for (Vec2& p : loop)
    {
      p = { p[0] * height / (high - low), p[1] * height / (high - low) };
    }
  }
  return loops;
}

//------------------------------------------------------------------------------
void SetCurve(vtkPolyData* output, const std::vector<Vec3>& curve)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkIdList> line;
  for (const Vec3& x : curve)
  {
    line->InsertNextId(points->InsertNextPoint(x.data()));
  }
  line->InsertNextId(0);
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(line);
  output->SetPoints(points);
  output->SetLines(lines);
}

//------------------------------------------------------------------------------
double SetTriangles(
  vtkPolyData* output, const std::vector<Vec3>& positions, std::vector<Triangle> triangles)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, static_cast<vtkIdType>(positions.size()));
  for (std::size_t k = 0; k < positions.size(); ++k)
  {
    points->SetPoint(static_cast<vtkIdType>(k), positions[k].data());
  }
  double volume = 0;
  for (const Triangle& t : triangles)
  {
    const Vec3& first = positions[0];
    volume +=
      Dot(positions[t[0]] - first, Cross(positions[t[1]] - first, positions[t[2]] - first)) / 6;
  }
  if (volume < 0)
  {
    for (Triangle& t : triangles)
    {
      std::swap(t[1], t[2]);
    }
  }
  output->SetPoints(points);
  lacuna::Arrays::SetTriangles(output, triangles);
  return std::abs(volume);
}

//------------------------------------------------------------------------------
void SetImplant(vtkPolyData* output, const SkullImplant& implant)
{
  SetTriangles(output, implant.Points, implant.Triangles);
  const auto count = static_cast<vtkIdType>(implant.Triangles.size());
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName("ImplantFace");
  lacuna::Arrays::SetNumberOfTuples(faces, count);
  for (vtkIdType k = 0; k < count; ++k)
  {
    faces->SetValue(k, static_cast<unsigned char>(implant.Faces[k]));
  }
  output->GetCellData()->AddArray(faces);
  if (!implant.Parts.empty()) // a guide has none of these
  {
    vtkNew<vtkIntArray> parts;
    parts->SetName("Part");
    lacuna::Arrays::SetNumberOfTuples(parts, count);
    std::copy(implant.Parts.begin(), implant.Parts.end(), parts->GetPointer(0));
    output->GetCellData()->AddArray(parts);
    AddArray(output, "PredictedError", implant.Errors);
    AddArray(output, "Thickness", implant.Thickness);
    AddArray(output, "ThicknessError", implant.ThicknessErrors);
    output->GetPointData()->SetActiveScalars("PredictedError");
  }
}

//------------------------------------------------------------------------------
void SetPlates(vtkPolyData* output, const SkullImplant& implant, double screwLength)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> thickness;
  thickness->SetName("BoneThickness");
  vtkNew<vtkUnsignedCharArray> isThick;
  isThick->SetName("IsThickEnough");
  vtkNew<vtkCellArray> lines;
  for (const ImplantPlateScrews& plate : implant.Plates)
  {
    const vtkIdType ends[2] = { points->InsertNextPoint(plate.OnImplant.data()),
      points->InsertNextPoint(plate.OnBone.data()) };
    lines->InsertNextCell(2, ends);
    thickness->InsertNextValue(plate.BoneThickness);
    isThick->InsertNextValue(plate.BoneThickness >= screwLength ? 1 : 0);
  }
  output->SetPoints(points);
  output->SetLines(lines);
  output->GetCellData()->SetScalars(thickness);
  output->GetCellData()->AddArray(isThick);
}
}
