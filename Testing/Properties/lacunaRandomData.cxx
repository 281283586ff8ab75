// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRandomData.h"

#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaTrackedSlices.h"
#include "vtkCellArray.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lacunaProperties
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

vtkSmartPointer<vtkDataArray> AddArray(
  vtkDataSet* data, int type, const char* name, int components = 1)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(data->GetNumberOfPoints());
  data->GetPointData()->AddArray(array);
  return array;
}

lacuna::Vec3 RandomAxis(Dice& dice)
{
  for (;;)
  {
    const lacuna::Vec3 axis{ dice.Real(-1, 1), dice.Real(-1, 1), dice.Real(-1, 1) };
    if (lacuna::Norm(axis) > 0.1)
    {
      return lacuna::Normalized(axis);
    }
  }
}

// A bent surface over a plane; no symmetry.
struct Relief
{
  explicit Relief(Dice& dice)
    : Height(dice.Real(5, 40))
    , Slopes{ dice.Real(-0.3, 0.3), dice.Real(-0.3, 0.3) }
    , Bend(dice.Real(-0.008, 0.008))
    , Twist(dice.Real(-0.004, 0.004))
  {
  }
  double operator()(double x, double y) const
  {
    return this->Height + this->Slopes[0] * x + this->Slopes[1] * y +
      this->Bend * (x * x + 0.6 * y * y) + this->Twist * x * y;
  }
  double Height;
  lacuna::Vec2 Slopes;
  double Bend;
  double Twist;
};
}

//------------------------------------------------------------------------------
lacuna::Matrix4 RandomPose(Dice& dice, double reach)
{
  const lacuna::Vec3 shift{ dice.Real(-reach, reach), dice.Real(-reach, reach),
    dice.Real(-reach, reach) };
  return lacuna::Matrix4::Translation(shift) *
    lacuna::Matrix4::Rotation(RandomAxis(dice), dice.Real(-180, 180) * Degree);
}

//------------------------------------------------------------------------------
int RandomType(Dice& dice)
{
  return dice.Pick({ VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT,
    VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
    VTK_ID_TYPE, VTK_FLOAT, VTK_DOUBLE });
}

//------------------------------------------------------------------------------
void PlaceImage(vtkImageData* image, const int dimensions[3], Dice& dice)
{
  int extent[6];
  double spacing[3];
  double origin[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = dice.Chance(0.5) ? 0 : dice.Whole(-7, 9);
    extent[2 * axis + 1] = extent[2 * axis] + dimensions[axis] - 1;
    spacing[axis] = dice.Scale(0.3, 3);
    origin[axis] = dice.Real(-100, 100);
  }
  image->SetExtent(extent);
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  if (dice.Chance(0.5))
  {
    const lacuna::Matrix4 pose = RandomPose(dice, 0);
    const double hand = dice.Chance(0.2) ? -1 : 1;
    vtkNew<vtkMatrix3x3> direction;
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        direction->SetElement(row, column, (column == 0 ? hand : 1) * pose(row, column));
      }
    }
    image->SetDirectionMatrix(direction);
  }
}

