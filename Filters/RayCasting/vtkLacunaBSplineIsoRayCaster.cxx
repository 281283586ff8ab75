// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaBSplineIsoRayCaster.h"

#include "lacunaIsoRayCaster.h"

#include "vtkAlgorithmOutput.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaScalarType.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>

static_assert(vtkLacunaBSplineIsoRayCaster::Trilinear ==
    static_cast<int>(lacuna::FieldInterpolation::Trilinear),
  "the property is the kernel's enumeration");

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

std::array<int, 3> SizeOf(const int extent[6])
{
  return { extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1 };
}

bool IsEmpty(const int extent[6])
{
  const auto size = SizeOf(extent);
  return size[0] <= 0 || size[1] <= 0 || size[2] <= 0;
}

/// The kernel's indices start at the extent's first voxel.
lacuna::Matrix4 IndexToWorld(
  const double* origin, const double* spacing, const double* direction, const int* extent)
{
  vtkNew<vtkMatrix4x4> m;
  vtkImageData::ComputeIndexToPhysicalMatrix(origin, spacing, direction, m->GetData());
  return lacuna::Matrix4(m->GetData()) *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
}

std::string Joined(const double* values, std::size_t n)
{
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = 0; i < n; ++i)
  {
    text << (i ? "," : "") << values[i];
  }
  return text.str();
}
}

//------------------------------------------------------------------------------
/// The prepared volume is kept: a new view or iso-value of the same volume needs it unchanged.
class vtkLacunaBSplineIsoRayCaster::Internals
{
public:
  using Key =
    std::tuple<vtkDataArray*, vtkMTimeType, std::array<int, 3>, std::array<double, 16>, int, int>;
  Key CasterKey{};
  /// What the caster refers to when the input's own memory layout does not serve.
  vtkSmartPointer<vtkDataArray> Copy;
  std::unique_ptr<lacuna::IsoRayCaster> Caster;

  static lacuna::ImagePlane MakePlane(vtkLacunaBSplineIsoRayCaster* self, vtkInformation* inInfo)
  {
    int extent[6];
    double origin[3] = { 0, 0, 0 };
    double spacing[3] = { 1, 1, 1 };
    double direction[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    inInfo->Get(SDDP::WHOLE_EXTENT(), extent);
    if (inInfo->Has(vtkDataObject::ORIGIN()))
    {
      inInfo->Get(vtkDataObject::ORIGIN(), origin);
    }
    if (inInfo->Has(vtkDataObject::SPACING()))
    {
      inInfo->Get(vtkDataObject::SPACING(), spacing);
    }
    vtkImageData* data = vtkImageData::GetData(inInfo);
    if (inInfo->Has(vtkDataObject::DIRECTION()))
    {
      inInfo->Get(vtkDataObject::DIRECTION(), direction);
    }
    else if (data && !IsEmpty(data->GetExtent()))
    {
      std::copy_n(data->GetDirectionMatrix()->GetData(), 9, direction);
    }
    lacuna::ViewSettings view;
    std::copy_n(self->ViewDirection, 3, view.Direction.data());
    std::copy_n(self->ViewUp, 3, view.Up.data());
    std::copy_n(self->FocalPoint, 3, view.FocalPoint.data());
    view.HasFocalPoint = vtkLacunaDepthMap::IsGiven(self->FocalPoint);
    std::copy_n(self->PlaneOrigin, 3, view.PlaneOrigin.data());
    view.HasPlaneOrigin = vtkLacunaDepthMap::IsGiven(self->PlaneOrigin);
    view.PixelSpacing = self->PixelSpacing;
    view.Size = { self->ImageSize[0], self->ImageSize[1] };
    return lacuna::MakeImagePlane(
      IndexToWorld(origin, spacing, direction, extent), SizeOf(extent), view);
  }

  const lacuna::IsoRayCaster& Prepare(vtkLacunaBSplineIsoRayCaster* self, vtkImageData* input,
    vtkDataArray* scalars, vtkLacunaExecution& execution)
  {
    lacuna::VoxelVolume volume;
    volume.Type = vtkLacunaScalarType::Get(scalars);
    volume.Size = SizeOf(input->GetExtent());
    volume.IndexToWorld = IndexToWorld(input->GetOrigin(), input->GetSpacing(),
      input->GetDirectionMatrix()->GetData(), input->GetExtent());
    std::array<double, 16> matrix;
    std::copy_n(volume.IndexToWorld.Data(), 16, matrix.begin());
    const Key key{ scalars, scalars->GetMTime(), volume.Size, matrix, self->Interpolation,
      self->SolidSide };
    if (!this->Caster || key != this->CasterKey)
    {
      this->Caster.reset();
      this->Copy = nullptr;
      if (!scalars->HasStandardMemoryLayout())
      {
        this->Copy.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
        this->Copy->DeepCopy(scalars);
      }
      volume.Voxels = (this->Copy ? this->Copy.Get() : scalars)->GetVoidPointer(0);
      this->Caster = std::make_unique<lacuna::IsoRayCaster>(volume,
        static_cast<lacuna::FieldInterpolation>(self->Interpolation),
        self->SolidSide == Above ? lacuna::SolidSide::Above : lacuna::SolidSide::Below, execution);
      this->CasterKey = key;
    }
    return *this->Caster;
  }
};

vtkStandardNewMacro(vtkLacunaBSplineIsoRayCaster);

//------------------------------------------------------------------------------
vtkLacunaBSplineIsoRayCaster::vtkLacunaBSplineIsoRayCaster()
  : Internal(std::make_unique<Internals>())
{
  std::fill_n(this->FocalPoint, 3, VTK_DOUBLE_MAX);
  std::fill_n(this->PlaneOrigin, 3, VTK_DOUBLE_MAX);
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
      if (IsEmpty(extent))
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
  // any pixel's ray may go anywhere in the volume
  vtkInformation* inInfo = inputVector[0]->GetInformationObject(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  inInfo->Get(SDDP::WHOLE_EXTENT(), extent);
  inInfo->Set(SDDP::UPDATE_EXTENT(), extent, 6);
  // this very extent: a producer of sub-extents would split it once more by piece
  inInfo->Set(SDDP::UPDATE_PIECE_NUMBER(), 0);
  inInfo->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), 1);
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
      if (!input || IsEmpty(input->GetExtent()))
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
      const lacuna::IsoRayCaster& caster = this->Internal->Prepare(this, input, scalars, execution);

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
      vtkNew<vtkCharArray> mask;
      mask->SetName(vtkLacunaDepthMap::MaskName);
      mask->SetNumberOfTuples(pixels);
      vtkNew<vtkFloatArray> normals;
      normals->SetName(vtkLacunaDepthMap::NormalsName);
      normals->SetNumberOfComponents(3);
      normals->SetNumberOfTuples(pixels);

