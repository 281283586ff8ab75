// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaProbeCalibration.h"

#include "lacunaCalibrationOutputs.h"
#include "lacunaCalibrationPicks.h"
#include "lacunaCalibrationReport.h"
#include "lacunaFieldData.h"
#include "lacunaOutputFile.h"
#include "lacunaParameterText.h"
#include "lacunaPrintableText.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
constexpr std::array<const char*, 4> MethodNames{ "ThreeWires", "SingleWall", "PointTarget",
  "StylusPivot" };
constexpr int SmallestPicture = 16; // pixels

using Picks = std::vector<lacuna::SlicePick>;

// Far outside of the pictures is a slip: too far to be told from the others as an outlier. The
// slices may be a part of those that were picked in, and poses without pictures have any pixels.
void CheckPlaces(const Picks& picks, vtkImageData* slices)
{
  double bounds[6];
  slices->GetBounds(bounds);
  for (std::size_t i = 0; i < picks.size(); ++i)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      const double low = bounds[2 * axis], high = bounds[2 * axis + 1];
      const double pixel = picks[i].Pick.Pixel[static_cast<std::size_t>(axis)];
      const double size = high - low + 1;
      if (size >= SmallestPicture && (pixel < low - size || pixel > high + size))
      {
        throw std::runtime_error("row " + std::to_string(i) + " of the table of picks has " +
          lacuna::FormatNumber(pixel) + (axis == 0 ? " as Column" : " as Row") +
          "; the slices have " + lacuna::FormatNumber(low) + " to " + lacuna::FormatNumber(high));
      }
    }
  }
}

// Spots of wires, or of a point, in slices without picks.
Picks FindSpots(lacuna::AlgorithmExecution& execution, vtkImageData* slices,
  const lacuna::ProbePoses& poses, const std::vector<lacuna::WireRange>& ranges, const Picks& picks,
  std::vector<std::string>& advice)
{
  Picks found = lacuna::CalibrationPicks::FindSpots(execution, slices, poses, ranges, picks);
  for (const lacuna::WireRange& range : ranges)
  {
    const auto isIn = [&range](const lacuna::SlicePick& pick)
    { return pick.Slice >= range.First && pick.Slice <= range.Last; };
    if (std::none_of(found.begin(), found.end(), isIn) &&
      std::none_of(picks.begin(), picks.end(), isIn))
    {
      advice.push_back("no bright spot is found in slices " + std::to_string(range.First) + " to " +
        std::to_string(range.Last));
    }
  }
  return found;
}

// Of the pixels that the stack has or had, (column, row).
std::array<lacuna::Vec2, 4> GetCorners(vtkImageData* slices)
{
  double bounds[6];
  slices->GetBounds(bounds);
  return { lacuna::Vec2{ bounds[0], bounds[2] }, lacuna::Vec2{ bounds[1], bounds[2] },
    lacuna::Vec2{ bounds[0], bounds[3] }, lacuna::Vec2{ bounds[1], bounds[3] } };
}

// Columns and rows; 0 of poses without pictures, which have any pixels.
lacuna::Vec2 GetSize(vtkImageData* slices)
{
  double bounds[6];
  slices->GetBounds(bounds);
  const lacuna::Vec2 size{ bounds[1] - bounds[0] + 1, bounds[3] - bounds[2] + 1 };
  return std::min(size[0], size[1]) >= SmallestPicture ? size : lacuna::Vec2{ 0, 0 };
}

// With what is known of slices that were not looked at, which often is why there are too few picks.
lacuna::ProbeCalibration SolveOrTell(const Picks& picks,
  const lacuna::ProbeCalibrationOptions& options, const std::vector<std::string>& known)
{
  std::vector<lacuna::CalibrationPick> kernelPicks;
  for (const lacuna::SlicePick& pick : picks)
  {
    kernelPicks.push_back(pick.Pick);
  }
  try
  {
    return lacuna::ProbeCalibration::Solve(kernelPicks, options);
  }
  catch (const std::invalid_argument& error)
  {
    std::string text = error.what();
    for (const std::string& sentence : known)
    {
      text += "; " + sentence;
    }
    throw std::invalid_argument(text);
  }
}

// mm: at the worst corner of the slices, or at the stylus's tip.
double GetExpectedError(const lacuna::ProbeCalibration& found, vtkImageData* slices, bool isStylus)
{
  double worst = 0;
  for (const lacuna::Vec2& corner : GetCorners(slices))
  {
    worst = std::max(worst, found.GetExpectedError(isStylus ? lacuna::Vec2{ 0, 0 } : corner));
  }
  return worst;
}

