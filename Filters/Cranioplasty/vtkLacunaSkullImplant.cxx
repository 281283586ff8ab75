// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSkullImplant.h"

#include "lacunaFieldData.h"
#include "lacunaImplantData.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaSkullImplant.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullShape.h"
#include "lacunaSkullShells.h"
#include "lacunaSkullTemplate.h"
#include "lacunaVolumeSymmetry.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaSkullImplant);

namespace
{
using lacuna::NameOf;
using lacuna::Rounded;
using lacuna::Vec3;

constexpr std::array<const char*, 2> DefectChoiceNames{ "Largest", "Nearest to Point" };
constexpr double RaySpacing = 2;    // mm at 90 mm
constexpr double Seen = 10;         // mm, the farthest bone that shows what a place is like
constexpr double MostDistance = 30; // mm of Point from a hole
constexpr double SmallHole = 400;   // mm^2, below which it may be none
constexpr double ThinPlace = 1.5;   // mm, of an implant
constexpr double WideUndercut = 1;  // mm: of which is told
constexpr double BelowBone = 25;    // mm, of the box in which bone is looked at
constexpr double BesideBone = 12;   // mm
constexpr double LeastGap = 10;     // mm^2, of those that are told of
// A template that fits: part of the sound bone that it has to have, scale or its inverse, RMS in mm.
constexpr double LeastCovered = 0.6;
constexpr double MostScale = 1.5;
constexpr double MostTemplateError = 6;
constexpr std::int16_t LevelOfHalf = 300; // of the copy in which symmetry is sought

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

// The largest of the holes that are too small.
std::string GetSmallHole(const lacuna::SkullRays& rays)
{
  const std::vector<std::vector<int>> small = FindDefects(rays, LeastGap);
  return small.empty()
    ? ""
    : ". The largest gap has " + lacuna::SkullHoles(rays, { small[0] }).GetText();
}

// The one hole that is drawn; its rays become open.
std::vector<std::vector<int>> OpenWithin(vtkPolyData* outline, lacuna::SkullRays& rays)
{
  std::vector<int> hole = FindRaysWithin(rays, lacuna::GetCurve(outline));
  if (hole.empty())
  {
    throw std::runtime_error("the outline of the defect encloses nothing of the skull");
  }
  for (const int ray : hole)
  {
    rays.Kinds[ray] = lacuna::SkullRayKind::Open;
  }
  return { std::move(hole) };
}

// All holes of the vault, the largest first.
std::vector<std::vector<int>> FindHoles(const lacuna::SkullRays& rays)
{
  std::vector<std::vector<int>> holes = FindDefects(rays);
  if (holes.empty())
  {
    throw std::runtime_error("no hole of 1 cm^2 or more was found in the vault of the skull" +
      GetSmallHole(rays) +
      ". Look at the bone at this Level, or draw an outline around the defect");
  }
  return holes;
}

// The hole nearest to a point.
std::size_t FindNearest(const lacuna::SkullHoles& holes, std::size_t count, const Vec3& point)
{
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k)
  {
    const double distance = holes.GetDistance(k, point);
    if (distance < least)
    {
      least = distance;
      nearest = k;
    }
  }
  if (!(least <= MostDistance))
  {
    throw std::runtime_error("Point " + NameOf(point) + " is " + Rounded(least) +
      " mm away from the nearest hole. Found: " + holes.GetText());
  }
  return nearest;
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
    " cm^2. The least certain place is " + NameOf(worst) + ", " + Rounded(distanceOf(worst), 1) +
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
    " mm, at " + NameOf(implant.Points[thinnest]) + ". Look whether the material allows that";
}

// Of an implant: where its surface is uncertain, where it is thin, and where bone is undercut.
void AddWarnings(const lacuna::SkullImplant& implant, const lacuna::SkullRays& rays,
  const lacuna::MirrorPlane& plane, double edgeClearance, std::vector<std::string>& warnings)
{
  if (implant.LargestError > lacuna::TrustedError)
  {
    warnings.push_back(GetDoubts(implant, rays, plane));
  }
  if (const std::string thin = GetThinPlaces(implant); !thin.empty())
  {
    warnings.push_back(thin);
  }
  if (implant.UndercutWidth > WideUndercut)
  {
    warnings.push_back("the wall of bone has undercuts, so that the gap beside the implant is up "
                       "to " +
      Rounded(implant.UndercutWidth + edgeClearance) + " mm wide, most at " +
      NameOf(implant.UndercutPoint) + ". Another InsertionDirection may suit this place better");
  }
}

