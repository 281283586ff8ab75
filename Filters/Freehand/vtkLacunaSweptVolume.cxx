// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSweptVolume.h"

#include "lacunaSweptVolume.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedIntArray.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <type_traits>

namespace
{
template <class T>
lacuna::PixelType GetPixelTypeOf()
{
  using lacuna::PixelType;
  if (std::is_floating_point<T>::value)
  {
    return sizeof(T) == 4 ? PixelType::Float32 : PixelType::Float64;
  }
  const bool isSigned = std::is_signed<T>::value;
  switch (sizeof(T))
  {
    case 1:
      return isSigned ? PixelType::Int8 : PixelType::UInt8;
    case 2:
      return isSigned ? PixelType::Int16 : PixelType::UInt16;
    case 4:
      return isSigned ? PixelType::Int32 : PixelType::UInt32;
    default:
      return isSigned ? PixelType::Int64 : PixelType::UInt64;
  }
}

lacuna::PixelType GetPixelType(vtkDataArray* array)
{
  switch (array->GetDataType())
  {
    vtkTemplateMacro(return GetPixelTypeOf<VTK_TT>());
    default:
      throw std::runtime_error(
        std::string("grey levels of type ") + array->GetDataTypeAsString() + " are not supported");
  }
}

// The valid slices of one input.
struct Sweep
{
  vtkImageData* Stack = nullptr;
  vtkSmartPointer<vtkDataArray> GreyLevels;
  std::vector<lacuna::SliceImage> Slices;
};

// Pixels of an axis that are used: indices relative to the stack's extent.
struct Range
{
  int First, Last;
};

// Cuts one axis of a stack to a part of the clip rectangle; size 0 reaches to the edge.
Range Clip(vtkImageData* stack, int axis, int start, int size)
{
  const int* extent = stack->GetExtent();
  const double origin = stack->GetOrigin()[axis];
  const double spacing = stack->GetSpacing()[axis];
  Range range{ extent[2 * axis], extent[2 * axis + 1] };
  const double first = origin + spacing * range.First;
  const double last = origin + spacing * range.Last;
  // compared as numbers of columns or rows: far-off requests do not overflow
  const double wantedLast = size > 0 ? start + static_cast<double>(size) - 1 : last;
  range.First = start > last ? range.Last + 1
    : start > first          ? static_cast<int>(std::ceil((start - origin) / spacing - 1e-6))
                             : range.First;
  range.Last = wantedLast < first ? range.First - 1
    : wantedLast < last ? static_cast<int>(std::floor((wantedLast - origin) / spacing + 1e-6))
                        : range.Last;
  if (range.Last - range.First + 1 < 2)
  {
    std::ostringstream message;
    message << "ClipRectangle leaves " << std::max(0, range.Last - range.First + 1)
            << (axis == 0 ? " columns" : " rows") << " of " << first << " to " << last
            << "; at least 2 are needed";
    throw std::runtime_error(message.str());
  }
  return range;
}

void CheckStack(vtkImageData* stack)
{
  if (!stack->GetDirectionMatrix()->IsIdentity())
  {
    throw std::runtime_error(
      "the stack of slices has a direction matrix; the coordinates of tracked slices are (column, "
      "row, slice), where they lie in space is in the field data array 'ImageToReference'");
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(stack->GetSpacing()[a] > 0))
    {
      throw std::runtime_error("the stack of slices has a spacing that is not positive; the "
                               "coordinates of tracked slices are (column, row, slice)");
    }
  }
}