// Where the calibration puts the slices, or the stylus's tip.
void SetPlaces(const lacuna::ProbePoses& poses, const lacuna::ProbeCalibration& found,
  bool isStylus, vtkImageData* slices)
{
  if (isStylus)
  {
    const lacuna::Vec3 tip = found.ImageToProbe.Column(3);
    lacuna::FieldData::Set(slices, "StylusTip", { tip[0], tip[1], tip[2] }, 3);
    return;
  }
  std::vector<lacuna::Matrix4> imageToReference;
  for (vtkIdType i = 0; i < poses.GetCount(); ++i)
  {
    imageToReference.push_back(poses.Get(i) * found.ImageToProbe);
  }
  lacuna::FieldData::SetMatrices(
    slices, lacuna::TrackedSlices::ImageToReferenceName, imageToReference);
  lacuna::FieldData::SetMatrices(
    slices, lacuna::TrackedSlices::ImageToProbeName, { found.ImageToProbe });
}

// The figures of the calibration, which each output has.
void SetFigures(
  const lacuna::ProbeCalibration& found, double expectedError, bool isStylus, vtkDataObject* output)
{
  if (!isStylus)
  {
    const lacuna::Vec3 angles = found.GetAngles();
    lacuna::FieldData::Set(
      output, "PixelSpacing", { found.PixelSpacing[0], found.PixelSpacing[1] }, 2);
    lacuna::FieldData::Set(output, "ImageAngles", { angles[0], angles[1], angles[2] }, 3);
  }
  lacuna::FieldData::Set(output, "CalibrationRms", { found.Rms }, 1);
  lacuna::FieldData::Set(output, "CalibrationSpread", { found.Spread }, 1);
  lacuna::FieldData::Set(output, "ExpectedError", { expectedError }, 1);
  lacuna::FieldData::Set(output, "Views", { static_cast<double>(found.Views) }, 1);
  lacuna::FieldData::Set(output, "Condition", { found.Condition }, 1);
  lacuna::FieldData::Set(output, "RunnerUpRms", { found.RunnerUpRms }, 1);
}

vtkSmartPointer<vtkStringArray> MakeAdviceArray(const std::vector<std::string>& advice)
{
  auto sentences = vtkSmartPointer<vtkStringArray>::New();
  sentences->SetName("Advice");
  for (const std::string& sentence : advice)
  {
    sentences->InsertNextValue(sentence);
  }
  return sentences;
}
}

vtkStandardNewMacro(vtkLacunaProbeCalibration);

//------------------------------------------------------------------------------
vtkLacunaProbeCalibration::vtkLacunaProbeCalibration()
{
  this->TakesEmpty = true; // an error
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(5);
}