// Field data of the output.
void SetWarnings(vtkPolyData* output, const std::vector<std::string>& warnings)
{
  vtkNew<vtkStringArray> told;
  told->SetName("Warnings");
  for (const std::string& warning : warnings)
  {
    told->InsertNextValue(warning);
  }
  output->GetFieldData()->AddArray(told);
}

void SetNumber(vtkPolyData* output, const char* name, double value)
{
  lacuna::FieldData::Set(output, name, { value }, 1);
}

void SetPoint(vtkPolyData* output, const char* name, const Vec3& p)
{
  lacuna::FieldData::Set(output, name, { p[0], p[1], p[2] }, 3);
}

void SetMeasures(vtkPolyData* output, const lacuna::SkullImplant& implant, double density)
{
  const auto range = std::minmax_element(implant.Thickness.begin(), implant.Thickness.end());
  SetNumber(output, "Volume", implant.Volume);
  SetNumber(output, "Mass", implant.Volume * density / 1000);
  SetNumber(output, "OuterArea", implant.OuterArea);
  SetNumber(output, "DefectArea", implant.HoleArea);
  SetNumber(output, "ThicknessMinimum", *range.first);
  SetNumber(output, "ThicknessMean",
    std::accumulate(implant.Thickness.begin(), implant.Thickness.end(), 0.0) /
      static_cast<double>(implant.Thickness.size()));
  SetNumber(output, "ThicknessMaximum", *range.second);
  SetNumber(output, "PredictedErrorRMS", implant.ErrorRMS);
  SetNumber(output, "PredictedErrorMaximum", implant.LargestError);
  SetPoint(output, "PredictedErrorMaximumPoint", implant.LargestErrorPoint);
  SetPoint(output, "InsertionDirection", implant.InsertionDirection);
  SetNumber(output, "LeastTaper", implant.LeastTaper);
  SetNumber(output, "InsertionClearance", implant.InsertionClearance);
  SetNumber(output, "UndercutVolume", implant.UndercutVolume);
  SetNumber(output, "UndercutWidth", implant.UndercutWidth);
  SetPoint(output, "UndercutPoint", implant.UndercutPoint);
  SetNumber(output, "MinimumThickness", implant.MinimumThickness);
  SetPoint(output, "MinimumThicknessPoint", implant.ThinnestPoint);
  SetNumber(output, "NumberOfHoles", implant.Holes);
}

void SetPlane(vtkPolyData* output, const lacuna::MirrorPlane& plane, const Vec3& center)
{
  SetPoint(output, "SymmetryPlaneOrigin", center - plane.Distance(center) * plane.Normal);
  SetPoint(output, "SymmetryPlaneNormal", plane.Normal);
}

void SetTemplate(
  vtkPolyData* output, const lacuna::TemplateFit& fit, const lacuna::SkullShape& shape)
{
  SetNumber(output, "TemplateFitRMS", fit.RMS);
  SetNumber(output, "TemplateScale", fit.Scale);
  SetNumber(output, "TemplateFactor", shape.GetOuterFactor());
  SetNumber(output, "TemplateThicknessFactor", shape.GetThicknessFactor());
}
}

//------------------------------------------------------------------------------
vtkLacunaSkullImplant::vtkLacunaSkullImplant()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesBlocks = true;
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(3);
}