Sweep CollectSweep(vtkImageData* stack, const int clip[4], const std::string& suffix)
{
  Sweep sweep;
  sweep.Stack = stack;
  const vtkLacunaTrackedSlices tracked(stack);
  CheckStack(stack);
  sweep.GreyLevels = tracked.GetGreyLevels();
  if (!sweep.GreyLevels->HasStandardMemoryLayout())
  {
    sweep.GreyLevels.TakeReference(
      vtkDataArray::CreateDataArray(tracked.GetGreyLevels()->GetDataType()));
    sweep.GreyLevels->DeepCopy(tracked.GetGreyLevels());
  }
  const lacuna::PixelType type = GetPixelType(sweep.GreyLevels);
  const auto* pixels = static_cast<const unsigned char*>(sweep.GreyLevels->GetVoidPointer(0));
  const Range columns = Clip(stack, 0, clip[0], clip[2]);
  const Range rows = Clip(stack, 1, clip[1], clip[3]);
  const double* origin = stack->GetOrigin();
  const double* spacing = stack->GetSpacing();
  const lacuna::Matrix4 windowToImage =
    lacuna::Matrix4::Translation(
      { origin[0] + spacing[0] * columns.First, origin[1] + spacing[1] * rows.First, 0 }) *
    lacuna::Matrix4::Scaling({ spacing[0], spacing[1], 1 });

  const int* extent = stack->GetExtent();
  const std::int64_t width = extent[1] - extent[0] + 1;
  const std::int64_t height = extent[3] - extent[2] + 1;
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    const vtkIdType number = tracked.GetSliceNumber(k);
    if (tracked.GetStatus(number) != vtkLacunaTrackedSlices::Valid)
    {
      continue;
    }
    lacuna::SliceImage slice;
    slice.Type = type;
    slice.Pixels = pixels +
      ((k - extent[4]) * height * width + (rows.First - extent[2]) * width + columns.First -
        extent[0]) *
        static_cast<std::int64_t>(lacuna::GetPixelSize(type));
    slice.RowStride = width;
    slice.Width = columns.Last - columns.First + 1;
    slice.Height = rows.Last - rows.First + 1;
    slice.PixelToReference = tracked.GetImageToReference(number) * windowToImage;
    slice.Label = "slice " + std::to_string(number) + suffix;
    lacuna::CheckSlice(slice);
    sweep.Slices.push_back(slice);
  }
  return sweep;
}

bool HasPoints(const int extent[6])
{
  return extent[0] <= extent[1] && extent[2] <= extent[3] && extent[4] <= extent[5];
}
}

// What there is to do: which slices go into which grid.
class vtkLacunaSweptVolume::Plan
{
public:
  // Throws std::exception with a text for the user.
  Plan(vtkLacunaSweptVolume* self, vtkInformationVector* inputs)
  {
    const int count = inputs->GetNumberOfInformationObjects();
    const std::size_t needed = self->Interpolation == NearestVoxel ? 1 : 2;
    for (int i = 0; i < count; ++i)
    {
      vtkImageData* stack = vtkImageData::GetData(inputs, i);
      if (!stack || stack->GetNumberOfPoints() == 0)
      {
        continue;
      }
      const std::string suffix = count > 1 ? " of input " + std::to_string(i) : "";
      this->Sweeps.push_back(CollectSweep(stack, self->ClipRectangle, suffix));
      const std::size_t valid = this->Sweeps.back().Slices.size();
      if (valid < needed)
      {
        std::ostringstream message;
        message << "the slices" << suffix << " are too few: " << valid << " of "
                << stack->GetDimensions()[2] << " are valid (SliceStatus 0), at least " << needed
                << " are needed";
        throw std::runtime_error(message.str());
      }
    }
    if (this->Sweeps.empty())
    {
      return;
    }
    if (!(self->MaximumSliceGap >= 0))
    {
      throw std::runtime_error("MaximumSliceGap must be positive, or 0 for no limit");
    }
    this->ChooseTypes(self->OutputScalarType);
    this->ChooseGrid(self);
  }

  bool IsEmpty() const { return this->Sweeps.empty(); }

  // Says what is wrong with slices between which nothing could be filled.
  static void CheckPairs(vtkLacunaSweptVolume* self, const lacuna::SweptVolume& volume)
  {
    const lacuna::SweptVolume::PairCounts& pairs = volume.GetPairCounts();
    if (pairs.All > 0 && pairs.All == pairs.Coincident)
    {
      throw std::runtime_error("all slices lie in the same plane: there is nothing between them");
    }
    if (pairs.Turned > 0)
    {
      vtkWarningWithObjectMacro(self,
        << pairs.Turned << " of " << pairs.All
        << " pairs of consecutive slices are turned by 90 degrees or more against each other; "
           "nothing was filled between them. The order of the slices or their poses may be wrong.");
    }
  }

