// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Records out of a FASTRAK's stream of bytes, whatever else is in it.
#ifndef lacunaFastrakParser_h
#define lacunaFastrakParser_h

#include "lacunaFastrakRecord.h"
#include "lacunaFastrakReply.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lacuna
{
using FastrakMessage = std::variant<FastrakRecord, FastrakReply>;

/// Cuts a stream into data records and replies.
///
/// Between records nothing separates them, so bytes that are lost, changed or added shift all that
/// follows. The parser then drops bytes until records fit again. After damage it takes a record
/// only when the one that follows at once is right too (then both), or after EndOfTransmission: a
/// right header and possible numbers alone can come about by chance within other numbers.
class FastrakParser
{
public:
  /// What did not become a message.
  struct Counts
  {
    std::uint64_t DamagedRecords = 0; ///< places where the stream was broken
    std::uint64_t DroppedBytes = 0;
  };

  /// The same layout for all stations, until SetLayout.
  explicit FastrakParser(const FastrakFormat& format = {}, const FastrakLayout& layout = {});
  void SetLayout(int station, const FastrakLayout& layout);

  /// Takes the next bytes and adds the messages that are complete now, in order.
  void Feed(std::string_view bytes, std::vector<FastrakMessage>& messages);
  /// The line is silent and nothing is on its way: what is begun stays incomplete and is dropped,
  /// and the next byte begins a record.
  void EndOfTransmission();

  /// Bytes of a record or reply that is not complete.
  std::size_t GetNumberOfWaitingBytes() const { return this->Waiting.size(); }
  const Counts& GetCounts() const { return this->Lost; }

private:
  enum class Finding
  {
    Message,
    Incomplete,
    Nothing
  };
  Finding Look(std::size_t at, FastrakMessage& message, std::size_t& length) const;
  void Drop(std::size_t count);

  FastrakFormat Format;
  std::array<FastrakLayout, FastrakStations> Layouts;
  std::string Waiting;
  bool InStep = true; ///< the first byte that waits begins a record
  Counts Lost;
};
}
#endif
