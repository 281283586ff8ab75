// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the image of a tracked ultrasound probe lies in the probe's coordinate system.
///
/// A phantom is scanned from many sides and points of it are picked in the images. Coordinate systems
/// in the order of the transforms: image (column, row), probe (the tracker's receiver on it), tracker
/// (transmitter), phantom. Every pick says which of its phantom coordinates are zero; that gives
/// equations for ImageToProbe and for where the phantom lies, which is found along with it:
///
/// - three wires at right angles through one point (Carr 1996, appendix A): two equations a pick
/// - a wall, such as the flat floor of a water bath (Prager et al. 1998): one equation a pick
/// - a point that does not move, such as the tip of a needle: three equations a pick
/// - the tip of a stylus that carries the receiver, in a hole: three equations a pose. There is no
///   image then; the tip is where (0, 0) would be
///
/// Picks of different targets may be mixed when they belong to one phantom: its wall is the plane of
/// wires x and y, its point the crossing of the wires.
#ifndef lacunaProbeCalibration_h
#define lacunaProbeCalibration_h

#include "lacunaMatrix4.h"
#include "lacunaProperties.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
/// What is seen at a picked pixel; the names of the wires are those of the phantom's axes.
enum class CalibrationTarget
{
  WireX,
  WireY,
  WireZ,
  Wall,
  Point,
  Tip
};

/// Whether phantom coordinate axis, 0 to 2, is zero there.
bool IsZeroAt(CalibrationTarget target, int axis);

struct CalibrationPick
{
  Matrix4 ProbeToTracker; ///< mm; a rotation and a translation
  Vec2 Pixel;             ///< column, row; 0, 0 of a tip
  CalibrationTarget Target;
  /// Number of the slice. Errors of picks in one slice may be alike, and a probe at rest shows the
  /// same again in the next ones: what they tell together is not counted as if it were independent.
  /// Below 0: the pick is on its own.
  std::int64_t Slice = -1;
};

struct ProbeCalibrationOptions
{
  static constexpr ValueRange OutlierLimitRange = ValueRange::AtLeast(2).OrZero("none is left out");

  /// mm a column, mm a row, above 0; not used with EstimateScale, nor of tips.
  Vec2 PixelSpacing{ 1, 1 };
  bool EstimateScale = false; ///< find the pixel spacing along with the rest
  /// Picks with an equation that is off by more than so many standard deviations are left out.
  double OutlierLimit = 4;
};

/// A direction in which the picks hardly hold the image.
struct CalibrationWeakness
{
  double Error = 0;   ///< mm at the image's far corner: one standard deviation of what is not known
  std::string Motion; ///< what is not known and which motion of the probe would tell
};

class ProbeCalibration
{
public:
  /// Needs no start. Throws std::invalid_argument for what cannot be: options out of range, a pose
  /// that is no rotation and translation, numbers that are not finite, too few picks (fewer equations
  /// than unknowns and three more), picks whose poses or pixels do not determine the image. The text
  /// says what is missing. Results do not depend on the order in which picks come but for rounding.
  static ProbeCalibration Solve(
    const std::vector<CalibrationPick>& picks, const ProbeCalibrationOptions& options = {});

  /// (column, row, 0, 1) to mm. Its third column is the unit normal, so that it is a rotation (never
  /// a mirror) times the pixel spacing.
  Matrix4 ImageToProbe;
  /// Of wires, which are the same after half a turn about any of them, the one with axes nearest to the
  /// tracker's. For a wall turned and moved arbitrarily within it, for a point turned arbitrarily about it.
  Matrix4 TrackerToPhantom;
  Vec2 PixelSpacing{ 1, 1 };

  /// Of all picks, in their order: phantom coordinates in mm. Those that should be zero are the
  /// errors of the equations.
  std::vector<Vec3> PhantomPoints;
  std::vector<bool> Used; ///< of each pick; the others are outliers

  std::size_t Equations = 0; ///< that were used
  std::size_t Unknowns = 0;
  /// Slices used that are different views: those in which the probe rested (receiver and image within
  /// five times Spread) count once. The covariance takes errors as independent between views only.
  std::size_t Views = 0;
  double Rms = 0; ///< mm, of the equations used (Carr 1996, eq. A.14)
  double Spread =
    0; ///< mm, standard deviation of an equation: the same over equations less unknowns
  /// Largest over smallest singular value of the equations, lengths in mm and rotations by their
  /// effect at the picks' mean distance from the image's origin.
  double Condition = 0;
  /// RMS in mm of the best solution that is another one (a corner moves by more than 5 mm); infinite
  /// when there is none. Near Rms, the picks do not tell which of the two is right.
  double RunnerUpRms = 0;
  /// Those whose Error is above 1 mm and three times the median of all; the worst first.
  std::vector<CalibrationWeakness> Weaknesses;

  /// What to expect at a pixel: covariance in mm^2 of its place in the probe's coordinate system.
  std::array<Vec3, 3> GetCovariance(const Vec2& pixel) const;
  /// Root of the sum of the variances, mm.
  double GetExpectedError(const Vec2& pixel) const;
  /// Standard deviation of the ratio of the row spacing to the column spacing, relative; 0 where
  /// they were given.
  double GetRatioError() const;
  /// Azimuth, elevation and roll of the image in degrees, as the 3Space gives a receiver's.
  Vec3 GetAngles() const;

private:
  static constexpr int ImageUnknowns = 8; // rotation, translation, logarithms of the spacing
  std::array<double, ImageUnknowns * ImageUnknowns> Covariance{};
};
}
#endif
