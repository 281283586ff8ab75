// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Skulls of VTK's data as rays meet them.
#ifndef lacunaSkullShells_h
#define lacunaSkullShells_h

#include "lacunaBoneDistance.h"
#include "lacunaSkullTemplate.h"
#include "lacunaTriangleSurface.h"
#include "lacunaVoxelVolume.h"
#include "vtkSmartPointer.h"

#include <array>
#include <memory>

class vtkDataArray;
class vtkDataObject;
class vtkImageData;

namespace lacuna
{
/// The active point scalars of one component. keep gets the voxels where they must be copied. Throws
/// std::runtime_error without them.
VoxelVolume GetBoneVolume(vtkImageData* image, vtkSmartPointer<vtkDataArray>& keep);

/// The surface of vtkFlyingEdges3D at a level in a box (opposite corners, world mm), in world mm. volume: of GetBoneVolume;
/// voxels: its values, or others of its grid.
TriangleSurface MakeBoneSurface(
  const VoxelVolume& volume, vtkDataArray* voxels, double level, const std::array<Vec3, 2>& box);

/// Bone at or above a level in a box (opposite corners, world mm), with the surface of vtkFlyingEdges3D. volume: of
/// GetBoneVolume, whose voxels must be kept.
std::unique_ptr<BoneDistance> MakeBoneDistance(
  const VoxelVolume& volume, vtkDataArray* voxels, double level, const std::array<Vec3, 2>& box);

/// A vtkImageData in which only bone is at or above the level, or a vtkPolyData with polygons or strips: the outermost
/// one along a ray is the outer table, the innermost one within 20 mm of it the inner table. Throws std::runtime_error
/// for anything else.
std::unique_ptr<SkullShell> MakeSkullShell(vtkDataObject* data, double level);
}
#endif
