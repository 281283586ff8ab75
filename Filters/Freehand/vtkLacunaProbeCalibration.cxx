// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaProbeCalibration.h"

#include "lacunaAtomicFile.h"
#include "lacunaParameterText.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkLacunaCalibrationPicks.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

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
constexpr int MapIntervals = 60;      // of the map of expected errors along each axis
constexpr double MinimumMargin = 5;   // mm of a wall or wire shown beyond the picks

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

// Of what a pick should lie on, mm.
double GetError(const lacuna::Vec3& point, lacuna::CalibrationTarget target)
{
  double square = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    square += lacuna::IsZeroAt(target, axis) ? point[axis] * point[axis] : 0;
  }
  return std::sqrt(square);
}

const char* GetTargetName(lacuna::CalibrationTarget target)
{
  static const char* const names[] = { "X", "Y", "Z", "Wall", "Point" };
  return names[static_cast<int>(target)];
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

void FillTable(const Picks& picks, const lacuna::ProbeCalibration& found, vtkTable* table)
{
  vtkNew<vtkIntArray> slice;
  vtkNew<vtkStringArray> target;
  vtkNew<vtkUnsignedCharArray> used;
  slice->SetName("Slice");
  target->SetName("Target");
  used->SetName("Used");
  const char* const names[6] = { "Column", "Row", "PhantomX", "PhantomY", "PhantomZ", "Error" };
  vtkNew<vtkDoubleArray> numbers[6];
  for (int c = 0; c < 6; ++c)
  {
    numbers[c]->SetName(names[c]);
  }
  for (std::size_t i = 0; i < picks.size(); ++i)
  {
    const lacuna::CalibrationPick& pick = picks[i].Pick;
    const lacuna::Vec3& point = found.PhantomPoints[i];
    slice->InsertNextValue(static_cast<int>(picks[i].Slice));
    target->InsertNextValue(GetTargetName(pick.Target));
    used->InsertNextValue(found.Used[i]);
    const double values[6] = { pick.Pixel[0], pick.Pixel[1], point[0], point[1], point[2],
      GetError(point, pick.Target) };
    for (int c = 0; c < 6; ++c)
    {
      numbers[c]->InsertNextValue(values[c]);
    }
  }
  table->AddColumn(slice);
  table->AddColumn(target);
  for (auto& column : numbers)
  {
    table->AddColumn(column);
  }
  table->AddColumn(used);
}

// The picks in the phantom, and the phantom as far as they reach.
void FillPicture(const Picks& picks, const lacuna::ProbeCalibration& found, vtkPolyData* picture)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices, lines;
  vtkNew<vtkDoubleArray> error;
  vtkNew<vtkUnsignedCharArray> used;
  error->SetName("Error");
  used->SetName("Used");
  lacuna::Vec3 low{ 0, 0, 0 }, high{ 0, 0, 0 };
  for (std::size_t i = 0; i < picks.size(); ++i)
  {
    const lacuna::Vec3& point = found.PhantomPoints[i];
    const vtkIdType id = points->InsertNextPoint(point.data());
    vertices->InsertNextCell(1, &id);
    error->InsertNextValue(GetError(point, picks[i].Pick.Target));
    used->InsertNextValue(found.Used[i]);
    for (int axis = 0; axis < 3 && found.Used[i]; ++axis)
    {
      low[axis] = i == 0 ? point[axis] : std::min(low[axis], point[axis]);
      high[axis] = i == 0 ? point[axis] : std::max(high[axis], point[axis]);
    }
  }
  const auto addLine = [&](const std::vector<lacuna::Vec3>& corners)
  {
    lines->InsertNextCell(static_cast<int>(corners.size()));
    for (const lacuna::Vec3& corner : corners)
    {
      lines->InsertCellPoint(points->InsertNextPoint(corner.data()));
      error->InsertNextValue(0);
      used->InsertNextValue(1);
    }
  };
  const auto has = [&picks](lacuna::CalibrationTarget target)
  {
    return std::any_of(picks.begin(), picks.end(),
      [target](const vtkLacunaCalibrationPick& pick) { return pick.Pick.Target == target; });
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    if (has(static_cast<lacuna::CalibrationTarget>(axis)))
    {
      lacuna::Vec3 first{ 0, 0, 0 }, last{ 0, 0, 0 };
      first[axis] = std::min(0.0, low[axis]) - MinimumMargin;
      last[axis] = std::max(0.0, high[axis]) + MinimumMargin;
      addLine({ first, last });
    }
  }
  if (has(lacuna::CalibrationTarget::Wall))
  {
    addLine({ { low[0] - MinimumMargin, low[1] - MinimumMargin, 0 },
      { high[0] + MinimumMargin, low[1] - MinimumMargin, 0 },
      { high[0] + MinimumMargin, high[1] + MinimumMargin, 0 },
      { low[0] - MinimumMargin, high[1] + MinimumMargin, 0 },
      { low[0] - MinimumMargin, low[1] - MinimumMargin, 0 } });
  }
  picture->SetPoints(points);
  picture->SetVerts(vertices);
  picture->SetLines(lines);
  picture->GetPointData()->SetScalars(error);
  picture->GetPointData()->AddArray(used);
}

