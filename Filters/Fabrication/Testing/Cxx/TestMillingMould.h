// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A small mould and its path's files, for tests of Milling Tool Path and G-Code Writer.
#ifndef TestMillingMould_h
#define TestMillingMould_h

#include "lacunaFieldData.h"
#include "lacunaMatrix4.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkLacunaMillingToolPath.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

namespace millingMould
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

inline double Height(double x, double y)
{
  return 0.01 * (x - 12) * (x - 12) - 0.02 * (y - 7) * (y - 7) + 0.05 * x * std::sin(0.2 * y) - 6;
}

// 31 x 21 points of 1 mm; the plane is across the axis of size 1.
inline vtkSmartPointer<vtkStructuredGrid> Mould(
  const std::function<double(double, double)>& height = Height, int flatAxis = 2)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  const int sizes[3][3] = { { 1, 31, 21 }, { 31, 1, 21 }, { 31, 21, 1 } };
  grid->SetDimensions(sizes[flatAxis]);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int j = 0; j < 21; ++j)
  {
    for (int i = 0; i < 31; ++i)
    {
      points->InsertNextPoint(i, j, height(i, j));
    }
  }
  grid->SetPoints(points);
  lacuna::Matrix4 press = lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.7);
  lacuna::FieldData::SetMatrices(grid, "PressToPatient", { press });
  return grid;
}

inline double Field(vtkDataObject* data, const char* name, int component = 0)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, component) : NaN;
}

inline vtkPolyData* Map(vtkLacunaMillingToolPath* filter)
{
  return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
}

inline std::string Read(const std::string& path)
{
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// The folder for files of a test program: its argument after -T.
inline std::string Folder(int argc, char* argv[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_WARNING);
  std::string folder = ".";
  for (int k = 1; k + 1 < argc; ++k)
  {
    folder = std::string(argv[k]) == "-T" ? argv[k + 1] : folder;
  }
  return folder;
}
}
#endif
