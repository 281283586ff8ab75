// SPDX-License-Identifier: BSD-3-Clause
// Bytes from a tracker's port: however they are divided, the same messages come out.
#include "lacunaFastrakParser.h"
#include "lacunaFuzzTarget.h"

#include <algorithm>

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
std::vector<int> MakeItems(Bytes& bytes)
{
  const int known[] = { 0, 1, 2, 3, 4, 5, 6, 7, 11, 16, 50, 51, 52, 53, 54, 55, 56, 57, 61, 66 };
  std::vector<int> items;
  for (int count = bytes.Take() % 8; count >= 0; --count)
  {
    items.push_back(known[bytes.Take() % std::size(known)]);
  }
  return items;
}

bool AreSame(const FastrakMessage& left, const FastrakMessage& right)
{
  if (left.index() != right.index())
  {
    return false;
  }
  if (const auto* reply = std::get_if<FastrakReply>(&left))
  {
    const auto& other = std::get<FastrakReply>(right);
    return reply->Station == other.Station && reply->Command == other.Command &&
      reply->Text == other.Text;
  }
  const auto& record = std::get<FastrakRecord>(left);
  const auto& other = std::get<FastrakRecord>(right);
  return record.Station == other.Station && record.Error == other.Error &&
    record.Position == other.Position && record.RelativePosition == other.RelativePosition &&
    record.Angles == other.Angles && record.Axes == other.Axes &&
    record.Quaternion == other.Quaternion && record.Button == other.Button;
}

void Use(const FastrakMessage& message)
{
  if (const auto* record = std::get_if<FastrakRecord>(&message))
  {
    Require(record->Station >= 1 && record->Station <= FastrakStations, "a station 1 to 4");
    const auto pose = record->GetPose();
    Require(!pose || pose->IsFinite(), "a pose is numbers");
    DescribeFastrakError(record->Error);
  }
  else
  {
    const auto& reply = std::get<FastrakReply>(message);
    ReadFastrakStatus(reply);
    if (const auto complaint = ReadFastrakComplaint(reply))
    {
      Require(!DescribeFastrakComplaint(*complaint).empty(), "a complaint in words");
    }
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  Bytes bytes(data, size);
  const std::uint8_t choice = bytes.Take();
  FastrakFormat format;
  format.Binary = choice & 1;
  format.Unit = choice & 2 ? LengthUnit::Centimetre : LengthUnit::Inch;
  FastrakLayout layout;
  try
  {
    layout = FastrakLayout::FromNumbers(MakeItems(bytes));
  }
  catch (const std::invalid_argument& error)
  {
    RequireSentence(error);
    return 0;
  }
  FastrakParser whole(format, layout);
  FastrakParser divided(format, layout);
  std::string stream;
  while (bytes.GetSize() > 0)
  {
    stream += static_cast<char>(bytes.Take());
  }
  std::vector<FastrakMessage> messages;
  whole.Feed(stream, messages);
  std::vector<FastrakMessage> pieces;
  const std::size_t step = 1 + (choice >> 2);
  for (std::size_t at = 0; at < stream.size(); at += step)
  {
    divided.Feed(std::string_view(stream).substr(at, step), pieces);
  }
  Require(std::equal(messages.begin(), messages.end(), pieces.begin(), pieces.end(), AreSame),
    "the same messages of a divided stream");
  Require(whole.GetCounts().DroppedBytes == divided.GetCounts().DroppedBytes &&
      whole.GetNumberOfWaitingBytes() == divided.GetNumberOfWaitingBytes(),
    "the same losses of a divided stream");
  Require(whole.GetNumberOfWaitingBytes() <= stream.size(), "no more waits than came");
  whole.EndOfTransmission();
  Require(whole.GetNumberOfWaitingBytes() == 0, "nothing waits after the end");
  for (const FastrakMessage& message : messages)
  {
    Use(message);
  }
  return 0;
}
