// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaImplantPlate.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaFittedPart.h"
#include "lacunaImplantPlate.h"
#include "lacunaParameterText.h"
#include "lacunaSolidMesh.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

vtkStandardNewMacro(vtkLacunaImplantPlate);

//------------------------------------------------------------------------------
vtkLacunaImplantPlate::vtkLacunaImplantPlate()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesBlocks = true;
  this->SetNumberOfInputPorts(2);
}

namespace
{
constexpr const char* BoneThicknessName = "Thickness";
constexpr double LargestTriangle = 0.5; // mm, when TriangleSize is left to the filter
constexpr double LargestLack = 0.01;    // of Thickness, between facets
constexpr int MaximumRefinements = 3;
constexpr vtkIdType MaximumMarks = 20000;

//------------------------------------------------------------------------------
// The least thickness of bone within radius of p (mm from the part's first pixel), NaN when unknown.
// The map's thickness is along the rays; the one along the axis is shorter where they are oblique.
double GetBoneThickness(
  vtkImageData* map, const lacuna::FittedPart& part, const lacuna::PlateHole& hole)
{
  vtkDataArray* thickness = map->GetPointData()->GetArray(BoneThicknessName);
  const double radius = std::max(hole.Radius, std::max(part.Spacing[0], part.Spacing[1]));
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t j = 0; j < part.Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < part.Size.Columns; ++i)
    {
      if (std::hypot(static_cast<double>(i) * part.Spacing[0] - hole.Foot[0],
            static_cast<double>(j) * part.Spacing[1] - hole.Foot[1]) > radius)
      {
        continue;
      }
      if (part.Mask[i + part.Size.Columns * j])
      {
        return 0;
      }
      if (thickness)
      {
        const vtkIdType pixel =
          part.Column + i + (part.Row + j) * static_cast<vtkIdType>(map->GetDimensions()[0]);
        const double t = thickness->GetComponent(pixel, 0);
        least = std::min(least, std::isfinite(t) ? t * std::abs(hole.Axis[2]) : 0);
      }
    }
  }
  return std::isfinite(least) ? least : std::numeric_limits<double>::quiet_NaN();
}

void Append(std::vector<double>& values, const lacuna::Vec3& v)
{
  values.insert(values.end(), v.data(), v.data() + 3);
}

//------------------------------------------------------------------------------
// One place for each cluster of points: clicks on a surface mark points, patches of them when a box
// was dragged, and corners of cells when cells were selected. Points not farther apart than distance
// belong together. Clusters are in the order of their first points.
std::vector<lacuna::Vec3> GetMarkedHoles(vtkPointSet* marks, double distance)
{
  const vtkIdType count = marks->GetNumberOfPoints();
  if (count > MaximumMarks)
  {
    throw std::runtime_error("HoleMarks has " + std::to_string(count) +
      " points, more than twenty thousand; give it the picked points only, for example by "
      "Extract Selection, not the surface they were picked on");
  }
  std::vector<lacuna::Vec3> points(static_cast<std::size_t>(count));
  for (vtkIdType k = 0; k < count; ++k)
  {
    marks->GetPoint(k, points[k].data());
  }
  std::vector<lacuna::Vec3> holes;
  std::vector<char> taken(points.size(), 0);
  std::vector<std::size_t> cluster;
  for (std::size_t first = 0; first < points.size(); ++first)
  {
    if (taken[first])
    {
      continue;
    }
    taken[first] = 1;
    cluster.assign(1, first);
    lacuna::Vec3 sum{};
    for (std::size_t i = 0; i < cluster.size(); ++i)
    {
      const lacuna::Vec3& p = points[cluster[i]];
      sum = sum + p;
      for (std::size_t k = first + 1; k < points.size(); ++k)
      {
        if (!taken[k] && lacuna::Norm(points[k] - p) <= distance)
        {
          taken[k] = 1;
          cluster.push_back(k);
        }
      }
    }
    holes.push_back((1 / static_cast<double>(cluster.size())) * sum);
  }
  return holes;
}

