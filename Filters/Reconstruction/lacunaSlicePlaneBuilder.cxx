// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSlicePlaneBuilder.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaPoseJudge.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace
{
constexpr float NoNumber = std::numeric_limits<float>::quiet_NaN();

int Size(const std::array<int, 6>& extent, std::size_t axis)
{
  return extent[2 * axis + 1] - extent[2 * axis] + 1;
}

std::array<int, 6> ToArray(const int extent[6])
{
  return { extent[0], extent[1], extent[2], extent[3], extent[4], extent[5] };
}

// Numbers too large for a float become the largest one; none stays none.
float ToFloat(double value)
{
  return static_cast<float>(std::min(value, double{ std::numeric_limits<float>::max() }));
}

template <class Array>
vtkSmartPointer<Array> MakeArray(const char* name, vtkIdType count, const char* unit = nullptr)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, count);
  if (unit)
  {
    array->SetComponentName(0, unit);
  }
  return array;
}
}

//------------------------------------------------------------------------------
lacuna::SlicePlaneBuilder::SlicePlaneBuilder(
  vtkImageData* stack, const int whole[6], int first, int last, const Options& options)
  : Settings(options)
  , Stack(stack)
  , Tracked(stack)
  , GreyLevels(this->Tracked.GetGreyLevels())
  , Whole(ToArray(whole))
  , Lattice(Size(this->Whole, 0), Size(this->Whole, 1),
      lacuna::SliceLattice::ChooseStep(Size(this->Whole, 0), Size(this->Whole, 1),
        (static_cast<std::int64_t>(whole[5]) - whole[4]) / options.Stride + 1,
        options.MaximumNumberOfPoints))
{
  if (!stack->GetDirectionMatrix()->IsIdentity())
  {
    throw std::runtime_error(
      "the stack of slices has a direction matrix; the coordinates of tracked slices are (column, "
      "row, slice), where they lie in space is in the field data array 'ImageToReference'");
  }
  const int* extent = stack->GetExtent();
  if (!std::equal(extent, extent + 4, whole) ||
    (first <= last && (extent[4] > first || extent[5] < last)))
  {
    throw std::runtime_error("the stack that came holds less than its whole slices");
  }
  if (Size(this->Whole, 0) < 2 || Size(this->Whole, 1) < 2)
  {
    throw std::runtime_error("the slices have " + std::to_string(Size(this->Whole, 0)) + " x " +
      std::to_string(Size(this->Whole, 1)) + " pixels; at least 2 x 2 are needed");
  }
  if (!this->GreyLevels->HasStandardMemoryLayout())
  {
    this->GreyLevels.TakeReference(vtkDataArray::CreateDataArray(this->GreyLevels->GetDataType()));
    lacuna::Arrays::Copy(this->Tracked.GetGreyLevels(), this->GreyLevels);
  }
  this->ReadSweep();
  this->ChooseSlices(first, last);
}

//------------------------------------------------------------------------------
void lacuna::SlicePlaneBuilder::ReadSweep()
{
  const vtkIdType count = this->Tracked.GetNumberOfSlices();
  std::vector<lacuna::Matrix4> poses;
  std::vector<double> times;
  for (vtkIdType i = 0; i < count; ++i)
  {
    poses.push_back(this->Tracked.GetImageToReference(i));
    times.push_back(this->Tracked.GetTimestamp(i));
  }
  // also of slices that are not in the stack: speeds depend on their poses
  this->Sweep = lacuna::PoseJudge::JudgeSweep(
    this->Stack, this->Tracked, this->Whole.data(), this->Settings.KeepOutliers);
  if (lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::TimestampName, 1, count))
  {
    this->Speeds = lacuna::GetSliceSpeeds(poses, this->Sweep.HasPose, times, this->GetCorners());
  }
  vtkDataArray* calibration =
    lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::ImageToProbeName, 16, -1);
  if (calibration && calibration->GetNumberOfTuples() >= 1)
  {
    this->ImageToProbe = lacuna::FieldData::GetMatrix(calibration, 0);
    for (const lacuna::Vec3& corner : this->GetCorners())
    {
      const double radius = lacuna::Norm(this->ImageToProbe.Point(corner));
      this->BadCalibration |= !(radius <= lacuna::PoseJudge::LargestCoordinate);
    }
    this->Calibrated = !this->BadCalibration;
  }
}

