// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaPhantomSweep.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaPhantomScene.h"
#include "lacunaPhantomSweep.h"
#include "lacunaProbeMotion.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVersionCompat.h"
#include "lacunaVolumeDirection.h"
#include "lacunaVolumeScene.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaPhantomSweep);

namespace
{
constexpr double SlicesPerSecond = 25;
constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::unique_ptr<lacuna::PhantomScene> MakeVolumeScene(
  const T* voxels, vtkDataArray* scalars, vtkImageData* volume)
{
  std::array<int, 3> dimensions;
  volume->GetDimensions(dimensions.data());
  const int* extent = volume->GetExtent();
  const lacuna::Matrix4 toIndex(*volume->GetPhysicalToIndexMatrix()->Element);
  const lacuna::Vec3 first{ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
    static_cast<double>(extent[4]) };
  return std::make_unique<lacuna::VolumeScene<T>>(voxels, dimensions,
    scalars->GetNumberOfComponents(), lacuna::Matrix4::Translation(-1.0 * first) * toIndex);
}

std::unique_ptr<lacuna::PhantomScene> MakeScene(vtkImageData* volume)
{
  lacuna::VolumeDirection::Check(volume);
  vtkDataArray* scalars = volume->GetPointData()->GetScalars();
  if (!scalars || volume->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the input volume has no active point scalars to image");
  }
  return lacuna::DispatchScalars(lacuna::ArrayScalarType::Get(scalars), scalars->GetVoidPointer(0),
    [&](const auto* voxels) { return MakeVolumeScene(voxels, scalars, volume); });
}
}

//------------------------------------------------------------------------------
vtkLacunaPhantomSweep::vtkLacunaPhantomSweep()
{
  this->TakesEmpty = true;  // an error
  this->KeepsPlace = false; // columns, rows and slices, whatever the volume's are
  this->SetNumberOfInputPorts(1);
}

//------------------------------------------------------------------------------
vtkLacunaPhantomSweep::~vtkLacunaPhantomSweep() = default;

//------------------------------------------------------------------------------
int vtkLacunaPhantomSweep::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaPhantomSweep::SetVolumeConnection(int, vtkAlgorithmOutput* volume)
{
  this->SetInputConnection(volume);
}

//------------------------------------------------------------------------------
lacuna::ProbeMotion vtkLacunaPhantomSweep::MakeMotion(vtkImageData* volume)
{
  std::ostringstream message;
  if (this->ImageSize[0] < 1 || this->ImageSize[1] < 1)
  {
    message << "ImageSize is " << this->ImageSize[0] << " " << this->ImageSize[1]
            << "; a slice needs at least 1 column and 1 row";
    throw std::invalid_argument(message.str());
  }
  if (!(this->PixelSpacing > 0 && this->PixelSpacing <= 1000))
  {
    message << "PixelSpacing is " << this->PixelSpacing
            << " mm; it must be above 0 and at most 1000 mm";
    throw std::invalid_argument(message.str());
  }
  if (!(this->SpeckleLevel >= 0 && this->SpeckleLevel <= 10))
  {
    message << "SpeckleLevel is " << this->SpeckleLevel << "; it must be from 0 to 10";
    throw std::invalid_argument(message.str());
  }
  if (this->OutputScalarType != UNSIGNED_CHAR && this->OutputScalarType != FLOAT)
  {
    message << "OutputScalarType is " << this->OutputScalarType
            << "; it must be 0 (UnsignedChar) or 1 (Float)";
    throw std::invalid_argument(message.str());
  }
  lacuna::ProbeMotion::Parameters p;
  p.Motion = static_cast<lacuna::ProbeMotion::Kind>(this->Motion);
  p.NumberOfSlices = this->NumberOfSlices;
  p.NumberOfSweeps = this->NumberOfSweeps;
  p.ImageDepth = this->PixelSpacing * (this->ImageSize[1] - 1);
  p.Travel = this->Travel;
  p.SweepAngle = this->SweepAngle;
  p.TwistAngle = this->TwistAngle;
  p.FanAngle = this->FanAngle;
  p.Wander = this->Wander;
  p.Center = { this->Center[0], this->Center[1], this->Center[2] };
  if (volume)
  {
    double middle[3];
    volume->GetCenter(middle);
    p.Center = p.Center + lacuna::Vec3{ middle[0], middle[1], middle[2] };
  }
  p.PositionNoise = this->PoseNoise[0];
  p.AngleNoise = this->PoseNoise[1];
  p.Seed = static_cast<std::uint64_t>(this->Seed);
  return lacuna::ProbeMotion(p);
}

