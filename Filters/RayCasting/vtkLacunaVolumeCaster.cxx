// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaVolumeCaster.h"

#include "vtkImageData.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaScalarType.h"
#include "vtkMatrix4x4.h"

#include <algorithm>

static_assert(static_cast<int>(lacuna::SolidSide::Above) == 0 &&
    static_cast<int>(lacuna::SolidSide::Below) == 1 &&
    static_cast<int>(lacuna::FieldInterpolation::Trilinear) == 2,
  "the filters' properties are the kernel's enumerations");

//------------------------------------------------------------------------------
lacuna::Matrix4 vtkLacunaVolumeCaster::IndexToWorld(vtkImageData* volume)
{
  const int* extent = volume->GetExtent();
  return lacuna::Matrix4(volume->GetIndexToPhysicalMatrix()->GetData()) *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
}

//------------------------------------------------------------------------------
const lacuna::IsoRayCaster& vtkLacunaVolumeCaster::Prepare(vtkImageData* volume,
  vtkDataArray* scalars, int interpolation, int solidSide, vtkLacunaExecution& execution)
{
  const int* dimensions = volume->GetDimensions();
  lacuna::VoxelVolume voxels;
  voxels.Type = vtkLacunaScalarType::Get(scalars);
  voxels.Size = { dimensions[0], dimensions[1], dimensions[2] };
  voxels.IndexToWorld = IndexToWorld(volume);
  std::array<double, 16> matrix;
  std::copy_n(voxels.IndexToWorld.Data(), 16, matrix.begin());
  const Key key{ scalars, scalars->GetMTime(), voxels.Size, matrix, interpolation, solidSide };
  if (!this->Caster || key != this->CasterKey)
  {
    this->Caster.reset();
    this->Copy = nullptr;
    if (!scalars->HasStandardMemoryLayout())
    {
      this->Copy.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
      this->Copy->DeepCopy(scalars);
    }
    voxels.Voxels = (this->Copy ? this->Copy.Get() : scalars)->GetVoidPointer(0);
    this->Caster = std::make_unique<lacuna::IsoRayCaster>(voxels,
      static_cast<lacuna::FieldInterpolation>(interpolation),
      static_cast<lacuna::SolidSide>(solidSide), execution);
    this->CasterKey = key;
  }
  return *this->Caster;
}