//------------------------------------------------------------------------------
// As far as SliceStatus is concerned.
bool lacuna::SlicePlaneBuilder::MayShow(vtkIdType slice) const
{
  const unsigned char status = this->Tracked.GetStatus(slice);
  return this->Settings.InvalidSlices == LeaveOut ? status == lacuna::TrackedSlices::Valid
                                                  : !(status & lacuna::TrackedSlices::PoseInvalid);
}

//------------------------------------------------------------------------------
void lacuna::SlicePlaneBuilder::ChooseSlices(int first, int last)
{
  bool any = false;
  std::string firstProblem;
  vtkIdType outlines = 0;
  for (std::int64_t k = this->Whole[4]; k <= this->Whole[5]; k += this->Settings.Stride)
  {
    ShownSlice slice{ static_cast<int>(k), this->Tracked.GetSliceNumber(static_cast<int>(k)),
      this->Settings.OutlineOnly, false, 0, 0 };
    const bool valid = this->Tracked.GetStatus(slice.Number) == lacuna::TrackedSlices::Valid;
    if (!this->MayShow(slice.Number))
    {
      continue;
    }
    if (!this->Sweep.HasPose[slice.Number])
    {
      const std::string& problem = this->Sweep.Problems[slice.Number];
      firstProblem = firstProblem.empty() ? problem : firstProblem;
      if (k >= first && k <= last)
      {
        this->LeftOut.push_back(problem);
      }
      continue;
    }
    any = true;
    if (k < first || k > last)
    {
      continue;
    }
    slice.IsBlank = !valid && this->Settings.InvalidSlices == Outline;
    slice.IsOutline |= slice.IsBlank;
    slice.FirstPoint = this->NumberOfPoints;
    this->NumberOfPoints += slice.IsOutline ? 4 : this->Lattice.GetNumberOfPoints();
    outlines += slice.IsOutline ? 1 : 0;
    this->Shown.push_back(slice);
  }
  if (!any && !firstProblem.empty())
  {
    throw std::runtime_error(
      "there is no slice to show: none of those asked for has a pose that can be used. " +
      firstProblem);
  }
  if (!any)
  {
    throw std::runtime_error(
      "there is no slice to show: SliceStatus says that none of those asked for is valid; with "
      "InvalidSlices those are shown nevertheless that have poses");
  }
  // lines come before polygons
  this->NumberOfCells = outlines;
  outlines = 0;
  for (ShownSlice& slice : this->Shown)
  {
    slice.FirstCell = slice.IsOutline ? outlines++ : this->NumberOfCells;
    this->NumberOfCells += slice.IsOutline ? 0 : this->GetCellsPerLattice();
  }
  // coordinates and two arrays of the points; corners and five arrays of the cells
  lacuna::RequireMemory("the slices in space",
    20.0 * static_cast<double>(this->NumberOfPoints) +
      58.0 * static_cast<double>(this->NumberOfCells));
}

//------------------------------------------------------------------------------
std::vector<vtkIdType> lacuna::SlicePlaneBuilder::GetShown() const
{
  std::vector<vtkIdType> numbers;
  for (const ShownSlice& slice : this->Shown)
  {
    numbers.push_back(slice.Number);
  }
  return numbers;
}

//------------------------------------------------------------------------------
bool lacuna::SlicePlaneBuilder::IsTooFast(vtkIdType slice) const
{
  return this->Settings.SpeedLimit > 0 && this->Speeds[slice] > this->Settings.SpeedLimit;
}

//------------------------------------------------------------------------------
vtkIdType lacuna::SlicePlaneBuilder::GetCellsPerLattice() const
{
  return (static_cast<vtkIdType>(this->Lattice.GetColumns().size()) - 1) *
    (static_cast<vtkIdType>(this->Lattice.GetRows().size()) - 1);
}

//------------------------------------------------------------------------------
// The place of a pixel (extent indices) in its slice.
lacuna::Vec3 lacuna::SlicePlaneBuilder::GetPixel(int i, int j) const
{
  const double* origin = this->Stack->GetOrigin();
  const double* spacing = this->Stack->GetSpacing();
  return { origin[0] + spacing[0] * i, origin[1] + spacing[1] * j, 0 };
}