  std::vector<Sweep> Sweeps;
  lacuna::VolumeGrid Grid;
  int ScalarType = VTK_FLOAT;
  bool DoublePrecision = false;

private:
  void ChooseTypes(int outputScalarType)
  {
    const int first = this->Sweeps.front().GreyLevels->GetDataType();
    for (const Sweep& sweep : this->Sweeps)
    {
      this->DoublePrecision |= lacuna::NeedsDoublePrecision(sweep.Slices.front().Type);
      if (outputScalarType == vtkLacunaSweptVolume::Input &&
        sweep.GreyLevels->GetDataType() != first)
      {
        throw std::runtime_error(std::string("the inputs have grey levels of different types (") +
          this->Sweeps.front().GreyLevels->GetDataTypeAsString() + ", " +
          sweep.GreyLevels->GetDataTypeAsString() + "); set OutputScalarType to Float");
      }
    }
    this->ScalarType = outputScalarType == vtkLacunaSweptVolume::Float ? VTK_FLOAT : first;
  }

  void ChooseGrid(vtkLacunaSweptVolume* self)
  {
    lacuna::VolumeGridRequest request;
    std::copy(self->OutputSpacing, self->OutputSpacing + 3, request.Spacing.data());
    std::copy(self->OutputBounds, self->OutputBounds + 6, request.Bounds.begin());
    request.BytesPerVoxel = lacuna::SweptVolume::GetBytesPerVoxel(this->DoublePrecision) +
      vtkDataArray::GetDataTypeSize(this->ScalarType) +
      static_cast<std::int64_t>(sizeof(unsigned int) + sizeof(char));
    request.MemoryLimit = self->MemoryLimit * 1048576.0;
    std::vector<lacuna::SliceImage> all;
    for (const Sweep& sweep : this->Sweeps)
    {
      all.insert(all.end(), sweep.Slices.begin(), sweep.Slices.end());
    }
    this->Grid = lacuna::MakeVolumeGrid(all, request);
  }
};