//------------------------------------------------------------------------------
const lacuna::PhantomScene& vtkLacunaPhantomSweep::GetScene()
{
  if (!this->Scene || this->SceneAnatomy != this->Anatomy ||
    this->SceneEdgeWidth != this->EdgeWidth)
  {
    this->Scene =
      lacuna::MakePhantomScene(static_cast<lacuna::Anatomy>(this->Anatomy), this->EdgeWidth);
    this->SceneAnatomy = this->Anatomy;
    this->SceneEdgeWidth = this->EdgeWidth;
  }
  return *this->Scene;
}

//------------------------------------------------------------------------------
const lacuna::PhantomScene* vtkLacunaPhantomSweep::FindScene()
{
  if (this->GetNumberOfInputConnections(0) > 0)
  {
    return nullptr;
  }
  try
  {
    return &this->GetScene();
  }
  catch (const std::invalid_argument&)
  {
    return nullptr; // Announce says what is wrong
  }
}

//------------------------------------------------------------------------------
void vtkLacunaPhantomSweep::Announce(const lacuna::Ports& ports)
{
  this->MakeMotion(nullptr);
  this->GetScene();
  vtkInformation* info = ports.GetOutputInformation();
  const int extent[6] = { 0, this->ImageSize[0] - 1, 0, this->ImageSize[1] - 1, 0,
    this->NumberOfSlices - 1 };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), 0.0, 0.0, 0.0);
  info->Set(vtkDataObject::SPACING(), 1.0, 1.0, 1.0);
  lacuna::VolumeDirection::AnnounceAlongAxes(info);
  vtkDataObject::SetPointDataActiveScalarInfo(
    info, this->OutputScalarType == FLOAT ? VTK_FLOAT : VTK_UNSIGNED_CHAR, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaPhantomSweep::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* volume = ports.GetInput<vtkImageData>(); // a slice may cut through any part of it
  if (volume && volume->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the input volume is empty");
  }
  const lacuna::ProbeMotion motion = this->MakeMotion(volume);
  const std::unique_ptr<lacuna::PhantomScene> volumeScene = volume ? MakeScene(volume) : nullptr;
  const lacuna::PhantomScene& scene = volumeScene ? *volumeScene : this->GetScene();

  lacuna::Extent extent = ports.GetExtent();
  auto* output = ports.GetOutput<vtkImageData>();
  const double bytes =
    lacuna::CountPoints(extent) * (this->OutputScalarType == FLOAT ? sizeof(float) : 1);
  constexpr double BytesPerPose = 4.0 * 16 * sizeof(double);
  std::ostringstream what;
  what << "a sweep of " << this->NumberOfSlices << " slices of " << this->ImageSize[0] << " x "
       << this->ImageSize[1] << " pixels";
  lacuna::RequireMemory(what.str(), bytes + BytesPerPose * this->NumberOfSlices);

  output->SetOrigin(0, 0, 0);
  output->SetSpacing(1, 1, 1);
  output->SetExtent(extent.data());
  vtkDataArray* scalars = lacuna::Arrays::AddScalars(
    output, this->OutputScalarType == FLOAT ? VTK_FLOAT : VTK_UNSIGNED_CHAR, "Intensity");

  const lacuna::Matrix4 imageToProbe =
    lacuna::MakeImageToProbe(this->ImageSize[0], this->PixelSpacing);
  lacuna::SliceImaging imaging;
  imaging.Columns = this->ImageSize[0];
  imaging.Rows = this->ImageSize[1];
  imaging.SpeckleLevel = this->SpeckleLevel;
  imaging.Seed = static_cast<std::uint64_t>(this->Seed);
  imaging.ImageToReference = [&](std::int64_t slice)
  { return motion.TrueProbeToReference(slice) * imageToProbe; };
  if (this->OutputScalarType == FLOAT)
  {
    lacuna::SampleSlices(
      execution, scene, imaging, extent, static_cast<float*>(scalars->GetVoidPointer(0)));
  }
  else
  {
    lacuna::SampleSlices(
      execution, scene, imaging, extent, static_cast<unsigned char*>(scalars->GetVoidPointer(0)));
  }

  std::vector<lacuna::Matrix4> probePoses(this->NumberOfSlices);
  std::vector<lacuna::Matrix4> imagePoses(this->NumberOfSlices);
  std::vector<double> times(this->NumberOfSlices);
  std::vector<int> frames(this->NumberOfSlices);
  for (int i = 0; i < this->NumberOfSlices; ++i)
  {
    probePoses[i] = motion.RecordedProbeToReference(i);
    imagePoses[i] = probePoses[i] * imageToProbe;
    times[i] = i / SlicesPerSecond;
    frames[i] = i;
  }
  lacuna::TrackedSlices::Write(output, imagePoses, times,
    std::vector<unsigned char>(this->NumberOfSlices, lacuna::TrackedSlices::Valid), frames);
  lacuna::FieldData::SetMatrices(output, "ProbeToReference", probePoses);
  lacuna::FieldData::SetMatrices(output, lacuna::TrackedSlices::ImageToProbeName, { imageToProbe });
}

