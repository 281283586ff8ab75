// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOccludedAngle.h"

#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaShapeGrowth.h"
#include "vtkAlgorithmOutput.h"
#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

vtkStandardNewMacro(vtkLacunaOccludedAngle);

namespace
{
const double Pi = 3.14159265358979323846;
constexpr double DataOpacity = 0.95; // of a voxel of opacity 1

/// The two axes of a 2-D image, or three, in the kernel's order, with the image's extent.
struct Geometry
{
  explicit Geometry(vtkImageData* image)
  {
    int dimensions[3];
    image->GetDimensions(dimensions);
    int count = 0;
    for (int axis : { 0, 1, 2 })
    {
      if (dimensions[axis] > 1)
      {
        this->Dimensions[count] = dimensions[axis];
        this->Spacing[count++] = image->GetSpacing()[axis];
      }
    }
    this->Axes = count;
  }

  std::int64_t GetSize() const
  {
    return this->Dimensions[0] * this->Dimensions[1] * this->Dimensions[2];
  }

  std::array<std::int64_t, 3> Dimensions{ 1, 1, 1 };
  lacuna::Vec3 Spacing{ 1, 1, 1 };
  int Axes = 0;
};

float* At(lacuna::AttenuationField& field, std::int64_t i)
{
  const auto& n = field.GetDimensions();
  const std::int64_t row = i / n[0];
  return field.Row(row % n[1], row / n[1]) + i % n[0];
}

std::string Where(vtkImageData* image, vtkIdType i)
{
  int dimensions[3];
  image->GetDimensions(dimensions);
  const int* extent = image->GetExtent();
  std::ostringstream text;
  text << "voxel (" << extent[0] + i % dimensions[0] << ", "
       << extent[2] + (i / dimensions[0]) % dimensions[1] << ", "
       << extent[4] + i / (static_cast<vtkIdType>(dimensions[0]) * dimensions[1]) << ")";
  return text.str();
}

/// Copies scalars into the field, converted by a function object of (value, index).
template <class Convert>
struct Fill
{
  lacuna::AttenuationField& Field;
  lacuna::Execution& Execution;
  Convert& Converter;

  template <class Array>
  void operator()(Array* array) const
  {
    const auto values = vtk::DataArrayValueRange<1>(array);
    const auto& n = this->Field.GetDimensions();
    this->Execution.For(n[1] * n[2], std::max<std::int64_t>(1, (1 << 16) / n[0]),
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t r = begin; r < end; ++r)
        {
          float* row = this->Field.Row(r % n[1], r / n[1]);
          for (std::int64_t i = 0; i < n[0]; ++i)
          {
            row[i] = this->Converter(static_cast<double>(values[r * n[0] + i]), r * n[0] + i);
          }
        }
      });
  }
};
}

//------------------------------------------------------------------------------
/// One execution: from the inputs to the iterations' images.
class vtkLacunaOccludedAngle::Run
{
public:
  Run(vtkLacunaOccludedAngle* self, vtkImageData* input, vtkImageData* space)
    : Self(self)
    , Input(input)
    , Space(space)
    , Grid(input)
  {
    this->Scalars = self->GetInputArrayToProcess(0, input);
    // ParaView gives an empty name while it does not know the input's arrays yet.
    const char* name = self->GetInputArrayInformation(0)->Get(vtkDataObject::FIELD_NAME());
    if (!this->Scalars && name && !*name)
    {
      this->Scalars = input->GetPointData()->GetScalars();
    }
    if (!this->Scalars)
    {
      throw std::runtime_error("the input has no point scalars; choose an array");
    }
    if (this->Scalars->GetNumberOfComponents() != 1)
    {
      throw std::runtime_error(std::string("the array '") +
        (this->Scalars->GetName() ? this->Scalars->GetName() : "") +
        "' has more than one component; extract one");
    }
    if (this->Scalars->GetNumberOfTuples() != this->Grid.GetSize())
    {
      throw std::runtime_error("the array chosen is not a point array of the whole image");
    }
    if (this->Grid.Axes < 2)
    {
      throw std::runtime_error("an occluded angle needs an image that is at least two voxels wide "
                               "along two axes");
    }
  }