// What to expect at pixels all over the picture, in its coordinates.
void FillErrorMap(vtkImageData* slices, const lacuna::ProbeCalibration& found, vtkImageData* map)
{
  double bounds[6];
  slices->GetBounds(bounds);
  int size[2];
  double spacing[2];
  for (int axis = 0; axis < 2; ++axis)
  {
    const double length = bounds[2 * axis + 1] - bounds[2 * axis];
    const int intervals = length > 0 ? MapIntervals : 0;
    size[axis] = intervals + 1;
    spacing[axis] = intervals ? length / intervals : 1;
  }
  map->SetOrigin(bounds[0], bounds[2], 0);
  map->SetSpacing(spacing[0], spacing[1], 1);
  map->SetDimensions(size[0], size[1], 1);
  vtkNew<vtkDoubleArray> error;
  error->SetName("ExpectedError");
  for (vtkIdType i = 0; i < map->GetNumberOfPoints(); ++i)
  {
    double pixel[3];
    map->GetPoint(i, pixel);
    error->InsertNextValue(found.GetExpectedError({ pixel[0], pixel[1] }));
  }
  map->GetPointData()->SetScalars(error);
}
}

vtkStandardNewMacro(vtkLacunaProbeCalibration);

//------------------------------------------------------------------------------
vtkLacunaProbeCalibration::vtkLacunaProbeCalibration()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(4);
}

//------------------------------------------------------------------------------
int vtkLacunaProbeCalibration::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
int vtkLacunaProbeCalibration::FillOutputPortInformation(int port, vtkInformation* info)
{
  static const char* const types[] = { "vtkImageData", "vtkTable", "vtkPolyData", "vtkImageData" };
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
      vtkTable* table = vtkTable::GetData(inputs[1]);
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
      if (!table && this->Method != SingleWall)
      {
        throw std::runtime_error("there is no table of picks (second input); only a wall is looked "
                                 "for in the slices themselves");
      }
      const Picks picks = table ? vtkLacunaCalibrationPicks::Read(table, poses, target)
                                : FindWallPicks(execution, slices, poses);
      CheckPlaces(picks, slices);
      if (!table && picks.empty())
      {
        throw std::runtime_error(
          "no slice shows a flat wall: a bright line over most of the width, "
          "dark above it. Crop rulers and texts by Extract Subset, or give a "
          "table of picks");
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
      const std::vector<std::string> advice = GetAdvice(found, picks);
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
      FillTable(picks, found, residuals);
      vtkPolyData* picture = vtkPolyData::GetData(outputs, 2);
      FillPicture(picks, found, picture);
      vtkImageData* map = vtkImageData::GetData(outputs, 3);
      FillErrorMap(slices, found, map);

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
        .Add("OutlierLimit", this->OutlierLimit);
      for (vtkDataObject* output :
        std::initializer_list<vtkDataObject*>{ calibrated, residuals, picture, map })
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
        if (table)
        {
          sources.push_back(table);
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
  os << indent << "OutputFileName: " << this->OutputFileName << "\n";
}