//------------------------------------------------------------------------------
// In the order of an outline.
std::array<lacuna::Vec3, 4> lacuna::SlicePlaneBuilder::GetCorners() const
{
  const std::array<int, 6>& e = this->Whole;
  return { this->GetPixel(e[0], e[2]), this->GetPixel(e[1], e[2]), this->GetPixel(e[1], e[3]),
    this->GetPixel(e[0], e[3]) };
}

//------------------------------------------------------------------------------
// The arrays begin at the slice's first point; levels and errors may be missing.
void lacuna::SlicePlaneBuilder::FillSlice(
  const ShownSlice& slice, float* points, float* levels, float* errors) const
{
  const lacuna::Matrix4& pose = this->Tracked.GetImageToReference(slice.Number);
  const auto add = [&](const lacuna::Vec3& pixel)
  {
    const lacuna::Vec3 place = pose.Point(pixel);
    for (int a = 0; a < 3; ++a)
    {
      *points++ = static_cast<float>(place[a]);
    }
    if (errors)
    {
      const double radius = lacuna::Norm(this->ImageToProbe.Point(pixel));
      *errors++ = slice.IsBlank
        ? NoNumber
        : ToFloat(lacuna::GetRegistrationError(this->Settings.Accuracy, radius));
    }
  };
  if (slice.IsOutline)
  {
    for (const lacuna::Vec3& corner : this->GetCorners())
    {
      add(corner);
    }
    std::fill_n(levels, levels ? 4 : 0, NoNumber);
    return;
  }
  for (const int row : this->Lattice.GetRows())
  {
    for (const int column : this->Lattice.GetColumns())
    {
      add(this->GetPixel(this->Whole[0] + column, this->Whole[2] + row));
    }
  }
  const lacuna::ScalarType type = lacuna::ArrayScalarType::Get(this->GreyLevels);
  const auto* pixels = static_cast<const unsigned char*>(this->GreyLevels->GetVoidPointer(0));
  const std::int64_t size = static_cast<std::int64_t>(Size(this->Whole, 0)) * Size(this->Whole, 1) *
    static_cast<std::int64_t>(lacuna::GetScalarSize(type));
  this->Lattice.Reduce(type, pixels + (slice.K - this->Stack->GetExtent()[4]) * size, levels);
}

//------------------------------------------------------------------------------
template <class Array>
void lacuna::SlicePlaneBuilder::MakePolygons(
  vtkPolyData* output, lacuna::AlgorithmExecution& execution) const
{
  using Value = typename Array::ValueType;
  const auto columns = static_cast<vtkIdType>(this->Lattice.GetColumns().size());
  const auto rows = static_cast<vtkIdType>(this->Lattice.GetRows().size());
  std::vector<vtkIdType> firstPoints;
  for (const ShownSlice& slice : this->Shown)
  {
    if (!slice.IsOutline)
    {
      firstPoints.push_back(slice.FirstPoint);
    }
  }
  const vtkIdType perSlice = this->GetCellsPerLattice();
  const vtkIdType count = perSlice * static_cast<vtkIdType>(firstPoints.size());
  vtkNew<Array> offsets;
  vtkNew<Array> points;
  lacuna::Arrays::SetNumberOfTuples(offsets, count + 1);
  lacuna::Arrays::SetNumberOfTuples(points, 4 * count);
  offsets->SetValue(count, static_cast<Value>(4 * count));
  execution.For(static_cast<std::int64_t>(firstPoints.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t s = begin; s < end; ++s)
      {
        Value* offset = offsets->GetPointer(s * perSlice);
        for (vtkIdType cell = s * perSlice; cell < (s + 1) * perSlice; ++cell)
        {
          *offset++ = static_cast<Value>(4 * cell);
        }
        Value* point = points->GetPointer(4 * s * perSlice);
        for (vtkIdType y = 0; y + 1 < rows; ++y)
        {
          for (vtkIdType x = 0; x + 1 < columns; ++x)
          {
            const vtkIdType corner = firstPoints[s] + y * columns + x;
            *point++ = static_cast<Value>(corner);
            *point++ = static_cast<Value>(corner + 1);
            *point++ = static_cast<Value>(corner + columns + 1);
            *point++ = static_cast<Value>(corner + columns);
          }
        }
      }
    });
  vtkNew<vtkCellArray> polygons;
  polygons->SetData(offsets, points);
  output->SetPolys(polygons);
}

