// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grid of a volume as VTK stores it, and its voxels.
#ifndef lacunaVolumeBox_h
#define lacunaVolumeBox_h

#include "lacunaMatrix4.h"
#include "lacunaScalarType.h"
#include "lacunaVector.h"
#include "lacunaVolumeFile.h"

#include <array>
#include <cstdint>

namespace lacuna
{
class Execution;
class PixelSource;

/// A right-handed box: the voxel (i, j, k) lies at Origin + i Spacing[0] Axes[0] + ...
struct VolumeBox
{
  std::array<std::int64_t, 3> Dimensions{};
  std::array<double, 3> Spacing{}; ///< mm, > 0
  std::array<Vec3, 3> Axes{};      ///< unit vectors at right angles, right-handed
  Vec3 Origin{};                   ///< mm
  bool ReversedSlices = false;     ///< k counts the stored slices from the last one
};

/// The most by which a corner of the box may differ from where the file has it, mm: rounded
/// directions do, sheared axes do by more.
constexpr double VolumeTolerance = 0.05;

/// The grid of indexToPatient with these dimensions. Left-handed axes become right-handed ones by
/// taking the slices in reverse order; no voxel moves by that. Axes are turned by the least that
/// makes their angles right (polar decomposition; Higham 1986, SIAM J. Sci. Stat. Comput. 7, 1160).
/// Throws std::invalid_argument when the matrix is not finite, an axis has no length, or a corner
/// would move by more than VolumeTolerance.
VolumeBox FindVolumeBox(
  const Matrix4& indexToPatient, const std::array<std::int64_t, 3>& dimensions);

/// The type of voxels with the values slope * stored + intercept: that which is stored without a
/// change of values; 16 or 32 bit integers where whole numbers stay such and fit, whatever is stored;
/// otherwise float, or double for stored types of over 24 bits.
ScalarType GetVolumeType(ScalarType stored, double slope, double intercept);

/// Reads the part extent (first and last column, row and slice of the grid) of file's voxels into
/// voxels of type GetVolumeType, x fastest, components together. pixels: those of file.Slices.
/// Throws std::runtime_error when they cannot be read, and Aborted.
void ReadVolume(const VolumeFile& file, const VolumeBox& grid, PixelSource& pixels,
  const std::array<int, 6>& extent, void* voxels, Execution& execution);
}
#endif
