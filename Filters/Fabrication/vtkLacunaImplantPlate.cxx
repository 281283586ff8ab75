// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaImplantPlate.h"

#include "lacunaImplantPlate.h"
#include "lacunaParameterText.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

vtkStandardNewMacro(vtkLacunaImplantPlate);

namespace
{
constexpr const char* BoneThicknessName = "Thickness";
constexpr double LargestTriangle = 0.5; // mm, when TriangleSize is left to the filter
constexpr double LargestLack = 0.01;    // of Thickness, between facets
constexpr int MaximumRefinements = 3;

//------------------------------------------------------------------------------
// The rectangle of the map on which there is a fit.
struct FittedPart
{
  std::int64_t Column = 0; // of its first pixel, from the first of the map
  std::int64_t Row = 0;
  lacuna::GridSize Size;
  std::vector<double> Depths;
  std::vector<unsigned char> Mask;
};

vtkDataArray* GetArray(vtkImageData* map, const char* name)
{
  vtkDataArray* array = map->GetPointData()->GetArray(name);
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("the depth map has no point array '") + name +
      "' with one component; run RBF Hole Filler on it first");
  }
  return array;
}

FittedPart GetFittedPart(vtkImageData* map)
{
  vtkDataArray* fitted = GetArray(map, vtkLacunaDepthMap::FittedName);
  vtkDataArray* filled = GetArray(map, vtkLacunaDepthMap::FilledMaskName);
  int dimensions[3];
  map->GetDimensions(dimensions);
  const std::int64_t columns = dimensions[0];
  std::int64_t first[2] = { dimensions[0], dimensions[1] };
  std::int64_t last[2] = { -1, -1 };
  bool any = false;
  for (vtkIdType k = 0; k < fitted->GetNumberOfTuples(); ++k)
  {
    const bool number = std::isfinite(fitted->GetComponent(k, 0));
    if (filled->GetComponent(k, 0) != 0)
    {
      any = true;
      if (!number)
      {
        throw std::runtime_error("pixel " + std::to_string(k % columns) + ", " +
          std::to_string(k / columns) +
          " is marked in FilledMask, but Fitted is no number there; "
          "use both as RBF Hole Filler gives them");
      }
    }
    if (number)
    {
      const std::int64_t at[2] = { k % columns, k / columns };
      for (int i = 0; i < 2; ++i)
      {
        first[i] = std::min(first[i], at[i]);
        last[i] = std::max(last[i], at[i]);
      }
    }
  }
  if (!any)
  {
    throw std::runtime_error("no pixel of the depth map is filled (FilledMask is 0 everywhere), so "
                             "there is no defect to make a plate for; mark it in RBF Hole Filler");
  }
  FittedPart part;
  part.Column = first[0];
  part.Row = first[1];
  part.Size = { last[0] - first[0] + 1, last[1] - first[1] + 1 };
  for (std::int64_t j = first[1]; j <= last[1]; ++j)
  {
    for (std::int64_t i = first[0]; i <= last[0]; ++i)
    {
      const double depth = fitted->GetComponent(i + columns * j, 0);
      if (!std::isfinite(depth))
      {
        throw std::runtime_error("Fitted has a hole at pixel " + std::to_string(i) + ", " +
          std::to_string(j) + "; it must be a complete rectangle, as RBF Hole Filler gives it");
      }
      part.Depths.push_back(depth);
      part.Mask.push_back(filled->GetComponent(i + columns * j, 0) != 0);
    }
  }
  return part;
}

