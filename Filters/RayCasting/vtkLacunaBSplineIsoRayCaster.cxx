// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaBSplineIsoRayCaster.h"

#include "lacunaIsoRayCaster.h"
#include "lacunaParameterText.h"
#include "lacunaPerspective.h"

#include "vtkAlgorithmOutput.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaCasterView.h"
#include "vtkLacunaCutAway.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaVolumeCaster.h"
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

using SDDP = vtkStreamingDemandDrivenPipeline;
using View = vtkLacunaCasterView;
}

//------------------------------------------------------------------------------
class vtkLacunaBSplineIsoRayCaster::Internals
{
public:
  vtkLacunaVolumeCaster Caster;

  static lacuna::Vec3 Eye(vtkLacunaBSplineIsoRayCaster* self)
  {
    return { self->EyePosition[0], self->EyePosition[1], self->EyePosition[2] };
  }

  static lacuna::ImagePlane MakePlane(vtkLacunaBSplineIsoRayCaster* self, vtkInformation* inInfo)
  {
    const View::Frame frame = View::FrameOf(inInfo);
    lacuna::ViewSettings view;
    std::copy_n(self->ViewDirection, 3, view.Direction.data());
    std::copy_n(self->ViewUp, 3, view.Up.data());
    std::copy_n(self->FocalPoint, 3, view.FocalPoint.data());
    view.HasFocalPoint = vtkLacunaDepthMap::IsGiven(self->FocalPoint);
    std::copy_n(self->PlaneOrigin, 3, view.PlaneOrigin.data());
    view.HasPlaneOrigin = vtkLacunaDepthMap::IsGiven(self->PlaneOrigin);
    view.PixelSpacing = self->PixelSpacing;
    view.Size = { self->ImageSize[0], self->ImageSize[1] };
    if (self->Projection == Parallel)
    {
      return lacuna::MakeImagePlane(frame.IndexToWorld, frame.Size, view);
    }
    if (!vtkLacunaDepthMap::IsGiven(self->EyePosition))
    {
      throw std::runtime_error(
        "a perspective view needs EyePosition: the point from which the viewer looks");
    }
    lacuna::CheckVolumeSize(frame.Size);
    return lacuna::MakePerspectivePlane(lacuna::CornersOf(frame.IndexToWorld, frame.Size),
      lacuna::SmallestEdgeOf(frame.IndexToWorld), view, Eye(self), self->ViewAngle);
  }

