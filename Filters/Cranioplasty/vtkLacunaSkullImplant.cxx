// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSkullImplant.h"

#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaSkullEllipsoid.h"
#include "lacunaSkullImplant.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullShape.h"
#include "lacunaSkullShells.h"
#include "lacunaSkullTemplate.h"
#include "lacunaVolumeSymmetry.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDelaunay2D.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkLacunaArrays.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <memory>
#include <new>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaSkullImplant);

namespace
{
using lacuna::Vec3;

constexpr double RaySpacing = 2;        // mm at 90 mm
constexpr double Seen = 10;             // mm, the farthest bone that shows what a place is like
constexpr double MostDistance = 30;     // mm of Point from a hole
constexpr double AutomaticTriangle = 1; // mm
constexpr double SmallHole = 400;       // mm^2, below which it may be none
constexpr double ThinPlace = 1.5;       // mm, of an implant
constexpr double WideUndercut = 1;      // mm: of which is told
constexpr double BelowBone = 25;        // mm, of the box in which bone is looked at
constexpr double BesideBone = 12;       // mm
constexpr double LeastGap = 10;         // mm^2, of those that are told of
// A template that fits: part of the sound bone that it has to have, scale or its inverse, RMS in mm.
constexpr double LeastCovered = 0.6;
constexpr double MostScale = 1.5;
constexpr double MostTemplateError = 6;
constexpr std::int16_t LevelOfHalf = 300; // of the copy in which symmetry is sought

std::string Name(const Vec3& p)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(1);
  text << std::fixed << "(" << p[0] << ", " << p[1] << ", " << p[2] << ") mm";
  return text.str();
}

std::string Rounded(double value, double steps = 10)
{
  return lacuna::FormatNumber(std::round(steps * value) / steps);
}

// Bone and what is like it have the same value: teeth and metal do not decide.
lacuna::SymmetryResult FindSymmetry(
  const lacuna::VoxelVolume& volume, double level, lacuna::Execution& execution)
{
  lacuna::RequireMemory("a copy of the volume in which its symmetry is sought",
    2.0 * static_cast<double>(volume.NumberOfVoxels()));
  std::vector<std::int16_t> bone(static_cast<std::size_t>(volume.NumberOfVoxels()));
  const lacuna::Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.05);
  lacuna::DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels)
    {
      execution.For(volume.NumberOfVoxels(), 65536,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t i = begin; i < end; ++i)
          {
            const double ratio = static_cast<double>(voxels[i]) / level;
            bone[i] = static_cast<std::int16_t>(
              ratio > 0 ? std::min(ratio, 2.0) * LevelOfHalf : 0); // NaN is 0
          }
        });
    });
  execution.SetStage(0.05, 1);
  lacuna::MaskedVolume masked;
  masked.Volume = volume;
  masked.Volume.Voxels = bone.data();
  masked.Volume.Type = lacuna::ScalarType::Int16;
  try
  {
    return lacuna::FindSymmetryPlane(masked, execution);
  }
  catch (const lacuna::Aborted&)
  {
    throw;
  }
  catch (const std::exception& error)
  {
    throw std::runtime_error("the two sides of the skull are not found in this scan (" +
      std::string(error.what()) +
      "): it has to show the whole vault, and Level has to be that of bone");
  }
}

std::vector<Vec3> GetCurve(vtkPolyData* data)
{
  std::vector<Vec3> curve;
  Vec3 p{};
  for (vtkIdType c = 0; c < data->GetNumberOfCells(); ++c)
  {
    if (data->GetCellType(c) == VTK_POLY_LINE || data->GetCellType(c) == VTK_POLYGON)
    {
      vtkCell* cell = data->GetCell(c);
      for (vtkIdType k = 0; k < cell->GetNumberOfPoints(); ++k)
      {
        data->GetPoint(cell->GetPointId(static_cast<int>(k)), p.data());
        curve.push_back(p);
      }
      break;
    }
  }
  const bool hasLine = !curve.empty();
  for (vtkIdType k = 0; !hasLine && k < data->GetNumberOfPoints(); ++k)
  {
    data->GetPoint(k, p.data());
    curve.push_back(p);
  }
  return curve;
}

