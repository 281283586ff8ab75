// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A FASTRAK without hardware, for tests, demonstrations and the training of operators.
#ifndef lacunaFastrakEmulator_h
#define lacunaFastrakEmulator_h

#include "lacunaFastrakRecord.h"

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// What goes wrong; probabilities are per byte.
struct FastrakFaults
{
  double Changed = 0;   ///< a byte to the host becomes another
  double Lost = 0;      ///< a byte to the host does not arrive
  double Added = 0;     ///< a byte comes before one to the host
  bool Silent = false;  ///< nothing is sent at all
  bool Garbage = false; ///< every byte becomes another, as at a wrong baud rate
  char Error = ' ';     ///< error code of all records
  std::string Ignored;  ///< letters of commands that have no effect
  std::string Refused;  ///< letters of commands that it does not know: *ERROR*
};

struct FastrakEmulatorOptions
{
  int Baud = 19200;
  std::array<bool, FastrakStations> Receivers{ true, false, false, false }; ///< plugged in
  double SampleLatency = 0.0035; ///< s from the start of a request to the instant of its pose
  double AnswerLatency = 0.0055; ///< s from the end of a request to the first byte of its record
  double PositionNoise = 0;      ///< standard deviation of each coordinate, mm
  double AngularNoise = 0;       ///< standard deviation of each angle, degrees
  double StartTime = 10;         ///< s of silence after Reinitialise
  std::uint32_t Seed = 1;
  FastrakFaults Faults;
};

/// Takes commands and gives records with the timing of a serial line, in whatever time it is told:
/// the clock's or a simulated one. Times are s and must not go back.
///
/// It acts on P C c F f U u S W ^K ^Y ^S ^Q l O H e A R and sends the answers to l, O and H with only
/// a station. The commands B b D d G I N o Q r V v X x y are taken without effect. Anything else
/// gets an *ERROR* record. Positions are reported in the hemisphere set, so that a receiver that
/// leaves it is seen with all signs changed, as by the unit.
class FastrakEmulator
{
public:
  /// Receiver to transmitter, mm, at a time; may be asked for times ahead.
  using PoseScript = std::function<Matrix4(double time, int station)>;

  FastrakEmulator(PoseScript script, const FastrakEmulatorOptions& options = {});

  /// The host begins to send these bytes at a time.
  void Receive(std::string_view bytes, double time);
  /// The bytes that have come out by a time since they were asked for last.
  std::string Send(double time);
  /// When the next byte will be out; nothing while there is none to come.
  std::optional<double> GetNextTime();
  /// The stylus's button; may push a record (command e).
  void SetButton(bool pressed, double time);
  int GetBaud() const { return this->Options.Baud; }
  /// From now on.
  void SetFaults(const FastrakFaults& faults) { this->Options.Faults = faults; }

private:
  struct Station
  {
    bool Active = false;
    FastrakLayout Layout;
    Vec3 Zenith{ 1, 0, 0 };
    Matrix4 TransmitterToFrame; ///< of the alignment
    Vec3 LastPosition{ 0, 0, 0 };
  };
  struct Byte
  {
    double Time;
    char Value;
  };

  void Reset();
  void Take(char c, double begin, double end);
  bool IsSpoilt(const std::string& command, double end);
  bool ActOnLetter(char c, double begin, double end);
  void ActOnLine(const std::string& line, double end);
  void ActOnStation(const std::string& line, int number,
    const std::vector<std::optional<double>>& fields, double end);
  std::string DescribeActive() const;
  bool Align(Station& station, const std::vector<std::optional<double>>& fields) const;
  void Answer(const std::string& bytes, double time);
  void AnswerStatus(double time);
  void Complain(const std::string& command, int code, double time);
  void SendRecords(double sample, double ready);
  int CountActive() const;
  void SendContinuous(double time);
  FastrakRecord Measure(int station, double time);
  void Corrupt(char value, double time);

  PoseScript Script;
  FastrakEmulatorOptions Options;
  std::array<Station, FastrakStations> Stations;
  FastrakFormat Format;
  bool Continuous = false;
  bool Suspended = false;
  bool ButtonAsks = true;
  bool ButtonPressed = false;
  double NextContinuous = 0;
  double DeafUntil = 0;
  double InputFree = 0;  ///< when the line to the unit is free
  double OutputFree = 0; ///< when that to the host is
  std::string Line;      ///< a command that is not complete
  std::deque<Byte> Output;
  std::mt19937 Random;
};
}
#endif