//------------------------------------------------------------------------------
void lacuna::SlicePlaneBuilder::MakeCells(
  vtkPolyData* output, lacuna::AlgorithmExecution& execution) const
{
  vtkNew<vtkCellArray> lines;
  const auto count = static_cast<vtkIdType>(this->Shown.size());
  lacuna::Arrays::Reserve(lines, count, 5 * count);
  for (const ShownSlice& slice : this->Shown)
  {
    if (slice.IsOutline)
    {
      const vtkIdType p = slice.FirstPoint;
      lines->InsertNextCell({ p, p + 1, p + 2, p + 3, p });
    }
  }
  output->SetLines(lines);
  if (4 * this->NumberOfCells < VTK_INT_MAX)
  {
    this->MakePolygons<vtkTypeInt32Array>(output, execution);
  }
  else
  {
    this->MakePolygons<vtkTypeInt64Array>(output, execution);
  }
}

//------------------------------------------------------------------------------
void lacuna::SlicePlaneBuilder::AddCellData(vtkPolyData* output) const
{
  const vtkIdType count = this->NumberOfCells;
  const vtkIdType timed = this->HasTimes() ? count : 0;
  const auto number = MakeArray<vtkIntArray>("SliceNumber", count);
  const auto status = MakeArray<vtkUnsignedCharArray>("SliceStatus", count);
  const auto time = MakeArray<vtkDoubleArray>("Timestamp", timed, "s");
  const auto speed = MakeArray<vtkFloatArray>("Speed", timed, "mm/s");
  const auto fast = MakeArray<vtkUnsignedCharArray>("TooFast", timed);
  for (const ShownSlice& slice : this->Shown)
  {
    const vtkIdType first = slice.FirstCell;
    const vtkIdType cells = slice.IsOutline ? 1 : this->GetCellsPerLattice();
    std::fill_n(number->GetPointer(first), cells, static_cast<int>(slice.Number));
    std::fill_n(status->GetPointer(first), cells, this->Tracked.GetStatus(slice.Number));
    if (timed > 0)
    {
      std::fill_n(time->GetPointer(first), cells, this->Tracked.GetTimestamp(slice.Number));
      std::fill_n(speed->GetPointer(first), cells,
        slice.IsBlank ? NoNumber : ToFloat(this->Speeds[slice.Number]));
      std::fill_n(
        fast->GetPointer(first), cells, static_cast<unsigned char>(this->IsTooFast(slice.Number)));
    }
  }
  vtkCellData* data = output->GetCellData();
  data->AddArray(number);
  data->AddArray(status);
  if (this->HasTimes())
  {
    data->AddArray(speed);
    data->AddArray(fast);
    data->AddArray(time);
  }
}

//------------------------------------------------------------------------------
void lacuna::SlicePlaneBuilder::Build(vtkPolyData* output, lacuna::AlgorithmExecution& execution)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  lacuna::Arrays::SetNumberOfPoints(points, this->NumberOfPoints);
  auto* coordinates = static_cast<float*>(points->GetVoidPointer(0));
  const bool grey = !this->Settings.OutlineOnly;
  const bool calibrated = this->Calibrated;
  const auto levels = MakeArray<vtkFloatArray>("Intensity", grey ? this->NumberOfPoints : 0);
  const auto errors =
    MakeArray<vtkFloatArray>("RegistrationError", calibrated ? this->NumberOfPoints : 0, "mm");
  execution.SetStage(0, 0.8);
  execution.For(static_cast<std::int64_t>(this->Shown.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t s = begin; s < end; ++s)
      {
        const ShownSlice& slice = this->Shown[s];
        this->FillSlice(slice, coordinates + 3 * slice.FirstPoint,
          grey ? levels->GetPointer(slice.FirstPoint) : nullptr,
          calibrated ? errors->GetPointer(slice.FirstPoint) : nullptr);
      }
    });
  execution.SetStage(0.8, 1);
  output->SetPoints(points);
  this->MakeCells(output, execution);
  if (grey)
  {
    output->GetPointData()->AddArray(levels);
  }
  if (calibrated)
  {
    output->GetPointData()->AddArray(errors);
  }
  this->AddCellData(output);
}
