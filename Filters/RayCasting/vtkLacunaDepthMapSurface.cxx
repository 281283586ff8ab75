// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaDepthMapSurface.h"

#include "lacunaDepthMapMesher.h"
#include "lacunaDepthNormals.h"

#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "lacunaMapDepths.h"
#include "lacunaMemory.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

/// First and last row of pixels of a piece; neighbouring pieces share a row. Empty: first = last.
struct Rows
{
  int First;
  int Last;

  Rows(const int whole[6], vtkInformation* outInfo)
  {
    const std::int64_t piece = outInfo->Get(SDDP::UPDATE_PIECE_NUMBER());
    const std::int64_t pieces = std::max(1, outInfo->Get(SDDP::UPDATE_NUMBER_OF_PIECES()));
    const std::int64_t squares = std::max(0, whole[3] - whole[2]);
    this->First = whole[2] + static_cast<int>(piece * squares / pieces);
    this->Last = whole[2] + static_cast<int>((piece + 1) * squares / pieces);
  }
};

/// The tuples of an array at ids.
vtkSmartPointer<vtkAbstractArray> Carry(vtkAbstractArray* array, vtkIdList* ids)
{
  auto carried = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
  carried->SetName(array->GetName());
  carried->SetNumberOfComponents(array->GetNumberOfComponents());
  lacuna::Arrays::SetNumberOfTuples(carried, ids->GetNumberOfIds());
  array->GetTuples(ids, carried);
  return carried;
}

void CarryArrays(vtkPointData* from, vtkIdList* ids, vtkPointData* to)
{
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    to->AddArray(Carry(from->GetAbstractArray(i), ids));
  }
}

/// The numbers in the whole map of pixels, which are numbered in a part of it.
vtkSmartPointer<vtkIdTypeArray> NumberPixels(
  const std::vector<long long>& pixels, const int extent[6], const int whole[6])
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(lacuna::DepthMap::PixelIdName);
  lacuna::Arrays::SetNumberOfTuples(numbers, static_cast<vtkIdType>(pixels.size()));
  const std::int64_t columns = std::int64_t(extent[1]) - extent[0] + 1;
  const std::int64_t wholeColumns = std::int64_t(whole[1]) - whole[0] + 1;
  for (std::size_t i = 0; i < pixels.size(); ++i)
  {
    const std::int64_t column = pixels[i] % columns + extent[0] - whole[0];
    const std::int64_t row = pixels[i] / columns + extent[2] - whole[2];
    numbers->SetValue(static_cast<vtkIdType>(i), column + row * wholeColumns);
  }
  return numbers;
}

/// Degrees between the map's normals and those that the depths give by the nine cases.
vtkSmartPointer<vtkFloatArray> DifferenceOfNormals(vtkImageData* map, const std::string& name,
  const lacuna::DepthGrid& grid, const lacuna::DiscontinuityLimits& limits,
  lacuna::AlgorithmExecution& execution)
{
  vtkDataArray* array = map->GetPointData()->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 3)
  {
    throw std::runtime_error("the depth map has no normals '" + name +
      "' of three components to compare: turn ComputeNormalDifference off");
  }
  vtkNew<vtkFloatArray> stored;
  lacuna::Arrays::Copy(array, stored);
  const vtkIdType pixels = map->GetNumberOfPoints();
  vtkNew<vtkFloatArray> estimated;
  estimated->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(estimated, pixels);
  lacuna::EstimateNormals(grid, lacuna::DepthNormalMethod::Predicate, limits, grid.Extent,
    estimated->GetPointer(0), execution);
  auto difference = vtkSmartPointer<vtkFloatArray>::New();
  difference->SetName(lacuna::DepthMap::NormalDifferenceName);
  lacuna::Arrays::SetNumberOfTuples(difference, pixels);
  lacuna::AnglesBetween(
    stored->GetPointer(0), estimated->GetPointer(0), pixels, difference->GetPointer(0), execution);
  return difference;
}
}

vtkStandardNewMacro(vtkLacunaDepthMapSurface);