      const std::size_t count = this->IsoValues.size();
      for (std::size_t i = 0; i < count; ++i)
      {
        const double isoValue = this->IsoValues[i];
        vtkNew<vtkDoubleArray> depth;
        depth->SetName((vtkLacunaDepthMap::DepthName + (i ? "_" + std::to_string(i) : "")).c_str());
        depth->SetNumberOfTuples(pixels);
        if (!(isoValue >= caster.GetMinimum() && isoValue <= caster.GetMaximum()))
        {
          vtkWarningMacro("iso-value " << isoValue << " lies outside the values of array '" << name
                                       << "', which range from " << caster.GetMinimum() << " to "
                                       << caster.GetMaximum() << ": " << depth->GetName()
                                       << " is empty");
        }
        execution.SetStage(0.1 + 0.9 * i / count, 0.1 + 0.9 * (i + 1) / count);
        caster.Cast(plane, isoValue,
          { { extent[0], extent[1], extent[2], extent[3] }, depth->GetPointer(0),
            i ? nullptr : mask->GetPointer(0), i ? nullptr : normals->GetPointer(0) },
          execution);
        output->GetPointData()->AddArray(depth);
        if (i == 0)
        {
          output->GetPointData()->AddArray(mask);
          output->GetPointData()->SetNormals(normals);
        }
      }
      output->GetPointData()->SetActiveScalars(vtkLacunaDepthMap::DepthName);
      if (caster.GetNumberOfNonFiniteVoxels() > 0)
      {
        vtkWarningMacro("" << caster.GetNumberOfNonFiniteVoxels() << " voxels of array '" << name
                           << "' are not finite numbers and are taken to be empty");
      }

      vtkLacunaFieldData::Set(output, vtkLacunaDepthMap::IsoValuesName, this->IsoValues, 1);
      vtkLacunaProvenance::Record(output, this, { input },
        "Array=" + name + " IsoValues=" + Joined(this->IsoValues.data(), count) +
          " Interpolation=" + std::to_string(this->Interpolation) + " SolidSide=" +
          std::to_string(this->SolidSide) + " ViewDirection=" + Joined(this->ViewDirection, 3) +
          " ViewUp=" + Joined(this->ViewUp, 3) + " PlaneOrigin=" + Joined(plane.Origin.data(), 3) +
          " PixelSpacing=" + Joined(&plane.PixelSpacing, 1) +
          " ImageSize=" + std::to_string(plane.Size[0]) + "," + std::to_string(plane.Size[1]));
    });
}

//------------------------------------------------------------------------------
void vtkLacunaBSplineIsoRayCaster::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ScalarArray: " << this->ScalarArray << "\n"
     << indent << "IsoValues: " << Joined(this->IsoValues.data(), this->IsoValues.size()) << "\n"
     << indent << "Interpolation: " << this->Interpolation << "\n"
     << indent << "SolidSide: " << this->SolidSide << "\n"
     << indent << "ViewDirection: " << Joined(this->ViewDirection, 3) << "\n"
     << indent << "ViewUp: " << Joined(this->ViewUp, 3) << "\n"
     << indent << "FocalPoint: " << Joined(this->FocalPoint, 3) << "\n"
     << indent << "PlaneOrigin: " << Joined(this->PlaneOrigin, 3) << "\n"
     << indent << "PixelSpacing: " << this->PixelSpacing << "\n"
     << indent << "ImageSize: " << this->ImageSize[0] << " " << this->ImageSize[1] << "\n";
}