// Holes on the ellipsoid that fits the skull.
class Holes
{
public:
  Holes(const lacuna::SkullRays& rays, std::vector<std::vector<int>> defects)
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
      const Vec3 direction = lacuna::Normalized(middle);
      this->Centers.push_back(rays.Center + this->GetRadius(direction) * direction);
      this->Areas.push_back(area);
    }
  }

  double GetArea(std::size_t defect) const { return this->Areas[defect]; } ///< mm^2
  double GetDistance(std::size_t defect, const Vec3& point) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (const int ray : this->Defects[defect])
    {
      least = std::min(least, lacuna::Norm(this->GetPoint(ray) - point));
    }
    return least;
  }

  std::string GetText(std::size_t defect) const
  {
    return Rounded(this->Areas[defect] / 100) + " cm^2 around " + Name(this->Centers[defect]);
  }

  std::string GetText() const
  {
    std::string text;
    for (std::size_t k = 0; k < this->Areas.size(); ++k)
    {
      text += (k ? "; " : "") + this->GetText(k);
    }
    return text;
  }

  // first: number of the first defect.
  void SetOutput(vtkPolyData* output, int first) const
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
    vtkLacunaArrays::SetNumberOfTuples(triangles, static_cast<vtkIdType>(corners.size()));
    std::copy(corners.begin(), corners.end(), triangles->GetPointer(0));
    output->SetPoints(points);
    vtkLacunaArrays::SetTriangles(output, triangles);
    output->GetCellData()->SetScalars(numbers);
    std::vector<double> centers;
    for (const Vec3& c : this->Centers)
    {
      centers.insert(centers.end(), c.data(), c.data() + 3);
    }
    vtkLacunaFieldData::Set(output, "DefectAreas", this->Areas, 1);
    vtkLacunaFieldData::Set(output, "DefectCenters", centers, 3);
  }

