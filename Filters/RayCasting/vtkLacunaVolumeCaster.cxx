// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaVolumeCaster.h"

#include "vtkImageData.h"
#include "vtkLacunaArrays.h"
#include "vtkLacunaCasterView.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaScalarType.h"

#include <algorithm>

static_assert(static_cast<int>(lacuna::SolidSide::Above) == 0 &&
    static_cast<int>(lacuna::SolidSide::Below) == 1 &&
    static_cast<int>(lacuna::FieldInterpolation::Trilinear) == 2,
  "the filters' properties are the kernel's enumerations");

//------------------------------------------------------------------------------
const lacuna::IsoRayCaster& vtkLacunaVolumeCaster::Prepare(vtkImageData* volume,
  vtkDataArray* scalars, int interpolation, int solidSide, vtkLacunaExecution& execution)
{
  const vtkLacunaCasterView::Frame frame = vtkLacunaCasterView::FrameOf(volume);
  lacuna::VoxelVolume voxels;
  voxels.Type = vtkLacunaScalarType::Get(scalars);
  voxels.Size = frame.Size;
  voxels.IndexToWorld = frame.IndexToWorld;
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
      vtkLacunaArrays::Copy(scalars, this->Copy);
    }
    voxels.Voxels = (this->Copy ? this->Copy.Get() : scalars)->GetVoidPointer(0);
    this->Caster = std::make_unique<lacuna::IsoRayCaster>(voxels,
      static_cast<lacuna::FieldInterpolation>(interpolation),
      static_cast<lacuna::SolidSide>(solidSide), execution);
    this->CasterKey = key;
  }
  return *this->Caster;
}