  /// The last iteration, or all of them when they are kept.
  std::vector<vtkSmartPointer<vtkImageData>> GetIterations(lacuna::Execution& execution)
  {
    lacuna::GrowthOptions options = this->GetOptions();
    std::ostringstream what;
    what << "the occluded angle of " << this->Grid.GetSize() << " voxels";
    const double kept = this->Self->KeepIterations ? 5.0 * options.Steps.size() : 0;
    lacuna::RequireMemory(what.str(), (12.0 + kept) * static_cast<double>(this->Grid.GetSize()));

    lacuna::AttenuationField field(this->Grid.Dimensions, this->Grid.Spacing);
    this->FillField(field, execution);
    this->CutSpace(field);

    vtkNew<vtkFloatArray> angle;
    angle->SetName("OccludedAngle");
    angle->SetNumberOfTuples(this->Grid.GetSize());
    vtkNew<vtkUnsignedCharArray> object;
    object->SetName("Object");
    object->SetNumberOfTuples(this->Grid.GetSize());
    std::vector<vtkSmartPointer<vtkImageData>> images;
    std::vector<lacuna::GrowthStatistics> all;
    const auto observe = [&](int iteration, const lacuna::GrowthStatistics& statistics)
    {
      all.push_back(statistics);
      const bool last = iteration + 1 == static_cast<int>(options.Steps.size());
      if (this->Self->KeepIterations && !last)
      {
        vtkNew<vtkFloatArray> angleCopy;
        angleCopy->DeepCopy(angle);
        vtkNew<vtkUnsignedCharArray> objectCopy;
        objectCopy->DeepCopy(object);
        images.push_back(this->MakeImage(angleCopy, objectCopy, options, all));
      }
    };
    lacuna::GrowShape(
      field, options, angle->GetPointer(0), object->GetPointer(0), observe, execution);
    images.push_back(this->MakeImage(angle, object, options, all));
    return images;
  }

private:
  lacuna::GrowthOptions GetOptions() const
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
    lacuna::GrowthOptions options;
    options.Binary = this->Self->Mode == BINARY;
    options.Directions = this->Self->NumberOfDirections + this->Self->NumberOfDirections % 2;
    options.ObjectOpacity = this->Self->ObjectOpacity;
    options.KeepData = this->Self->KeepData;
    options.MedianKernel = this->Self->MedianKernel;
    for (std::size_t i = 0; i < thresholds.size(); ++i)
    {
      const double radius = radii.empty() ? 0 : radii[radii.size() == 1 ? 0 : i];
      if (!(thresholds[i] >= 0 && thresholds[i] <= 2 * half) || !(radius >= 0))
      {
        std::ostringstream message;
        message << "iteration " << i + 1 << " has the threshold " << thresholds[i]
                << " pi and the radius " << radius << " mm; a threshold must be between 0 and "
                << 2 * half << " pi, a radius not negative";
        throw std::runtime_error(message.str());
      }
      options.Steps.push_back({ (thresholds[i] == 0 ? half : thresholds[i]) * Pi, radius });
    }
    return options;
  }

  void FillField(lacuna::AttenuationField& field, lacuna::Execution& execution)
  {
    const double largest = lacuna::GetLargestAttenuation(field);
    const double opaque = lacuna::GetAttenuation(field, DataOpacity);
    const double least = lacuna::GetAttenuation(field, 0.5);
    const bool binary = this->Self->Mode == BINARY;
    const auto finish = [=](double attenuation)
    {
      return static_cast<float>(
        binary ? (attenuation >= least ? 1.0 : 0.0) : std::min(attenuation, largest));
    };
    const auto refuse = [this](const char* what, vtkIdType i)
    { throw std::runtime_error(what + (" at " + Where(this->Input, i))); };
    if (this->Self->Attenuation == ARRAY)
    {
      auto convert = [&](double value, vtkIdType i)
      {
        if (!(value >= 0))
        {
          refuse("the attenuation is negative or not a number", i);
        }
        return finish(value);
      };
      this->Convert(field, execution, convert);
    }
    else if (this->Self->Attenuation == OPACITY_FUNCTION)
    {
      vtkPiecewiseFunction* function = this->Self->OpacityFunction;
      if (!function || function->GetSize() == 0)
      {
        throw std::runtime_error("there is no OpacityFunction; give one, or choose another way to "
                                 "make attenuation of grey levels");
      }
      auto convert = [&](double value, vtkIdType i)
      {
        const double opacity = function->GetValue(value);
        if (!(opacity >= 0) || std::isnan(value))
        {
          refuse("the opacity is negative or not a number", i);
        }
        return finish(opacity * opaque);
      };
      this->Convert(field, execution, convert);
    }
    else
    {
      double range[2];
      this->Scalars->GetRange(range);
      if (!(range[1] > range[0]))
      {
        throw std::runtime_error("all grey levels are " + std::to_string(range[0]) +
          ": there is no data to reconstruct from");
      }
      const double scale = opaque / (range[1] - range[0]);
      auto convert = [&](double value, vtkIdType i)
      {
        if (!std::isfinite(value))
        {
          refuse("the grey level is not a finite number", i);
        }
        return finish((value - range[0]) * scale);
      };
      this->Convert(field, execution, convert);
    }
  }

  template <class Converter>
  void Convert(lacuna::AttenuationField& field, lacuna::Execution& execution, Converter& convert)
  {
    const Fill<Converter> fill{ field, execution, convert };
    if (!vtkArrayDispatch::Dispatch::Execute(this->Scalars, fill))
    {
      fill(this->Scalars);
    }
  }

  void CutSpace(lacuna::AttenuationField& field)
  {
    vtkImplicitFunction* function = this->Self->ReconstructionSpace;
    vtkDataArray* mask = nullptr;
    if (this->Space)
    {
      mask = this->Space->GetPointData()->GetScalars();
      const bool same = std::equal(this->Input->GetExtent(), this->Input->GetExtent() + 6,
                          this->Space->GetExtent()) &&
        this->SamePlace();
      if (!same || !mask || mask->GetNumberOfTuples() != this->Grid.GetSize())
      {
        throw std::runtime_error("the reconstruction space (second input) must be an image with "
                                 "point scalars and with the extent, origin, spacing and direction "
                                 "of the first");
      }
    }
    if (!mask && !function)
    {
      return;
    }
    bool any = false;
    for (vtkIdType i = 0; i < this->Grid.GetSize(); ++i)
    {
      bool inside = !mask || mask->GetComponent(i, 0) != 0;
      if (inside && function)
      {
        double point[3];
        this->Input->GetPoint(i, point);
        inside = function->FunctionValue(point) < 0;
      }
      float* value = At(field, i);
      *value = inside ? *value : lacuna::AttenuationField::OutsideSpace();
      any = any || *value > 0;
    }
    if (!any)
    {
      throw std::runtime_error("the reconstruction space contains none of the data; nothing can be "
                               "reconstructed in it");
    }
  }

  bool SamePlace() const
  {
    const double tolerance = 1e-6 * this->Grid.Spacing[0];
    bool same = true;
    for (int i = 0; i < 3; ++i)
    {
      same = same &&
        std::abs(this->Input->GetOrigin()[i] - this->Space->GetOrigin()[i]) <= tolerance &&
        std::abs(this->Input->GetSpacing()[i] - this->Space->GetSpacing()[i]) <= tolerance;
      for (int j = 0; j < 3; ++j)
      {
        same = same &&
          std::abs(this->Input->GetDirectionMatrix()->GetElement(i, j) -
            this->Space->GetDirectionMatrix()->GetElement(i, j)) <= 1e-9;
      }
    }
    return same;
  }

  vtkSmartPointer<vtkImageData> MakeImage(vtkFloatArray* angle, vtkUnsignedCharArray* object,
    const lacuna::GrowthOptions& options, const std::vector<lacuna::GrowthStatistics>& all) const
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->CopyStructure(this->Input);
    image->GetPointData()->SetScalars(angle);
    image->GetPointData()->AddArray(object);
    const lacuna::Vec3& edge = this->Grid.Spacing;
    const bool flat = this->Grid.Axes == 2;
    const double voxel = flat ? edge[0] * edge[1] : edge[0] * edge[1] * edge[2] / 1000;
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
      vtkLacunaFieldData::Set(image, names[i], columns[i], 1);
    }
    return image;
  }

  vtkLacunaOccludedAngle* Self;
  vtkImageData* Input;
  vtkImageData* Space;
  Geometry Grid;
  vtkDataArray* Scalars = nullptr;
};

