// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSliceRayCaster.h"

#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaProposedLevel.h"
#include "lacunaSliceFingerprint.h"
#include "lacunaSliceImages.h"
#include "lacunaSliceRayCaster.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// Far above rounding: of slices at the widest distance, none is cut off by chance.
constexpr double GapTolerance = 1e-6;

bool IsSame(const lacuna::ImagePlane& a, const lacuna::ImagePlane& b)
{
  return a.Origin == b.Origin && a.Right == b.Right && a.Down == b.Down && a.View == b.View &&
    a.PixelSpacing == b.PixelSpacing && a.Size == b.Size;
}

// True when info announces the map of plane.
bool IsAnnounced(vtkInformation* info, const lacuna::ImagePlane& plane)
{
  vtkNew<vtkInformation> now;
  lacuna::DepthMap::SetInformation(now, plane);
  const auto isSame = [&](auto* key, int count)
  { return info->Has(key) && std::equal(now->Get(key), now->Get(key) + count, info->Get(key)); };
  return isSame(SDDP::WHOLE_EXTENT(), 6) && isSame(vtkDataObject::ORIGIN(), 3) &&
    isSame(vtkDataObject::SPACING(), 3) && isSame(vtkDataObject::DIRECTION(), 9);
}
}

//------------------------------------------------------------------------------
/// What there is to do: which slices are seen from where.
class vtkLacunaSliceRayCaster::Plan
{
public:
  /// Throws std::exception with a text for the user.
  Plan(vtkLacunaSliceRayCaster* self, const lacuna::Ports& ports)
  {
    auto* stack = ports.GetInput<vtkImageData>();
    if (!stack || stack->GetNumberOfPoints() == 0)
    {
      return;
    }
    lacuna::SliceSelection selection =
      lacuna::SliceSelection::Make(self, ports.GetInputInformation());
    selection.HasSweepEnds = self->GapMethod == AutomaticGap;
    this->Images = std::make_unique<lacuna::SliceImages>(stack, selection);
    if (this->GetSlices().empty() && !this->IsMoreToCome())
    {
      std::ostringstream message;
      message << "no slice is left to look at: " << this->Images->DescribeFlags();
      if (!this->Images->LeftOut.empty())
      {
        message << "; " << this->Images->LeftOut.size() << " have bad poses";
      }
      message << "; " << this->Images->DescribeRemedy();
      throw std::runtime_error(message.str());
    }
    if (this->GetSlices().empty() && this->Images->Others.empty())
    {
      this->Images.reset(); // of a sweep that has just begun
      return;
    }
    const lacuna::SliceFan fan = lacuna::SliceFan::Make(self);
    if (fan.HasSector())
    {
      this->Images->ApplyFan(fan);
    }
    this->ChoosePlane(self);
    this->MaximumGap = self->GapMethod == UnlimitedGap ? 0 : self->MaximumGap;
    if (self->GapMethod == AutomaticGap)
    {
      const double widest =
        (1 + GapTolerance) * lacuna::GetWidestStepAlongRays(this->GetSlices(), this->Plane);
      this->MaximumGap = this->MaximumGap > 0 && this->MaximumGap < widest ? this->MaximumGap
        : widest > 0                                                       ? widest
                                                                           : this->MaximumGap;
    }
  }

  bool IsEmpty() const { return !this->Images; }
  const std::vector<lacuna::SliceImage>& GetSlices() const { return this->Images->Slices; }
  /// True while a replay has not reached its end, and while slices are being taken.
  bool IsMoreToCome() const { return this->Images->IsMoreToCome; }

  std::unique_ptr<lacuna::SliceImages> Images;
  lacuna::ImagePlane Plane;
  double MaximumGap = 0; ///< mm along the rays; 0 = no limit

private:
  void ChoosePlane(vtkLacunaSliceRayCaster* self)
  {
    const lacuna::ViewSettings view = lacuna::DepthMap::GetView(self);
    std::vector<lacuna::Vec3> points;
    double finest = VTK_DOUBLE_MAX;
    for (const auto* slices : { &this->Images->Slices, &this->Images->Others })
    {
      for (const lacuna::SliceImage& slice : *slices)
      {
        const auto corners = lacuna::GetCorners(slice);
        points.insert(points.end(), corners.begin(), corners.end());
        finest = std::min({ finest, lacuna::Norm(slice.PixelToReference.Column(0)),
          lacuna::Norm(slice.PixelToReference.Column(1)) });
      }
    }
    this->Plane = lacuna::MakeImagePlane(points, finest, view);
  }
};

//------------------------------------------------------------------------------
/// The casting so far: more slices of the same sweep, or another MaximumGap, go on from there.
class vtkLacunaSliceRayCaster::State
{
public:
  std::unique_ptr<lacuna::SliceRayCaster> Caster;
  lacuna::ImagePlane Plane;
  std::array<int, 4> Extent{};
  double IsoValue = 0;
  int SolidSide = 0;
  std::vector<lacuna::SliceFingerprint> Slices;
  /// Of the first slices that have been cast; kept up only while it is of interest.
  lacuna::GreyRange GreyLevels;

