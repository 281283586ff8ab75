// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scans for vtkLacunaProbeCalibration whose truth is known, and what it makes of them.
#ifndef lacunaTestCalibrations_h
#define lacunaTestCalibrations_h

#include "lacunaTestScans.h"
#include "vtkLacunaProbeCalibration.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <fstream>
#include <functional>
#include <iterator>

namespace lacunaTestCalibrations
{
using namespace lacunaTestScans;

struct Scan
{
  vtkSmartPointer<vtkImageData> Slices;
  vtkSmartPointer<vtkTable> Picks;
};

inline vtkSmartPointer<vtkTable> MakeTable(const std::vector<double>& slices,
  const std::vector<double>& columns, const std::vector<double>& rows, const std::string& wires)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  AddColumn(table, "Slice", slices);
  AddColumn(table, "Column", columns);
  AddColumn(table, "Row", rows);
  if (!wires.empty())
  {
    vtkNew<vtkStringArray> column;
    column->SetName("Wire");
    for (const char wire : wires)
    {
      column->InsertNextValue(std::string(1, wire));
    }
    table->AddColumn(column);
  }
  return table;
}

// Three wires, exactly picked.
inline Scan ScanWires(int count)
{
  std::vector<Matrix4> poses;
  std::vector<double> slices, columns, rows;
  std::string wires;
  for (int i = 0; i < count; ++i)
  {
    const int wire = i % 3;
    Vec3 place{ 0, 0, 0 };
    place[wire] = 45 * Wave(i, 7);
    // the image's normal within 40 degrees of the wire
    Vec3 across{ 0, 0, 0 };
    across[(wire + 1) % 3] = 1;
    const Matrix4 normalToWire = wire == 2
      ? Matrix4()
      : Matrix4::Rotation(
          { wire == 1 ? 1.0 : 0.0, wire == 0 ? 1.0 : 0.0, 0 }, (wire == 0 ? 90 : -90) * Degree);
    const Matrix4 turn = Matrix4::Rotation(across, 40 * Degree * Wave(i, 4)) * normalToWire *
      Matrix4::Rotation({ 0, 0, 1 }, 180 * Degree * Wave(i, 5));
    const double column = 0.5 * Width * (1 + 0.9 * Wave(i, 8));
    const double row = 0.5 * Height * (1 + 0.9 * Wave(i, 9));
    const Vec3 arm = turn.Vector({ ColumnSpacing * column, RowSpacing * row, 0 });
    poses.push_back(ProbeToTracker(Matrix4::Translation(place - arm) * turn));
    slices.push_back(i);
    columns.push_back(column);
    rows.push_back(row);
    wires += "XyZ"[wire];
  }
  return { MakeScan(poses), MakeTable(slices, columns, rows, wires) };
}

// A floor that is to be found by itself.
inline vtkSmartPointer<vtkImageData> ScanFloor(int count, double degrees = 45)
{
  std::vector<Matrix4> scans, poses;
  for (int i = 0; i < count; ++i)
  {
    const Matrix4 turn = LookingDown(i, degrees);
    const Vec3 middle = turn.Vector({ 0.5 * Width * ColumnSpacing, 0, 0 });
    const double depth = Height * RowSpacing * (0.5 + 0.2 * Wave(i, 6));
    scans.push_back(Matrix4::Translation(
                      { 30 * Wave(i, 10), 30 * Wave(i, 11), -middle[2] - depth * turn(2, 1) }) *
      turn);
    poses.push_back(ProbeToTracker(scans.back()));
  }
  auto slices = MakeScan(poses);
  for (int i = 0; i < count; ++i)
  {
    DrawFloor(slices, i, scans[static_cast<std::size_t>(i)]);
  }
  return slices;
}

using Settings = std::function<void(vtkLacunaProbeCalibration*)>;

struct Calibrated
{
  vtkSmartPointer<vtkImageData> Slices;
  vtkSmartPointer<vtkTable> Residuals;
  vtkSmartPointer<vtkPolyData> Picture;
  vtkSmartPointer<vtkImageData> Map;
  std::string Errors, Warnings;

  double GetFigure(const char* name) const
  {
    return lacuna::FieldData::Get(this->Slices, name, 1, 1)->GetTuple1(0);
  }
  Matrix4 GetImageToProbe() const
  {
    return lacuna::FieldData::GetMatrix(
      lacuna::FieldData::Get(this->Slices, "ImageToProbe", 16, 1), 0);
  }
};

inline Calibrated Calibrate(vtkImageData* slices, vtkTable* picks, const Settings& configure = {})
{
  vtkNew<vtkLacunaProbeCalibration> filter;
  filter->SetInputData(slices);
  if (picks)
  {
    filter->SetInputDataObject(1, picks);
  }
  filter->SetPixelSpacing(ColumnSpacing);
  filter->SetRowSpacing(RowSpacing);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  Calibrated result;
  result.Slices = filter->GetOutput();
  result.Residuals = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
  result.Picture = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(2));
  result.Map = vtkImageData::SafeDownCast(filter->GetOutputDataObject(3));
  result.Errors = messages->Errors;
  result.Warnings = messages->Warnings;
  if (!result.Errors.empty())
  {
    LACUNA_CHECK_THAT(result.Slices->GetNumberOfPoints() == 0 &&
        result.Residuals->GetNumberOfRows() == 0 && result.Picture->GetNumberOfPoints() == 0 &&
        result.Map->GetNumberOfPoints() == 0,
      "no half result after: " + result.Errors);
  }
  return result;
}

inline double LargestDifference(const Matrix4& a, const Matrix4& b)
{
  double largest = 0;
  for (int i = 0; i < 16; ++i)
  {
    largest = std::max(largest, std::abs(a.Data()[i] - b.Data()[i]));
  }
  return largest;
}

inline std::string ReadFile(const std::string& name)
{
  std::ifstream file(name);
  return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}
}
#endif