vtkStandardNewMacro(vtkLacunaSweptVolume);

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // Slices that change with time change the grid: it is found again when the time is known.
  if (request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_TIME_DEPENDENT_INFORMATION()))
  {
    return this->RequestInformation(request, inputs, outputs);
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  // Any part of the volume may need any slice, on any rank.
  for (int i = 0; i < inputs[0]->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = inputs[0]->GetInformationObject(i);
    if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
    {
      info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(),
        info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()), 6);
    }
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // The whole extent follows from the poses, which are data. Downstream divides the whole extent
  // into pieces before any data are asked for: so the input must be executed now. When it is up to
  // date, as it usually is, this does nothing.
  this->RequestUpdateExtent(request, inputs, outputs);
  for (int i = 0; i < this->GetNumberOfInputConnections(0); ++i)
  {
    vtkAlgorithmOutput* connection = this->GetInputConnection(0, i);
    connection->GetProducer()->Update(connection->GetIndex());
  }

  vtkInformation* info = outputs->GetInformationObject(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  try
  {
    const Plan plan(this, inputs[0]);
    if (!plan.IsEmpty())
    {
      for (int a = 0; a < 3; ++a)
      {
        extent[2 * a + 1] = plan.Grid.Dimensions[a] - 1;
      }
      info->Set(vtkDataObject::ORIGIN(), plan.Grid.Origin.data(), 3);
      info->Set(vtkDataObject::SPACING(), plan.Grid.Spacing.data(), 3);
      vtkDataObject::SetPointDataActiveScalarInfo(info, plan.ScalarType, 1);
    }
  }
  catch (const std::exception& e)
  {
    vtkErrorMacro(<< e.what());
    return 0;
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Remove(vtkDataObject::DIRECTION());
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  info->Set(vtkStreamingDemandDrivenPipeline::TIME_DEPENDENT_INFORMATION(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  return vtkLacunaExecution::Run(this, outputs,
    [&](vtkLacunaExecution& execution)
    {
      vtkInformation* info = outputs->GetInformationObject(0);
      vtkImageData* output = vtkImageData::GetData(outputs);
      output->GetFieldData()->Initialize(); // VTK passes the slices' own
      const Plan plan(this, inputs[0]);
      if (plan.IsEmpty())
      {
        output->Initialize();
        return;
      }
      int whole[6];
      info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
      for (int a = 0; a < 3; ++a)
      {
        if (whole[2 * a + 1] != plan.Grid.Dimensions[a] - 1 ||
          info->Get(vtkDataObject::ORIGIN())[a] != plan.Grid.Origin[a] ||
          info->Get(vtkDataObject::SPACING())[a] != plan.Grid.Spacing[a])
        {
          throw std::runtime_error("the slices have changed since the volume was announced (a "
                                   "source that changes with time?); set OutputBounds and "
                                   "OutputSpacing, so that they do not depend on the slices");
        }
      }

      int updateExtent[6];
      info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), updateExtent);
      output->SetExtent(updateExtent);
      output->SetOrigin(plan.Grid.Origin.data());
      output->SetSpacing(plan.Grid.Spacing.data());
      const vtkIdType size = output->GetNumberOfPoints();
      vtkSmartPointer<vtkDataArray> intensity;
      intensity.TakeReference(vtkDataArray::CreateDataArray(plan.ScalarType));
      intensity->SetName("Intensity");
      intensity->SetNumberOfTuples(size);
      vtkNew<vtkUnsignedIntArray> contributions;
      contributions->SetName("Contributions");
      contributions->SetNumberOfTuples(size);
      vtkNew<vtkCharArray> mask;
      mask->SetName("vtkValidPointMask");
      mask->SetNumberOfTuples(size);

      if (HasPoints(updateExtent))
      {
        lacuna::SweptVolume::Options options;
        options.Interpolation = this->Interpolation == NearestVoxel
          ? lacuna::SweptVolume::Method::NearestVoxel
          : lacuna::SweptVolume::Method::BetweenSlices;
        options.Sampling = static_cast<lacuna::PixelSampling>(this->PixelSampling);
        options.Compound =
          this->Compounding == Maximum ? lacuna::Compounding::Maximum : lacuna::Compounding::Mean;
        options.MaximumSliceGap = this->MaximumSliceGap;
        options.DoublePrecision = plan.DoublePrecision;
        std::array<int, 6> extent;
        std::copy(updateExtent, updateExtent + 6, extent.begin());
        lacuna::SweptVolume volume(plan.Grid, extent, options);
        const auto count = static_cast<double>(plan.Sweeps.size());
        for (std::size_t s = 0; s < plan.Sweeps.size(); ++s)
        {
          volume.BeginSweep();
          volume.AddSlices(plan.Sweeps[s].Slices, execution, 0.9 * static_cast<double>(s) / count,
            0.9 * static_cast<double>(s + 1) / count);
        }
        Plan::CheckPairs(this, volume);
        execution.SetStage(0.9, 1);
        switch (plan.ScalarType)
        {
          vtkTemplateMacro(volume.Write(static_cast<VTK_TT*>(intensity->GetVoidPointer(0)),
            contributions->GetPointer(0), mask->GetPointer(0), execution));
        }
      }
      output->GetPointData()->SetScalars(intensity);
      output->GetPointData()->AddArray(contributions);
      output->GetPointData()->AddArray(mask);
      std::vector<vtkDataObject*> stacks;
      for (const Sweep& sweep : plan.Sweeps)
      {
        stacks.push_back(sweep.Stack);
      }
      vtkLacunaProvenance::Record(output, this, stacks, this->DescribeParameters());
    });
}

//------------------------------------------------------------------------------
std::string vtkLacunaSweptVolume::DescribeParameters() const
{
  constexpr std::array<const char*, 3> samplings{ "Footprint", "Bilinear", "Nearest" };
  constexpr std::array<const char*, 2> interpolations{ "BetweenSlices", "NearestVoxel" };
  constexpr std::array<const char*, 2> compoundings{ "Mean", "Maximum" };
  constexpr std::array<const char*, 2> types{ "Input", "Float" };
  std::ostringstream text;
  const auto list = [&](const char* name, const auto& values)
  {
    text << name << "=";
    const char* separator = "";
    for (const auto value : values)
    {
      text << separator << value;
      separator = ",";
    }
    text << " ";
  };
  list("OutputSpacing", this->OutputSpacing);
  list("OutputBounds", this->OutputBounds);
  text << "PixelSampling=" << samplings[this->PixelSampling]
       << " Interpolation=" << interpolations[this->Interpolation]
       << " Compounding=" << compoundings[this->Compounding]
       << " MaximumSliceGap=" << this->MaximumSliceGap << " ";
  list("ClipRectangle", this->ClipRectangle);
  text << "OutputScalarType=" << types[this->OutputScalarType];
  return text.str();
}

//------------------------------------------------------------------------------
void vtkLacunaSweptVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Parameters: " << this->DescribeParameters() << "\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
}