//------------------------------------------------------------------------------
int vtkLacunaProbeCalibration::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
int vtkLacunaProbeCalibration::FillOutputPortInformation(int port, vtkInformation* info)
{
  static const char* const types[] = { "vtkImageData", "vtkTable", "vtkPolyData", "vtkImageData",
    "vtkPolyData" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types[port]);
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::SetOutputFileName(const char* name)
{
  if (this->OutputFileName != (name ? name : ""))
  {
    this->OutputFileName = name ? name : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::SetWireRanges(const char* ranges)
{
  if (this->WireRanges != (ranges ? ranges : ""))
  {
    this->WireRanges = ranges ? ranges : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::Announce(const lacuna::Ports& ports)
{
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    ports.GetOutputInformation(port)->Remove(
      vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT()); // it takes a moment
  }
  // The map of expected errors has a grid of its own; a request in that of the slices would never be
  // met and calculate everything anew each time.
  vtkInformation* slices = ports.GetInputInformation();
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  double origin[3] = { 0, 0, 0 }, spacing[3] = { 1, 1, 1 };
  if (slices->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    slices->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  }
  if (slices->Has(vtkDataObject::ORIGIN()))
  {
    slices->Get(vtkDataObject::ORIGIN(), origin);
  }
  if (slices->Has(vtkDataObject::SPACING()))
  {
    slices->Get(vtkDataObject::SPACING(), spacing);
  }
  const lacuna::CalibrationOutputs::ErrorMapGrid grid(extent, origin, spacing);
  vtkInformation* map = ports.GetOutputInformation(3);
  map->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), grid.Extent, 6);
  map->Set(vtkDataObject::ORIGIN(), grid.Origin, 3);
  map->Set(vtkDataObject::SPACING(), grid.Spacing, 3);
  lacuna::VolumeDirection::AnnounceAlongAxes(map);
  vtkDataObject::SetPointDataActiveScalarInfo(map, VTK_DOUBLE, 1);
}

//------------------------------------------------------------------------------
std::vector<lacuna::SlicePick> vtkLacunaProbeCalibration::FindPicks(
  lacuna::AlgorithmExecution& execution, vtkImageData* slices, vtkDataObject* given,
  const lacuna::ProbePoses& poses, std::vector<std::string>& advice)
{
  if (this->Method == StylusPivot && given)
  {
    throw std::runtime_error("StylusPivot is calculated from poses alone: take the picks (second "
                             "input) away");
  }
  std::optional<lacuna::CalibrationTarget> target;
  if (this->Method != ThreeWires)
  {
    target = this->Method == SingleWall ? lacuna::CalibrationTarget::Wall
                                        : lacuna::CalibrationTarget::Point;
  }
  std::vector<lacuna::WireRange> ranges;
  if (this->Method == ThreeWires)
  {
    ranges = lacuna::ReadWireRanges(this->WireRanges, poses.GetCount());
  }
  else if (this->Method == PointTarget && !given)
  {
    ranges.push_back({ lacuna::CalibrationTarget::Point, 0, poses.GetCount() - 1 });
  }
  if (!given && this->Method == ThreeWires && ranges.empty())
  {
    throw std::runtime_error("neither picks (second input) nor WireRanges are given: say which "
                             "slices show which wire, like X 0-49, Y 50-99, Z 100-149");
  }
  const bool needsSpots = this->Method == ThreeWires || this->Method == PointTarget;
  if (!given && needsSpots && !this->FindSpots)
  {
    throw std::runtime_error("there are no picks (second input), and FindSpots is off");
  }
  Picks picks;
  if (given)
  {
    picks = lacuna::CalibrationPicks::Read(given, poses, target, ranges);
    CheckPlaces(picks, slices);
    advice.push_back(lacuna::CalibrationPicks::DescribeFlagged(picks, poses));
  }
  const bool finds = needsSpots ? this->FindSpots && !ranges.empty() : !given;
  std::string leftOut;
  if (finds)
  {
    const Picks found = this->Method == StylusPivot
      ? lacuna::CalibrationPicks::GetTips(slices, poses)
      : needsSpots ? ::FindSpots(execution, slices, poses, ranges, picks, advice)
                   : lacuna::CalibrationPicks::FindWallPicks(execution, slices, poses);
    picks.insert(picks.end(), found.begin(), found.end());
    leftOut =
      lacuna::CalibrationPicks::DescribeLeftOut(slices, poses, ranges, this->Method == StylusPivot);
    advice.push_back(leftOut);
  }
  if (!given && picks.empty())
  {
    static const char* const texts[] = { "no slice shows a bright spot on dark. Crop rulers and "
                                         "texts by Extract Subset, or give picks",
      "no slice shows a flat wall: a bright line over most of the width, dark above it. Crop "
      "rulers "
      "and texts by Extract Subset, or give a table of picks",
      "", "no slice has a pose that could be used" };
    throw std::runtime_error(
      std::string(texts[needsSpots ? 0 : this->Method]) + (leftOut.empty() ? "" : "; " + leftOut));
  }
  advice.erase(std::remove(advice.begin(), advice.end(), std::string()), advice.end());
  return picks;
}

//------------------------------------------------------------------------------
lacuna::ProbeCalibrationOptions vtkLacunaProbeCalibration::GetOptions() const
{
  lacuna::ProbeCalibrationOptions options;
  options.OutlierLimit = this->OutlierLimit;
  if (this->Method == StylusPivot)
  {
    return options;
  }
  if (!this->EstimateScale && this->PixelSpacing == 0)
  {
    throw std::runtime_error("PixelSpacing is 0: give the mm from pixel to pixel (see the depth "
                             "scale of the scanner), or set EstimateScale");
  }
  options.PixelSpacing = { this->PixelSpacing,
    this->RowSpacing == 0 ? this->PixelSpacing : this->RowSpacing };
  options.EstimateScale = this->EstimateScale;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* slices = ports.GetInput<vtkImageData>();
  auto* given = ports.GetInput<vtkDataObject>(1);
  if (slices->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the stack of slices is empty");
  }
  const bool pivot = this->Method == StylusPivot;
  const char* array = pivot && slices->GetFieldData()->HasArray(lacuna::ProbePoses::StylusName)
    ? lacuna::ProbePoses::StylusName
    : lacuna::ProbePoses::ArrayName;
  const lacuna::ProbePoses poses(slices, array);
  std::vector<std::string> advice;
  const Picks picks = this->FindPicks(execution, slices, given, poses, advice);
  const lacuna::ProbeCalibrationOptions options = this->GetOptions();
  const lacuna::ProbeCalibration found = SolveOrTell(picks, options, advice);
  lacuna::CalibrationReport::Image image;
  image.Size = pivot ? lacuna::Vec2{ 0, 0 } : GetSize(slices);
  image.EstimateScale = options.EstimateScale;
  image.ExpectedRatio =
    this->PixelSpacing > 0 && this->RowSpacing > 0 ? this->RowSpacing / this->PixelSpacing : 1;
  image.ExpectedError = GetExpectedError(found, slices, pivot);
  const lacuna::CalibrationReport report(found, picks, image);
  const std::vector<std::string> more = report.GetAdvice();
  advice.insert(advice.begin(), more.begin(), more.end());
  // Each rank has the slices calibrated; all else is there once.
  const bool first = ports.IsFirst();
  for (const std::string& sentence : advice)
  {
    if (first)
    {
      vtkWarningMacro(<< lacuna::ToPrintable(sentence));
    }
  }

  auto* calibrated = ports.GetOutput<vtkImageData>(0);
  calibrated->ShallowCopy(slices);
  SetPlaces(poses, found, pivot, calibrated);
  lacuna::CalibrationOutputs::FillErrorMap(slices, found, ports.GetOutput<vtkImageData>(3));
  if (first)
  {
    lacuna::CalibrationOutputs::FillTable(picks, found, ports.GetOutput<vtkTable>(1));
    lacuna::CalibrationOutputs::FillPhantom(picks, found, ports.GetOutput<vtkPolyData>(2));
    lacuna::CalibrationOutputs::FillSlices(picks, found, ports.GetOutput<vtkPolyData>(4));
  }
  const vtkSmartPointer<vtkStringArray> sentences = MakeAdviceArray(advice);
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    auto* output = ports.GetOutput<vtkDataObject>(port);
    SetFigures(found, image.ExpectedError, pivot, output);
    output->GetFieldData()->AddArray(sentences);
  }
  if (first && !this->OutputFileName.empty())
  {
    this->WriteFile(report, array, advice);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::WriteFile(const lacuna::CalibrationReport& report,
  const std::string& frame, const std::vector<std::string>& advice)
{
  const char* from = this->Method == StylusPivot ? "StylusTip" : "Image";
  const std::string to = frame.substr(0, frame.find("ToTracker"));
  std::string refusal = report.GetRefusal();
  refusal += refusal.empty() ? "" : ". Look at Advice";
  if (refusal.empty() && !lacuna::CalibrationReport::MayReplace(this->OutputFileName, from, to))
  {
    refusal = "it holds something else, or more, than Probe Calibration wrote for '" +
      std::string(from) + "' to '" + to + "'. Set another OutputFileName";
  }
  try
  {
    if (refusal.empty())
    {
      report.Write(this->OutputFileName, from, to, advice);
    }
  }
  catch (const lacuna::FileError& e)
  {
    refusal = e.what(); // the outputs are there all the same
  }
  if (!refusal.empty())
  {
    vtkErrorMacro(<< lacuna::ToPrintable("'" + std::string(this->OutputFileName) +
                    "' is not written, and kept if it is there: " + refusal));
  }
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("Method", this->Method, MethodNames)
    .Add("PixelSpacing", this->PixelSpacing, ValueRange::AtLeast(0, "mm"))
    .Add("RowSpacing", this->RowSpacing, ValueRange::Above(0, "mm").OrZero("as PixelSpacing"))
    .Add("EstimateScale", this->EstimateScale)
    .Add("OutlierLimit", this->OutlierLimit, lacuna::ProbeCalibrationOptions::OutlierLimitRange)
    .Add("WireRanges", this->WireRanges)
    .Add("FindSpots", this->FindSpots);
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "OutputFileName: " << this->OutputFileName << "\n";
}