  /// What the casting takes, which the next one uses or frees before it needs more.
  double GetBytes() const
  {
    return this->Caster ? static_cast<double>(lacuna::SliceRayCaster::GetBytesPerPixel()) *
        (1.0 + this->Extent[1] - this->Extent[0]) * (1.0 + this->Extent[3] - this->Extent[2])
                        : 0;
  }

  /// Brings the casting up to date and returns how many slices had to be cast for that.
  std::size_t Update(const vtkLacunaSliceRayCaster* self, const Plan& plan,
    const std::array<int, 4>& extent, lacuna::Execution& execution)
  {
    execution.SetStage(0, 0.1);
    std::vector<lacuna::SliceFingerprint> slices =
      lacuna::GetFingerprints(plan.GetSlices(), execution);
    // not kept while it changes: what is stopped on the way is of no use
    std::unique_ptr<lacuna::SliceRayCaster> caster = std::move(this->Caster);
    auto known = static_cast<std::ptrdiff_t>(this->Slices.size());
    const auto begin = plan.GetSlices().begin();
    if (caster && IsSame(this->Plane, plan.Plane) && this->Extent == extent &&
      this->IsoValue == self->IsoValue && this->SolidSide == self->SolidSide &&
      lacuna::IsContinued(this->Slices, slices))
    {
      caster->MoveSlices({ begin, begin + known });
    }
    else
    {
      known = 0;
      this->GreyLevels = {};
      caster = nullptr; // its memory goes before there is a new one
      caster = std::make_unique<lacuna::SliceRayCaster>(
        plan.Plane, extent, self->IsoValue, static_cast<lacuna::SolidSide>(self->SolidSide));
    }
    execution.SetStage(0.1, 0.9);
    caster->AddSlices({ begin + known, plan.GetSlices().end() }, execution);
    this->Plane = plan.Plane;
    this->Extent = extent;
    this->IsoValue = self->IsoValue;
    this->SolidSide = self->SolidSide;
    this->Slices = std::move(slices);
    this->Caster = std::move(caster);
    return this->Slices.size() - static_cast<std::size_t>(known);
  }
};

vtkStandardNewMacro(vtkLacunaSliceRayCaster);

//------------------------------------------------------------------------------
vtkLacunaSliceRayCaster::vtkLacunaSliceRayCaster()
  : Kept(std::make_unique<State>())
{
  std::fill_n(this->FocalPoint, 3, VTK_DOUBLE_MAX);
  std::fill_n(this->PlaneOrigin, 3, VTK_DOUBLE_MAX);
}

//------------------------------------------------------------------------------
vtkLacunaSliceRayCaster::~vtkLacunaSliceRayCaster() = default;

