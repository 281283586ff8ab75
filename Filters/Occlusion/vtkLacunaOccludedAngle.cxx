// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOccludedAngle.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaFunctionText.h"
#include "lacunaMemory.h"
#include "lacunaOcclusionInput.h"
#include "lacunaShapeGrowth.h"
#include "lacunaVolumeDirection.h"
#include "vtkAlgorithmOutput.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaOccludedAngle);

using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr std::array<const char*, 2> ModeNames{ "Continuous", "Binary" };
constexpr std::array<const char*, 3> AttenuationNames{ "Linear in Range", "Opacity Function",
  "Array" };
const int MaximumNumberOfDirections = 10000000;
const double Pi = 3.14159265358979323846;

/// Grey level, opacity, midpoint and sharpness of each node.
std::vector<double> GetNodes(vtkPiecewiseFunction* function)
{
  std::vector<double> nodes(4 * static_cast<std::size_t>(function->GetSize()));
  for (int i = 0; i < function->GetSize(); ++i)
  {
    function->GetNodeValue(i, nodes.data() + 4 * static_cast<std::size_t>(i));
  }
  return nodes;
}
}

//------------------------------------------------------------------------------
/// One execution: from the inputs to the iterations' images. The constructor gets all that takes
/// memory.
class vtkLacunaOccludedAngle::Run
{
public:
  Run(vtkLacunaOccludedAngle* self, vtkImageData* input, vtkImageData* space,
    lacuna::Execution& execution)
    : Self(self)
    , Input(input)
    , Space(space)
    , Grid(input)
    , Scalars(lacuna::OcclusionInput::FindScalars(input, self->ScalarArray))
  {
    std::ostringstream what;
    what << "the occluded angle of " << this->Grid.GetSize() << " voxels";
    const double kept = self->KeepIterations ? 5.0 * self->ThresholdsOverPi.size() : 0;
    lacuna::RequireMemory(what.str(),
      (12.0 + kept + lacuna::GetOccludedAngleMemory(self->NumberOfDirections)) *
        static_cast<double>(this->Grid.GetSize()));

    this->Options = this->GetOptionsWithSteps();
    this->Field =
      std::make_unique<lacuna::AttenuationField>(this->Grid.Dimensions, this->Grid.Spacing);
    lacuna::OcclusionInput::Fill(*this->Field, this->Input, this->Scalars,
      { self->Attenuation, self->OpacityFunction, self->Mode == Binary }, execution);
    lacuna::OcclusionInput::CutSpace(
      *this->Field, this->Input, this->Space, self->ReconstructionSpace);
    this->Angle->SetName("OccludedAngle");
    lacuna::Arrays::SetNumberOfTuples(this->Angle, this->Grid.GetSize());
    this->Object->SetName("Object");
    lacuna::Arrays::SetNumberOfTuples(this->Object, this->Grid.GetSize());
  }

  /// The last iteration, or all of them when they are kept.
  std::vector<vtkSmartPointer<vtkImageData>> GetIterations(
    lacuna::Execution& execution, const lacuna::Ranks& ranks)
  {
    const lacuna::GrowthOptions& options = this->Options;
    std::vector<vtkSmartPointer<vtkImageData>> images;
    std::vector<lacuna::GrowthStatistics> all;
    const auto observe = [&](int iteration, const lacuna::GrowthStatistics& statistics)
    {
      all.push_back(statistics);
      const bool last = iteration + 1 == static_cast<int>(options.Steps.size());
      if (this->Self->KeepIterations && !last)
      {
        vtkNew<vtkFloatArray> angleCopy;
        lacuna::Arrays::Copy(this->Angle, angleCopy);
        vtkNew<vtkUnsignedCharArray> objectCopy;
        lacuna::Arrays::Copy(this->Object, objectCopy);
        images.push_back(this->MakeImage(angleCopy, objectCopy, options, all));
      }
    };
    lacuna::GrowShape(*this->Field, options, this->Angle->GetPointer(0),
      this->Object->GetPointer(0), observe, execution, ranks);
    images.push_back(this->MakeImage(this->Angle, this->Object, options, all));
    const auto empty = std::find_if(all.begin(), all.end(),
      [](const lacuna::GrowthStatistics& statistics) { return statistics.ObjectVoxels == 0; });
    if (empty != all.end())
    {
      vtkWarningWithObjectMacro(
        this->Self, << "iteration " << empty - all.begin() + 1 << " has no object"
                    << (empty + 1 == all.end() ? "" : ", so the following ones have none either")
                    << ": lower its threshold of "
                    << options.Steps[empty - all.begin()].Threshold / Pi << " pi");
    }
    return images;
  }

private:
  lacuna::GrowthOptions GetOptionsWithSteps() const
  {
    const std::vector<double>& thresholds = this->Self->ThresholdsOverPi;
    const std::vector<double>& radii = this->Self->LocalRadii;
    if (radii.size() > 1 && radii.size() != thresholds.size())
    {
      throw std::runtime_error("LocalRadii has " + std::to_string(radii.size()) +
        " values and ThresholdsOverPi " + std::to_string(thresholds.size()) +
        "; give one radius for all iterations or one per threshold");
    }
    const double half = this->Grid.Axes == 2 ? 1 : 2;
    lacuna::GrowthOptions options = this->Self->GetOptions();
    for (std::size_t i = 0; i < thresholds.size(); ++i)
    {
      const double radius = radii.empty() ? 0 : radii[radii.size() == 1 ? 0 : i];
      if (thresholds[i] > 2 * half)
      {
        throw std::runtime_error("ThresholdsOverPi is " + lacuna::FormatNumber(thresholds[i]) +
          "; in a 2-D image it must be at most 2");
      }
      options.Steps.push_back({ (thresholds[i] == 0 ? half : thresholds[i]) * Pi, radius });
    }
    return options;
  }

