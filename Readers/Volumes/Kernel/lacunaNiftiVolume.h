// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a NIfTI image lies.
///
/// NIfTI has two matrices to its space (x to the patient's right, y to anterior, z to superior): sform, 12
/// numbers, and qform, a rotation, distances and an offset. Each has a code: 0 not given, 1 the
/// scanner's space, 2 aligned to another scan, 3 Talairach, 4 MNI 152. Source: nifti1.h
/// and nifti2.h (nifti.nimh.nih.gov, 2007, 2011), "3D IMAGE (VOLUME) ORIENTATION AND LOCATION IN SPACE".
/// VTK's reader is not used: of an unknown data type it reads beyond a table (9.1 to 9.5), near half a turn its qform
/// is off by up to 0.0005 rad, and it does not look at check sums.
#ifndef lacunaNiftiVolume_h
#define lacunaNiftiVolume_h

#include "lacunaVolumeFile.h"

#include <array>
#include <cstdint>
#include <string>

namespace lacuna
{
/// What a header says, NIfTI-1 or NIfTI-2.
struct NiftiHeader
{
  int Version = 1;
  std::array<std::int64_t, 8> Dim{};
  std::array<double, 8> PixDim{};
  int DataType = 0;
  std::int64_t VoxelOffset = 0;
  double Slope = 0;
  double Intercept = 0;
  int Units = 0; ///< xyzt_units
  int QFormCode = 0;
  int SFormCode = 0;
  std::array<double, 3> Quaternion{}; ///< b, c, d
  std::array<double, 3> QOffset{};
  std::array<std::array<double, 4>, 3> SRows{};
  bool BigEndian = false; ///< the voxels
  bool Compressed = false;
};

/// Reads a header, also of a file that is compressed by gzip, whatever its name. Throws
/// std::runtime_error with the file's name when it is no NIfTI file with header and voxels in one.
NiftiHeader ReadNiftiHeader(const std::string& fileName);

/// Which matrix says where the image lies.
enum class NiftiTransform
{
  Automatic, ///< that which is given; sform where both agree; an error where they do not
  SForm,
  QForm
};
inline constexpr std::array<const char*, 3> NiftiTransformNames{ "Automatic", "SForm", "QForm" };

/// The volume. Throws std::runtime_error with the file's name, what is wrong and what would be right:
/// no matrix or two that differ, several volumes, voxels that are no real numbers, unknown units.
VolumeFile MakeNiftiVolume(
  const std::string& fileName, const NiftiHeader& header, NiftiTransform transform);
}
#endif
