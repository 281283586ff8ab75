// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An image's voxels as kernels take them. Not a part of the module's interface.
#ifndef lacunaVolumeMask_h
#define lacunaVolumeMask_h

#include "lacunaVolumeSymmetry.h"
#include "vtkSmartPointer.h"

class vtkDataArray;
class vtkImageData;

namespace lacuna::VolumeMask
{
/// The image's vtkValidPointMask, or null. Throws std::runtime_error when it has several components.
vtkDataArray* GetMask(vtkImageData* image);

/// The active scalars, where they lie in the world, and which count. The image must live longer, and
/// keep, which gets the voxels where they must be copied. Throws std::runtime_error when they have not
/// one component, or the direction has got lost.
MaskedVolume Get(vtkImageData* image, vtkSmartPointer<vtkDataArray>& keep);
}
#endif
