// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the numbers in a table to poses: one transform for each row.
#ifndef lacunaPoseTable_h
#define lacunaPoseTable_h

#include "lacunaMatrix4.h"
#include "lacunaPoseColumns.h"

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
/// What the poses of a table map, as written: x_B = AToB x_A. The image frame is (column, row) in
/// pixels or, with a PixelSpacing, in mm.
enum class PoseTransform
{
  ProbeToReference,
  ReferenceToProbe,
  ImageToReference,
  ReferenceToImage
};
inline constexpr std::array<const char*, 4> PoseTransformNames{ "ProbeToReference",
  "ReferenceToProbe", "ImageToReference", "ReferenceToImage" };

struct PoseTableOptions
{
  PoseFormat Format = PoseFormat::Matrix;
  PoseTransform Transform = PoseTransform::ProbeToReference;
  LengthUnit Unit = LengthUnit::Millimetre; ///< of the poses
  /// mm between columns and between rows; 0 0: the size of a pixel is in the matrices, in the
  /// lengths of the first two columns.
  Vec2 PixelSpacing{ 0, 0 };
  Matrix4 ImageToProbe; ///< calibration, mm
  /// Whether rows with a pose that is none are taken as rows without a pose.
  bool SkipInvalid = false;
};

/// Poses in mm, one for each row.
struct PoseTable
{
  /// Probe or image frame to mm in the reference frame; what is not Usable is all NaN.
  std::vector<Matrix4> ToReference;
  std::vector<char> Usable;
  std::vector<std::string> Warnings; ///< for the user, naming rows
};

/// Reads rows of numbers, count of them in each (12 or 16, 7, 6), as FindPoseColumns orders them.
/// Rows that refused flags (empty: none does) are not looked at and not usable; a warning names
/// them.
///
/// A row without a pose (numbers that are not finite; a matrix or a quaternion of zeros, as some
/// trackers write what they did not see) is not usable, and a warning names it. Everything else
/// that is no pose by lacunaGeometryGate.h throws std::runtime_error with its row, or becomes a
/// warning (see SkipInvalid, and the table of rules in that file). Quaternions are normalised.
/// Matrices are taken as they are. Angles are degrees: azimuth about z, elevation about the new
/// y, roll about the new x (Carr 1996, ch. 2), so R = Rz(azimuth) Ry(elevation) Rx(roll). All 0
/// is then a pose, but a warning names such rows after the first, since ParaView reads empty ones
/// so.
///
/// Only poses of an image frame in pixels may have columns of other lengths than 1: pixel sizes,
/// the same in all rows within a hundredth.
PoseTable ReadPoseTable(const std::vector<double>& numbers, std::size_t count,
  const std::vector<char>& refused, const PoseTableOptions& options);

/// How the pixels join the poses.
struct PoseChain
{
  bool Calibrated = false; ///< false: PixelToPose is not known
  /// (column, row, 0, 1) to mm in the frame whose poses the table has: the probe, or the image.
  Matrix4 PixelToPose;
  bool HasImageToProbe = false;
  Matrix4 ImageToProbe; ///< (column, row, 0, 1) to mm
  std::string Warning;  ///< for the user: ImageToProbe may be wrong; empty: it has no fault
};

/// Checks the calibration and the pixel spacing together. Not calibrated when the poses are the
/// probe's, ImageToProbe is the identity and PixelSpacing 0 0. The columns of ImageToProbe have the
/// length 1, or that of PixelSpacing once more, or carry the size of a pixel alone. Throws
/// std::runtime_error when it is given twice and differently or not at all, and when ImageToProbe
/// or PixelSpacing is no calibration by lacunaGeometryGate.h.
PoseChain MakePoseChain(const PoseTableOptions& options);

/// Between two rigid transforms (or with the same pixel sizes), at 0 <= t <= 1: straight on,
/// turning evenly about one axis.
Matrix4 InterpolatePose(const Matrix4& first, const Matrix4& second, double t);
}
#endif