//------------------------------------------------------------------------------
void vtkLacunaSkullImplant::SetEngravedText(const char* text)
{
  const std::string value = text ? text : "";
  if (this->EngravedText != value)
  {
    this->EngravedText = value;
    this->Modified();
  }
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
lacuna::SkullImplantOptions vtkLacunaSkullImplant::GetOptions() const
{
  lacuna::SkullImplantOptions options;
  options.Level = this->Level;
  options.EdgeClearance = this->EdgeClearance;
  options.TriangleSize = this->TriangleSize;
  options.Thickness = this->Thickness;
  options.MinimumThickness = this->MinimumThickness;
  std::copy_n(this->InsertionDirection, 3, options.InsertionDirection.data());
  options.OuterOffset = this->OuterOffset;
  options.InnerOffset = this->InnerOffset;
  options.OffsetFade = this->OffsetFade;
  options.Parts = this->Parts;
  options.DrainageSpacing = this->DrainageSpacing;
  options.DrainageDiameter = this->DrainageDiameter;
  options.SutureSpacing = this->SutureSpacing;
  options.SutureDiameter = this->SutureDiameter;
  options.Plates = this->Plates;
  options.ScrewDiameter = this->ScrewDiameter;
  options.ScrewLength = this->ScrewLength;
  options.RimDistance = this->RimDistance;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaSkullImplant::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* outline = ports.GetInput<vtkPolyData>(1);
  auto* other = ports.GetInput<vtkDataSet>(2);
  const bool isDrawn = outline && outline->GetNumberOfPoints() > 0;
  const bool hasTemplate = other && other->GetNumberOfPoints() > 0;
  lacuna::SkullImplantOptions options = this->GetOptions();
  options.Text = lacuna::GetTextOutlines(this->EngravedText, this->TextHeight);
  CheckSkullImplantOptions(options);
  vtkSmartPointer<vtkDataArray> keep;
  const lacuna::VoxelVolume volume = lacuna::GetBoneVolume(ports.GetInput<vtkImageData>(), keep);

  execution.SetStage(0, 0.3);
  const lacuna::SymmetryResult symmetry = FindSymmetry(volume, this->Level, execution);
  execution.SetStage(0.3, 0.32);
  const Vec3 center = FindSkullCenter(volume, this->Level, symmetry.Plane, execution);
  execution.SetStage(0.32, 0.35);
  lacuna::SkullRays rays = TraceSkull(volume, this->Level, center, RaySpacing, execution);
  const std::vector<std::vector<int>> defects =
    isDrawn ? OpenWithin(outline, rays) : FindHoles(rays);
  const lacuna::SkullHoles holes(rays, defects);
  holes.SetOutput(ports.GetOutput<vtkPolyData>(1), isDrawn ? 0 : 1);
  const std::size_t chosen = !isDrawn && this->DefectChoice == NearestToPoint
    ? FindNearest(holes, defects.size(), { this->Point[0], this->Point[1], this->Point[2] })
    : 0;

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
  const lacuna::SkullImplant implant =
    MakeSkullImplant(volume, rays, defects[chosen], shape, *near, options, execution);

  std::vector<std::string> warnings = implant.Warnings;
  if (!isDrawn && holes.GetArea(chosen) < SmallHole)
  {
    warnings.push_back("the hole has only " + holes.GetText(chosen) +
      ": it may be thin bone that this Level does not show. Look at it in the CT");
  }
  if (hasTemplate && shape.GetOuterFactor() == 0 && shape.GetThicknessFactor() == 0)
  {
    warnings.emplace_back(
      "the template is not used: the sound bone of this skull has nothing of its shape. Compare "
      "both in the picture, or give another skull");
  }
  AddWarnings(implant, rays, shape.GetPlane(), this->EdgeClearance, warnings);
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< warning);
  }
  auto* output = ports.GetOutput<vtkPolyData>();
  lacuna::SetImplant(output, implant);
  SetWarnings(output, warnings);
  lacuna::SetPlates(ports.GetOutput<vtkPolyData>(2), implant, this->ScrewLength);
  SetNumber(output, "ChosenDefect", isDrawn ? 0 : static_cast<double>(chosen + 1));
  SetMeasures(output, implant, this->Density);
  SetPlane(output, shape.GetPlane(), center);
  if (hasTemplate)
  {
    SetTemplate(output, example.Fit, shape);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSkullImplant::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("Level", this->Level, ValueRange::Above(0, "HU"))
    .Add("DefectChoice", this->DefectChoice, DefectChoiceNames)
    .Add("Point", this->Point, ValueRange::Any("mm"));
  this->GetOptions().Describe(properties);
  properties.Add("EngravedText", this->EngravedText)
    .Add("TextHeight", this->TextHeight, ValueRange::Between(2, 20, "mm"))
    .Add("Density", this->Density, ValueRange::Above(0, "g/cm\u00b3"))
    .Add("TemplateLevel", this->TemplateLevel, ValueRange::Above(0, "HU").OrZero("as Level"));
}
