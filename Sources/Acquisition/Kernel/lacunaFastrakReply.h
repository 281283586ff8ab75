// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a FASTRAK says besides data records: answers to questions, its status, its complaints.
#ifndef lacunaFastrakReply_h
#define lacunaFastrakReply_h

#include <optional>
#include <string>
#include <string_view>

namespace lacuna
{
/// A record that begins with '2' and ends with a line feed.
struct FastrakReply
{
  char Station = ' '; ///< '1' to '4' or blank
  char Command = ' '; ///< the letter of the command that it answers
  std::string Text;   ///< all bytes, without the end of the line
};

/// Answer to S.
struct FastrakStatus
{
  int Flags = 0; ///< as sent
  bool Binary = false;
  bool Centimetres = false;
  bool Compensation = false;
  bool Continuous = false;
  std::string TestError; ///< of the built-in test; blanks removed, empty: none
  std::string Firmware;
  std::string Identification;
};

/// "*ERROR*": a command that the unit did not take.
struct FastrakComplaint
{
  std::string Command; ///< as it was understood
  int Code = -99;      ///< EC of the record; -99 when it cannot be read
};

/// A reply from its bytes with the end of the line; nothing when they are not printable ASCII with
/// a station or a blank and a command at the right places.
std::optional<FastrakReply> DecodeFastrakReply(std::string_view bytes);

/// Nothing when the reply is not one to S of 54 to 55 bytes with three hexadecimal flags of which
/// those that are always 1 are 1.
std::optional<FastrakStatus> ReadFastrakStatus(const FastrakReply& reply);

/// Nothing when the reply is no complaint.
std::optional<FastrakComplaint> ReadFastrakComplaint(const FastrakReply& reply);

/// "did not understand the command 'Z9' (its code -99)", for a sentence that begins with "The
/// FASTRAK".
std::string DescribeFastrakComplaint(const FastrakComplaint& complaint);

/// True for a character that a header can have as error code.
bool IsFastrakErrorCode(char code);
/// Whether a record with this code still has a pose to rely on: none, or a note that does not
/// concern the measurement (m, s, w).
bool IsFastrakErrorHarmless(char code);
/// What a code means and what to do, "weak signal: bring the receiver nearer ...".
std::string DescribeFastrakError(char code);
}
#endif