  /// Rings round voxels like +-1e20 reach far: say so.
  static bool IsPadded(const lacuna::IsoRayCaster& caster, double isoValue)
  {
    const double below = isoValue - caster.GetMinimum();
    const double above = caster.GetMaximum() - isoValue;
    const double greatest = std::max(below, above);
    return greatest > 1e5 * std::min(below, above) ||
      greatest > 1e10 * std::max(1.0, std::abs(isoValue));
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
int vtkLacunaBSplineIsoRayCaster::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkLacunaExecution::RunInformation(this, outputVector,
    [&]
    {
      vtkInformation* inInfo = inputVector[0]->GetInformationObject(0);
      vtkInformation* outInfo = outputVector->GetInformationObject(0);
      int extent[6] = { 0, -1, 0, -1, 0, -1 };
      inInfo->Get(SDDP::WHOLE_EXTENT(), extent);
      if (View::IsEmpty(extent))
      {
        outInfo->Set(SDDP::WHOLE_EXTENT(), extent, 6);
        return;
      }
      if (!inInfo->Has(vtkDataObject::DIRECTION()))
      {
        // ParaView's filter between any two proxies drops the direction from the information: then
        // only the data know it. When they are up to date, as they usually are, this does nothing.
        this->RequestUpdateExtent(request, inputVector, outputVector);
        vtkAlgorithmOutput* connection = this->GetInputConnection(0, 0);
        connection->GetProducer()->Update(connection->GetIndex());
      }
      const lacuna::ImagePlane plane = Internals::MakePlane(this, inInfo);
      vtkLacunaDepthMap::SetInformation(outInfo, plane);
    });
}

//------------------------------------------------------------------------------
int vtkLacunaBSplineIsoRayCaster::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  // Any pixel's ray may go anywhere in the volume. Of the start depths all are asked for: a map of
  // another size must be seen to be one.
  for (int port = 0; port < 2; ++port)
  {
    if (inputVector[port]->GetNumberOfInformationObjects() > 0)
    {
      vtkInformation* inInfo = inputVector[port]->GetInformationObject(0);
      int extent[6] = { 0, -1, 0, -1, 0, -1 };
      inInfo->Get(SDDP::WHOLE_EXTENT(), extent);
      inInfo->Set(SDDP::UPDATE_EXTENT(), extent, 6);
      // this very extent: a producer of sub-extents would split it once more by piece
      inInfo->Set(SDDP::UPDATE_PIECE_NUMBER(), 0);
      inInfo->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), 1);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaBSplineIsoRayCaster::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkLacunaExecution::Run(this, outputVector,
    [&](vtkLacunaExecution& execution)
    {
      vtkImageData* input = vtkImageData::GetData(inputVector[0]);
      vtkImageData* output = vtkImageData::GetData(outputVector);
      if (!input || View::IsEmpty(input->GetExtent()))
      {
        return;
      }
      vtkPointData* inputData = input->GetPointData();
      vtkDataArray* scalars = this->ScalarArray.empty()
        ? inputData->GetScalars()
        : inputData->GetArray(this->ScalarArray.c_str());
      if (!scalars)
      {
        throw std::runtime_error(this->ScalarArray.empty()
            ? "the volume has no active point scalars: choose an array"
            : "the volume has no point array '" + this->ScalarArray + "' of numbers");
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
      if (this->IsoValues.empty())
      {
        throw std::runtime_error("no iso-value is given: add one to IsoValues");
      }

      const lacuna::ImagePlane plane =
        Internals::MakePlane(this, inputVector[0]->GetInformationObject(0));
      execution.SetStage(0, 0.1);
      const lacuna::IsoRayCaster& caster = this->Internal->Caster.Prepare(
        input, scalars, this->Interpolation, this->SolidSide, execution);

      int extent[6];
      outputVector->GetInformationObject(0)->Get(SDDP::UPDATE_EXTENT(), extent);
      if (extent[0] < 0 || extent[1] >= plane.Size[0] || extent[2] < 0 ||
        extent[3] >= plane.Size[1] || extent[4] != 0 || extent[5] != 0)
      {
        throw std::runtime_error("pixels outside of the depth map were asked for");
      }
      output->SetExtent(extent);
      vtkLacunaDepthMap::SetGeometry(output, plane);
      const vtkIdType pixels = output->GetNumberOfPoints();
      const auto mask = View::MakeArray<vtkCharArray>(vtkLacunaDepthMap::MaskName, pixels);

      const lacuna::Vec3 eye = Internals::Eye(this);
      lacuna::RayRequest request;
      request.Eye = this->Projection == Perspective ? &eye : nullptr;
      request.CapCutAway = this->CapCutAway;
      request.CapBoundary = this->CapBoundary;
      request.Normals = this->NormalMethod == Analytic ? lacuna::SurfaceNormal::Analytic
                                                       : lacuna::SurfaceNormal::GreyLevel;
      std::vector<double> startDepths;
      vtkImageData* start = vtkImageData::GetData(inputVector[1]);
      if (start)
      {
        startDepths = View::StartDepths(start, plane, request.Eye, extent);
        request.StartDepth = startDepths.data();
      }
      std::unique_ptr<lacuna::CutRegion> cutAway;
      if (this->CutAway)
      {
        const View::Frame frame = View::FrameOf(input);
        cutAway = vtkLacunaCutAway::MakeRegion(this->CutAway,
          0.5 * lacuna::SmallestEdgeOf(frame.IndexToWorld),
          lacuna::CornersOf(frame.IndexToWorld, frame.Size));
        request.CutAway = cutAway.get();
      }
      vtkSmartPointer<vtkDoubleArray> thickness;

      const std::size_t count = this->IsoValues.size();
      for (std::size_t i = 0; i < count; ++i)
      {
        const double isoValue = this->IsoValues[i];
        const std::string number = i ? "_" + std::to_string(i) : "";
        const auto depth =
          View::MakeArray<vtkDoubleArray>(vtkLacunaDepthMap::DepthName + number, pixels);
        const auto normals =
          View::MakeArray<vtkFloatArray>(vtkLacunaDepthMap::NormalsName + number, pixels, 3);
        if (!(isoValue >= caster.GetMinimum() && isoValue <= caster.GetMaximum()))
        {
          vtkWarningMacro("iso-value " << isoValue << " lies outside the values of array '" << name
                                       << "', which range from " << caster.GetMinimum() << " to "
                                       << caster.GetMaximum() << ": " << depth->GetName()
                                       << " is empty");
        }
        if (this->Interpolation == InterpolatingBSpline && Internals::IsPadded(caster, isoValue))
        {
          vtkWarningMacro("array '"
            << name << "' has values from " << caster.GetMinimum() << " to " << caster.GetMaximum()
            << ", very far from the iso-value " << isoValue
            << ": round such voxels the spline that goes through all voxels "
               "swings far up and down. Replace padding values by that of "
               "air with Threshold or Calculator, or choose BSpline");
        }
        request.Thickness = nullptr;
        if (i == 0 && this->ComputeThickness)
        {
          thickness = View::MakeArray<vtkDoubleArray>(ThicknessName, pixels);
          request.Thickness = thickness->GetPointer(0);
        }
        execution.SetStage(0.1 + 0.9 * i / count, 0.1 + 0.9 * (i + 1) / count);
        caster.Cast(plane, isoValue,
          { { extent[0], extent[1], extent[2], extent[3] }, depth->GetPointer(0),
            i ? nullptr : mask->GetPointer(0), normals->GetPointer(0) },
          request, execution);
        vtkPointData* pointData = output->GetPointData();
        pointData->AddArray(depth);
        pointData->AddArray(normals);
        if (i == 0)
        {
          pointData->AddArray(mask);
          pointData->SetNormals(normals);
          if (thickness)
          {
            pointData->AddArray(thickness);
          }
        }
      }
      output->GetPointData()->SetActiveScalars(vtkLacunaDepthMap::DepthName);
      if (caster.GetNumberOfNonFiniteVoxels() > 0)
      {
        vtkWarningMacro("" << caster.GetNumberOfNonFiniteVoxels() << " voxels of array '" << name
                           << "' are not finite numbers and are taken to be empty");
      }

      vtkLacunaFieldData::Set(output, vtkLacunaDepthMap::IsoValuesName, this->IsoValues, 1);
      if (request.Eye)
      {
        vtkLacunaFieldData::Set(
          output, vtkLacunaDepthMap::EyePositionName, { eye[0], eye[1], eye[2] }, 3);
        vtkLacunaFieldData::Set(
          output, vtkLacunaDepthMap::ViewAngleName, { lacuna::ViewAngleOf(plane, eye) }, 1);
      }
      std::vector<vtkDataObject*> sources{ input };
      if (start)
      {
        sources.push_back(start);
      }
      lacuna::ParameterText parameters;
      parameters.Add("Array", name)
        .Add("IsoValues", this->IsoValues)
        .Add("Interpolation", this->Interpolation)
        .Add("SolidSide", this->SolidSide)
        .Add("ViewDirection", this->ViewDirection)
        .Add("ViewUp", this->ViewUp)
        .Add("PlaneOrigin", plane.Origin.Elements)
        .Add("PixelSpacing", plane.PixelSpacing)
        .Add("ImageSize", plane.Size);
      if (request.Eye)
      {
        parameters.Add("EyePosition", eye.Elements);
      }
      parameters.Add("NormalMethod", this->NormalMethod)
        .Add("CutAway", this->CutAway ? this->CutAway->GetClassName() : "None")
        .Add("CapCutAway", this->CapCutAway)
        .Add("CapBoundary", this->CapBoundary);
      vtkLacunaProvenance::Record(output, this, sources, parameters.Get());
    });
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ScalarArray: " << this->ScalarArray << "\n"
     << indent << "IsoValues: " << lacuna::FormatValue(this->IsoValues) << "\n"
     << indent << "Interpolation: " << this->Interpolation << "\n"
     << indent << "SolidSide: " << this->SolidSide << "\n"
     << indent << "ViewDirection: " << lacuna::FormatValue(this->ViewDirection) << "\n"
     << indent << "ViewUp: " << lacuna::FormatValue(this->ViewUp) << "\n"
     << indent << "FocalPoint: " << lacuna::FormatValue(this->FocalPoint) << "\n"
     << indent << "PlaneOrigin: " << lacuna::FormatValue(this->PlaneOrigin) << "\n"
     << indent << "PixelSpacing: " << this->PixelSpacing << "\n"
     << indent << "Projection: " << this->Projection << "\n"
     << indent << "EyePosition: " << lacuna::FormatValue(this->EyePosition) << "\n"
     << indent << "ViewAngle: " << this->ViewAngle << "\n"
     << indent << "NormalMethod: " << this->NormalMethod << "\n"
     << indent << "CutAway: " << this->CutAway.Get() << "\n"
     << indent << "CapCutAway: " << this->CapCutAway << "\n"
     << indent << "CapBoundary: " << this->CapBoundary << "\n"
     << indent << "ComputeThickness: " << this->ComputeThickness << "\n"
     << indent << "ImageSize: " << this->ImageSize[0] << " " << this->ImageSize[1] << "\n";
}
