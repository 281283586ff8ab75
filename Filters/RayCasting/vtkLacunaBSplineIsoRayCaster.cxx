// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaBSplineIsoRayCaster.h"

#include "lacunaIsoRayCaster.h"
#include "lacunaMemory.h"

#include "lacunaCasterView.h"
#include "lacunaCutAway.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaFunctionText.h"
#include "lacunaProposedLevel.h"
#include "lacunaVolumeCaster.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace
{
constexpr const char* ThicknessName = "Thickness";
constexpr std::array<const char*, 2> ProjectionNames{ "Parallel", "Perspective" };

using SDDP = vtkStreamingDemandDrivenPipeline;
using View = lacuna::CasterView;
}

//------------------------------------------------------------------------------
class vtkLacunaBSplineIsoRayCaster::Internals
{
public:
  lacuna::VolumeCaster Caster;
  std::string Made; ///< parameters of the last map

  static lacuna::Vec3 Eye(vtkLacunaBSplineIsoRayCaster* self)
  {
    return { self->EyePosition[0], self->EyePosition[1], self->EyePosition[2] };
  }

  static lacuna::ImagePlane MakePlane(vtkLacunaBSplineIsoRayCaster* self, vtkImageData* volume)
  {
    const View::Frame frame = View::FrameOf(volume);
    const lacuna::ViewSettings view = lacuna::DepthMap::GetView(self);
    if (self->Projection == Parallel)
    {
      return lacuna::MakeImagePlane(frame.IndexToWorld, frame.Size, view);
    }
    if (!lacuna::DepthMap::IsGiven(self->EyePosition))
    {
      throw std::runtime_error(
        "a perspective view needs EyePosition: the point from which the viewer looks");
    }
    lacuna::CheckVolumeSize(frame.Size);
    return lacuna::MakePerspectivePlane(lacuna::CornersOf(frame.IndexToWorld, frame.Size),
      lacuna::SmallestEdgeOf(frame.IndexToWorld), view, Eye(self), self->ViewAngle);
  }

  /// Voxels so far from the iso-value that the rings of the interpolating spline round them reach
  /// far, like padding of 1e9 and more. No data of 16 bits are, whatever the iso-value.
  static bool IsPadded(const lacuna::IsoRayCaster& caster, double isoValue)
  {
    const double greatest =
      std::max(isoValue - caster.GetMinimum(), caster.GetMaximum() - isoValue);
    return greatest > 1e4 * std::max(65536.0, std::abs(isoValue));
  }

  /// What the iso-values of one request share.
  struct Casting
  {
    const lacuna::IsoRayCaster& Caster;
    std::string ArrayName;
    lacuna::ImagePlane Plane;
    std::array<int, 4> Extent;
    lacuna::RayRequest Request;
    vtkImageData* Output;
  };

  static void CheckIsoValues(vtkLacunaBSplineIsoRayCaster* self)
  {
    if (self->IsoValues.empty())
    {
      throw std::runtime_error("no iso-value is given: add one to IsoValues");
    }
  }

  static void RequireMemory(vtkLacunaBSplineIsoRayCaster* self, vtkImageData* map, bool hasStart)
  {
    // depths and normals of each, mask and thickness of the first
    const double bytes = (sizeof(double) + 3 * sizeof(float)) * self->IsoValues.size() +
      sizeof(char) + (self->ComputeThickness ? sizeof(double) : 0) +
      (hasStart ? sizeof(double) : 0);
    lacuna::RequireMemory(
      "this part of the depth map, " + std::to_string(map->GetNumberOfPoints()) + " pixels,",
      static_cast<double>(map->GetNumberOfPoints()) * bytes);
  }

  /// Null: nothing is cut away.
  static std::unique_ptr<lacuna::CutRegion> MakeCutAway(
    vtkLacunaBSplineIsoRayCaster* self, vtkImageData* volume)
  {
    if (!self->CutAway)
    {
      return nullptr;
    }
    const View::Frame frame = View::FrameOf(volume);
    return lacuna::CutAway::MakeRegion(self->CutAway,
      0.5 * lacuna::SmallestEdgeOf(frame.IndexToWorld),
      lacuna::CornersOf(frame.IndexToWorld, frame.Size));
  }

