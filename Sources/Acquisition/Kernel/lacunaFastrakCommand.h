// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The commands of a FASTRAK, as the bytes to send. Those of one letter act at once; those with
/// fields end with a carriage return. Functions throw std::invalid_argument for stations other than 1
/// to 4 and numbers that are not finite.
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
/// Forgets the reference angles that a boresight has taken.
std::string Unboresight(int station);
/// Poses are in the transmitter's frame again.
std::string ResetAlignment(int station);
/// Whether the stylus's button asks for a record itself; it is reported by the item Button anyway.
std::string ButtonAsksForRecord(int station, bool on);
/// No adaptive low-pass filter of position or attitude.
std::string PositionFilterOff();
std::string AttitudeFilterOff();
/// Rate, 2400 to 115200 baud, no parity, 8 bits, no handshake.
std::string SerialRate(int baud);
}
}
#endif
