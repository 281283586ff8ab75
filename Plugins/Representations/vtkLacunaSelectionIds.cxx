// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSelectionIds.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPVGeometryFilter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace
{
using Index = std::array<int, 3>; // of a point or cell of the image

/// The point of the image: of a map by PixelId, of slices by place and slice.
class PointFinder
{
public:
  PointFinder(vtkPolyData* surface, vtkImageData* image)
    : Surface(surface)
    , Pixels(vtkIdTypeArray::SafeDownCast(surface->GetPointData()->GetArray("PixelId")))
    , Slices(surface->GetCellData()->GetArray("SliceNumber"))
    , Poses(image->GetFieldData()->GetArray("ImageToReference"))
  {
    image->GetDimensions(this->Size.data());
  }

  bool IsPossible() const
  {
    return this->Pixels ||
      (this->Slices && this->Poses && this->Poses->GetNumberOfComponents() == 16);
  }

  /// The cells are asked for slice by slice.
  Index Find(vtkIdType point, vtkIdType cell)
  {
    if (this->Pixels)
    {
      const vtkIdType pixel = this->Pixels->GetValue(point);
      return { static_cast<int>(pixel % this->Size[0]), static_cast<int>(pixel / this->Size[0]),
        0 };
    }
    const int slice = static_cast<int>(this->Slices->GetTuple1(cell));
    if (slice != this->Slice && slice >= 0 && slice < this->Poses->GetNumberOfTuples())
    {
      this->Slice = slice;
      double pose[16];
      this->Poses->GetTuple(slice, pose);
      vtkMatrix4x4::Invert(pose, this->ReferenceToImage);
    }
    double place[4] = { 0, 0, 0, 1 };
    this->Surface->GetPoint(point, place);
    vtkMatrix4x4::MultiplyPoint(this->ReferenceToImage, place, place);
    const auto whole = [](double x, int size)
    { return static_cast<int>(std::clamp(std::round(x), 0.0, size - 1.0)); };
    return { whole(place[0], this->Size[0]), whole(place[1], this->Size[1]), slice };
  }

  vtkIdType GetNumber(const Index& index, int lessRows) const
  {
    const vtkIdType columns = std::max(this->Size[0] - lessRows, 1);
    const vtkIdType rows = std::max(this->Size[1] - lessRows, 1);
    return index[0] + columns * (index[1] + rows * index[2]);
  }
  const Index& GetSize() const { return this->Size; }

private:
  vtkPolyData* Surface;
  vtkIdTypeArray* Pixels;
  vtkDataArray* Slices;
  vtkDataArray* Poses;
  Index Size{};
  int Slice = -1;
  double ReferenceToImage[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
};
}

vtkStandardNewMacro(vtkLacunaSelectionIds);

//------------------------------------------------------------------------------
vtkLacunaSelectionIds::vtkLacunaSelectionIds()
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
void vtkLacunaSelectionIds::Use(vtkAlgorithm* geometry)
{
  if (auto* filter = vtkPVGeometryFilter::SafeDownCast(geometry))
  {
    filter->PassThroughCellIdsOff(); // which would be those of the surface
    filter->PassThroughPointIdsOff();
  }
}

//------------------------------------------------------------------------------
int vtkLacunaSelectionIds::FillInputPortInformation(int port, vtkInformation* information)
{
  information->Set(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPolyData" : "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSelectionIds::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  auto* surface = vtkPolyData::GetData(inputs[0]);
  auto* output = vtkPolyData::GetData(outputs);
  output->ShallowCopy(surface);
  PointFinder finder(surface, vtkImageData::GetData(inputs[1]));
  if (!finder.IsPossible())
  {
    return 1;
  }
  vtkNew<vtkIdTypeArray> points, cells;
  points->SetName("vtkOriginalPointIds"); // what ParaView selects by
  points->SetNumberOfValues(surface->GetNumberOfPoints());
  points->FillValue(0);
  cells->SetName("vtkOriginalCellIds");
  cells->SetNumberOfValues(surface->GetNumberOfCells());
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell)
  {
    surface->GetCellPoints(cell, corners);
    Index lowest = finder.GetSize();
    for (const vtkIdType point : *corners)
    {
      const Index index = finder.Find(point, cell);
      points->SetValue(point, finder.GetNumber(index, 0));
      for (int axis = 0; axis < 3; ++axis)
      {
        lowest[axis] = std::min(lowest[axis], index[axis]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) // the last slice ends the cells before it
    {
      lowest[axis] = std::clamp(lowest[axis], 0, std::max(finder.GetSize()[axis] - 2, 0));
    }
    cells->SetValue(cell, finder.GetNumber(lowest, 1));
  }
  output->GetPointData()->AddArray(points);
  output->GetCellData()->AddArray(cells);
  return 1;
}
