// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaPhantomSweep.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
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

#include <array>
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
constexpr std::array<const char*, 2> ScalarTypeNames{ "UnsignedChar", "Float" };
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

// As the kernel takes them.
struct vtkLacunaPhantomSweep::Options : lacuna::ProbeMotion::Parameters
{
  explicit Options(const vtkLacunaPhantomSweep* self)
  {
    this->Motion = static_cast<lacuna::ProbeMotion::Kind>(self->Motion);
    this->NumberOfSlices = self->NumberOfSlices;
    this->NumberOfSweeps = self->NumberOfSweeps;
    this->ImageDepth = self->PixelSpacing * (self->ImageSize[1] - 1);
    this->Travel = self->Travel;
    this->SweepAngle = self->SweepAngle;
    this->TwistAngle = self->TwistAngle;
    this->FanAngle = self->FanAngle;
    this->Wander = self->Wander;
    this->Center = { self->Center[0], self->Center[1], self->Center[2] };
    this->PositionNoise = self->PoseNoise[0];
    this->AngleNoise = self->PoseNoise[1];
    this->Seed = static_cast<std::uint64_t>(self->Seed);
  }
};

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
  lacuna::ProbeMotion(Options(this)); // throws
  this->CheckProperties();
  this->GetScene();
  vtkInformation* info = ports.GetOutputInformation();
  const int extent[6] = { 0, this->ImageSize[0] - 1, 0, this->ImageSize[1] - 1, 0,
    this->NumberOfSlices - 1 };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), 0.0, 0.0, 0.0);
  info->Set(vtkDataObject::SPACING(), 1.0, 1.0, 1.0);
  lacuna::VolumeDirection::AnnounceAlongAxes(info);
  vtkDataObject::SetPointDataActiveScalarInfo(
    info, this->OutputScalarType == Float ? VTK_FLOAT : VTK_UNSIGNED_CHAR, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaPhantomSweep::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* volume = ports.GetInput<vtkImageData>(); // a slice may cut through any part of it
  if (volume && volume->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the input volume is empty");
  }
  Options options(this);
  if (volume)
  {
    double middle[3];
    volume->GetCenter(middle);
    options.Center = options.Center + lacuna::Vec3{ middle[0], middle[1], middle[2] };
  }
  const lacuna::ProbeMotion motion(options);
  const std::unique_ptr<lacuna::PhantomScene> volumeScene = volume ? MakeScene(volume) : nullptr;
  const lacuna::PhantomScene& scene = volumeScene ? *volumeScene : this->GetScene();

  lacuna::Extent extent = ports.GetExtent();
  auto* output = ports.GetOutput<vtkImageData>();
  const double bytes =
    lacuna::CountPoints(extent) * (this->OutputScalarType == Float ? sizeof(float) : 1);
  constexpr double BytesPerPose = 4.0 * 16 * sizeof(double);
  std::ostringstream what;
  what << "a sweep of " << this->NumberOfSlices << " slices of " << this->ImageSize[0] << " x "
       << this->ImageSize[1] << " pixels";
  lacuna::RequireMemory(what.str(), bytes + BytesPerPose * this->NumberOfSlices);

  output->SetOrigin(0, 0, 0);
  output->SetSpacing(1, 1, 1);
  output->SetExtent(extent.data());
  vtkDataArray* scalars = lacuna::Arrays::AddScalars(
    output, this->OutputScalarType == Float ? VTK_FLOAT : VTK_UNSIGNED_CHAR, "Intensity");

  const lacuna::Matrix4 imageToProbe =
    lacuna::MakeImageToProbe(this->ImageSize[0], this->PixelSpacing);
  lacuna::SliceImaging imaging;
  imaging.Columns = this->ImageSize[0];
  imaging.Rows = this->ImageSize[1];
  imaging.SpeckleLevel = this->SpeckleLevel;
  imaging.Seed = static_cast<std::uint64_t>(this->Seed);
  imaging.ImageToReference = [&](std::int64_t slice)
  { return motion.TrueProbeToReference(slice) * imageToProbe; };
  if (this->OutputScalarType == Float)
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
void vtkLacunaPhantomSweep::Describe(lacuna::Properties& properties) const
{
  Options(this).Describe(properties);
  properties.Add("ImageSize", this->ImageSize, lacuna::ValueRange::AtLeast(1, "pixels"))
    .Add("PixelSpacing", this->PixelSpacing, lacuna::ValueRange::Above(0, "mm").UpTo(1000))
    .Add("SpeckleLevel", this->SpeckleLevel, lacuna::SpeckleLevels)
    .Add("PoseNoise", this->PoseNoise, lacuna::ValueRange::AtLeast(0, "mm, degrees"))
    .Add("Anatomy", this->Anatomy, lacuna::AnatomyNames)
    .Add("Seed", this->Seed)
    .Add("EdgeWidth", this->EdgeWidth, lacuna::EdgeWidths)
    .Add("OutputScalarType", this->OutputScalarType, ScalarTypeNames);
}
