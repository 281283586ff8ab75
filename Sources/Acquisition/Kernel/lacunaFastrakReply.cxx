// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakReply.h"

#include "lacunaFastrakRecord.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace lacuna
{
namespace
{
constexpr std::string_view ErrorWord = "*ERROR*";

std::string Trim(std::string_view text)
{
  const std::size_t first = text.find_first_not_of(' ');
  const std::size_t last = text.find_last_not_of(' ');
  return first == std::string_view::npos ? std::string()
                                         : std::string(text.substr(first, last - first + 1));
}
}

bool IsFastrakErrorCode(char code)
{
  return code >= ' ' && code <= 'z';
}

bool IsFastrakErrorHarmless(char code)
{
  return code == ' ' || code == 'm' || code == 's' || code == 'w';
}

std::string DescribeFastrakError(char code)
{
  switch (code)
  {
    case ' ':
      return "no error";
    case 'a':
    case 'b':
    case 'c':
      return "a driver of the transmitter is at its limit: keep metal away from it and check its "
             "plug";
    case 'd':
    case 'e':
    case 'f':
    case 'g':
      return "self-calibration failed (gain or coil): check the receiver's plug, switch the unit "
             "off and on";
    case 'j':
      return "the signal is too strong: move the receiver away from the transmitter";
    case 'k':
      return "the signal is weak: bring the receiver nearer to the transmitter (within 0.76 m for "
             "the quoted accuracy)";
    case 'l':
      return "there is no signal: check the plugs of transmitter and receiver";
    case 'm':
      return "the check sum of the stored settings was wrong; the measurement is not concerned";
    case 's':
      return "the position filter was reset; the measurement is not concerned";
    case 't':
    case 'u':
      return "metal compensation failed: the receiver is outside the compensated region";
    case 'v':
      return "there is no synchronisation signal: check the y command and the sync plug";
    case 'w':
      return "settings could not be stored; the measurement is not concerned";
    case 'x':
      return "the receiver is outside the position envelope";
    case 'y':
      return "the receiver is outside the angular envelope";
    default:
      return code < 'a' ? "the unit's hardware test failed: switch it off and on, see the service "
                          "part of its manual"
                        : "the unit reports an error that its manual does not explain";
  }
}

std::optional<FastrakReply> DecodeFastrakReply(std::string_view bytes)
{
  while (!bytes.empty() && (bytes.back() == '\n' || bytes.back() == '\r'))
  {
    bytes.remove_suffix(1);
  }
  const auto printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (bytes.size() < 3 || bytes[0] != '2' ||
    !(bytes[1] == ' ' || (bytes[1] >= '1' && bytes[1] <= '0' + FastrakStations)) ||
    !std::isalpha(static_cast<unsigned char>(bytes[2])) ||
    !std::all_of(bytes.begin(), bytes.end(), printable))
  {
    return std::nullopt;
  }
  return FastrakReply{ bytes[1], bytes[2], std::string(bytes) };
}

std::optional<FastrakStatus> ReadFastrakStatus(const FastrakReply& reply)
{
  constexpr int alwaysOne = 0x3f0;
  const std::string& text = reply.Text;
  if (reply.Command != 'S' || text.size() < 52 || text.size() > 53)
  {
    return std::nullopt;
  }
  int flags = 0;
  const auto result = std::from_chars(text.data() + 3, text.data() + 6, flags, 16);
  if (result.ptr != text.data() + 6 || (flags & alwaysOne) != alwaysOne)
  {
    return std::nullopt;
  }
  FastrakStatus status;
  status.Flags = flags;
  status.Binary = flags & 1;
  status.Centimetres = flags & 2;
  status.Compensation = flags & 4;
  status.Continuous = flags & 8;
  status.TestError = Trim(std::string_view(text).substr(6, 3));
  status.Firmware = Trim(std::string_view(text).substr(15, 6));
  status.Identification = Trim(std::string_view(text).substr(21));
  return status;
}

std::optional<FastrakComplaint> ReadFastrakComplaint(const FastrakReply& reply)
{
  const std::size_t first = reply.Text.find(ErrorWord);
  if (first == std::string::npos)
  {
    return std::nullopt;
  }
  FastrakComplaint complaint;
  const std::size_t echo = first + ErrorWord.size();
  const std::size_t second = reply.Text.find(ErrorWord, echo);
  complaint.Command = Trim(std::string_view(reply.Text)
                             .substr(echo, second == std::string::npos ? second : second - echo));
  const std::size_t code = reply.Text.find("EC", second == std::string::npos ? echo : second);
  if (code != std::string::npos)
  {
    std::size_t number = reply.Text.find_first_not_of(' ', code + 2);
    number = std::min(number, reply.Text.size());
    std::from_chars(
      reply.Text.data() + number, reply.Text.data() + reply.Text.size(), complaint.Code);
  }
  return complaint;
}

std::string DescribeFastrakComplaint(const FastrakComplaint& complaint)
{
  const std::string command =
    " the command '" + complaint.Command + "' (its code " + std::to_string(complaint.Code) + ")";
  switch (complaint.Code)
  {
    case -1:
      return "misses a field in" + command;
    case -2:
      return "found no number where it wants one in" + command;
    case -3:
      return "found a number out of range in" + command;
    case -4:
      return "is not configured for the frequency in" + command;
    case -5:
      return "could not store the answer to" + command;
    default:
      return "did not understand" + command;
  }
}
}