//------------------------------------------------------------------------------
void AddScalars(vtkImageData* image, int type, const char* name,
  const std::function<double(const lacuna::Vec3&)>& value)
{
  const vtkSmartPointer<vtkDataArray> array = AddArray(image, type, name);
  const int* extent = image->GetExtent();
  vtkIdType point = 0;
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        array->SetTuple1(point++,
          value({ static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) }));
      }
    }
  }
  image->GetPointData()->SetActiveScalars(name);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> RandomVolume(Dice& dice)
{
  int dimensions[3] = { dice.Length(2, 10), dice.Length(2, 10), dice.Length(2, 10) };
  if (dice.Chance(0.25))
  {
    for (int& dimension : dimensions)
    {
      dimension = dice.Chance(0.4) ? 1 : dimension;
    }
  }
  else if (dice.Chance(0.04))
  {
    dimensions[dice.Whole(0, 2)] = 0;
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  PlaceImage(image, dimensions, dice);
  const int kind = dice.Whole(0, 3);
  const int* extent = image->GetExtent();
  const lacuna::Vec3 middle{ extent[0] + dice.Real(0, dimensions[0]),
    extent[2] + dice.Real(0, dimensions[1]), extent[4] + dice.Real(0, dimensions[2]) };
  AddScalars(image, RandomType(dice), dice.Pick({ "Data", "Intensity", "Levels of grey" }),
    [&](const lacuna::Vec3& p)
    {
      const lacuna::Vec3 d = p - middle;
      return kind == 0 ? dice.Real(0, 100)
        : kind == 1    ? 42
                       : std::max(0.0, 100 - 12 * lacuna::Norm({ d[0], 1.3 * d[1], 0.8 * d[2] }));
    });
  return image;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> RandomLump(Dice& dice, int least, int most)
{
  const int dimensions[3] = { dice.Length(least, most), dice.Length(least, most),
    dice.Length(least, most) };
  auto image = vtkSmartPointer<vtkImageData>::New();
  PlaceImage(image, dimensions, dice);
  const int* extent = image->GetExtent();
  const lacuna::Vec3 middle{ extent[0] + 0.47 * dimensions[0], extent[2] + 0.52 * dimensions[1],
    extent[4] + 0.45 * dimensions[2] };
  const double fall = 110.0 / *std::min_element(dimensions, dimensions + 3);
  AddScalars(image, RandomType(dice), "Data",
    [&](const lacuna::Vec3& p)
    {
      const lacuna::Vec3 d = p - middle;
      return std::max(
        0.0, 100 - fall * (lacuna::Norm(d) + 0.1 * d[0] - 0.06 * d[1] + 0.01 * d[1] * d[2]));
    });
  return image;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> RandomSlices(Dice& dice, bool isCalibrated)
{
  const int slices = dice.Length(2, 7);
  auto stack = vtkSmartPointer<vtkImageData>::New();
  int extent[6] = { 0, dice.Length(3, 9), 0, dice.Length(3, 9), 0, slices - 1 };
  if (dice.Chance(0.2)) // a crop
  {
    extent[0] = dice.Whole(0, 2);
    extent[2] = dice.Whole(0, 2);
    extent[4] = dice.Whole(0, slices - 1);
  }
  stack->SetExtent(extent);
  if (slices > 3 && extent[4] == 0 && dice.Chance(0.1)) // a stride
  {
    stack->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, (slices - 1) / 2);
    stack->SetSpacing(1, 1, 2);
  }
  AddScalars(stack, RandomType(dice), "Intensity",
    [&](const lacuna::Vec3& p) { return std::fmod(7 * p[0] + 11 * p[1] + 23 * p[2], 101); });

  const double pixel = dice.Scale(0.2, 1);
  const lacuna::Matrix4 imageToProbe =
    RandomPose(dice, 20) * lacuna::Matrix4::Scaling({ pixel, pixel * dice.Real(0.8, 1.2), pixel });
  const lacuna::Matrix4 room = RandomPose(dice, 200);
  const double step = dice.Real(0.2, 1.5);
  const double tilt = dice.Real(-3, 3) * Degree;
  std::vector<lacuna::Matrix4> probe;
  std::vector<lacuna::Matrix4> poses;
  std::vector<double> times;
  std::vector<unsigned char> status;
  std::vector<int> frames;
  for (int i = 0; i < slices; ++i)
  {
    // along the slices' normal
    const lacuna::Vec3 normal = lacuna::Normalized(imageToProbe.Column(2));
    probe.push_back(room * lacuna::Matrix4::Translation(i * step * normal) *
      lacuna::Matrix4::Rotation({ 1, 2, 0.5 }, i * tilt));
    poses.push_back(probe.back() * imageToProbe);
    times.push_back(10 + 0.04 * i);
    status.push_back(static_cast<unsigned char>(
      dice.Chance(0.05) ? dice.Whole(1, 15) : lacuna::TrackedSlices::Valid));
    frames.push_back(100 + i);
  }
  if (!isCalibrated)
  {
    poses.clear();
  }
  lacuna::TrackedSlices::Write(stack, poses, times, status, frames);
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", probe);
  if (isCalibrated)
  {
    lacuna::FieldData::SetMatrices(
      stack, lacuna::TrackedSlices::ImageToProbeName, { imageToProbe });
  }
  return stack;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> RandomStack(Dice& dice, int slices)
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  const int dimensions[3] = { dice.Length(2, 9), dice.Length(2, 9), slices };
  PlaceImage(stack, dimensions, dice);
  AddScalars(stack, RandomType(dice), dice.Pick({ "Grey", "PNGImage", "DICOMImage" }),
    [&](const lacuna::Vec3&) { return dice.Real(0, 120); });
  return stack;
}

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
vtkSmartPointer<vtkTable> RandomPoses(Dice& dice, int rows, int format)
{
  static const std::vector<const char*> names[3] = { { "m00", "m01", "m02", "m03", "m10", "m11",
                                                       "m12", "m13", "m20", "m21", "m22", "m23" },
    { "x", "y", "z", "qx", "qy", "qz", "qw" }, { "x", "y", "z", "azimuth", "elevation", "roll" } };
  std::vector<std::vector<double>> columns(names[format].size());
  std::vector<double> times;
  for (int row = 0; row < rows; ++row)
  {
    const lacuna::Vec3 axis = RandomAxis(dice);
    const double half = dice.Real(-1, 1);
    const lacuna::Matrix4 pose =
      lacuna::Matrix4::Translation({ dice.Real(-9, 9), dice.Real(-9, 9), 1.0 * row }) *
      lacuna::Matrix4::Rotation(axis, 2 * half);
    for (std::size_t i = 0; i < columns.size(); ++i)
    {
      const int n = static_cast<int>(i);
      columns[i].push_back(format == 0 ? pose(n / 4, n % 4)
          : n < 3                      ? pose(n, 3)
          : format == 2                ? dice.Real(-80, 80)
          : n == 6                     ? std::cos(half)
                                       : axis[i - 3] * std::sin(half));
    }
    times.push_back(0.04 * row);
  }
  auto table = vtkSmartPointer<vtkTable>::New();
  for (std::size_t i = 0; i < columns.size(); ++i)
  {
    AddColumn(table, names[format][i], columns[i]);
  }
  AddColumn(table, "Timestamp", times);
  return table;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkTable> RandomSignal(Dice& dice)
{
  std::vector<double> times;
  std::vector<double> values;
  const int rows = dice.Whole(2, 20);
  for (int i = 0; i < rows; ++i)
  {
    times.push_back(9.9 + 0.03 * i);
    values.push_back(dice.Real(0, 1.5));
  }
  auto table = vtkSmartPointer<vtkTable>::New();
  AddColumn(table, "Time", times);
  AddColumn(table, "Gate", values);
  return table;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkTable> RandomPicks(Dice& dice, int slices)
{
  std::vector<double> columns[3];
  auto table = vtkSmartPointer<vtkTable>::New();
  vtkNew<vtkStringArray> wires;
  wires->SetName("Wire");
  const int rows = dice.Whole(1, 40);
  for (int i = 0; i < rows; ++i)
  {
    columns[0].push_back(dice.Whole(0, slices - 1));
    columns[1].push_back(dice.Real(0, 6));
    columns[2].push_back(dice.Real(0, 6));
    wires->InsertNextValue(dice.Pick({ "X", "Y", "Z" }));
  }
  AddColumn(table, "Slice", columns[0]);
  AddColumn(table, "Column", columns[1]);
  AddColumn(table, "Row", columns[2]);
  table->AddColumn(wires);
  return table;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> RandomDepthMap(Dice& dice, bool isFilled, int least)
{
  const int columns = dice.Length(least, least + 10);
  const int rows = dice.Length(least, least + 10);
  const int first[2] = { dice.Chance(0.5) ? 0 : dice.Whole(-5, 20), dice.Chance(0.5) ? 0 : 3 };
  auto map = vtkSmartPointer<vtkImageData>::New();
  map->SetExtent(first[0], first[0] + columns - 1, first[1], first[1] + rows - 1, 0, 0);
  const lacuna::Matrix4 pose = RandomPose(dice, 100);
  const lacuna::Vec2 pixel{ dice.Real(0.7, 1.3), dice.Real(0.7, 1.3) };
  lacuna::DepthMap::SetGeometry(
    map, { pose.Column(3), pose.Column(0), pose.Column(1), pose.Column(2), pixel });
  const Relief relief(dice);
  const bool hasHoles = !isFilled && dice.Chance(0.6);
  const lacuna::Vec2 middle{ first[0] + 0.5 * columns, first[1] + 0.5 * rows };
  const double radius = std::min(columns, rows) * (isFilled ? 0.25 : dice.Real(0.1, 0.4));
  const auto depths = AddArray(map, VTK_DOUBLE, lacuna::DepthMap::DepthName);
  const auto valid = AddArray(map, VTK_CHAR, lacuna::DepthMap::MaskName);
  const auto normals = AddArray(map, VTK_FLOAT, lacuna::DepthMap::NormalsName, 3);
  const auto mark = AddArray(map, VTK_UNSIGNED_CHAR, isFilled ? "Marked" : "Defect");
  const auto filled = AddArray(map, VTK_CHAR, lacuna::DepthMap::FilledMaskName);
  const auto fitted = AddArray(map, VTK_DOUBLE, lacuna::DepthMap::FittedName);
  for (vtkIdType i = 0; i < map->GetNumberOfPoints(); ++i)
  {
    const lacuna::Vec2 p{ first[0] + static_cast<double>(i % columns),
      first[1] + static_cast<double>(i / columns) };
    const bool isInside = std::hypot(p[0] - middle[0], 1.2 * (p[1] - middle[1])) <= radius;
    const double depth = relief(pixel[0] * (p[0] - middle[0]), pixel[1] * (p[1] - middle[1]));
    const bool isHole = hasHoles && isInside;
    depths->SetTuple1(i, isHole ? NaN : depth);
    valid->SetTuple1(i, isHole ? 0 : 1);
    const lacuna::Vec3 towards = -1.0 * pose.Column(2);
    normals->SetTuple(i, isHole ? lacuna::Vec3{}.data() : towards.data());
    mark->SetTuple1(i, isInside ? 1 : 0);
    filled->SetTuple1(i, isInside ? 1 : 0);
    fitted->SetTuple1(i, depth);
  }
  if (!isFilled)
  {
    map->GetPointData()->RemoveArray(lacuna::DepthMap::FilledMaskName);
    map->GetPointData()->RemoveArray(lacuna::DepthMap::FittedName);
  }
  map->GetPointData()->SetActiveScalars(lacuna::DepthMap::DepthName);
  lacuna::FieldData::Set(map, lacuna::DepthMap::IsoValuesName, { 50 }, 1);
  return map;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> RandomPoints(Dice& dice, int least, int most)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(dice.Pick({ VTK_FLOAT, VTK_DOUBLE }));
  vtkNew<vtkCellArray> vertices;
  const int count = dice.Length(least, most);
  const bool isFlat = dice.Chance(0.2);
  for (int i = 0; i < count; ++i)
  {
    const vtkIdType id = points->InsertNextPoint(
      dice.Real(-20, 20), dice.Real(-10, 10), isFlat ? 3 : dice.Real(0, 15));
    vertices->InsertNextCell(1, &id);
  }
  data->SetPoints(points);
  data->SetVerts(vertices);
  const auto values = AddArray(
    data, dice.Pick({ VTK_FLOAT, VTK_DOUBLE, VTK_SHORT }), "Value", dice.Chance(0.2) ? 3 : 1);
  const auto errors = AddArray(data, VTK_DOUBLE, "Error");
  for (int i = 0; i < count; ++i)
  {
    for (int c = 0; c < values->GetNumberOfComponents(); ++c)
    {
      values->SetComponent(i, c, dice.Real(-50, 50));
    }
    errors->SetTuple1(i, dice.Real(0.5, 2));
  }
  data->GetPointData()->SetActiveScalars("Value");
  return data;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkStructuredGrid> RandomMould(Dice& dice)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  const int columns = dice.Length(3, 12);
  const int rows = dice.Length(3, 12);
  const int sizes[3][3] = { { 1, columns, rows }, { columns, 1, rows }, { columns, rows, 1 } };
  const lacuna::Vec2 spacing{ dice.Real(0.5, 2), dice.Real(0.5, 2) };
  const Relief relief(dice);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int j = 0; j < rows; ++j)
  {
    for (int i = 0; i < columns; ++i)
    {
      points->InsertNextPoint(
        spacing[0] * i, spacing[1] * j, relief(spacing[0] * i, spacing[1] * j) - relief.Height - 5);
    }
  }
  grid->SetDimensions(sizes[dice.Whole(0, 2)]);
  grid->SetPoints(points);
  lacuna::FieldData::SetMatrices(grid, "PressToPatient", { RandomPose(dice, 100) });
  return grid;
}
}
