// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMapDepths.h"

#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <stdexcept>

//------------------------------------------------------------------------------
lacuna::MapDepths::MapDepths(
  vtkImageData* map, const lacuna::DepthMap& contract, const std::string& depthArray)
{
  vtkDataArray* array = map->GetPointData()->GetArray(depthArray.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(
      "the depth map has no one-component point array '" + depthArray + "' to take depths from");
  }
  this->Depths = vtkDoubleArray::SafeDownCast(array);
  if (!this->Depths)
  {
    this->Depths = vtkSmartPointer<vtkDoubleArray>::New();
    lacuna::Arrays::Copy(array, this->Depths);
  }
  const int* extent = map->GetExtent();
  this->Grid.Depth = this->Depths->GetPointer(0);
  this->Grid.Extent = { extent[0], extent[1], extent[2], extent[3] };
  this->Grid.ImageToWorld = contract.GetImageToWorld();
  this->Grid.Perspective = contract.IsPerspective();
  this->Grid.Eye = contract.GetEye();
}
