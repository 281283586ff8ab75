// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a simulated probe is at each slice.
#ifndef lacunaProbeMotion_h
#define lacunaProbeMotion_h

#include "lacunaMatrix4.h"
#include "lacunaProperties.h"

#include <array>
#include <cstdint>

namespace lacuna
{
/// The path of a probe over one or more sweeps.
///
/// Probe frame (mm): origin at the middle of the transducer face, x across the image (columns), y
/// into the tissue (rows), z = x cross y. At rest its axes are those of the reference frame, and
/// the middle of the image lies at Center. Every sweep runs through u = -1 ... 1 in even steps:
///
/// - Sweep: the probe moves along z by u Travel/2: parallel planes.
/// - Fan: it tilts by u SweepAngle/2 about the x axis of the face: planes meet in the face.
/// - Twist: it turns by u SweepAngle/2 about its y axis: planes meet in that axis.
/// - Arbitrary: it moves as in Sweep, turns by TwistAngle sin(pi u), tilts by FanAngle
///   sin(3/2 pi u + 0.6) and sways by Wander (mm) sideways (cos) and in depth (half of it): smooth
///   and never parallel for long; neighbouring planes may cross within the image.
///
/// Sweep s of n is turned by s 180/n degrees about the y axis through Center, so that two sweeps
/// cross at right angles. The slices are shared out evenly, the first sweeps get one more.
class ProbeMotion
{
public:
  enum class Kind
  {
    Sweep,
    Fan,
    Twist,
    Arbitrary
  };
  static constexpr std::array<const char*, 4> KindNames{ "Sweep", "Fan", "Twist", "Arbitrary" };

  struct Parameters
  {
    Kind Motion = Kind::Sweep;
    std::int64_t NumberOfSlices = 60; ///< of all sweeps together
    std::int64_t NumberOfSweeps = 1;  ///< at most NumberOfSlices
    double ImageDepth = 48;           ///< mm from the first to the last row
    double Travel = 50;               ///< mm; Sweep and Arbitrary
    double SweepAngle = 60;           ///< degrees from end to end; Fan and Twist
    double TwistAngle = 12;           ///< degrees, amplitude; Arbitrary
    double FanAngle = 8;              ///< degrees, amplitude; Arbitrary
    double Wander = 2;                ///< mm, amplitude; Arbitrary
    Vec3 Center = { 0, 0, 0 };        ///< mm, reference frame
    double PositionNoise = 0;         ///< mm, standard deviation along each axis, at most 1e5
    double AngleNoise = 0;            ///< degrees, standard deviation about each axis, at most 180
    std::uint64_t Seed = 0;

    void Describe(Properties& properties) const; ///< with the ranges, but for depth, noise and seed
  };

  /// Throws std::invalid_argument that names the parameter and says what would be right.
  explicit ProbeMotion(const Parameters& parameters);

  /// True pose at a slice, 0 <= slice < NumberOfSlices.
  Matrix4 TrueProbeToReference(std::int64_t slice) const;
  /// What the tracker says: the true pose with the probe displaced along the reference axes by
  /// PositionNoise and turned about its own three axes (through its origin) by AngleNoise, normally
  /// distributed and independent for each slice. Equal to the true pose when both are 0.
  Matrix4 RecordedProbeToReference(std::int64_t slice) const;

private:
  Parameters P;
};

/// (column, row, 0, 1) to the probe frame for an image of the given number of columns and square
/// pixels of spacing mm; row 0 lies in the transducer face.
Matrix4 MakeImageToProbe(std::int64_t columns, double spacing);
}
#endif
