// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaCalibrationPicks.h"

#include "lacunaParameterText.h"
#include "lacunaWallDetection.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaScalarType.h"
#include "vtkLacunaStackPixels.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace
{
vtkAbstractArray* GetColumn(vtkTable* table, const char* name)
{
  vtkAbstractArray* column = table->GetColumnByName(name);
  if (!column || column->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("the table of picks has no column '") + name +
      "'; it needs Slice, Column, Row and for three wires Wire");
  }
  return column;
}

double GetNumber(vtkAbstractArray* column, vtkIdType row)
{
  bool isNumber = false;
  const double number = column->GetVariantValue(row).ToDouble(&isNumber);
  if (!isNumber || !std::isfinite(number))
  {
    throw std::runtime_error("row " + std::to_string(row) + " of the table of picks has '" +
      std::string(column->GetVariantValue(row).ToString()) + "' as " + column->GetName() +
      "; a number is needed");
  }
  return number;
}

lacuna::CalibrationTarget GetWire(vtkAbstractArray* column, vtkIdType row)
{
  const std::string text = column->GetVariantValue(row).ToString();
  const std::string wires = "XYZxyz";
  const std::size_t place = text.size() == 1 ? wires.find(text) : std::string::npos;
  if (place == std::string::npos)
  {
    throw std::runtime_error("row " + std::to_string(row) + " of the table of picks has '" + text +
      "' as Wire; it must be X, Y or Z");
  }
  return static_cast<lacuna::CalibrationTarget>(place % 3);
}

}

//------------------------------------------------------------------------------
vtkLacunaProbePoses::vtkLacunaProbePoses(vtkImageData* slices)
{
  vtkDataArray* status =
    vtkLacunaFieldData::Get(slices, vtkLacunaTrackedSlices::SliceStatusName, 1, -1);
  vtkDataArray* matrices =
    vtkLacunaFieldData::Find(slices, ArrayName, 16, status->GetNumberOfTuples());
  if (!matrices)
  {
    throw std::runtime_error("the slices have no field data array 'ProbeToTracker' (16 numbers for "
                             "each slice): record the probe's transform under that name");
  }
  for (vtkIdType i = 0; i < status->GetNumberOfTuples(); ++i)
  {
    this->Valid.push_back(
      !(static_cast<int>(status->GetTuple1(i)) & vtkLacunaTrackedSlices::PoseInvalid));
    this->Matrices.push_back(vtkLacunaFieldData::GetMatrix(matrices, i));
  }
}

//------------------------------------------------------------------------------
std::vector<vtkLacunaCalibrationPick> vtkLacunaCalibrationPicks::Read(vtkTable* table,
  const vtkLacunaProbePoses& poses, std::optional<lacuna::CalibrationTarget> target)
{
  vtkAbstractArray* slices = GetColumn(table, "Slice");
  vtkAbstractArray* columns = GetColumn(table, "Column");
  vtkAbstractArray* rows = GetColumn(table, "Row");
  vtkAbstractArray* wires = target ? nullptr : GetColumn(table, "Wire");
  std::vector<vtkLacunaCalibrationPick> picks;
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    const double number = GetNumber(slices, row);
    if (number != std::floor(number) || number < 0 ||
      number >= static_cast<double>(poses.GetCount()))
    {
      throw std::runtime_error("row " + std::to_string(row) +
        " of the table of picks is of slice " + lacuna::FormatNumber(number) +
        "; the sweep has slices 0 to " + std::to_string(poses.GetCount() - 1));
    }
    const vtkIdType slice = static_cast<vtkIdType>(number);
    if (!poses.IsValid(slice))
    {
      throw std::runtime_error("row " + std::to_string(row) +
        " of the table of picks is of slice " + std::to_string(slice) +
        ", which has no pose (SliceStatus 1): remove the row");
    }
    picks.push_back({ slice,
      { poses.Get(slice), { GetNumber(columns, row), GetNumber(rows, row) },
        target ? *target : GetWire(wires, row) } });
  }
  return picks;
}

//------------------------------------------------------------------------------
std::vector<std::optional<std::array<lacuna::Vec2, 2>>> vtkLacunaCalibrationPicks::FindWalls(
  vtkLacunaExecution& execution, vtkImageData* slices)
{
  vtkDataArray* levels = vtkLacunaStackPixels::Find(slices);
  if (levels->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the slices have colours; grey levels are needed to look for a wall");
  }
  int extent[6];
  double spacing[3], origin[3];
  slices->GetExtent(extent);
  slices->GetSpacing(spacing);
  slices->GetOrigin(origin);
  const int width = extent[1] - extent[0] + 1, height = extent[3] - extent[2] + 1;
  std::vector<std::optional<std::array<lacuna::Vec2, 2>>> walls(
    static_cast<std::size_t>(extent[5] - extent[4] + 1));
  execution.For(static_cast<std::int64_t>(walls.size()), 1,
    [&](std::int64_t first, std::int64_t last)
    {
      for (std::int64_t k = first; k < last; ++k)
      {
        lacuna::GreyImage image;
        image.Type = vtkLacunaScalarType::Get(levels);
        image.Pixels = levels->GetVoidPointer(static_cast<vtkIdType>(k) * width * height);
        image.RowStride = image.Width = width;
        image.Height = height;
        if (const std::optional<lacuna::WallLine> wall = lacuna::FindWall(image))
        {
          std::array<lacuna::Vec2, 2> points = wall->Points;
          for (lacuna::Vec2& point : points)
          {
            for (std::size_t axis = 0; axis < 2; ++axis)
            {
              point[axis] = origin[axis] + spacing[axis] * (extent[2 * axis] + point[axis]);
            }
          }
          walls[static_cast<std::size_t>(k)] = points;
        }
      }
    });
  return walls;
}
