// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeCaster.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaCasterView.h"
#include "vtkImageData.h"

#include <algorithm>

static_assert(static_cast<int>(lacuna::SolidSide::Above) == 0 &&
    static_cast<int>(lacuna::SolidSide::Below) == 1 &&
    static_cast<int>(lacuna::FieldInterpolation::Trilinear) == 2,
  "the filters' properties are the kernel's enumerations");

//------------------------------------------------------------------------------
const lacuna::IsoRayCaster& lacuna::VolumeCaster::Prepare(vtkImageData* volume,
  vtkDataArray* scalars, int interpolation, int solidSide, lacuna::AlgorithmExecution& execution)
{
  const lacuna::CasterView::Frame frame = lacuna::CasterView::FrameOf(volume);
  lacuna::VoxelVolume voxels;
  voxels.Type = lacuna::ArrayScalarType::Get(scalars);
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
      lacuna::Arrays::Copy(scalars, this->Copy);
    }
    voxels.Voxels = (this->Copy ? this->Copy.Get() : scalars)->GetVoidPointer(0);
    this->Caster = std::make_unique<lacuna::IsoRayCaster>(voxels,
      static_cast<lacuna::FieldInterpolation>(interpolation),
      static_cast<lacuna::SolidSide>(solidSide), execution);
    this->CasterKey = key;
  }
  return *this->Caster;
}