//------------------------------------------------------------------------------
vtkLacunaOccludedAngle::vtkLacunaOccludedAngle()
{
  this->SetNumberOfInputPorts(2);
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
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
int vtkLacunaOccludedAngle::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  info->Remove(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  info->Remove(vtkStreamingDemandDrivenPipeline::TIME_RANGE());
  if (this->KeepIterations)
  {
    std::vector<double> steps(this->ThresholdsOverPi.size());
    for (std::size_t i = 0; i < steps.size(); ++i)
    {
      steps[i] = static_cast<double>(i) + 1;
    }
    const double range[2] = { 1, static_cast<double>(steps.size()) };
    info->Set(
      vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaOccludedAngle::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  for (int port : { 0, 1 })
  {
    for (int i = 0; i < inputVector[port]->GetNumberOfInformationObjects(); ++i)
    {
      vtkInformation* info = inputVector[port]->GetInformationObject(i);
      int whole[6];
      info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
      info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), whole, 6);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaOccludedAngle::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkLacunaExecution::Run(this, outputVector,
    [&](vtkLacunaExecution& execution)
    {
      vtkImageData* input = vtkImageData::GetData(inputVector[0]);
      vtkImageData* space = vtkImageData::GetData(inputVector[1]);
      vtkMTimeType time = std::max(this->GetMTime(), input->GetMTime());
      time = space ? std::max(time, space->GetMTime()) : time;
      std::vector<vtkSmartPointer<vtkImageData>> iterations;
      if (this->KeepIterations && !this->Iterations.empty() && this->IterationsTime == time)
      {
        iterations = this->Iterations;
      }
      else
      {
        this->Iterations.clear();
        iterations = Run(this, input, space).GetIterations(execution);
      }
      std::size_t chosen = iterations.size() - 1;
      vtkInformation* info = outputVector->GetInformationObject(0);
      vtkImageData* output = vtkImageData::GetData(outputVector);
      if (this->KeepIterations)
      {
        this->Iterations = iterations;
        this->IterationsTime = time;
        if (info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
        {
          const double step = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
          const double last = static_cast<double>(iterations.size());
          chosen = static_cast<std::size_t>(std::clamp(std::floor(step), 1.0, last)) - 1;
        }
      }
      output->ShallowCopy(iterations[chosen]);
      if (this->KeepIterations)
      {
        output->GetInformation()->Set(
          vtkDataObject::DATA_TIME_STEP(), static_cast<double>(chosen) + 1);
      }
      int extent[6];
      info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
      output->Crop(extent);
      lacuna::ParameterText parameters;
      parameters.Add("Mode", this->Mode == BINARY ? "Binary" : "Continuous")
        .Add("Attenuation", this->Attenuation)
        .Add("NumberOfDirections", this->NumberOfDirections)
        .Add("ThresholdsOverPi", this->ThresholdsOverPi)
        .Add("LocalRadii", this->LocalRadii)
        .Add("ObjectOpacity", this->ObjectOpacity)
        .Add("KeepData", this->KeepData)
        .Add("MedianKernel", this->MedianKernel);
      std::vector<vtkDataObject*> inputs{ input };
      if (space)
      {
        inputs.push_back(space);
      }
      vtkLacunaProvenance::Record(output, this, inputs, parameters.Get());
    });
}

//------------------------------------------------------------------------------
void vtkLacunaOccludedAngle::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Mode: " << (this->Mode == BINARY ? "Binary" : "Continuous") << "\n";
  os << indent << "Attenuation: " << this->Attenuation << "\n";
  os << indent << "OpacityFunction: " << this->OpacityFunction.Get() << "\n";
  os << indent << "NumberOfDirections: " << this->NumberOfDirections << "\n";
  os << indent << "ThresholdsOverPi:";
  for (double threshold : this->ThresholdsOverPi)
  {
    os << " " << threshold;
  }
  os << "\n" << indent << "LocalRadii:";
  for (double radius : this->LocalRadii)
  {
    os << " " << radius;
  }
  os << "\n" << indent << "ObjectOpacity: " << this->ObjectOpacity << "\n";
  os << indent << "KeepData: " << this->KeepData << "\n";
  os << indent << "MedianKernel: " << this->MedianKernel << "\n";
  os << indent << "ReconstructionSpace: " << this->ReconstructionSpace.Get() << "\n";
  os << indent << "KeepIterations: " << this->KeepIterations << "\n";
}
