// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The one check of poses and calibrations, whatever they come from.
///
/// A pose is a rotation and a translation. A calibration maps pixels (column, row, 0, 1) to mm: its
/// first two columns are perpendicular and as long as a pixel. Its third column places no pixel.
/// It tells of damage all the same, since programs derive it from the first two: it is perpendicular
/// to both, and its length is their mean (PLUS: arithmetic, Lacuna: geometric), or 1, which confirms
/// square pixels only.
#ifndef lacunaGeometryGate_h
#define lacunaGeometryGate_h

#include "lacunaMatrix4.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// How far products of a pose's axes may be from those of a rotation. A wrong number that stays below
/// moves a pixel by at most 1.5 times as much of its distance from the sensor: 0.45 mm at 300 mm.
/// Sequences of PLUS have at most 0.00051.
constexpr double RigidTolerance = 1e-3;

enum class GeometryFault
{
  None,
  NotFinite,
  LastRow,   ///< other than 0 0 0 1
  Singular,  ///< its axes lie in a plane
  FarAway,   ///< more than a kilometre
  NotRigid,  ///< a pose: beyond what numbers with two decimals are off
  Mirrored,  ///< a pose
  Rounded,   ///< a pose: beyond RigidTolerance, but within what numbers with two decimals are off
  PixelSize, ///< a calibration: no pixel of ultrasound has this size or ratio
  Skewed,    ///< a calibration: rows and columns are far from perpendicular
  MirroredImage, ///< a calibration
  Inexact ///< a calibration: a pixel may be off by more than 0.5 mm, but it may be as it was made
};

struct GeometryFinding
{
  GeometryFault Fault = GeometryFault::None;
  std::string Text;   ///< what is wrong, to be put behind the matrix's name: "mirrors: ..."
  std::string Advice; ///< what to do, without a full stop

  explicit operator bool() const { return this->Fault != GeometryFault::None; }
};

/// Of the pose of a rigid body, mm.
GeometryFinding CheckPose(const Matrix4& pose);

/// Of a unit quaternion, by its length: Rounded, NotRigid (more than 0.01 off) or NotFinite.
GeometryFinding CheckQuaternion(double length);

/// Of a matrix that maps pixels to mm, a calibration or a pose of the image. Limits: pixels of 0.001
/// to 10 mm (100 MHz sampling makes 0.008 mm; the deepest picture has 300 mm, 30 such pixels), not
/// more than 50 times as long as wide (scan lines 0.6 mm apart, sampled at 40 MHz: 0.019 mm), rows
/// and columns at 84.3 to 95.7 degrees (cosine 0.1; PLUS's least squares fits have up to 0.048).
/// Inexact: a cosine above 0.0025 (0.5 mm at 200 mm), or a third column that is neither the mean of
/// the other two within 0.1 %, nor 1 with sides that agree within 0.1 %.
GeometryFinding CheckImage(const Matrix4& imageToMillimetres);

/// Of transforms that together map pixels to mm, in this order. Their product has to pass CheckImage.
/// Each one after the product has the unit mm has to be rigid and right-handed: a factor would look
/// like the pixels of another scanner, and two mirrors like none. link: the one that is wrong, or links.size() for the product.
GeometryFinding CheckImageChain(const std::vector<Matrix4>& links, std::size_t& link);

/// In place of a pose where there is none: NaN.
Matrix4 NoPose();

/// Where a matrix comes from.
enum class GeometryOrigin
{
  Sequence,        ///< the transforms of a sequence file
  CalibrationFile, ///< that a reader of sequences takes
  Settings,        ///< properties of filters, and the calibration of a live source
  Table,           ///< of poses
  Live,            ///< poses of a tracker
  Slices,          ///< the array ImageToReference of tracked slices
  Picks            ///< poses from which a calibration or a tracker's errors are computed
};

enum class GeometryAction
{
  Use,
  Warn,  ///< used, and a warning names it
  Flag,  ///< the slice has no pose (SliceStatus 1), and a message names it
  Refuse ///< an error names it
};

/// The table of rules, which the user guide has as well (geometry-checks.md). Table is Flag in place of
/// Refuse with SkipInvalidPoses, Slices with BadPoses LeaveOut.
GeometryAction GetAction(GeometryOrigin origin, GeometryFault fault);
}
#endif
