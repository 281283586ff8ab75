// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Data records of the Polhemus 3Space FASTRAK (User Manual Rev. G, 2012): what a record holds, to
/// and from bytes.
#ifndef lacunaFastrakRecord_h
#define lacunaFastrakRecord_h

#include "lacunaMatrix4.h"
#include "lacunaPoseColumns.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// R = Rz(azimuth) Ry(elevation) Rx(roll), degrees (Carr 1996, ch. 2).
Matrix4 FastrakRotation(const Vec3& angles);
/// Rotation of a quaternion w x y z, which need not have the length 1.
Matrix4 FastrakRotation(const std::array<double, 4>& quaternion);
/// Azimuth, elevation, roll in degrees of a rotation, elevation -90..90; roll 0 at its ends.
Vec3 FastrakAngles(const Matrix4& rotation);
/// Quaternion w x y z of a rotation, w >= 0.
std::array<double, 4> FastrakQuaternion(const Matrix4& rotation);

/// Stations, that is receivers, are counted from 1.
constexpr int FastrakStations = 4;

/// Items of the output list (command O).
enum class FastrakItem
{
  Space = 0,
  CarriageReturn = 1, ///< and line feed
  Position = 2,
  RelativePosition = 3, ///< since the record before
  Angles = 4,           ///< azimuth, elevation, roll
  XAxis = 5,            ///< direction cosines of the receiver's axes
  YAxis = 6,
  ZAxis = 7,
  Quaternion = 11,
  Button = 16, ///< of the stylus
  /// The same in ASCII with more digits; binary numbers are the same.
  ExtendedSpace = 50,
  ExtendedCarriageReturn = 51,
  ExtendedPosition = 52,
  ExtendedRelativePosition = 53,
  ExtendedAngles = 54,
  ExtendedXAxis = 55,
  ExtendedYAxis = 56,
  ExtendedZAxis = 57,
  ExtendedQuaternion = 61,
  ExtendedButton = 66
};

/// How a unit writes its records; as it is after power-up.
struct FastrakFormat
{
  bool Binary = false;                ///< IEEE float32, little-endian; else fixed columns of ASCII
  LengthUnit Unit = LengthUnit::Inch; ///< or Centimetre
};

/// The items of a record, in order; an item may come twice.
class FastrakLayout
{
public:
  /// The list after power-up: position, angles, end of line.
  FastrakLayout();
  /// Throws std::invalid_argument for more than 32 items, a record of more than 254 bytes, and
  /// an item that is listed both plain and extended.
  explicit FastrakLayout(std::vector<FastrakItem> items);
  /// From the numbers of the items; throws std::invalid_argument for one there is not.
  static FastrakLayout FromNumbers(const std::vector<int>& numbers);

  const std::vector<FastrakItem>& GetItems() const { return this->Items; }
  /// Bytes of a record with its three of the header.
  std::size_t GetLength(bool binary) const;
  /// Whether a record says where the receiver is and how it is turned.
  bool HasPose() const;

private:
  std::vector<FastrakItem> Items;
};

/// What a record says: absent unless it is in the layout. Lengths are mm, angles degrees.
struct FastrakRecord
{
  int Station = 1;
  char Error = ' '; ///< the last code of the unit's tests; blank: none
  std::optional<Vec3> Position;
  std::optional<Vec3> RelativePosition;
  std::optional<Vec3> Angles; ///< azimuth, elevation, roll
  std::array<std::optional<Vec3>, 3> Axes;
  std::optional<std::array<double, 4>> Quaternion; ///< w x y z
  std::optional<bool> Button;                      ///< whether it is pressed

  /// Receiver to transmitter, mm. From the angles or, where they are not listed, the quaternion or
  /// the axes, made orthonormal. Nothing when the position or the orientation is missing, or when
  /// lacunaGeometryGate.h flags the axes.
  std::optional<Matrix4> GetPose() const;
};

/// A record from all its bytes, or nothing when they cannot be one: another length; a header other
/// than '0', a station and an error code; columns that are no number; numbers that are not finite
/// or that no unit sends (further than 4 m, angles beyond +-180 and +-90 degrees, axes or
/// quaternions whose length lacunaGeometryGate.h flags); an item listed twice with two values. The
/// records have no check sum: damage that leaves possible values is not seen here (see MotionCheck).
std::optional<FastrakRecord> DecodeFastrakRecord(
  std::string_view bytes, const FastrakLayout& layout, const FastrakFormat& format);

/// The bytes of a record. What is listed and absent in it is written as zeros. Throws
/// std::invalid_argument for numbers that do not fit their columns.
std::string EncodeFastrakRecord(
  const FastrakRecord& record, const FastrakLayout& layout, const FastrakFormat& format);
}
#endif