//------------------------------------------------------------------------------
// The least thickness of bone within radius of p (mm from the part's first pixel), NaN when unknown.
// The map's thickness is along the rays; the one along the axis is shorter where they are oblique.
double GetBoneThickness(vtkImageData* map, const FittedPart& part, const lacuna::Vec2& spacing,
  const lacuna::PlateHole& hole)
{
  vtkDataArray* thickness = map->GetPointData()->GetArray(BoneThicknessName);
  const double radius = std::max(hole.Radius, std::max(spacing[0], spacing[1]));
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t j = 0; j < part.Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < part.Size.Columns; ++i)
    {
      if (std::hypot(static_cast<double>(i) * spacing[0] - hole.Foot[0],
            static_cast<double>(j) * spacing[1] - hole.Foot[1]) > radius)
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
void SetMesh(vtkPolyData* output, const lacuna::ImplantPlate& plate, const lacuna::Matrix4& toWorld)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(plate.Points.size()));
  for (std::size_t k = 0; k < plate.Points.size(); ++k)
  {
    points->SetPoint(static_cast<vtkIdType>(k), toWorld.Point(plate.Points[k]).data());
  }
  vtkNew<vtkCellArray> triangles;
  triangles->AllocateExact(static_cast<vtkIdType>(plate.Triangles.size()),
    3 * static_cast<vtkIdType>(plate.Triangles.size()));
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName(vtkLacunaImplantPlate::PlateFaceName);
  faces->SetNumberOfTuples(static_cast<vtkIdType>(plate.Faces.size()));
  for (std::size_t k = 0; k < plate.Triangles.size(); ++k)
  {
    const auto& t = plate.Triangles[k];
    triangles->InsertNextCell({ t[0], t[1], t[2] });
    faces->SetValue(static_cast<vtkIdType>(k), static_cast<unsigned char>(plate.Faces[k]));
  }
  output->SetPoints(points);
  output->SetPolys(triangles);
  output->GetCellData()->SetScalars(faces);
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
int vtkLacunaImplantPlate::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaImplantPlate::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  vtkLacunaRequest::Whole(inputVector[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaImplantPlate::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* map = vtkImageData::GetData(inputVector[0]);
  vtkPolyData* output = vtkPolyData::GetData(outputVector);
  const int piece = outputVector->GetInformationObject(0)->Get(
    vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER());
  if (!map || map->GetNumberOfPoints() == 0 || piece > 0)
  {
    return 1; // empty in, empty out; the plate is one piece
  }
  const auto body = [&](vtkLacunaExecution& execution)
  {
    const vtkLacunaDepthMap contract(map);
    if (contract.IsPerspective())
    {
      throw std::runtime_error("this is a perspective depth map; a plate needs a parallel one, "
                               "filled by RBF Hole Filler");
    }
    if (this->Side != Inward && this->Side != Outward)
    {
      throw std::runtime_error(
        "Side is " + std::to_string(this->Side) + "; it must be 0 (Inward) or 1 (Outward)");
    }
    if (this->EdgeShape < Square || this->EdgeShape > Rounded)
    {
      throw std::runtime_error("EdgeShape is " + std::to_string(this->EdgeShape) +
        "; it must be 0 (Square), 1 (Beveled) or 2 (Rounded)");
    }
    if (!(this->Density > 0 && std::isfinite(this->Density)))
    {
      throw std::runtime_error("Density is " + lacuna::FormatNumber(this->Density) +
        "; it must be a number of g/cm^3 above 0");
    }
    const FittedPart part = GetFittedPart(map);
    const lacuna::Vec2 spacing = contract.GetPixelSpacing();
    const int* extent = map->GetExtent();
    const lacuna::Matrix4 toWorld = contract.GetImageToWorld() *
      lacuna::Matrix4::Translation({ static_cast<double>(extent[0] + part.Column),
        static_cast<double>(extent[2] + part.Row), 0 }) *
      lacuna::Matrix4::Scaling({ 1 / spacing[0], 1 / spacing[1], 1 });
    if (toWorld.Determinant3() < 0)
    {
      throw std::runtime_error("ImageToWorld of the depth map mirrors; a plate would be the "
                               "patient's mirror image");
    }

    lacuna::ImplantPlateOptions options;
    options.Thickness = this->Thickness;
    options.Side = this->Side == Inward ? lacuna::PlateSide::Inward : lacuna::PlateSide::Outward;
    options.EdgeClearance = this->EdgeClearance;
    options.CornerRadius = this->CornerRadius;
    options.Edge = static_cast<lacuna::PlateEdge>(this->EdgeShape);
    options.EdgeSize = this->Bevel;
    options.BothFaces = this->BevelBothFaces;
    const bool automatic = this->TriangleSize == 0;
    options.TriangleSize =
      automatic ? std::min({ LargestTriangle, spacing[0], spacing[1] }) : this->TriangleSize;
    options.Hole = { this->HoleDiameter, this->CountersinkDiameter, this->CountersinkAngle };
    options.DrainageSpacing = this->DrainageSpacing;
    options.DrainageDiameter = this->DrainageDiameter;
    const lacuna::Matrix4 toPart = toWorld.Inverse();
    for (const auto& p : this->HolePoints)
    {
      options.HolePoints.push_back(toPart.Point({ p[0], p[1], p[2] }));
    }

    execution.SetStage(0, 0.1);
    const lacuna::ReliefSurface surface(execution, part.Size, part.Depths, spacing);
    execution.SetStage(0.1, 1);
    lacuna::ImplantPlate plate;
    for (int refinements = 0;; ++refinements)
    {
      const lacuna::Execution::NestedStages nested(execution);
      plate = lacuna::MakeImplantPlate(
        execution, surface, part.Size, spacing, part.Mask, options, toWorld);
      const double lack = 1 - plate.MinimumThickness / this->Thickness;
      if (!automatic || lack <= LargestLack || refinements == MaximumRefinements)
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

    SetMesh(output, plate, toWorld);
    std::vector<double> centers;
    std::vector<double> axes;
    std::vector<double> bone;
    std::vector<double> land;
    for (std::size_t k = 0; k < plate.Holes.size(); ++k)
    {
      const lacuna::PlateHole& hole = plate.Holes[k];
      Append(centers, toWorld.Point(hole.Centre));
      Append(axes, lacuna::Normalized(toWorld.Vector(hole.Axis)));
      land.push_back(hole.Land);
      bone.push_back(GetBoneThickness(map, part, spacing, hole));
      if (bone.back() < this->MinimumBoneThickness)
      {
        const std::string found = bone.back() == 0
          ? "lies over the defect, where there is no bone for a screw"
          : "lies over bone only " + lacuna::FormatNumber(std::round(100 * bone.back()) / 100) +
            " mm thick (MinimumBoneThickness is " +
            lacuna::FormatNumber(this->MinimumBoneThickness) + " mm)";
        vtkWarningMacro(<< "screw hole " << k + 1 << " " << found);
      }
    }
    const lacuna::Vec3 tightest = toWorld.Point(plate.MinimumRadiusPoint);
    vtkLacunaFieldData::Set(output, "Volume", { plate.Volume }, 1);
    vtkLacunaFieldData::Set(output, "Mass", { plate.Volume * this->Density / 1000 }, 1);
    vtkLacunaFieldData::Set(output, "OuterArea", { plate.OuterArea }, 1);
    vtkLacunaFieldData::Set(output, "OutlineLength", { plate.Outline.Length }, 1);
    vtkLacunaFieldData::Set(output, "MinimumThickness", { plate.MinimumThickness }, 1);
    vtkLacunaFieldData::Set(output, "MinimumCurvatureRadius", { plate.MinimumRadius }, 1);
    vtkLacunaFieldData::Set(output, "TightestPoint", { tightest[0], tightest[1], tightest[2] }, 3);
    vtkLacunaFieldData::Set(output, "HoleCenters", centers, 3);
    vtkLacunaFieldData::Set(output, "HoleAxes", axes, 3);
    vtkLacunaFieldData::Set(output, "HoleBoneThickness", bone, 1);
    vtkLacunaFieldData::Set(output, "HoleLand", land, 1);
    vtkLacunaFieldData::Set(
      output, "DrainageHoleCount", { static_cast<double>(plate.DrainageHoles) }, 1);

    std::vector<double> picked;
    for (const auto& p : this->HolePoints)
    {
      picked.insert(picked.end(), p.begin(), p.end());
    }
    lacuna::ParameterText parameters;
    parameters.Add("Thickness", this->Thickness)
      .Add("Side", this->Side)
      .Add("EdgeClearance", this->EdgeClearance)
      .Add("EdgeShape", this->EdgeShape)
      .Add("Bevel", this->Bevel)
      .Add("BevelBothFaces", this->BevelBothFaces)
      .Add("CornerRadius", this->CornerRadius)
      .Add("TriangleSize", this->TriangleSize)
      .Add("HolePoints", picked)
      .Add("HoleDiameter", this->HoleDiameter)
      .Add("CountersinkDiameter", this->CountersinkDiameter)
      .Add("CountersinkAngle", this->CountersinkAngle)
      .Add("DrainageSpacing", this->DrainageSpacing)
      .Add("DrainageDiameter", this->DrainageDiameter)
      .Add("Density", this->Density);
    vtkLacunaProvenance::Record(output, this, { map }, parameters.Get());
  };
  return vtkLacunaExecution::Run(this, outputVector, body);
}

//------------------------------------------------------------------------------
void vtkLacunaImplantPlate::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Thickness: " << this->Thickness << "\n";
  os << indent << "Side: " << this->Side << "\n";
  os << indent << "EdgeClearance: " << this->EdgeClearance << "\n";
  os << indent << "EdgeShape: " << this->EdgeShape << "\n";
  os << indent << "Bevel: " << this->Bevel << "\n";
  os << indent << "BevelBothFaces: " << this->BevelBothFaces << "\n";
  os << indent << "CornerRadius: " << this->CornerRadius << "\n";
  os << indent << "TriangleSize: " << this->TriangleSize << "\n";
  os << indent << "HolePoints: " << this->HolePoints.size() << "\n";
  os << indent << "HoleDiameter: " << this->HoleDiameter << "\n";
  os << indent << "CountersinkDiameter: " << this->CountersinkDiameter << "\n";
  os << indent << "CountersinkAngle: " << this->CountersinkAngle << "\n";
  os << indent << "MinimumBoneThickness: " << this->MinimumBoneThickness << "\n";
  os << indent << "DrainageSpacing: " << this->DrainageSpacing << "\n";
  os << indent << "DrainageDiameter: " << this->DrainageDiameter << "\n";
  os << indent << "Density: " << this->Density << "\n";
}