  static vtkDataArray* FindScalars(vtkLacunaBSplineIsoRayCaster* self, vtkImageData* input)
  {
    vtkPointData* inputData = input->GetPointData();
    vtkDataArray* scalars = self->ScalarArray.empty()
      ? inputData->GetScalars()
      : inputData->GetArray(self->ScalarArray.c_str());
    if (!scalars)
    {
      throw std::runtime_error(self->ScalarArray.empty()
          ? "the volume has no active point scalars: choose an array"
          : "the volume has no point array '" + self->ScalarArray + "' of numbers");
    }
    const std::string name = scalars->GetName() ? scalars->GetName() : "";
    if (scalars->GetNumberOfComponents() != 1)
    {
      throw std::runtime_error("array '" + name + "' has " +
        std::to_string(scalars->GetNumberOfComponents()) +
        " components; a surface needs one grey level per voxel");
    }
    if (scalars->GetNumberOfTuples() != input->GetNumberOfPoints())
    {
      throw std::runtime_error("array '" + name + "' has not one value per voxel");
    }
    return scalars;
  }

  /// An iso-value that the voxels do not reach may still have a surface: caps, and with an
  /// interpolating spline its overshoot. So this is said after the cast.
  static void WarnOfIsoValue(vtkLacunaBSplineIsoRayCaster* self, const Casting& casting,
    double isoValue, vtkDataArray* depth)
  {
    const double minimum = casting.Caster.GetMinimum();
    const double maximum = casting.Caster.GetMaximum();
    if (minimum > maximum)
    {
      vtkWarningWithObjectMacro(self,
        "no voxel of array '" << casting.ArrayName << "' is a finite number: " << depth->GetName()
                              << " is empty");
      return;
    }
    if (!(isoValue >= minimum && isoValue <= maximum))
    {
      bool hit = false;
      for (vtkIdType i = 0; i < depth->GetNumberOfTuples() && !hit; ++i)
      {
        hit = !std::isnan(depth->GetComponent(i, 0));
      }
      const bool isAllSolid = self->SolidSide == Above ? isoValue < minimum : isoValue > maximum;
      std::string seen = std::string(depth->GetName()) + " is empty";
      if (hit)
      {
        seen = self->Interpolation == InterpolatingBSpline
          ? "what is seen is the overshoot of the spline between the voxels"
          : "what is seen is";
        seen += isAllSolid
          ? (self->Interpolation == InterpolatingBSpline ? ", or where the solid is cut or ends"
                                                         : " where the solid is cut or ends")
          : "";
      }
      vtkWarningWithObjectMacro(self,
        "iso-value " << isoValue << " lies outside the values of array '" << casting.ArrayName
                     << "', which range from " << minimum << " to " << maximum << ": " << seen);
    }
    if (self->Interpolation == InterpolatingBSpline && IsPadded(casting.Caster, isoValue))
    {
      vtkWarningWithObjectMacro(self,
        "array '" << casting.ArrayName << "' has values from " << minimum << " to " << maximum
                  << ", very far from the iso-value " << isoValue
                  << ": round such voxels the spline that goes through all voxels "
                     "swings far up and down. Replace padding values by that of "
                     "air with Threshold or Calculator, or choose BSpline");
    }
  }

  /// Adds the arrays of one iso-value to the map.
  static void Cast(vtkLacunaBSplineIsoRayCaster* self, const Casting& casting, std::size_t i,
    lacuna::AlgorithmExecution& execution)
  {
    const bool isFirst = i == 0;
    const double isoValue = self->IsoValues[i];
    const std::string number = isFirst ? "" : "_" + std::to_string(i);
    const vtkIdType pixels = casting.Output->GetNumberOfPoints();
    vtkPointData* pointData = casting.Output->GetPointData();
    const auto depth =
      View::MakeArray<vtkDoubleArray>(lacuna::DepthMap::DepthName + number, pixels);
    const auto normals =
      View::MakeArray<vtkFloatArray>(lacuna::DepthMap::NormalsName + number, pixels, 3);
    const auto mask =
      isFirst ? View::MakeArray<vtkCharArray>(lacuna::DepthMap::MaskName, pixels) : nullptr;
    const auto thickness = isFirst && self->ComputeThickness
      ? View::MakeArray<vtkDoubleArray>(ThicknessName, pixels)
      : nullptr;
    lacuna::RayRequest request = casting.Request;
    request.Thickness = thickness ? thickness->GetPointer(0) : nullptr;
    casting.Caster.Cast(casting.Plane, isoValue,
      { casting.Extent, depth->GetPointer(0), mask ? mask->GetPointer(0) : nullptr,
        normals->GetPointer(0) },
      request, execution);
    WarnOfIsoValue(self, casting, isoValue, depth);
    pointData->AddArray(depth);
    pointData->AddArray(normals);
    if (isFirst)
    {
      pointData->AddArray(mask);
      pointData->SetNormals(normals);
      if (thickness)
      {
        pointData->AddArray(thickness);
      }
    }
  }

