// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeMask.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "lacunaMemory.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"

#include <cstddef>
#include <stdexcept>
#include <string>

namespace
{
// One component per point in plain memory; copies what is not so into keep.
vtkDataArray* GetPlain(vtkDataArray* array, vtkSmartPointer<vtkDataArray>& keep)
{
  if (array->HasStandardMemoryLayout())
  {
    return array;
  }
  keep.TakeReference(vtkDataArray::CreateDataArray(array->GetDataType()));
  lacuna::Arrays::Copy(array, keep);
  return keep;
}
}

//------------------------------------------------------------------------------
vtkDataArray* lacuna::VolumeMask::GetMask(vtkImageData* image)
{
  vtkDataArray* mask = image->GetPointData()->GetArray(lacuna::DepthMap::MaskName);
  if (mask && mask->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(
      std::string("point array '") + lacuna::DepthMap::MaskName + "' must have one component");
  }
  return mask;
}

//------------------------------------------------------------------------------
lacuna::MaskedVolume lacuna::VolumeMask::Get(
  vtkImageData* image, vtkSmartPointer<vtkDataArray>& keep)
{
  lacuna::VolumeDirection::Check(image);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the image has no active point scalars with one component; colours "
                             "and vectors cannot be mirrored");
  }
  lacuna::MaskedVolume given;
  given.Volume.Type = lacuna::ArrayScalarType::Get(scalars);
  given.Volume.Voxels = GetPlain(scalars, keep)->GetVoidPointer(0);
  image->GetDimensions(given.Volume.Size.data());
  const int* extent = image->GetExtent();
  given.Volume.IndexToWorld = lacuna::Matrix4(image->GetIndexToPhysicalMatrix()->GetData()) *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
  if (vtkDataArray* mask = GetMask(image))
  {
    lacuna::RequireMemory(
      "the mask of the volume", static_cast<double>(given.Volume.NumberOfVoxels()));
    given.Valid.resize(static_cast<std::size_t>(given.Volume.NumberOfVoxels()));
    for (std::size_t i = 0; i < given.Valid.size(); ++i)
    {
      given.Valid[i] = mask->GetComponent(static_cast<vtkIdType>(i), 0) != 0;
    }
  }
  return given;
}
