// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTemporalCalibration.h"

#include "lacunaCalibrationPicks.h"
#include "lacunaFieldData.h"
#include "lacunaTemporalCalibration.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

#include <limits>
#include <stdexcept>
#include <vector>

namespace
{
// The row of a line at a column.
double GetRow(const std::array<lacuna::Vec2, 2>& line, double column)
{
  const double part = (column - line[0][0]) / (line[1][0] - line[0][0]);
  return line[0][1] + part * (line[1][1] - line[0][1]);
}

void AddColumn(vtkTable* table, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name);
  for (const double value : values)
  {
    column->InsertNextValue(value);
  }
  table->AddColumn(column);
}
}

vtkStandardNewMacro(vtkLacunaTemporalCalibration);

//------------------------------------------------------------------------------
int vtkLacunaTemporalCalibration::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
vtkLacunaTemporalCalibration::vtkLacunaTemporalCalibration()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->TakesBlocks = true;
}

//------------------------------------------------------------------------------
void vtkLacunaTemporalCalibration::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* slices = ports.GetInput<vtkImageData>();
  if (slices->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the stack of slices is empty");
  }
  const lacuna::ProbePoses poses(slices);
  vtkDataArray* times =
    lacuna::FieldData::Find(slices, lacuna::TrackedSlices::TimestampName, 1, poses.GetCount());
  if (!times)
  {
    throw std::runtime_error("the slices have no times (field data array Timestamp, s)");
  }
  const auto walls = lacuna::CalibrationPicks::FindWalls(execution, slices);
  double bounds[6];
  slices->GetBounds(bounds);
  const int first = slices->GetExtent()[4];
  std::vector<lacuna::TemporalCalibration::Sample> samples;
  for (std::size_t k = 0; k < walls.size(); ++k)
  {
    const vtkIdType slice =
      lacuna::TrackedSlices::GetSliceNumber(slices, first + static_cast<int>(k), poses.GetCount());
    const double row = walls[k] ? GetRow(*walls[k], 0.5 * (bounds[0] + bounds[1]))
                                : std::numeric_limits<double>::quiet_NaN();
    samples.push_back(
      { times->GetTuple1(slice), row, poses.Get(slice), bool(poses.IsValid(slice)) });
  }
  const lacuna::TemporalCalibration found =
    lacuna::TemporalCalibration::Solve(samples, this->MaximumLag);
  auto* table = ports.GetOutput<vtkTable>();
  AddColumn(table, "Lag", found.Lags);
  AddColumn(table, "Correlation", found.Correlations);
  lacuna::FieldData::Set(table, "TimeOffset", { -found.Lag }, 1);
  lacuna::FieldData::Set(table, "LagSpread", { found.Spread }, 1);
  lacuna::FieldData::Set(table, "Correlation", { found.Correlation }, 1);
  lacuna::FieldData::Set(table, "Frames", { static_cast<double>(found.Frames) }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaTemporalCalibration::Describe(lacuna::Properties& properties) const
{
  properties.Add("MaximumLag", this->MaximumLag, lacuna::TemporalCalibration::MaximumLagRange);
}
