// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which columns of a table of poses hold what.
#ifndef lacunaPoseColumns_h
#define lacunaPoseColumns_h

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
/// How the rows of a table give poses.
enum class PoseFormat
{
  Matrix,     ///< 16 or 12 numbers, row by row
  Quaternion, ///< position and unit quaternion
  Euler       ///< position, azimuth, elevation and roll
};
inline constexpr std::array<const char*, 3> PoseFormatNames{ "Matrix", "Quaternion", "Euler" };

enum class LengthUnit
{
  Millimetre,
  Metre,
  Centimetre,
  Inch
};
inline constexpr std::array<const char*, 4> LengthUnitNames{ "mm", "m", "cm", "inch" };

/// Millimetres of one unit.
double GetMillimetres(LengthUnit unit);

/// Finds the columns of a pose among the names of a table's columns. Their order in the result is
/// - Matrix: m00 m01 m02 m03 m10 ... m23, and m30 ... m33 unless the table has no fourth row;
/// - Quaternion: x y z qx qy qz qw;
/// - Euler: x y z azimuth elevation roll.
///
/// wanted has the names of all of them in this order, or one text with which their names begin, or
/// nothing. Without all names, the usual ones are looked for: regardless of case, blanks and
/// punctuation, without a unit at the end ("x [mm]", "roll_deg"),
/// - position: tx ty tz, x y z, px py pz, posx ..., positionx ..., translationx ...;
/// - quaternion: qx qy qz qw, q1 q2 q3 q0 (q0 is the scalar part), quatx ..., quaternionx ...,
///   rotx ..., rotationx ..., ox ..., orientationx ...;
/// - angles: azimuth elevation roll, az el roll, yaw pitch roll, psi theta phi;
/// - matrix: any letters with two indices from 00 or from 11, with one index from 0 to 15 or from 1
///   to 16, or r with two indices for the rotation beside a position.
///
/// Throws std::runtime_error when columns are missing or there is more than one choice (with advice,
/// naming the columns there are and another format that would fit), and when the name of a column
/// has a unit that is not the one of positions or is not degrees.
std::vector<int> FindPoseColumns(const std::vector<std::string>& names, PoseFormat format,
  LengthUnit unit, const std::vector<std::string>& wanted,
  const std::string& advice =
    "name them in this order in PoseColumns, or the text with which all of "
    "them begin");

/// Finds one column: the one named wanted or, when wanted is empty, the first of the usual names
/// that there is, compared as above. Returns -1 when wanted is empty and there is none. Throws
/// std::runtime_error naming property when there is no column wanted.
int FindColumn(const std::vector<std::string>& names, const std::string& wanted,
  const std::vector<std::string>& usual, const std::string& property);

/// Throws std::runtime_error when the name of a column says that its times are not seconds.
void CheckSeconds(const std::string& name);
}
#endif