  /// What is recorded of the map: the view is the one that was found.
  static std::string GetMade(vtkLacunaBSplineIsoRayCaster* self, const Casting& casting)
  {
    lacuna::Properties parameters;
    parameters.Add("Array", casting.ArrayName)
      .Add("IsoValues", self->IsoValues)
      .Add("Interpolation", self->Interpolation, lacuna::FieldInterpolationNames)
      .Add("SolidSide", self->SolidSide, lacuna::SolidSideNames)
      .Add("ViewDirection", self->ViewDirection)
      .Add("ViewUp", self->ViewUp)
      .Add("PlaneOrigin", casting.Plane.Origin.Elements)
      .Add("PixelSpacing", casting.Plane.PixelSpacing)
      .Add("ImageSize", casting.Plane.Size);
    if (casting.Request.Eye)
    {
      parameters.Add("EyePosition", casting.Request.Eye->Elements);
    }
    parameters.Add("NormalMethod", self->NormalMethod, lacuna::SurfaceNormalNames)
      .Add("CutAway", lacuna::FunctionText::Describe(self->CutAway))
      .Add("CapCutAway", self->CapCutAway)
      .Add("CapBoundary", self->CapBoundary)
      .Add("ComputeThickness", self->ComputeThickness);
    return parameters.GetText();
  }
};

vtkStandardNewMacro(vtkLacunaBSplineIsoRayCaster);

