// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakParser.h"

#include <algorithm>

namespace lacuna
{
namespace
{
constexpr std::size_t LongestReply = 256;
}

FastrakParser::FastrakParser(const FastrakFormat& format, const FastrakLayout& layout)
  : Format(format)
{
  this->Layouts.fill(layout);
}

void FastrakParser::SetLayout(int station, const FastrakLayout& layout)
{
  this->Layouts.at(station - 1) = layout;
}

FastrakParser::Finding FastrakParser::Look(
  std::size_t at, FastrakMessage& message, std::size_t& length) const
{
  const std::string_view rest = std::string_view(this->Waiting).substr(at);
  if (rest.empty())
  {
    return Finding::Incomplete;
  }
  if (rest[0] == '0')
  {
    if (rest.size() < 2)
    {
      return Finding::Incomplete;
    }
    if (rest[1] < '1' || rest[1] > '0' + FastrakStations)
    {
      return Finding::Nothing;
    }
    const FastrakLayout& layout = this->Layouts[rest[1] - '1'];
    length = layout.GetLength(this->Format.Binary);
    if (rest.size() < length)
    {
      return Finding::Incomplete;
    }
    const auto record = DecodeFastrakRecord(rest.substr(0, length), layout, this->Format);
    if (!record)
    {
      return Finding::Nothing;
    }
    message = *record;
    return Finding::Message;
  }
  if (rest[0] == '2')
  {
    // what is no text ends the search at once, so that binary data is not taken for a reply
    const std::string_view text = rest.substr(0, LongestReply);
    const auto end = std::find_if(
      text.begin(), text.end(), [](char c) { return (c < ' ' || c > '~') && c != '\r'; });
    if (end == text.end())
    {
      return text.size() < LongestReply ? Finding::Incomplete : Finding::Nothing;
    }
    length = static_cast<std::size_t>(end - text.begin()) + 1;
    const auto reply = *end == '\n' ? DecodeFastrakReply(text.substr(0, length)) : std::nullopt;
    if (!reply)
    {
      return Finding::Nothing;
    }
    message = *reply;
    return Finding::Message;
  }
  return Finding::Nothing;
}

void FastrakParser::Drop(std::size_t count)
{
  this->Lost.DroppedBytes += count;
  if (this->InStep)
  {
    ++this->Lost.DamagedRecords;
    this->InStep = false;
  }
}

void FastrakParser::Feed(std::string_view bytes, std::vector<FastrakMessage>& messages)
{
  this->Waiting.append(bytes);
  std::size_t at = 0;
  while (at < this->Waiting.size())
  {
    FastrakMessage message;
    std::size_t length = 0;
    Finding finding = this->Look(at, message, length);
    if (finding == Finding::Message && !this->InStep)
    {
      FastrakMessage next;
      std::size_t nextLength = 0;
      finding = this->Look(at + length, next, nextLength);
    }
    if (finding == Finding::Incomplete)
    {
      break;
    }
    if (finding == Finding::Nothing)
    {
      this->Drop(1);
      ++at;
      continue;
    }
    this->InStep = true;
    messages.push_back(std::move(message));
    at += length;
  }
  this->Waiting.erase(0, at);
}

void FastrakParser::EndOfTransmission()
{
  if (!this->Waiting.empty())
  {
    this->Drop(this->Waiting.size());
    this->Waiting.clear();
  }
  this->InStep = true;
}
}
