// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An image and a reconstruction space as the occlusion kernel takes them.
#ifndef lacunaOcclusionInput_h
#define lacunaOcclusionInput_h

#include "lacunaAttenuationField.h"

#include <array>
#include <cstdint>
#include <string>

class vtkDataArray;
class vtkImageData;
class vtkImplicitFunction;
class vtkPiecewiseFunction;

namespace lacuna
{
namespace OcclusionInput
{
/// The two axes along which a flat image is wider than one voxel, or three, in order.
struct Grid
{
  /// Throws std::runtime_error when there are fewer than two.
  explicit Grid(vtkImageData* image);

  std::int64_t GetSize() const;
  /// ml, of a flat image mm^2.
  double GetVoxelContent() const;

  std::array<std::int64_t, 3> Dimensions{ 1, 1, 1 };
  Vec3 Spacing{ 1, 1, 1 };
  int Axes = 0;
};

/// The point array of that name, or the active scalars when the name is empty. Throws
/// std::runtime_error unless it has one component and a value per point.
vtkDataArray* FindScalars(vtkImageData* image, const std::string& name);

/// How grey levels become attenuation coefficients.
struct Conversion
{
  int Attenuation;                ///< vtkLacunaOccludedAngle::Attenuations
  vtkPiecewiseFunction* Function; ///< for ByOpacityFunction
  bool Binary;                    ///< to 1 where half of a ray is taken, else to 0
};

/// Throws std::runtime_error, with the voxel, for what is no attenuation; for equal grey levels and
/// for a missing function.
void Fill(AttenuationField& field, vtkImageData* image, vtkDataArray* scalars,
  const Conversion& conversion, Execution& execution);

/// Whether two images have the same voxels at the same places.
bool SamePlace(vtkImageData* a, vtkImageData* b);

/// Marks the voxels outside the reconstruction space: where the scalars of mask (may be null) are 0
/// or function (may be null) is not negative. Throws std::runtime_error when mask has another
/// geometry than image or no data is left.
void CutSpace(
  AttenuationField& field, vtkImageData* image, vtkImageData* mask, vtkImplicitFunction* function);
}
}
#endif