//------------------------------------------------------------------------------
void SetMeasures(vtkPolyData* output, const lacuna::ImplantPlate& plate, double density,
  const lacuna::Matrix4& toWorld)
{
  constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
  const bool isMeasured = std::isfinite(plate.MinimumThickness); // else all of it is edge
  const lacuna::Vec3 tightest = std::isfinite(plate.MinimumRadius)
    ? toWorld.Point(plate.MinimumRadiusPoint)
    : lacuna::Vec3{ NaN, NaN, NaN };
  lacuna::FieldData::Set(output, "Volume", { plate.Volume }, 1);
  lacuna::FieldData::Set(output, "Mass", { plate.Volume * density / 1000 }, 1);
  lacuna::FieldData::Set(output, "OuterArea", { plate.OuterArea }, 1);
  lacuna::FieldData::Set(output, "OutlineLength", { plate.Outline.Length }, 1);
  lacuna::FieldData::Set(
    output, "MinimumThickness", { isMeasured ? plate.MinimumThickness : NaN }, 1);
  lacuna::FieldData::Set(
    output, "MinimumCurvatureRadius", { isMeasured ? plate.MinimumRadius : NaN }, 1);
  lacuna::FieldData::Set(output, "TightestPoint", { tightest[0], tightest[1], tightest[2] }, 3);
}

