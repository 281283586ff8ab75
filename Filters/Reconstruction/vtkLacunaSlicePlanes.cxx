// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSlicePlanes.h"

#include "lacunaFieldData.h"
#include "lacunaItemList.h"
#include "lacunaSliceImages.h"
#include "lacunaSlicePlaneBuilder.h"
#include "lacunaTrackedSlices.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr std::array<const char*, 3> ColoringNames{ "Intensity", "Speed", "RegistrationError" };
constexpr std::array<const char*, 3> InvalidSliceChoiceNames{ "LeaveOut", "Outline", "Show" };

// Slices k of the stack that a piece of the output has; last < first: none.
struct Slab
{
  int First, Last;
};

Slab GetSlab(vtkInformation* input, vtkInformation* output)
{
  int whole[6];
  input->Get(SDDP::WHOLE_EXTENT(), whole);
  const std::int64_t depth = std::int64_t{ whole[5] } - whole[4] + 1;
  std::int64_t piece = 0;
  std::int64_t pieces = 1;
  if (output->Has(SDDP::UPDATE_NUMBER_OF_PIECES()) && output->Has(SDDP::UPDATE_PIECE_NUMBER()))
  {
    piece = output->Get(SDDP::UPDATE_PIECE_NUMBER());
    pieces = std::max(1, output->Get(SDDP::UPDATE_NUMBER_OF_PIECES()));
  }
  return { static_cast<int>(whole[4] + depth * piece / pieces),
    static_cast<int>(whole[4] + depth * (piece + 1) / pieces - 1) };
}

//------------------------------------------------------------------------------
// Whether a live source has given no slice with a pose yet, or has none for the moment.
bool IsYetToCome(vtkImageData* stack, const Slab& slab)
{
  if (!lacuna::TrackedSlices::IsGrowing(stack))
  {
    return false;
  }
  if (!stack->GetFieldData()->HasArray(lacuna::TrackedSlices::ImageToReferenceName))
  {
    return true;
  }
  const lacuna::TrackedSlices slices(stack);
  bool any = false;
  for (int slice = slab.First; slice <= slab.Last; ++slice)
  {
    any = any || !(slices.GetStatus(slice) & lacuna::TrackedSlices::PoseInvalid);
  }
  return !any;
}
}

vtkStandardNewMacro(vtkLacunaSlicePlanes);

//------------------------------------------------------------------------------
int vtkLacunaSlicePlanes::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
vtkLacunaSlicePlanes::vtkLacunaSlicePlanes()
{
  this->Sharing = lacuna::Share::Parts;
  this->TakesBlocks = true;
}

//------------------------------------------------------------------------------
void vtkLacunaSlicePlanes::Ask(const lacuna::Ports& ports)
{
  vtkInformation* in = ports.GetInputInformation();
  std::array<int, 6> extent;
  in->Get(SDDP::WHOLE_EXTENT(), extent.data());
  const Slab slab = GetSlab(in, ports.GetOutputInformation());
  if (slab.First <= slab.Last)
  {
    extent[4] = slab.First;
    extent[5] = slab.Last;
  }
  else if (extent[4] <= extent[5])
  {
    extent[5] = extent[4]; // what the sweep is, is asked for even where no slice is wanted
  }
  this->AskFor(in, extent);
}

