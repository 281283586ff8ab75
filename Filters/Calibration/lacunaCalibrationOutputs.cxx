// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationOutputs.h"

#include "lacunaArrays.h"
#include "lacunaParameterText.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace
{
using Picks = std::vector<lacuna::SlicePick>;

constexpr int MapIntervals = 60;    // of the map of expected errors along each axis
constexpr double MinimumMargin = 5; // mm of a wall or wire shown beyond the picks

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
  static const char* const names[] = { "X", "Y", "Z", "Wall", "Point", "Tip" };
  return names[static_cast<int>(target)];
}
}

namespace lacuna::CalibrationOutputs
{
//------------------------------------------------------------------------------
void FillTable(const Picks& picks, const lacuna::ProbeCalibration& found, vtkTable* table)
{
  vtkNew<vtkIntArray> slice;
  vtkNew<vtkStringArray> target;
  vtkNew<vtkUnsignedCharArray> used;
  slice->SetName("Slice");
  target->SetName("Target");
  used->SetName("Used");
  const char* const names[7] = { "Column", "Row", "PhantomX", "PhantomY", "PhantomZ", "Error",
    "Score" };
  vtkNew<vtkDoubleArray> numbers[7];
  for (int c = 0; c < 7; ++c)
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
    const double values[7] = { pick.Pixel[0], pick.Pixel[1], point[0], point[1], point[2],
      GetError(point, pick.Target), picks[i].Score };
    for (int c = 0; c < 7; ++c)
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

//------------------------------------------------------------------------------
void FillPhantom(const Picks& picks, const lacuna::ProbeCalibration& found, vtkPolyData* picture)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices, lines;
  vtkNew<vtkDoubleArray> error;
  vtkNew<vtkUnsignedCharArray> used;
  error->SetName("Error");
  used->SetName("Used");
  constexpr vtkIdType spare = 20; // corners of wires and walls, at most
  const vtkIdType count = static_cast<vtkIdType>(picks.size()) + spare;
  lacuna::Arrays::Reserve(points, count);
  lacuna::Arrays::Reserve(vertices, count, count);
  lacuna::Arrays::Reserve(error, count);
  lacuna::Arrays::Reserve(used, count);
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
      [target](const lacuna::SlicePick& pick) { return pick.Pick.Target == target; });
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

//------------------------------------------------------------------------------
void FillSlices(const Picks& picks, const lacuna::ProbeCalibration& found, vtkPolyData* picture)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkDoubleArray> error, score;
  vtkNew<vtkUnsignedCharArray> used;
  vtkNew<vtkStringArray> target;
  error->SetName("Error");
  score->SetName("Score");
  used->SetName("Used");
  target->SetName("Target");
  const auto count = static_cast<vtkIdType>(picks.size());
  lacuna::Arrays::Reserve(points, count);
  lacuna::Arrays::Reserve(vertices, count, count);
  lacuna::Arrays::Reserve(error, count);
  lacuna::Arrays::Reserve(score, count);
  lacuna::Arrays::Reserve(used, count);
  for (std::size_t i = 0; i < picks.size(); ++i)
  {
    const lacuna::CalibrationPick& pick = picks[i].Pick;
    const vtkIdType id =
      points->InsertNextPoint(pick.Pixel[0], pick.Pixel[1], static_cast<double>(picks[i].Slice));
    vertices->InsertNextCell(1, &id);
    error->InsertNextValue(GetError(found.PhantomPoints[i], pick.Target));
    score->InsertNextValue(picks[i].Score);
    used->InsertNextValue(found.Used[i]);
    target->InsertNextValue(GetTargetName(pick.Target));
  }
  picture->SetPoints(points);
  picture->SetVerts(vertices);
  picture->GetPointData()->SetScalars(error);
  picture->GetPointData()->AddArray(score);
  picture->GetPointData()->AddArray(used);
  picture->GetPointData()->AddArray(target);
}

//------------------------------------------------------------------------------
ErrorMapGrid::ErrorMapGrid(const int extent[6], const double origin[3], const double spacing[3])
  : Extent{ 0, 0, 0, 0, 0, 0 }
  , Origin{ 0, 0, 0 }
  , Spacing{ 1, 1, 1 }
{
  for (int axis = 0; axis < 2; ++axis)
  {
    const double length = spacing[axis] * (extent[2 * axis + 1] - extent[2 * axis]);
    this->Origin[axis] = origin[axis] + spacing[axis] * extent[2 * axis];
    if (length > 0)
    {
      this->Extent[2 * axis + 1] = MapIntervals;
      this->Spacing[axis] = length / MapIntervals;
    }
  }
}

//------------------------------------------------------------------------------
void FillErrorMap(vtkImageData* slices, const lacuna::ProbeCalibration& found, vtkImageData* map)
{
  const ErrorMapGrid grid(slices->GetExtent(), slices->GetOrigin(), slices->GetSpacing());
  map->SetOrigin(grid.Origin);
  map->SetSpacing(grid.Spacing);
  map->SetExtent(0, grid.Extent[1], 0, grid.Extent[3], 0, 0);
  vtkNew<vtkDoubleArray> error;
  error->SetName("ExpectedError");
  lacuna::Arrays::SetNumberOfTuples(error, map->GetNumberOfPoints());
  for (vtkIdType i = 0; i < map->GetNumberOfPoints(); ++i)
  {
    double pixel[3];
    map->GetPoint(i, pixel);
    error->SetValue(i, found.GetExpectedError({ pixel[0], pixel[1] }));
    if (!std::isfinite(error->GetValue(i)))
    {
      const double* spacing = slices->GetSpacing();
      throw std::runtime_error(
        "the error to expect is no number at the border of the slices, whose "
        "spacing is " +
        lacuna::FormatValue(std::array<double, 3>{ spacing[0], spacing[1], spacing[2] }) +
        "; the coordinates of tracked slices are (column, row, slice)");
    }
  }
  map->GetPointData()->SetScalars(error);
}
}