  vtkSmartPointer<vtkImageData> MakeImage(vtkFloatArray* angle, vtkUnsignedCharArray* object,
    const lacuna::GrowthOptions& options, const std::vector<lacuna::GrowthStatistics>& all) const
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->CopyStructure(this->Input);
    image->GetPointData()->SetScalars(angle);
    image->GetPointData()->AddArray(object);
    if (this->Input->GetFieldData()->HasArray(lacuna::VolumeDirection::ArrayName))
    {
      lacuna::VolumeDirection::Record(image);
    }
    const double voxel = this->Grid.GetVoxelContent();
    std::vector<double> columns[6];
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      columns[0].push_back(options.Steps[i].Threshold / Pi);
      columns[1].push_back(options.Steps[i].Radius);
      columns[2].push_back(static_cast<double>(all[i].ObjectVoxels));
      columns[3].push_back(static_cast<double>(all[i].ObjectVoxels) * voxel);
      columns[4].push_back(all[i].MeanAngle);
      columns[5].push_back(all[i].SuggestedThreshold / Pi);
    }
    const char* names[6] = { "ThresholdOverPi", "LocalRadius", "ObjectVoxels", "ObjectVolume",
      "MeanAngle", "SuggestedThresholdOverPi" };
    for (int i = 0; i < 6; ++i)
    {
      lacuna::FieldData::Set(image, names[i], columns[i], 1);
    }
    return image;
  }

  vtkLacunaOccludedAngle* Self;
  vtkImageData* Input;
  vtkImageData* Space;
  lacuna::OcclusionInput::Grid Grid;
  vtkDataArray* Scalars;
  lacuna::GrowthOptions Options;
  std::unique_ptr<lacuna::AttenuationField> Field;
  vtkNew<vtkFloatArray> Angle;
  vtkNew<vtkUnsignedCharArray> Object;
};

//------------------------------------------------------------------------------
vtkLacunaOccludedAngle::vtkLacunaOccludedAngle()
{
  this->Sharing = lacuna::Share::Together;
  this->TakesEmpty = true; // an error
  this->SetNumberOfInputPorts(2);
}

vtkLacunaOccludedAngle::~vtkLacunaOccludedAngle() = default;

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::SetOpacityFunction(vtkPiecewiseFunction* function)
{
  if (this->OpacityFunction != function)
  {
    this->OpacityFunction = function;
    this->Modified();
  }
}

vtkPiecewiseFunction* vtkLacunaOccludedAngle::GetOpacityFunction() const
{
  return this->OpacityFunction;
}

void vtkLacunaOccludedAngle::SetReconstructionSpace(vtkImplicitFunction* function)
{
  if (this->ReconstructionSpace != function)
  {
    this->ReconstructionSpace = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkLacunaOccludedAngle::GetReconstructionSpace() const
{
  return this->ReconstructionSpace;
}

void vtkLacunaOccludedAngle::SetReconstructionSpaceConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::SetNumberOfThresholdsOverPi(int count)
{
  this->ThresholdsOverPi.resize(std::max(0, count), 0.0);
  this->Modified();
}

int vtkLacunaOccludedAngle::GetNumberOfThresholdsOverPi() const
{
  return static_cast<int>(this->ThresholdsOverPi.size());
}

void vtkLacunaOccludedAngle::SetThresholdsOverPi(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro(<< "there is no threshold number " << i);
    return;
  }
  this->ThresholdsOverPi.resize(std::max<std::size_t>(this->ThresholdsOverPi.size(), i + 1), 0.0);
  this->ThresholdsOverPi[i] = value;
  this->Modified();
}

double vtkLacunaOccludedAngle::GetThresholdsOverPi(int i) const
{
  return i >= 0 && i < this->GetNumberOfThresholdsOverPi() ? this->ThresholdsOverPi[i] : 0;
}

void vtkLacunaOccludedAngle::SetNumberOfLocalRadii(int count)
{
  this->LocalRadii.resize(std::max(0, count), 0.0);
  this->Modified();
}

int vtkLacunaOccludedAngle::GetNumberOfLocalRadii() const
{
  return static_cast<int>(this->LocalRadii.size());
}

void vtkLacunaOccludedAngle::SetLocalRadii(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro(<< "there is no radius number " << i);
    return;
  }
  this->LocalRadii.resize(std::max<std::size_t>(this->LocalRadii.size(), i + 1), 0.0);
  this->LocalRadii[i] = value;
  this->Modified();
}