//------------------------------------------------------------------------------
void vtkLacunaSlicePlanes::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  vtkInformation* in = ports.GetInputInformation();
  auto* stack = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkPolyData>();
  output->GetFieldData()->Initialize(); // VTK passes the slices' own
  int whole[6];
  in->Get(SDDP::WHOLE_EXTENT(), whole);
  const Slab slab = GetSlab(in, ports.GetOutputInformation());
  if (IsYetToCome(stack, slab))
  {
    return;
  }
  lacuna::SlicePlaneBuilder::Options options;
  options.Stride = this->Stride;
  options.Accuracy = { this->TranslationAccuracy, this->AngularAccuracy };
  options.SpeedLimit = this->SpeedLimit;
  options.OutlineOnly = this->OutlineOnly;
  options.InvalidSlices = this->InvalidSlices;
  options.KeepOutliers = this->BadPoses == vtkLacunaSliceAlgorithm::KeepOutliers;
  options.MaximumNumberOfPoints = this->MaximumNumberOfPoints;
  lacuna::SlicePlaneBuilder builder(stack, whole, slab.First, slab.Last, options);
  this->CheckRequest(builder);
  if (!builder.GetLeftOut().empty())
  {
    vtkWarningMacro(<< lacuna::SliceImages::DescribeLeftOut(builder.GetLeftOut()));
  }
  builder.Build(output, execution);
  if (this->ColorBy == Speed)
  {
    output->GetCellData()->SetActiveScalars("Speed");
    this->WarnOfSpeed(builder);
  }
  else
  {
    output->GetPointData()->SetActiveScalars(
      this->ColorBy == RegistrationError ? "RegistrationError" : "Intensity");
  }
  lacuna::FieldData::Set(output, "PixelStep", { static_cast<double>(builder.GetPixelStep()) }, 1);
  lacuna::FieldData::Set(output, "SpeedLimit", { this->SpeedLimit }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSlicePlanes::WarnOfSpeed(const lacuna::SlicePlaneBuilder& builder)
{
  const std::vector<vtkIdType> shown = builder.GetShown();
  std::vector<std::size_t> fast;
  std::vector<std::size_t> unknown;
  for (const vtkIdType slice : shown)
  {
    if (std::isnan(builder.GetSpeed(slice)))
    {
      unknown.push_back(static_cast<std::size_t>(slice));
    }
    else if (builder.IsTooFast(slice))
    {
      fast.push_back(static_cast<std::size_t>(slice));
    }
  }
  if (!fast.empty())
  {
    vtkWarningMacro(<< fast.size() << " of " << shown.size() << " slices are faster than "
                    << this->SpeedLimit << " mm/s: " << lacuna::DescribeItems("slice", fast));
  }
  if (!unknown.empty())
  {
    vtkWarningMacro("the speed is not known in " << lacuna::DescribeItems("slice", unknown)
                                                 << ": no time, or none that is later than that "
                                                    "of the slice before");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSlicePlanes::CheckRequest(const lacuna::SlicePlaneBuilder& builder)
{
  if (builder.HasBadCalibration())
  {
    const std::string text = std::string("field data array '") +
      lacuna::TrackedSlices::ImageToProbeName +
      "' has elements that are not finite or beyond all measure, so RegistrationError is not known";
    if (this->ColorBy == RegistrationError)
    {
      throw std::runtime_error(text + "; mend the calibration, or choose another ColorBy");
    }
    vtkWarningMacro(<< text);
  }
  if (this->ColorBy == Speed && !builder.HasTimes())
  {
    throw std::runtime_error(std::string("ColorBy is Speed, but field data array '") +
      lacuna::TrackedSlices::TimestampName + "' is missing: the times of the slices are not known");
  }
  if (this->ColorBy == RegistrationError && !builder.HasCalibration())
  {
    throw std::runtime_error(std::string("ColorBy is RegistrationError, but field data array '") +
      lacuna::TrackedSlices::ImageToProbeName +
      "' is missing: how far the pixels are from the sensor is not known. Give the reader a "
      "CalibrationFileName, or Assemble Tracked Slices an ImageToProbe");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSlicePlanes::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("Stride", this->Stride, ValueRange::AtLeast(1))
    .Add("ColorBy", this->ColorBy, ColoringNames)
    .Add("TranslationAccuracy", this->TranslationAccuracy, ValueRange::AtLeast(0, "mm"))
    .Add("AngularAccuracy", this->AngularAccuracy, ValueRange::AtLeast(0, "degrees"))
    .Add("SpeedLimit", this->SpeedLimit, ValueRange::AtLeast(0, "mm/s"))
    .Add("OutlineOnly", this->OutlineOnly)
    .Add("InvalidSlices", this->InvalidSlices, InvalidSliceChoiceNames)
    .Add("BadPoses", this->BadPoses,
      lacuna::Choices(lacuna::PoseJudge::BadPoseRuleNames, vtkLacunaSliceAlgorithm::LeaveOut))
    .Add("MaximumNumberOfPoints", this->MaximumNumberOfPoints, ValueRange::AtLeast(4));
}
