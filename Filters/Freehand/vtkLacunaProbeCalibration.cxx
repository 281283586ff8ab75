// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaProbeCalibration.h"

#include "lacunaAtomicFile.h"
#include "lacunaParameterText.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaCalibrationOutputs.h"
#include "vtkLacunaCalibrationPicks.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
constexpr double LargeRms = 1.5;      // mm; that of Carr's phantom stayed below 0.5
constexpr double RivalRatio = 1.5;    // of the RMS of another solution
constexpr double ManyOutliers = 0.15; // of the picks

using Picks = std::vector<vtkLacunaCalibrationPick>;

// Two points of the floor's line in each slice that shows it and has a pose.
Picks FindWallPicks(
  vtkLacunaExecution& execution, vtkImageData* slices, const vtkLacunaProbePoses& poses)
{
  const auto walls = vtkLacunaCalibrationPicks::FindWalls(execution, slices);
  const int first = slices->GetExtent()[4];
  Picks picks;
  for (std::size_t k = 0; k < walls.size(); ++k)
  {
    const vtkIdType slice =
      vtkLacunaTrackedSlices::GetSliceNumber(slices, first + static_cast<int>(k), poses.GetCount());
    if (walls[k] && poses.IsValid(slice))
    {
      for (const lacuna::Vec2& point : *walls[k])
      {
        picks.push_back({ slice, { poses.Get(slice), point, lacuna::CalibrationTarget::Wall } });
      }
    }
  }
  return picks;
}

// Far outside of the pictures is a slip: too far to be told from the others as an outlier. The
// slices may be a part of those that were picked in, and poses without pictures have any pixels.
void CheckPlaces(const Picks& picks, vtkImageData* slices)
{
  constexpr double smallestPicture = 16; // pixels
  double bounds[6];
  slices->GetBounds(bounds);
  for (std::size_t i = 0; i < picks.size(); ++i)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      const double low = bounds[2 * axis], high = bounds[2 * axis + 1];
      const double pixel = picks[i].Pick.Pixel[static_cast<std::size_t>(axis)];
      const double size = high - low + 1;
      if (size >= smallestPicture && (pixel < low - size || pixel > high + size))
      {
        throw std::runtime_error("row " + std::to_string(i) + " of the table of picks has " +
          lacuna::FormatNumber(pixel) + (axis == 0 ? " as Column" : " as Row") +
          "; the slices have " + lacuna::FormatNumber(low) + " to " + lacuna::FormatNumber(high));
      }
    }
  }
}