//------------------------------------------------------------------------------
// bone: its thickness under each screw hole.
void SetHoles(vtkPolyData* output, const lacuna::ImplantPlate& plate,
  const std::vector<double>& bone, const lacuna::Matrix4& toWorld)
{
  std::vector<double> centers;
  std::vector<double> axes;
  std::vector<double> land;
  for (const lacuna::PlateHole& hole : plate.Holes)
  {
    Append(centers, toWorld.Point(hole.Centre));
    Append(axes, lacuna::Normalized(toWorld.Vector(hole.Axis)));
    land.push_back(hole.Land);
  }
  lacuna::FieldData::Set(output, "HoleCenters", centers, 3);
  lacuna::FieldData::Set(output, "HoleAxes", axes, 3);
  lacuna::FieldData::Set(output, "HoleBoneThickness", bone, 1);
  lacuna::FieldData::Set(output, "HoleLand", land, 1);
  lacuna::FieldData::Set(
    output, "DrainageHoleCount", { static_cast<double>(plate.DrainageHoles) }, 1);
}
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::AddHolePoint(double x, double y, double z)
{
  this->HolePoints.push_back({ x, y, z });
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::RemoveAllHolePoints()
{
  if (!this->HolePoints.empty())
  {
    this->HolePoints.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkLacunaImplantPlate::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkPointSet");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
lacuna::ImplantPlateOptions vtkLacunaImplantPlate::GetOptions() const
{
  lacuna::ImplantPlateOptions options;
  options.Thickness = this->Thickness;
  options.Side = static_cast<lacuna::PlateSide>(this->Side);
  options.EdgeClearance = this->EdgeClearance;
  options.CornerRadius = this->CornerRadius;
  options.Edge = static_cast<lacuna::PlateEdge>(this->EdgeShape);
  options.EdgeSize = this->Bevel;
  options.BothFaces = this->BevelBothFaces;
  options.TriangleSize = this->TriangleSize;
  options.Hole = { this->HoleDiameter, this->CountersinkDiameter, this->CountersinkAngle };
  options.DrainageSpacing = this->DrainageSpacing;
  options.DrainageDiameter = this->DrainageDiameter;
  return options;
}

//------------------------------------------------------------------------------
std::vector<lacuna::Vec3> vtkLacunaImplantPlate::GetHoles(vtkPointSet* marks) const
{
  std::vector<lacuna::Vec3> holes;
  for (const auto& p : this->HolePoints)
  {
    holes.push_back({ p[0], p[1], p[2] });
  }
  if (marks)
  {
    const double together = std::max(this->HoleDiameter, this->CountersinkDiameter);
    const std::vector<lacuna::Vec3> marked = GetMarkedHoles(marks, together);
    holes.insert(holes.end(), marked.begin(), marked.end());
  }
  return holes;
}

//------------------------------------------------------------------------------
lacuna::ImplantPlate vtkLacunaImplantPlate::MakePlate(const lacuna::FittedPart& part,
  lacuna::ImplantPlateOptions& options, lacuna::AlgorithmExecution& execution)
{
  execution.SetStage(0, 0.1);
  const lacuna::ReliefSurface surface(execution, part.Size, part.Depths, part.Spacing);
  execution.SetStage(0.1, 1);
  lacuna::ImplantPlate plate;
  for (int refinements = 0;; ++refinements)
  {
    const lacuna::Execution::NestedStages nested(execution);
    plate = lacuna::MakeImplantPlate(
      execution, surface, part.Size, part.Spacing, part.Mask, options, part.ToWorld);
    const double lack = 1 - plate.MinimumThickness / this->Thickness;
    if (this->TriangleSize != 0 || lack <= LargestLack || refinements == MaximumRefinements)
    {
      break;
    }
    // what flat triangles lack goes with the square of their size
    options.TriangleSize *= std::max(0.5, std::sqrt(0.8 * LargestLack / lack));
  }
  if (plate.MinimumThickness < (1 - LargestLack) * this->Thickness)
  {
    vtkWarningMacro(<< "triangles of " << lacuna::FormatNumber(options.TriangleSize)
                    << " mm are too coarse for the bends of the surface: the plate is only "
                    << lacuna::FormatNumber(std::round(1e4 * plate.MinimumThickness) / 1e4)
                    << " mm thick where the faces are nearest; make TriangleSize smaller");
  }
  for (const std::string& warning : plate.Outline.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
  if (this->EdgeClearance < 0 && this->Side == Inward)
  {
    vtkWarningMacro("the plate overlaps the bone (EdgeClearance is negative) and grows inwards, "
                    "so its rim lies within the bone; use Side Outward, or prepare a seat");
  }
  return plate;
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::WarnOfBone(const std::vector<double>& thickness)
{
  std::string unmeasured;
  for (std::size_t k = 0; k < thickness.size(); ++k)
  {
    const double bone = thickness[k];
    if (bone < this->MinimumBoneThickness)
    {
      const std::string found = bone == 0
        ? "lies over the defect, where there is no bone for a screw"
        : "lies over bone only " + lacuna::FormatNumber(std::round(100 * bone) / 100) +
          " mm thick (MinimumBoneThickness is " + lacuna::FormatNumber(this->MinimumBoneThickness) +
          " mm)";
      vtkWarningMacro(<< "screw hole " << k + 1 << " " << found);
    }
    if (std::isnan(bone))
    {
      unmeasured += (unmeasured.empty() ? "" : ", ") + std::to_string(k + 1);
    }
  }
  if (!unmeasured.empty() && this->MinimumBoneThickness > 0)
  {
    vtkWarningMacro(<< "the thickness of the bone under screw hole " << unmeasured
                    << " was not measured, so it is not known whether it holds a screw; set "
                       "ComputeThickness of B-Spline Iso Ray Caster, or MinimumBoneThickness 0 "
                       "not to be told");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* map = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkPolyData>();
  const lacuna::FittedPart part(map, "a plate");
  lacuna::ImplantPlateOptions options = this->GetOptions();
  if (options.TriangleSize == 0)
  {
    options.TriangleSize = std::min({ LargestTriangle, part.Spacing[0], part.Spacing[1] });
  }
  const std::vector<lacuna::Vec3> holes = this->GetHoles(ports.GetInput<vtkPointSet>(1));
  const lacuna::Matrix4 toPart = part.ToWorld.Inverse();
  for (const lacuna::Vec3& p : holes)
  {
    options.HolePoints.push_back(toPart.Point(p));
  }

  const lacuna::ImplantPlate plate = this->MakePlate(part, options, execution);
  lacuna::SolidMesh::Set(output, plate, part.ToWorld, PlateFaceName);
  std::vector<double> bone;
  for (const lacuna::PlateHole& hole : plate.Holes)
  {
    bone.push_back(GetBoneThickness(map, part, hole));
  }
  this->WarnOfBone(bone);
  SetMeasures(output, plate, this->Density, part.ToWorld);
  SetHoles(output, plate, bone, part.ToWorld);
  this->Drilled.clear();
  for (const lacuna::Vec3& p : holes)
  {
    Append(this->Drilled, p);
  }
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaImplantPlate::GetOrigins(const lacuna::Ports& ports) const
{
  return { ports.GetInput<vtkDataObject>() }; // the marks are parameters
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::DescribeWith(
  lacuna::Properties& properties, const std::vector<double>& holes) const
{
  using lacuna::ValueRange;
  this->GetOptions().Describe(properties);
  properties.Add("HolePoints", holes)
    .Add("MinimumBoneThickness", this->MinimumBoneThickness,
      ValueRange::Above(0, "mm").OrZero("no warnings"))
    .Add("Density", this->Density, ValueRange::Above(0, "g/cm\u00b3"));
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::Describe(lacuna::Properties& properties) const
{
  std::vector<double> given;
  for (const std::array<double, 3>& p : this->HolePoints)
  {
    given.insert(given.end(), p.begin(), p.end());
  }
  this->DescribeWith(properties, given);
}

//------------------------------------------------------------------------------
std::string vtkLacunaImplantPlate::Parameters(int) const
{
  lacuna::Properties properties;
  this->DescribeWith(properties, this->Drilled);
  return properties.GetText();
}