//------------------------------------------------------------------------------
int vtkLacunaDepthMapSurface::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapSurface::Announce(const lacuna::Ports& ports)
{
  ports.GetOutputInformation()->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapSurface::Ask(const lacuna::Ports& ports)
{
  vtkInformation* input = ports.GetInputInformation();
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
  input->Get(SDDP::WHOLE_EXTENT(), extent.data());
  const Rows rows(extent.data(), ports.GetOutputInformation());
  // one more row on either side for the rule; an extent may begin or end with the integers
  extent[2] = rows.First > extent[2] ? rows.First - 1 : extent[2];
  extent[3] = rows.Last < extent[3] ? rows.Last + 1 : extent[3];
  this->AskFor(input, extent);
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapSurface::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkPolyData>();
  const lacuna::DepthMap map(input);
  const lacuna::MapDepths depths(input, map, this->DepthArray);
  int whole[6];
  std::copy_n(input->GetExtent(), 6, whole);
  ports.GetInputInformation()->Get(SDDP::WHOLE_EXTENT(), whole);
  const Rows rows(whole, ports.GetOutputInformation());
  if (rows.First == rows.Last && whole[2] != whole[3])
  {
    return; // more pieces than rows
  }

  const lacuna::DiscontinuityLimits limits{ this->MaximumAngle, this->MaximumAngleChange };
  execution.SetStage(0, 0.6);
  const lacuna::DepthMapMesher mesher(
    depths.GetGrid(), { this->BreakAtDiscontinuities, limits }, rows.First, rows.Last, execution);

  execution.SetStage(0.6, 0.8);
  const vtkIdType numberOfPoints = mesher.GetNumberOfPoints();
  // coordinates, three numbers of the pixel, what is carried over; corners and offsets
  const double pixelBytes = 1024.0 *
    static_cast<double>(input->GetPointData()->GetActualMemorySize()) /
    static_cast<double>(input->GetNumberOfPoints());
  lacuna::RequireMemory("the surface of " + std::to_string(numberOfPoints) + " pixels",
    (48 + pixelBytes) * static_cast<double>(numberOfPoints) +
      32.0 * static_cast<double>(mesher.GetNumberOfTriangles()));
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(coordinates, numberOfPoints);
  std::vector<long long> pixels(numberOfPoints);
  mesher.FillPoints(coordinates->GetPointer(0), pixels.data(), execution);
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  output->SetPoints(points);

  execution.SetStage(0.8, 1);
  vtkNew<vtkTypeInt64Array> corners;
  lacuna::Arrays::SetNumberOfTuples(corners, 3 * mesher.GetNumberOfTriangles());
  mesher.FillTriangles(corners->GetPointer(0), execution);
  lacuna::Arrays::SetTriangles(output, corners);

  vtkNew<vtkIdList> ids;
  ids->SetNumberOfIds(numberOfPoints);
  std::copy(pixels.begin(), pixels.end(), ids->GetPointer(0));
  vtkPointData* pointData = output->GetPointData();
  CarryArrays(input->GetPointData(), ids, pointData);
  pointData->SetPedigreeIds(NumberPixels(pixels, input->GetExtent(), whole));
  const std::string normals = lacuna::DepthMap::GetNormalsName(this->DepthArray);
  if (this->ComputeNormalDifference)
  {
    const auto difference =
      DifferenceOfNormals(input, normals, depths.GetGrid(), limits, execution);
    pointData->AddArray(Carry(difference, ids));
  }
  pointData->SetActiveScalars(pointData->HasArray(lacuna::DepthMap::ColorName)
      ? lacuna::DepthMap::ColorName
      : this->DepthArray.c_str());
  vtkDataArray* carriedNormals = pointData->GetArray(normals.c_str());
  if (carriedNormals && carriedNormals->GetNumberOfComponents() == 3)
  {
    pointData->SetActiveNormals(normals.c_str());
  }
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapSurface::Describe(lacuna::Properties& properties) const
{
  properties.Add("DepthArray", this->DepthArray)
    .Add("BreakAtDiscontinuities", this->BreakAtDiscontinuities);
  lacuna::DiscontinuityLimits{ this->MaximumAngle, this->MaximumAngleChange }.Describe(properties);
  properties.Add("ComputeNormalDifference", this->ComputeNormalDifference);
}