//------------------------------------------------------------------------------
vtkLacunaBSplineIsoRayCaster::vtkLacunaBSplineIsoRayCaster()
  : Internal(std::make_unique<Internals>())
{
  std::fill_n(this->FocalPoint, 3, VTK_DOUBLE_MAX);
  std::fill_n(this->PlaneOrigin, 3, VTK_DOUBLE_MAX);
  std::fill_n(this->EyePosition, 3, VTK_DOUBLE_MAX);
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkLacunaBSplineIsoRayCaster::~vtkLacunaBSplineIsoRayCaster() = default;

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::SetNumberOfIsoValues(int number)
{
  const auto size = static_cast<std::size_t>(std::max(0, number));
  if (size != this->IsoValues.size())
  {
    this->IsoValues.resize(size, 0.0);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::SetIsoValue(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro("there is no iso-value number " << i);
    return;
  }
  if (i >= this->GetNumberOfIsoValues())
  {
    this->SetNumberOfIsoValues(i + 1);
  }
  if (this->IsoValues[i] != value)
  {
    this->IsoValues[i] = value;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkLacunaBSplineIsoRayCaster::GetIsoValue(int i) const
{
  return i >= 0 && i < this->GetNumberOfIsoValues() ? this->IsoValues[i] : vtkMath::Nan();
}

//------------------------------------------------------------------------------
double* vtkLacunaBSplineIsoRayCaster::GetProposedIsoRange()
{
  this->ProposedIsoRange = lacuna::ProposedLevel::Get(this, this->ScalarArray, 500);
  return this->ProposedIsoRange.data();
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::SetCutAway(vtkImplicitFunction* function)
{
  if (this->CutAway != function)
  {
    this->CutAway = function;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImplicitFunction* vtkLacunaBSplineIsoRayCaster::GetCutAway() const
{
  return this->CutAway;
}

//------------------------------------------------------------------------------
vtkMTimeType vtkLacunaBSplineIsoRayCaster::GetMTime()
{
  const vtkMTimeType time = this->Superclass::GetMTime();
  return this->CutAway ? std::max(time, this->CutAway->GetMTime()) : time;
}

//------------------------------------------------------------------------------
int vtkLacunaBSplineIsoRayCaster::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::Announce(const lacuna::Ports& ports)
{
  vtkInformation* info = ports.GetOutputInformation();
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  ports.GetInputInformation()->Get(SDDP::WHOLE_EXTENT(), extent);
  if (View::IsEmpty(extent))
  {
    info->Set(SDDP::WHOLE_EXTENT(), extent, 6);
    return;
  }
  // Only the data know where the volume is: ParaView 5.11 drops the direction from the information, and what its
  // Resample To Image announces is its input's. When they are up to date, as they usually are, this does nothing.
  this->UpdateInput(ports);
  auto* input = ports.GetInput<vtkImageData>();
  if (!input || View::IsEmpty(input->GetExtent()))
  {
    const int none[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(SDDP::WHOLE_EXTENT(), none, 6);
    return;
  }
  this->CheckProperties();
  lacuna::DepthMap::SetInformation(info, Internals::MakePlane(this, input));
}

//------------------------------------------------------------------------------
// Any pixel's ray may go anywhere in the volume. Of the start depths all are asked for: a map of
// another size must be seen to be one.
void vtkLacunaBSplineIsoRayCaster::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkImageData>();
  vtkDataArray* scalars = Internals::FindScalars(this, input);
  Internals::CheckIsoValues(this);

  const lacuna::ImagePlane plane = Internals::MakePlane(this, input);
  execution.SetStage(0, 0.1);
  const lacuna::IsoRayCaster& caster =
    this->Internal->Caster.Prepare(input, scalars, this->Interpolation, this->SolidSide, execution);

  std::array<int, 6> extent = ports.GetExtent();
  if (extent[0] < 0 || extent[1] >= plane.Size[0] || extent[2] < 0 || extent[3] >= plane.Size[1] ||
    extent[4] != 0 || extent[5] != 0)
  {
    throw std::runtime_error("pixels outside of the depth map were asked for");
  }
  output->SetExtent(extent.data());
  lacuna::DepthMap::SetGeometry(output, plane);

  const lacuna::Vec3 eye = Internals::Eye(this);
  Internals::Casting casting{ caster, scalars->GetName() ? scalars->GetName() : "", plane,
    { extent[0], extent[1], extent[2], extent[3] }, {}, output };
  lacuna::RayRequest& request = casting.Request;
  request.Eye = this->Projection == Perspective ? &eye : nullptr;
  request.CapCutAway = this->CapCutAway;
  request.CapBoundary = this->CapBoundary;
  request.Normals = static_cast<lacuna::SurfaceNormal>(this->NormalMethod);
  auto* start = ports.GetInput<vtkImageData>(1);
  Internals::RequireMemory(this, output, start != nullptr);
  std::vector<double> startDepths;
  if (start)
  {
    startDepths = View::StartDepths(start, plane, request.Eye, extent.data());
    request.StartDepth = startDepths.data();
  }
  const std::unique_ptr<lacuna::CutRegion> cutAway = Internals::MakeCutAway(this, input);
  request.CutAway = cutAway.get();
  const std::size_t count = this->IsoValues.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    execution.SetStage(0.1 + 0.9 * i / count, 0.1 + 0.9 * (i + 1) / count);
    Internals::Cast(this, casting, i, execution);
  }
  output->GetPointData()->SetActiveScalars(lacuna::DepthMap::DepthName);
  if (caster.GetNumberOfNonFiniteVoxels() > 0 && caster.GetMinimum() <= caster.GetMaximum())
  {
    vtkWarningMacro("" << caster.GetNumberOfNonFiniteVoxels() << " voxels of array '"
                       << casting.ArrayName
                       << "' are not finite numbers and are taken to be empty");
  }

  lacuna::FieldData::Set(output, lacuna::DepthMap::IsoValuesName, this->IsoValues, 1);
  if (request.Eye)
  {
    lacuna::FieldData::Set(
      output, lacuna::DepthMap::EyePositionName, { eye[0], eye[1], eye[2] }, 3);
    lacuna::FieldData::Set(
      output, lacuna::DepthMap::ViewAngleName, { lacuna::ViewAngleOf(plane, eye) }, 1);
  }
  this->Internal->Made = Internals::GetMade(this, casting);
}

//------------------------------------------------------------------------------
std::string vtkLacunaBSplineIsoRayCaster::Parameters(int) const
{
  return this->Internal->Made;
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::Describe(lacuna::Properties& properties) const
{
  using Range = lacuna::ValueRange;
  properties.Add("ScalarArray", this->ScalarArray)
    .Add("IsoValues", this->IsoValues, Range::Any("grey level"))
    .Add("Interpolation", this->Interpolation, lacuna::FieldInterpolationNames)
    .Add("SolidSide", this->SolidSide, lacuna::SolidSideNames)
    .Add("ViewDirection", this->ViewDirection, Range::Any())
    .Add("ViewUp", this->ViewUp, Range::Any())
    .Add("FocalPoint", this->FocalPoint, Range::Any("mm"))
    .Add("PlaneOrigin", this->PlaneOrigin, Range::Any("mm"))
    .Add("PixelSpacing", this->PixelSpacing, Range::Above(0, "mm").OrZero("smallest voxel edge"))
    .Add("ImageSize", this->ImageSize, Range::AtLeast(1, "pixels").OrZero("whole volume"))
    .Add("Projection", this->Projection, ProjectionNames)
    .Add("EyePosition", this->EyePosition, Range::Any("mm"))
    .Add("ViewAngle", this->ViewAngle, Range::Above(0, "degrees").UpTo(180))
    .Add("NormalMethod", this->NormalMethod, lacuna::SurfaceNormalNames)
    .Add("CutAway", lacuna::FunctionText::Describe(this->CutAway))
    .Add("CapCutAway", this->CapCutAway)
    .Add("CapBoundary", this->CapBoundary)
    .Add("ComputeThickness", this->ComputeThickness);
}