//------------------------------------------------------------------------------
double vtkLacunaPhantomSweep::EvaluateTruth(double x, double y, double z)
{
  const lacuna::Vec3 point{ x, y, z };
  const lacuna::PhantomScene* scene = lacuna::IsFinite(point) ? this->FindScene() : nullptr;
  return scene ? scene->Value(point) : NoNumber;
}

//------------------------------------------------------------------------------
double vtkLacunaPhantomSweep::GetTrueIsoValue()
{
  const lacuna::PhantomScene* scene = this->FindScene();
  return scene ? scene->IsoValue() : NoNumber;
}

//------------------------------------------------------------------------------
double vtkLacunaPhantomSweep::GetTrueVolume()
{
  const lacuna::PhantomScene* scene = this->FindScene();
  return scene ? scene->TrueVolume() : NoNumber;
}

//------------------------------------------------------------------------------
bool vtkLacunaPhantomSweep::AddTruth(vtkImageData* grid)
{
  try
  {
    if (!grid || grid->GetNumberOfPoints() == 0)
    {
      throw std::invalid_argument("AddTruth needs an image with at least one point");
    }
    if (this->GetNumberOfInputConnections(0) > 0)
    {
      throw std::invalid_argument("AddTruth knows the analytic scenes only; here an input volume "
                                  "is imaged: compare with that");
    }
    lacuna::RequireMemory("array Truth", 4.0 * static_cast<double>(grid->GetNumberOfPoints()));
    vtkNew<vtkFloatArray> truth;
    truth->SetName("Truth");
    lacuna::Arrays::SetNumberOfTuples(truth, grid->GetNumberOfPoints());
    std::array<int, 3> dimensions;
    grid->GetDimensions(dimensions.data());
    const int* extent = grid->GetExtent();
    const lacuna::Matrix4 toPhysical(*grid->GetIndexToPhysicalMatrix()->Element);
    const lacuna::Vec3 first{ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) };
    lacuna::ForgetAbort(this);
    lacuna::AlgorithmExecution execution(this);
    lacuna::SampleGrid(execution, this->GetScene(), dimensions,
      toPhysical * lacuna::Matrix4::Translation(first), truth->GetPointer(0));
    grid->GetPointData()->AddArray(truth);
    return true;
  }
  catch (const std::exception& e)
  {
    vtkErrorMacro(<< e.what());
    return false;
  }
}

//------------------------------------------------------------------------------
std::string vtkLacunaPhantomSweep::Parameters(int) const
{
  return lacuna::ParameterText()
    .Add("NumberOfSlices", this->NumberOfSlices)
    .Add("ImageSize", this->ImageSize)
    .Add("PixelSpacing", this->PixelSpacing)
    .Add("Motion", this->Motion)
    .Add("NumberOfSweeps", this->NumberOfSweeps)
    .Add("SpeckleLevel", this->SpeckleLevel)
    .Add("PoseNoise", this->PoseNoise)
    .Add("Anatomy", this->Anatomy)
    .Add("Seed", this->Seed)
    .Add("Travel", this->Travel)
    .Add("SweepAngle", this->SweepAngle)
    .Add("TwistAngle", this->TwistAngle)
    .Add("FanAngle", this->FanAngle)
    .Add("Wander", this->Wander)
    .Add("EdgeWidth", this->EdgeWidth)
    .Add("Center", this->Center)
    .Add("OutputScalarType", this->OutputScalarType)
    .Get();
}

//------------------------------------------------------------------------------
void vtkLacunaPhantomSweep::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << this->Parameters(0) << "\n";
}
