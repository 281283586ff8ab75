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

/// The point of the image, counted from its first: of a map by PixelId, of slices by place and slice.
class PointFinder
{
public:
  PointFinder(vtkPolyData* surface, vtkImageData* image)
    : Surface(surface)
    , Image(image)
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
    const auto slice = static_cast<vtkIdType>(this->Slices->GetTuple1(cell));
    if (slice < 0 || slice >= this->Poses->GetNumberOfTuples())
    {
      return { -1, -1, -1 };
    }
    if (slice != this->Slice)
    {
      this->Slice = slice;
      double pose[16];
      this->Poses->GetTuple(slice, pose);
      vtkMatrix4x4::Invert(pose, this->ReferenceToImage);
    }
    double place[4] = { 0, 0, 0, 1 };
    this->Surface->GetPoint(point, place);
    vtkMatrix4x4::MultiplyPoint(this->ReferenceToImage, place, place);
    place[2] = static_cast<double>(slice);
    const double* origin = this->Image->GetOrigin();
    const double* spacing = this->Image->GetSpacing();
    const int* extent = this->Image->GetExtent();
    Index index;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double number =
        std::round((place[axis] - origin[axis]) / spacing[axis]) - extent[2 * axis];
      if (!(number >= 0 && number < this->Size[axis]))
      {
        return { -1, -1, -1 };
      }
      index[axis] = static_cast<int>(number);
    }
    return index;
  }

  /// Of a point (lessRows 0) or cell (1); -1: none, which ParaView does not select.
  vtkIdType GetNumber(const Index& index, int lessRows) const
  {
    if (index[0] < 0)
    {
      return -1;
    }
    const vtkIdType columns = std::max(this->Size[0] - lessRows, 1);
    const vtkIdType rows = std::max(this->Size[1] - lessRows, 1);
    return index[0] + columns * (index[1] + rows * index[2]);
  }
  const Index& GetSize() const { return this->Size; }

private:
  vtkPolyData* Surface;
  vtkImageData* Image;
  vtkIdTypeArray* Pixels;
  vtkDataArray* Slices;
  vtkDataArray* Poses;
  Index Size{};
  vtkIdType Slice = -1;
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
  auto* image = vtkImageData::GetData(inputs[1]);
  if (!image)
  {
    return 1;
  }
  PointFinder finder(surface, image);
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
    for (int axis = 0; axis < 3 && lowest[0] >= 0;
         ++axis) // the last slice ends the cells before it
    {
      lowest[axis] = std::clamp(lowest[axis], 0, std::max(finder.GetSize()[axis] - 2, 0));
    }
    cells->SetValue(cell, finder.GetNumber(lowest, 1));
  }
  output->GetPointData()->AddArray(points);
  output->GetCellData()->AddArray(cells);
  return 1;
}
