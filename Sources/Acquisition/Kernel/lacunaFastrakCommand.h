// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The commands of a FASTRAK, as the bytes to send. Those of one letter act at once; those with
/// fields end with a carriage return. Lengths are given in mm and written in unit, which must be the
/// unit that the FASTRAK uses at that time. Functions throw std::invalid_argument for stations other
/// than 1 to 4 and numbers that are not finite.
#ifndef lacunaFastrakCommand_h
#define lacunaFastrakCommand_h

#include "lacunaFastrakRecord.h"

#include <string>

namespace lacuna
{
namespace FastrakCommand
{
/// @name One letter, no carriage return
///@{
constexpr char Point = 'P';           ///< one record of each active station
constexpr char Continuous = 'C';      ///< records without end
constexpr char StopContinuous = 'c';  ///< those on their way still come
constexpr char Ascii = 'F';           ///< records in ASCII
constexpr char Binary = 'f';          ///< records in binary
constexpr char Inches = 'U';          ///< lengths in inches
constexpr char Centimetres = 'u';     ///< lengths in centimetres
constexpr char Status = 'S';          ///< asks for the status record
constexpr char Defaults = 'W';        ///< settings as from the factory
constexpr char Save = '\x0b';         ///< keeps the settings (some seconds)
constexpr char Reinitialise = '\x19'; ///< as after power-up (10 s)
constexpr char Suspend = '\x13';      ///< no output until Resume
constexpr char Resume = '\x11';
constexpr char CompensationOn = 'D'; ///< of fixed metal
constexpr char CompensationOff = 'd';
///@}

/// The items of a station's records.
std::string OutputList(int station, const FastrakLayout& layout);
/// The zenith of the half of space in which the receiver is; 0 0 0: the unit follows it.
std::string Hemisphere(int station, const Vec3& zenith);
/// Switches a station on or off.
std::string Active(int station, bool on);
/// Takes the present orientation as the reference angles; and back.
std::string Boresight(int station);
std::string Unboresight(int station);
/// The reference angles azimuth, elevation, roll of Boresight, degrees.
std::string ReferenceAngles(int station, const Vec3& angles);
/// The frame of the poses: its origin, a point on its x axis and one in its xy plane, mm in the
/// present frame; send ResetAlignment first.
std::string Alignment(
  int station, const Vec3& origin, const Vec3& onX, const Vec3& onY, LengthUnit unit);
std::string ResetAlignment(int station);
/// How the transmitter is mounted: azimuth, elevation, roll, degrees.
std::string Mounting(int station, const Vec3& angles);
/// Where the stylus's tip is from its receiver, mm.
std::string TipOffset(int station, const Vec3& offset, LengthUnit unit);
/// Records come when the receiver has moved this far, mm.
std::string Increment(int station, double distance, LengthUnit unit);
/// The box of positions without error code x, mm, and of angles without y, degrees.
std::string PositionEnvelope(
  int station, const Vec3& maximum, const Vec3& minimum, LengthUnit unit);
std::string AngularEnvelope(int station, const Vec3& maximum, const Vec3& minimum);
/// Whether the stylus's button asks for a record itself; it is reported by the item Button anyway.
std::string ButtonAsksForRecord(int station, bool on);
/// Adaptive low-pass filters of position and attitude: F, lowest, highest and factor (each 0 to 1),
/// or off.
std::string PositionFilter(const std::array<double, 4>& parameters);
std::string PositionFilterOff();
std::string AttitudeFilter(const std::array<double, 4>& parameters);
std::string AttitudeFilterOff();
/// Rate, 2400 to 115200 baud, no parity, 8 bits, no handshake.
std::string SerialRate(int baud);
/// Asks what a command with a station has set: its letter and the station.
std::string Ask(char command, int station);
}
}
#endif