// Spots of wires, or of a point, in slices without picks.
Picks FindSpots(vtkLacunaExecution& execution, vtkImageData* slices,
  const vtkLacunaProbePoses& poses, const std::vector<lacuna::WireRange>& ranges,
  const Picks& picks, std::vector<std::string>& advice)
{
  Picks found = vtkLacunaCalibrationPicks::FindSpots(execution, slices, poses, ranges, picks);
  for (const lacuna::WireRange& range : ranges)
  {
    const auto isIn = [&range](const vtkLacunaCalibrationPick& pick)
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

std::string Format(const char* format, double value)
{
  char text[80];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// What the user should know, the most important first.
std::vector<std::string> GetAdvice(const lacuna::ProbeCalibration& found, const Picks& picks)
{
  std::vector<std::string> advice;
  if (found.RunnerUpRms < RivalRatio * found.Rms)
  {
    advice.push_back(Format("another position of the image fits nearly as well (RMS %.2f mm): ",
                       found.RunnerUpRms) +
      "the picks do not tell which is right; scan from more sides");
  }
  const auto outliers =
    static_cast<double>(std::count(found.Used.begin(), found.Used.end(), false));
  if (outliers > ManyOutliers * static_cast<double>(picks.size()))
  {
    advice.push_back(Format("%.0f", outliers) + " of " + std::to_string(picks.size()) +
      " picks do not agree with the others: check which wire is which, and the poses");
  }
  if (found.Rms > LargeRms)
  {
    advice.push_back(Format("the RMS error of %.2f mm is large; ", found.Rms) +
      "below 1 mm is usual. Is the pixel spacing right, the speed of sound that of water at this "
      "temperature, and no metal near the receiver?");
  }
  for (const lacuna::CalibrationWeakness& weakness : found.Weaknesses)
  {
    advice.push_back(Format("known to %.1f mm only is ", weakness.Error) + weakness.Motion);
  }
  return advice;
}

void WriteCalibration(const std::string& fileName, const lacuna::ProbeCalibration& found)
{
  std::string text = "<!-- Lacuna " + std::string(vtkLacunaProvenance::GetVersion()) +
    ", Probe Calibration: RMS " + Format("%.3f", found.Rms) + " mm of " +
    std::to_string(found.Equations) +
    " equations. Image: column, row, 0; mm. -->\n"
    "<PlusConfiguration version=\"2.9\">\n  <CoordinateDefinitions>\n"
    "    <Transform From=\"Image\" To=\"Probe\" Error=\"" +
    Format("%.4f", found.Rms) + "\"\n      Matrix=\"";
  for (int row = 0; row < 4; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      text += (column   ? " "
                  : row ? "\n        "
                        : "") +
        lacuna::FormatNumber(found.ImageToProbe(row, column));
    }
  }
  text += "\"/>\n  </CoordinateDefinitions>\n</PlusConfiguration>\n";
  lacuna::WriteFileAtomically(fileName, text);
}
}

vtkStandardNewMacro(vtkLacunaProbeCalibration);

//------------------------------------------------------------------------------
vtkLacunaProbeCalibration::vtkLacunaProbeCalibration()
{
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
int vtkLacunaProbeCalibration::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkLacunaRequest::Whole(inputs[0]->GetInformationObject(0));
  if (vtkInformation* table = inputs[1]->GetInformationObject(0))
  {
    vtkLacunaRequest::OnePiece(table);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaProbeCalibration::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  return vtkLacunaExecution::Run(this, outputs,
    [&](vtkLacunaExecution& execution)
    {
      vtkImageData* slices = vtkImageData::GetData(inputs[0]);
      vtkDataObject* given = vtkDataObject::GetData(inputs[1]);
      if (slices->GetNumberOfPoints() == 0)
      {
        throw std::runtime_error("the stack of slices is empty");
      }
      const vtkLacunaProbePoses poses(slices);
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
      if (!given && this->Method != SingleWall && !this->FindSpots)
      {
        throw std::runtime_error("there are no picks (second input), and FindSpots is off");
      }
      std::vector<std::string> advice;
      Picks picks;
      if (given)
      {
        picks = vtkLacunaCalibrationPicks::Read(given, poses, target, ranges);
        CheckPlaces(picks, slices);
      }
      if (this->FindSpots && !ranges.empty())
      {
        const Picks spots = ::FindSpots(execution, slices, poses, ranges, picks, advice);
        picks.insert(picks.end(), spots.begin(), spots.end());
      }
      else if (!given && this->Method == SingleWall)
      {
        picks = FindWallPicks(execution, slices, poses);
      }
      if (!given && picks.empty())
      {
        throw std::runtime_error(this->Method == SingleWall
            ? "no slice shows a flat wall: a bright line over most of the width, dark above it. "
              "Crop "
              "rulers and texts by Extract Subset, or give a table of picks"
            : "no slice shows a bright spot on dark. Crop rulers and texts by Extract Subset, or "
              "give picks");
      }
      if (!this->EstimateScale && this->PixelSpacing == 0)
      {
        throw std::runtime_error(
          "PixelSpacing is 0: give the mm from pixel to pixel (see the depth "
          "scale of the scanner), or set EstimateScale");
      }

      lacuna::ProbeCalibrationOptions options;
      options.PixelSpacing = { this->PixelSpacing,
        this->RowSpacing == 0 ? this->PixelSpacing : this->RowSpacing };
      options.EstimateScale = this->EstimateScale;
      options.OutlierLimit = this->OutlierLimit;
      std::vector<lacuna::CalibrationPick> kernelPicks;
      for (const vtkLacunaCalibrationPick& pick : picks)
      {
        kernelPicks.push_back(pick.Pick);
      }
      const lacuna::ProbeCalibration found = lacuna::ProbeCalibration::Solve(kernelPicks, options);
      const std::vector<std::string> more = GetAdvice(found, picks);
      advice.insert(advice.end(), more.begin(), more.end());
      for (const std::string& sentence : advice)
      {
        vtkWarningMacro(<< sentence);
      }

      vtkImageData* calibrated = vtkImageData::GetData(outputs, 0);
      calibrated->ShallowCopy(slices);
      std::vector<lacuna::Matrix4> imageToReference;
      for (vtkIdType i = 0; i < poses.GetCount(); ++i)
      {
        imageToReference.push_back(poses.Get(i) * found.ImageToProbe);
      }
      vtkLacunaFieldData::SetMatrices(
        calibrated, vtkLacunaTrackedSlices::ImageToReferenceName, imageToReference);
      vtkLacunaFieldData::SetMatrices(
        calibrated, vtkLacunaTrackedSlices::ImageToProbeName, { found.ImageToProbe });
      vtkTable* residuals = vtkTable::GetData(outputs, 1);
      vtkLacunaCalibrationOutputs::FillTable(picks, found, residuals);
      vtkPolyData* picture = vtkPolyData::GetData(outputs, 2);
      vtkLacunaCalibrationOutputs::FillPhantom(picks, found, picture);
      vtkImageData* map = vtkImageData::GetData(outputs, 3);
      vtkLacunaCalibrationOutputs::FillErrorMap(slices, found, map);
      vtkPolyData* marks = vtkPolyData::GetData(outputs, 4);
      vtkLacunaCalibrationOutputs::FillSlices(picks, found, marks);

      double expected = 0;
      for (const lacuna::Vec2& corner : GetCorners(slices))
      {
        expected = std::max(expected, found.GetExpectedError(corner));
      }
      const lacuna::Vec3 angles = found.GetAngles();
      vtkNew<vtkStringArray> sentences;
      sentences->SetName("Advice");
      for (const std::string& sentence : advice)
      {
        sentences->InsertNextValue(sentence);
      }
      lacuna::ParameterText parameters;
      parameters.Add("Method", this->Method)
        .Add("PixelSpacing", this->PixelSpacing)
        .Add("RowSpacing", this->RowSpacing)
        .Add("EstimateScale", this->EstimateScale)
        .Add("OutlierLimit", this->OutlierLimit)
        .Add("WireRanges", this->WireRanges)
        .Add("FindSpots", this->FindSpots);
      for (vtkDataObject* output :
        std::initializer_list<vtkDataObject*>{ calibrated, residuals, picture, map, marks })
      {
        vtkLacunaFieldData::Set(
          output, "PixelSpacing", { found.PixelSpacing[0], found.PixelSpacing[1] }, 2);
        vtkLacunaFieldData::Set(output, "CalibrationRms", { found.Rms }, 1);
        vtkLacunaFieldData::Set(output, "CalibrationSpread", { found.Spread }, 1);
        vtkLacunaFieldData::Set(output, "ExpectedError", { expected }, 1);
        vtkLacunaFieldData::Set(output, "Condition", { found.Condition }, 1);
        vtkLacunaFieldData::Set(output, "RunnerUpRms", { found.RunnerUpRms }, 1);
        vtkLacunaFieldData::Set(output, "ImageAngles", { angles[0], angles[1], angles[2] }, 3);
        output->GetFieldData()->AddArray(sentences);
        std::vector<vtkDataObject*> sources{ slices };
        if (given)
        {
          sources.push_back(given);
        }
        vtkLacunaProvenance::Record(output, this, sources, parameters.Get());
      }
      // Once, on the first rank of a parallel server.
      vtkInformation* info = outputs->GetInformationObject(0);
      if (!this->OutputFileName.empty() &&
        (!info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) ||
          info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) == 0))
      {
        WriteCalibration(this->OutputFileName, found);
      }
    });
}

//------------------------------------------------------------------------------
void vtkLacunaProbeCalibration::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << this->Method << "\n";
  os << indent << "PixelSpacing: " << this->PixelSpacing << "\n";
  os << indent << "RowSpacing: " << this->RowSpacing << "\n";
  os << indent << "EstimateScale: " << this->EstimateScale << "\n";
  os << indent << "OutlierLimit: " << this->OutlierLimit << "\n";
  os << indent << "WireRanges: " << this->WireRanges << "\n";
  os << indent << "FindSpots: " << this->FindSpots << "\n";
  os << indent << "OutputFileName: " << this->OutputFileName << "\n";
}