double vtkLacunaOccludedAngle::GetLocalRadii(int i) const
{
  return i >= 0 && i < this->GetNumberOfLocalRadii() ? this->LocalRadii[i] : 0;
}

//------------------------------------------------------------------------------
vtkMTimeType vtkLacunaOccludedAngle::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  if (this->OpacityFunction)
  {
    time = std::max(time, this->OpacityFunction->GetMTime());
  }
  return this->ReconstructionSpace ? std::max(time, this->ReconstructionSpace->GetMTime()) : time;
}

//------------------------------------------------------------------------------
int vtkLacunaOccludedAngle::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::Announce(const lacuna::Ports& ports)
{
  vtkInformation* info = ports.GetOutputInformation();
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  if (this->KeepIterations) // instead of the input's time
  {
    std::vector<double> steps(this->ThresholdsOverPi.size());
    std::iota(steps.begin(), steps.end(), 1.0);
    const double range[2] = { 1, static_cast<double>(steps.size()) };
    info->Set(Pipeline::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
    info->Set(Pipeline::TIME_RANGE(), range, 2);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::Ask(const lacuna::Ports& ports)
{
  this->Algorithm::Ask(ports);
  for (int port = 0; port < 2 && this->KeepIterations; ++port)
  {
    // the time asked for is an iteration, not the input's time
    if (vtkInformation* info = ports.GetInputInformation(port))
    {
      info->Remove(Pipeline::UPDATE_TIME_STEP());
      if (info->Has(Pipeline::TIME_STEPS()) && info->Length(Pipeline::TIME_STEPS()) > 0)
      {
        info->Set(Pipeline::UPDATE_TIME_STEP(), info->Get(Pipeline::TIME_STEPS())[0]);
      }
      else if (info->Has(Pipeline::TIME_RANGE()))
      {
        info->Set(Pipeline::UPDATE_TIME_STEP(), info->Get(Pipeline::TIME_RANGE())[0]);
      }
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  // Ranks that have worked together may be asked for other parts one by one.
  const bool keep = this->KeepIterations || lacuna::ControllerRanks().GetNumber() > 1;
  const std::vector<double> times = this->GetTimes();
  if (!keep || this->Made != times)
  {
    this->Made.clear();
    this->Iterations.clear();
    std::unique_ptr<Run> run;
    ports.Ranks.Together([&]
      { run = std::make_unique<Run>(this, input, ports.GetInput<vtkImageData>(1), execution); });
    this->Iterations = run->GetIterations(execution, ports.Ranks);
    this->Made = times;
  }
  std::size_t chosen = this->Iterations.size() - 1;
  vtkInformation* info = ports.GetOutputInformation();
  if (this->KeepIterations && info->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    const double step = info->Get(Pipeline::UPDATE_TIME_STEP());
    const double last = static_cast<double>(this->Iterations.size());
    // the first one for what is no number, too
    chosen = step >= 1 ? static_cast<std::size_t>(std::min(std::floor(step), last)) - 1 : 0;
  }
  auto* output = ports.GetOutput<vtkImageData>();
  output->ShallowCopy(this->Iterations[chosen]);
  if (this->KeepIterations)
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), static_cast<double>(chosen) + 1);
  }
  else if (input->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(),
      input->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
  }
  if (!keep)
  {
    this->Iterations.clear();
  }
}

//------------------------------------------------------------------------------
lacuna::GrowthOptions vtkLacunaOccludedAngle::GetOptions() const
{
  lacuna::GrowthOptions options;
  options.Binary = this->Mode == Binary;
  options.Directions = this->NumberOfDirections + this->NumberOfDirections % 2;
  options.ObjectOpacity = this->ObjectOpacity;
  options.Dilation = this->Dilation;
  options.KeepData = this->KeepData;
  options.MedianKernel = this->MedianKernel;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::Describe(lacuna::Properties& properties) const
{
  properties.Add("ScalarArray", this->ScalarArray)
    .Add("Mode", this->Mode, ModeNames)
    .Add("Attenuation", this->Attenuation, AttenuationNames)
    .Add("NumberOfDirections", this->NumberOfDirections,
      lacuna::ValueRange::Between(2, MaximumNumberOfDirections))
    .Add("ThresholdsOverPi", this->ThresholdsOverPi, lacuna::ValueRange::Between(0, 4))
    .Add("LocalRadii", this->LocalRadii, lacuna::ValueRange::Above(0, "mm").OrZero("whole space"));
  this->GetOptions().Describe(properties);
  if (this->Attenuation == ByOpacityFunction && this->OpacityFunction)
  {
    properties.Add("OpacityFunction", GetNodes(this->OpacityFunction));
  }
  properties.Add("ReconstructionSpace", lacuna::FunctionText::Describe(this->ReconstructionSpace))
    .Add("KeepIterations", this->KeepIterations);
}