//------------------------------------------------------------------------------
void vtkLacunaSliceRayCaster::Announce(const lacuna::Ports& ports)
{
  this->CheckProperties();
  this->UpdateInput(ports);
  vtkInformation* info = ports.GetOutputInformation();
  const Plan plan(this, ports);
  if (plan.IsEmpty())
  {
    const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(SDDP::WHOLE_EXTENT(), nothing, 6);
  }
  else
  {
    lacuna::DepthMap::SetInformation(info, plan.Plane);
  }
  info->Set(SDDP::TIME_DEPENDENT_INFORMATION(), 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceRayCaster::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  vtkInformation* info = ports.GetOutputInformation();
  auto* output = ports.GetOutput<vtkImageData>();
  output->GetFieldData()->Initialize(); // VTK passes the slices' own
  this->NumberOfCastSlices = 0;
  const Plan plan(this, ports);
  if (plan.IsEmpty())
  {
    output->Initialize();
    return;
  }
  const lacuna::ImagePlane& plane = plan.Plane;
  if (!IsAnnounced(info, plane))
  {
    throw std::runtime_error(
      "the slices have changed since the map was announced (a source that changes with "
      "time?); set FocalPoint, PlaneOrigin, PixelSpacing and ImageSize, so that the map does "
      "not depend on the slices");
  }
  int extent[6];
  info->Get(SDDP::UPDATE_EXTENT(), extent);
  output->SetExtent(extent);
  lacuna::DepthMap::SetGeometry(output, plane);
  const vtkIdType pixels = output->GetNumberOfPoints();
  constexpr std::int64_t arrays = sizeof(double) + sizeof(char) + 3 * sizeof(float);
  lacuna::RequireMemory("this part of the depth map",
    static_cast<double>(pixels) *
      static_cast<double>(arrays + lacuna::SliceRayCaster::GetBytesPerPixel()),
    this->Kept->GetBytes());
  vtkNew<vtkDoubleArray> depth;
  depth->SetName(lacuna::DepthMap::DepthName);
  lacuna::Arrays::SetNumberOfTuples(depth, pixels);
  vtkNew<vtkCharArray> mask;
  mask->SetName(lacuna::DepthMap::MaskName);
  lacuna::Arrays::SetNumberOfTuples(mask, pixels);
  vtkNew<vtkFloatArray> normals;
  normals->SetName(lacuna::DepthMap::NormalsName);
  normals->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(normals, pixels);
  if (pixels > 0)
  {
    const std::array<int, 4> part{ extent[0], extent[1], extent[2], extent[3] };
    this->NumberOfCastSlices =
      static_cast<vtkIdType>(this->Kept->Update(this, plan, part, execution));
    execution.SetStage(0.9, 1);
    this->Kept->Caster->Write(plan.MaximumGap,
      { part, depth->GetPointer(0), mask->GetPointer(0), normals->GetPointer(0) }, execution);
    this->WarnAbout(plan, std::count(mask->GetPointer(0), mask->GetPointer(pixels), 1) > 0, output);
  }
  output->GetPointData()->SetScalars(depth);
  output->GetPointData()->AddArray(mask);
  output->GetPointData()->SetNormals(normals);
  lacuna::FieldData::Set(output, lacuna::DepthMap::IsoValuesName, { this->IsoValue }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceRayCaster::WarnAbout(const Plan& plan, bool hasSurface, vtkImageData* output)
{
  std::map<std::string, std::string> warnings;
  this->RecordSweeps({ plan.Images.get() }, this->MaximumGap, output, warnings);
  lacuna::FieldData::Set(output, "RayGap", { plan.MaximumGap }, 1);
  const std::string preview = plan.Images->DescribePreview();
  if (!preview.empty())
  {
    warnings["preview"] = preview;
  }
  const lacuna::SliceRayCaster& caster = *this->Kept->Caster;
  const std::int64_t edgeOn = caster.GetNumberOfEdgeOnSlices();
  if (edgeOn > 0)
  {
    // the way to look that shows most of the slices
    lacuna::Vec3 across{ 0, 0, 0 };
    for (const lacuna::SliceImage& slice : plan.GetSlices())
    {
      const lacuna::Vec3 normal = lacuna::Normalized(
        lacuna::Cross(slice.PixelToReference.Column(0), slice.PixelToReference.Column(1)));
      across = across + (lacuna::Dot(normal, across) < 0 ? -1.0 : 1.0) * normal;
    }
    across = lacuna::Normalized(across);
    for (double& x : across.Elements)
    {
      x = std::round(1000 * x) / 1000 + 0.0; // to be read; no negative zero
    }
    std::ostringstream text;
    text << edgeOn << " of " << caster.GetNumberOfSlices()
         << " slices are seen edge-on, at less than " << lacuna::SliceProjection::SmallestAngle
         << " degree from the view direction, and left out; the slices are seen best along the "
            "ViewDirection "
         << across[0] << " " << across[1] << " " << across[2] << " or its opposite";
    warnings["edge-on"] = text.str();
  }
  if (!hasSurface && !plan.IsMoreToCome())
  {
    // the pixels are looked at only now: it takes longer than to cast a slice
    lacuna::GreyRange& range = this->Kept->GreyLevels;
    if (!range.Contains(this->IsoValue))
    {
      range.Update(plan.GetSlices());
    }
    if (!range.Contains(this->IsoValue))
    {
      std::ostringstream text;
      text << "IsoValue " << this->IsoValue << " lies outside the grey levels of the slices, ";
      if (range.HasLevels())
      {
        text << "which range from " << range.GetLow() << " to " << range.GetHigh();
      }
      else
      {
        text << "none of which is a number";
      }
      text << ": the map is empty";
      warnings["IsoValue " + std::to_string(this->IsoValue)] = text.str();
    }
  }
  this->WarnOfNews(warnings, plan.Images->LeftOut);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceRayCaster::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("IsoValue", this->IsoValue, ValueRange::Any("grey level"))
    .Add("SolidSide", this->SolidSide, lacuna::SolidSideNames);
  this->DescribeGapMethod(properties);
  properties.Add("MaximumGap", this->MaximumGap, ValueRange::AtLeast(0, "mm"))
    .Add("ViewDirection", this->ViewDirection, ValueRange::Any())
    .Add("ViewUp", this->ViewUp, ValueRange::Any())
    .Add("FocalPoint", this->FocalPoint, ValueRange::Any("mm"))
    .Add("PlaneOrigin", this->PlaneOrigin, ValueRange::Any("mm"))
    .Add("PixelSpacing", this->PixelSpacing, ValueRange::Above(0, "mm").OrZero("of the slices"))
    .Add("ImageSize", this->ImageSize, ValueRange::AtLeast(1, "pixels").OrZero("all slices"));
  this->DescribeClip(properties);
  this->DescribeSlices(properties);
}

//------------------------------------------------------------------------------
double* vtkLacunaSliceRayCaster::GetProposedIsoRange()
{
  this->ProposedIsoRange = lacuna::ProposedLevel::Get(this, {}, 128);
  return this->ProposedIsoRange.data();
}

//------------------------------------------------------------------------------
void vtkLacunaSliceRayCaster::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "NumberOfCastSlices: " << this->NumberOfCastSlices << "\n";
}