private:
  static std::vector<Vec3> GetPoints(const lacuna::SkullRays& rays)
  {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
    {
      if (rays.Kinds[i] == lacuna::SkullRayKind::Sound)
      {
        points.push_back(rays.Center + rays.Outer[i] * rays.Directions[i]);
      }
    }
    return points;
  }

  double GetRadius(const Vec3& direction) const
  {
    const double radius = this->Ellipsoid.GetRadius(direction);
    return radius > 0 && radius < 200 ? radius : 90;
  }

  Vec3 GetPoint(int ray) const
  {
    const Vec3& d = this->Rays.Directions[ray];
    return this->Rays.Center + this->GetRadius(d) * d;
  }

  // Delaunay's, seen from the opposite side of the sphere.
  void AddTriangles(std::size_t k, vtkPoints* points, std::vector<std::int64_t>& corners) const
  {
    const Vec3 axis = lacuna::Normalized(this->Centers[k] - this->Rays.Center);
    const Vec3 u = lacuna::Normalized(
      lacuna::Cross(axis, std::abs(axis[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
    const Vec3 v = lacuna::Cross(axis, u);
    vtkNew<vtkPoints> plane;
    plane->SetDataTypeToDouble();
    std::vector<int> used;
    for (const int ray : this->Defects[k])
    {
      const Vec3& d = this->Rays.Directions[ray];
      const double height = 1 + lacuna::Dot(d, axis);
      if (height > 0.2)
      {
        plane->InsertNextPoint(2 * lacuna::Dot(d, u) / height, 2 * lacuna::Dot(d, v) / height, 0);
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

  const lacuna::SkullRays& Rays;
  std::vector<std::vector<int>> Defects;
  lacuna::SkullEllipsoid Ellipsoid;
  std::vector<Vec3> Centers;
  std::vector<double> Areas;
};

// The largest of the holes that are too small.
std::string GetSmallHole(const lacuna::SkullRays& rays)
{
  const std::vector<std::vector<int>> small = FindDefects(rays, LeastGap);
  return small.empty() ? "" : ". The largest gap has " + Holes(rays, { small[0] }).GetText();
}

struct PlacedTemplate
{
  lacuna::TemplateFit Fit;
  lacuna::SkullRays Rays;
};

// Throws std::runtime_error for a template that does not fit.
PlacedTemplate FindTemplate(vtkDataObject* data, double level, const lacuna::SkullRays& rays,
  const lacuna::SoundBone& bone, lacuna::Execution& execution)
{
  PlacedTemplate example;
  std::string reason;
  try
  {
    const auto shell = lacuna::MakeSkullShell(data, level);
    example.Fit = FitTemplate(*shell, bone, execution);
    example.Rays = PlaceTemplate(*shell, example.Fit, rays, execution);
  }
  catch (const lacuna::Aborted&)
  {
    throw;
  }
  catch (const std::bad_alloc&)
  {
    throw;
  }
  catch (const std::exception& error)
  {
    reason = error.what();
  }
  const lacuna::TemplateFit& fit = example.Fit;
  if (reason.empty() && !(fit.Covered >= LeastCovered))
  {
    reason =
      "it has bone for only " + Rounded(100 * fit.Covered, 1) + " % of the skull's sound bone";
  }
  if (reason.empty() && !(fit.Scale >= 1 / MostScale && fit.Scale <= MostScale))
  {
    reason = "it would have to be " + Rounded(fit.Scale, 100) + " times as large";
  }
  if (reason.empty() && !(fit.RMS <= MostTemplateError))
  {
    reason = "turned, shifted and scaled its outer surface is still " + Rounded(fit.RMS) +
      " mm (RMS) away from sound bone";
  }
  if (!reason.empty())
  {
    throw std::runtime_error("the template does not fit: " + reason +
      ". Give a skull with a whole vault, in mm, at the grey level TemplateLevel; or no template");
  }
  return example;
}

// Holds the hole with the bone around it, and what is in front of it.
std::array<Vec3, 2> GetBox(const lacuna::SkullRays& rays, const std::vector<Vec3>& missing)
{
  double least = lacuna::MostSkullRadius;
  for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
  {
    least = rays.Kinds[i] == lacuna::SkullRayKind::Sound ? std::min(least, rays.Outer[i]) : least;
  }
  std::array<Vec3, 2> box{ rays.Center, rays.Center };
  bool isFirst = true;
  for (const Vec3& direction : missing)
  {
    for (const double radius : { least - BelowBone, lacuna::MostSkullRadius })
    {
      const Vec3 x = rays.Center + radius * direction;
      for (int a = 0; a < 3; ++a)
      {
        box[0][a] = isFirst ? x[a] - BesideBone : std::min(box[0][a], x[a] - BesideBone);
        box[1][a] = isFirst ? x[a] + BesideBone : std::max(box[1][a], x[a] + BesideBone);
      }
      isFirst = false;
    }
  }
  return box;
}

// How much of the outer surface is probably more than 1 mm off, where it is worst, and what is known there.
std::string GetDoubts(const lacuna::SkullImplant& implant, const lacuna::SkullRays& rays,
  const lacuna::MirrorPlane& plane)
{
  const auto distanceOf = [&](const Vec3& place)
  {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
    {
      if (rays.Kinds[i] == lacuna::SkullRayKind::Sound)
      {
        const Vec3 bone = rays.Center + rays.Outer[i] * rays.Directions[i];
        least = std::min(least, lacuna::Norm(bone - place));
      }
    }
    return least;
  };
  const Vec3& worst = implant.LargestErrorPoint;
  std::string text = "parts of the outer surface may be more than 1 mm off, about " +
    Rounded(implant.DoubtfulArea / 100) + " of " + Rounded(implant.OuterArea / 100) +
    " cm^2. The least certain place is " + Name(worst) + ", " + Rounded(distanceOf(worst), 1) +
    " mm away from sound bone";
  if (distanceOf(plane.Reflect(worst)) > Seen)
  {
    text += ", where the bone of the other side is missing, too";
  }
  return text + ": 95 % of errors there are within " +
    Rounded(implant.LargestError / lacuna::TrustedError) +
    " mm. Compare the implant with the other side where PredictedError is large";
}

// Where the implant is thinner than ThinPlace; empty for nowhere.
std::string GetThinPlaces(const lacuna::SkullImplant& implant)
{
  double area = 0;
  std::size_t thinnest = 0;
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    if (implant.Faces[t] != lacuna::SkullImplantFace::Outer)
    {
      continue;
    }
    const lacuna::Triangle& corners = implant.Triangles[t];
    const Vec3& a = implant.Points[corners[0]];
    const double third =
      lacuna::Norm(lacuna::Cross(implant.Points[corners[1]] - a, implant.Points[corners[2]] - a)) /
      6;
    for (const std::int32_t corner : corners)
    {
      area += implant.Thickness[corner] < ThinPlace ? third : 0;
      thinnest = implant.Thickness[corner] < implant.Thickness[thinnest] ? corner : thinnest;
    }
  }
  if (!(area > 0))
  {
    return {};
  }
  return "the implant is thinner than " + lacuna::FormatNumber(ThinPlace) + " mm on about " +
    Rounded(area / 100) + " cm^2. The thinnest place has " + Rounded(implant.Thickness[thinnest]) +
    " mm, at " + Name(implant.Points[thinnest]) + ". Look whether the material allows that";
}

void AddArray(vtkPolyData* output, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  vtkLacunaArrays::SetNumberOfTuples(array, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  output->GetPointData()->AddArray(array);
}

void SetSolid(vtkPolyData* output, const lacuna::SkullImplant& implant)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkLacunaArrays::SetNumberOfPoints(points, static_cast<vtkIdType>(implant.Points.size()));
  for (std::size_t k = 0; k < implant.Points.size(); ++k)
  {
    points->SetPoint(static_cast<vtkIdType>(k), implant.Points[k].data());
  }
  const auto count = static_cast<vtkIdType>(implant.Triangles.size());
  vtkNew<vtkTypeInt64Array> corners;
  vtkLacunaArrays::SetNumberOfTuples(corners, 3 * count);
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName("ImplantFace");
  vtkLacunaArrays::SetNumberOfTuples(faces, count);
  for (vtkIdType k = 0; k < count; ++k)
  {
    std::copy_n(implant.Triangles[k].begin(), 3, corners->GetPointer(3 * k));
    faces->SetValue(k, static_cast<unsigned char>(implant.Faces[k]));
  }
  output->SetPoints(points);
  vtkLacunaArrays::SetTriangles(output, corners);
  output->GetCellData()->AddArray(faces);
  AddArray(output, "PredictedError", implant.Errors);
  AddArray(output, "Thickness", implant.Thickness);
  AddArray(output, "ThicknessError", implant.ThicknessErrors);
  output->GetPointData()->SetActiveScalars("PredictedError");
}
}

//------------------------------------------------------------------------------
vtkLacunaSkullImplant::vtkLacunaSkullImplant()
{
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkLacunaSkullImplant::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port != 1)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  }
  if (port != 0)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSkullImplant::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  for (int port = 0; port < 3; ++port)
  {
    if (vtkInformation* info = inputs[port]->GetInformationObject(0))
    {
      vtkLacunaRequest::Whole(this, info, outputs);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSkullImplant::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const bool isWanted = vtkLacunaRequest::IsWanted(outputs); // the implant is one piece
  const auto body = [&](vtkLacunaExecution& execution)
  {
    vtkImageData* image = vtkImageData::GetData(inputs[0]);
    vtkPolyData* outline = vtkPolyData::GetData(inputs[1]);
    vtkDataSet* other = vtkDataSet::GetData(inputs[2]);
    const bool hasTemplate = other && other->GetNumberOfPoints() > 0;
    if (!image || image->GetNumberOfPoints() == 0)
    {
      return; // empty in, empty out
    }
    if (!(this->Level > 0) || !std::isfinite(this->Level))
    {
      throw std::runtime_error("Level is " + lacuna::FormatNumber(this->Level) +
        "; it must be a number above 0, the grey level of bone");
    }
    if (this->DefectChoice != Largest && this->DefectChoice != NearestToPoint)
    {
      throw std::runtime_error("DefectChoice is " + std::to_string(this->DefectChoice) +
        "; it must be 0 (Largest) or 1 (Nearest to Point)");
    }
    if (!(this->Density > 0 && std::isfinite(this->Density)))
    {
      throw std::runtime_error("Density is " + lacuna::FormatNumber(this->Density) +
        "; it must be a number of g/cm^3 above 0");
    }
    if (!(this->EdgeClearance >= 0 && this->EdgeClearance <= 5))
    {
      throw std::runtime_error("EdgeClearance is " + lacuna::FormatNumber(this->EdgeClearance) +
        " mm; it must be between 0 and 5");
    }
    if (!(this->Thickness == 0 || (this->Thickness >= 0.5 && this->Thickness <= 20)))
    {
      throw std::runtime_error("Thickness is " + lacuna::FormatNumber(this->Thickness) +
        " mm; it must be 0 (that of the bone) or between 0.5 and 20");
    }
    if (!(this->MinimumThickness >= 0 && this->MinimumThickness <= 10))
    {
      throw std::runtime_error("MinimumThickness is " +
        lacuna::FormatNumber(this->MinimumThickness) + " mm; it must be between 0 and 10");
    }
    if (!lacuna::IsFinite({ this->InsertionDirection[0], this->InsertionDirection[1],
          this->InsertionDirection[2] }))
    {
      throw std::runtime_error("InsertionDirection is not finite");
    }
    const double triangle = this->TriangleSize == 0 ? AutomaticTriangle : this->TriangleSize;
    if (!(triangle >= 0.2 && triangle <= 5))
    {
      throw std::runtime_error("TriangleSize is " + lacuna::FormatNumber(this->TriangleSize) +
        " mm; it must be 0 (automatic) or between 0.2 and 5");
    }
    if (!(this->TemplateLevel >= 0) || !std::isfinite(this->TemplateLevel))
    {
      throw std::runtime_error("TemplateLevel is " + lacuna::FormatNumber(this->TemplateLevel) +
        "; it must be a number above 0, the grey level of the template's bone, or 0 for Level");
    }
    vtkSmartPointer<vtkDataArray> keep;
    const lacuna::VoxelVolume volume = lacuna::GetBoneVolume(image, keep);

    execution.SetStage(0, 0.3);
    const lacuna::SymmetryResult symmetry = FindSymmetry(volume, this->Level, execution);
    execution.SetStage(0.3, 0.32);
    const Vec3 center = FindSkullCenter(volume, this->Level, symmetry.Plane, execution);
    execution.SetStage(0.32, 0.35);
    lacuna::SkullRays rays = TraceSkull(volume, this->Level, center, RaySpacing, execution);
    std::vector<std::vector<int>> defects;
    const bool isDrawn = outline && outline->GetNumberOfPoints() > 0;
    if (isDrawn)
    {
      defects.push_back(FindRaysWithin(rays, GetCurve(outline)));
      if (defects[0].empty())
      {
        throw std::runtime_error("the outline of the defect encloses nothing of the skull");
      }
      for (const int ray : defects[0])
      {
        rays.Kinds[ray] = lacuna::SkullRayKind::Open;
      }
    }
    else
    {
      defects = FindDefects(rays);
    }
    if (defects.empty())
    {
      throw std::runtime_error("no hole of 1 cm^2 or more was found in the vault of the skull" +
        GetSmallHole(rays) +
        ". Look at the bone at this Level, or draw an outline around the defect");
    }
    const Holes holes(rays, defects);
    holes.SetOutput(vtkPolyData::GetData(outputs, 1), isDrawn ? 0 : 1);
    std::size_t chosen = 0;
    if (!isDrawn && this->DefectChoice == NearestToPoint)
    {
      const Vec3 point{ this->Point[0], this->Point[1], this->Point[2] };
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < defects.size(); ++k)
      {
        const double distance = holes.GetDistance(k, point);
        if (distance < least)
        {
          least = distance;
          chosen = k;
        }
      }
      if (!(least <= MostDistance))
      {
        throw std::runtime_error("Point " + Name(point) + " is " + Rounded(least) +
          " mm away from the nearest hole. Found: " + holes.GetText());
      }
    }

    execution.SetStage(0.35, 0.4);
    const lacuna::SoundBone bone = GetSoundBone(rays);
    PlacedTemplate example;
    if (hasTemplate)
    {
      example = FindTemplate(
        other, this->TemplateLevel > 0 ? this->TemplateLevel : this->Level, rays, bone, execution);
    }
    execution.SetStage(0.4, 0.8);
    std::vector<Vec3> missing;
    for (const int ray : defects[chosen])
    {
      missing.push_back(rays.Directions[ray]);
    }
    const lacuna::SkullShape shape(
      bone, missing, symmetry.Plane, execution, hasTemplate ? &example.Rays : nullptr);
    execution.SetStage(0.8, 1);
    const std::unique_ptr<lacuna::BoneDistance> near =
      MakeBoneDistance(volume, keep, this->Level, GetBox(rays, missing));
    lacuna::SkullImplantOptions options;
    options.Thickness = this->Thickness;
    options.MinimumThickness = this->MinimumThickness;
    std::copy_n(this->InsertionDirection, 3, options.InsertionDirection.data());
    options.Level = this->Level;
    options.EdgeClearance = this->EdgeClearance;
    options.TriangleSize = triangle;
    const lacuna::SkullImplant implant =
      MakeSkullImplant(volume, rays, defects[chosen], shape, *near, options, execution);

    for (const std::string& warning : implant.Warnings)
    {
      vtkWarningMacro(<< warning);
    }
    if (!isDrawn && holes.GetArea(chosen) < SmallHole)
    {
      vtkWarningMacro(
        << "the hole has only " << holes.GetText(chosen)
        << ": it may be thin bone that this Level does not show. Look at it in the CT");
    }
    if (hasTemplate && shape.GetOuterFactor() == 0 && shape.GetThicknessFactor() == 0)
    {
      vtkWarningMacro(
        << "the template is not used: the sound bone of this skull has nothing of its "
           "shape. Compare both in the picture, or give another skull");
    }
    if (implant.LargestError > lacuna::TrustedError)
    {
      vtkWarningMacro(<< GetDoubts(implant, rays, shape.GetPlane()));
    }
    if (const std::string thin = GetThinPlaces(implant); !thin.empty())
    {
      vtkWarningMacro(<< thin);
    }
    if (implant.UndercutWidth > WideUndercut)
    {
      vtkWarningMacro(
        << "the wall of bone has undercuts, so that the gap beside the implant is up to "
        << Rounded(implant.UndercutWidth + this->EdgeClearance) << " mm wide, most at "
        << Name(implant.UndercutPoint)
        << ". Another InsertionDirection may suit this place better");
    }
    vtkPolyData* output = vtkPolyData::GetData(outputs, 0);
    SetSolid(output, implant);
    const auto set = [&](const char* name, double value)
    { vtkLacunaFieldData::Set(output, name, { value }, 1); };
    const auto setPoint = [&](const char* name, const Vec3& p) {
      vtkLacunaFieldData::Set(output, name, { p[0], p[1], p[2] }, 3);
    };
    const auto range = std::minmax_element(implant.Thickness.begin(), implant.Thickness.end());
    set("ChosenDefect", isDrawn ? 0 : static_cast<double>(chosen + 1));
    set("Volume", implant.Volume);
    set("Mass", implant.Volume * this->Density / 1000);
    set("OuterArea", implant.OuterArea);
    set("DefectArea", implant.HoleArea);
    set("ThicknessMinimum", *range.first);
    set("ThicknessMean",
      std::accumulate(implant.Thickness.begin(), implant.Thickness.end(), 0.0) /
        static_cast<double>(implant.Thickness.size()));
    set("ThicknessMaximum", *range.second);
    set("PredictedErrorRMS", implant.ErrorRMS);
    set("PredictedErrorMaximum", implant.LargestError);
    setPoint("PredictedErrorMaximumPoint", implant.LargestErrorPoint);
    setPoint("InsertionDirection", implant.InsertionDirection);
    set("LeastTaper", implant.LeastTaper);
    set("InsertionClearance", implant.InsertionClearance);
    set("UndercutVolume", implant.UndercutVolume);
    set("UndercutWidth", implant.UndercutWidth);
    setPoint("UndercutPoint", implant.UndercutPoint);
    set("MinimumThickness", implant.MinimumThickness);
    setPoint("MinimumThicknessPoint", implant.ThinnestPoint);
    const lacuna::MirrorPlane& plane = shape.GetPlane();
    setPoint("SymmetryPlaneOrigin", center - plane.Distance(center) * plane.Normal);
    setPoint("SymmetryPlaneNormal", plane.Normal);

    if (hasTemplate)
    {
      set("TemplateFitRMS", example.Fit.RMS);
      set("TemplateScale", example.Fit.Scale);
      set("TemplateFactor", shape.GetOuterFactor());
      set("TemplateThicknessFactor", shape.GetThicknessFactor());
    }

    lacuna::ParameterText parameters;
    parameters.Add("Level", this->Level)
      .Add("DefectChoice", this->DefectChoice)
      .Add("Point", std::vector<double>(this->Point, this->Point + 3))
      .Add("EdgeClearance", this->EdgeClearance)
      .Add("Thickness", this->Thickness)
      .Add("MinimumThickness", this->MinimumThickness)
      .Add("InsertionDirection",
        std::vector<double>(this->InsertionDirection, this->InsertionDirection + 3))
      .Add("TriangleSize", this->TriangleSize)
      .Add("Density", this->Density)
      .Add("TemplateLevel", this->TemplateLevel);
    std::vector<vtkDataObject*> given{ image };
    if (isDrawn)
    {
      given.push_back(outline);
    }
    if (hasTemplate)
    {
      given.push_back(other);
    }
    vtkLacunaProvenance::Record(output, this, given, parameters.Get());
    vtkLacunaProvenance::Record(vtkPolyData::GetData(outputs, 1), this, given, parameters.Get());
  };
  return vtkLacunaExecution::RunAgreed(this, outputs, isWanted, body);
}

//------------------------------------------------------------------------------
void vtkLacunaSkullImplant::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Level: " << this->Level << "\n";
  os << indent << "DefectChoice: " << this->DefectChoice << "\n";
  os << indent << "Point: " << this->Point[0] << " " << this->Point[1] << " " << this->Point[2]
     << "\n";
  os << indent << "EdgeClearance: " << this->EdgeClearance << "\n";
  os << indent << "Thickness: " << this->Thickness << "\n";
  os << indent << "MinimumThickness: " << this->MinimumThickness << "\n";
  os << indent << "InsertionDirection: " << this->InsertionDirection[0] << " "
     << this->InsertionDirection[1] << " " << this->InsertionDirection[2] << "\n";
  os << indent << "TriangleSize: " << this->TriangleSize << "\n";
  os << indent << "Density: " << this->Density << "\n";
  os << indent << "TemplateLevel: " << this->TemplateLevel << "\n";
}
