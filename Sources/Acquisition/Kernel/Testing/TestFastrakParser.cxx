// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakParser.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
const FastrakFormat Binary{ true, LengthUnit::Centimetre };
const FastrakFormat Ascii{ false, LengthUnit::Inch };

FastrakRecord NumberedRecord(int i, int station = 1)
{
  return MakeRecord({ 100 + 2.54 * i, -200 + 1.27 * i, 300 }, { 30, 40, 50 }, station);
}

// Positions tell the records apart.
bool IsNumbered(const FastrakRecord& record, int i)
{
  return Norm(*record.Position - *NumberedRecord(i).Position) < 0.3; // ASCII has 0.01 inch
}

std::vector<FastrakRecord> Records(const std::vector<FastrakMessage>& messages)
{
  std::vector<FastrakRecord> records;
  for (const FastrakMessage& message : messages)
  {
    if (const auto* record = std::get_if<FastrakRecord>(&message))
    {
      records.push_back(*record);
    }
  }
  return records;
}
}

TEST(FastrakParser, RecordsAndRepliesInPiecesOfAnySize)
{
  const FastrakLayout layout = FastrakLayout::FromNumbers({ 2, 4 });
  std::string bytes;
  for (int i = 0; i < 8; ++i)
  {
    bytes += EncodeFastrakRecord(NumberedRecord(i, 1 + i % 4), layout, Binary);
  }
  bytes += "2 E*ERROR*Z*ERROR* EC -99 *PS 0 *FL 0 *ST 0\r\n";
  bytes += EncodeFastrakRecord(NumberedRecord(8), layout, Binary);
  for (std::size_t piece = 1; piece <= bytes.size(); ++piece)
  {
    FastrakParser parser(Binary, layout);
    std::vector<FastrakMessage> messages;
    for (std::size_t at = 0; at < bytes.size(); at += piece)
    {
      parser.Feed(std::string_view(bytes).substr(at, piece), messages);
    }
    ASSERT_EQ(messages.size(), 10u);
    EXPECT_EQ(std::get<FastrakReply>(messages[8]).Command, 'E');
    const auto records = Records(messages);
    for (int i = 0; i < 9; ++i)
    {
      EXPECT_TRUE(IsNumbered(records[i], i));
    }
    EXPECT_EQ(records[5].Station, 2);
    EXPECT_EQ(parser.GetCounts().DroppedBytes, 0u);
    EXPECT_EQ(parser.GetNumberOfWaitingBytes(), 0u);
  }
}

TEST(FastrakParser, StationsHaveTheirOwnLayouts)
{
  FastrakParser parser(Binary, FastrakLayout::FromNumbers({ 2, 4 }));
  const FastrakLayout second = FastrakLayout::FromNumbers({ 2, 11, 0 });
  parser.SetLayout(2, second);
  std::vector<FastrakMessage> messages;
  parser.Feed(EncodeFastrakRecord(NumberedRecord(0), FastrakLayout::FromNumbers({ 2, 4 }), Binary) +
      EncodeFastrakRecord(NumberedRecord(1, 2), second, Binary),
    messages);
  const auto records = Records(messages);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_TRUE(records[1].Quaternion);
  EXPECT_FALSE(records[1].Angles);
}

// One byte lost, changed or added anywhere in one record of a stream costs at most that record and
// its neighbour, and no record is made up.
TEST(FastrakParser, FindsBackIntoStep)
{
  for (const FastrakFormat& format : { Binary, Ascii })
  {
    const FastrakLayout layout =
      format.Binary ? FastrakLayout::FromNumbers({ 2, 4, 0 }) : FastrakLayout();
    const std::size_t length = layout.GetLength(format.Binary);
    std::string clean;
    for (int i = 0; i < 12; ++i)
    {
      clean += EncodeFastrakRecord(NumberedRecord(i), layout, format);
    }
    for (std::size_t at = 5 * length; at < 6 * length; ++at)
    {
      for (int kind = 0; kind < 2; ++kind)
      {
        std::string bytes = clean;
        if (kind == 0)
        {
          bytes.erase(at, 1);
        }
        else
        {
          bytes.insert(at, 1, '\xb7');
        }
        FastrakParser parser(format, layout);
        std::vector<FastrakMessage> messages;
        parser.Feed(bytes, messages);
        const auto records = Records(messages);
        ASSERT_GE(records.size(), 10u) << "at " << at - 5 * length;
        int number = -1;
        for (const FastrakRecord& record : records)
        {
          int found = number + 1;
          while (found < 12 && !IsNumbered(record, found))
          {
            ++found;
          }
          ASSERT_LT(found, 12) << "a record that was never sent, at " << at - 5 * length;
          number = found;
        }
        EXPECT_EQ(number, 11);
        EXPECT_GT(parser.GetCounts().DroppedBytes, 0u);
        EXPECT_GT(parser.GetCounts().DamagedRecords, 0u);
      }
    }
  }
}

TEST(FastrakParser, SilenceEndsARecord)
{
  const FastrakLayout layout = FastrakLayout::FromNumbers({ 2, 4 });
  const std::string record = EncodeFastrakRecord(NumberedRecord(3), layout, Binary);
  FastrakParser parser(Binary, layout);
  std::vector<FastrakMessage> messages;
  parser.Feed(record.substr(0, 20), messages);
  EXPECT_EQ(parser.GetNumberOfWaitingBytes(), 20u);
  parser.EndOfTransmission();
  EXPECT_EQ(parser.GetCounts().DroppedBytes, 20u);
  EXPECT_EQ(parser.GetCounts().DamagedRecords, 1u);
  parser.Feed(record, messages);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(IsNumbered(std::get<FastrakRecord>(messages[0]), 3));

  // out of step a lone record is not believed
  parser.EndOfTransmission();
  parser.Feed("x" + record, messages);
  EXPECT_EQ(messages.size(), 1u);
  parser.EndOfTransmission();
  EXPECT_EQ(parser.GetCounts().DamagedRecords, 2u);
}

// Of 20 000 streams with random changes none crashes, and no byte is used twice. Binary values that
// are sent twice tell damage at one place: no record comes out then that was not sent.
TEST(FastrakParser, RandomDamageNeverCrashesNorMakesRecordsUp)
{
  std::mt19937 random(1996);
  for (int round = 0; round < 20000; ++round)
  {
    const bool binary = round % 2;
    const FastrakFormat format = binary ? Binary : Ascii;
    const FastrakLayout layout =
      binary ? FastrakLayout::FromNumbers({ 2, 4, 2, 4 }) : FastrakLayout();
    std::string clean;
    for (int i = 0; i < 4; ++i)
    {
      clean += EncodeFastrakRecord(NumberedRecord(i), layout, format);
    }
    clean += "21S3F3    F30  2.00  3SPACE FASTRAK of room 12       \r\n";
    const bool once = round % 4 < 2;
    const std::string bytes = Mutate(clean, once ? 1 : 4, random);
    FastrakParser parser(format, layout);
    std::vector<FastrakMessage> messages;
    std::size_t at = 0;
    while (at < bytes.size())
    {
      const std::size_t piece = 1 + random() % 50;
      parser.Feed(std::string_view(bytes).substr(at, piece), messages);
      at += piece;
    }
    parser.EndOfTransmission();
    std::size_t used = 0;
    for (const FastrakMessage& message : messages)
    {
      const auto* record = std::get_if<FastrakRecord>(&message);
      used += record ? layout.GetLength(binary) : std::get<FastrakReply>(message).Text.size() + 1;
      if (record && binary && once)
      {
        bool sent = false;
        for (int i = 0; i < 4; ++i)
        {
          sent |= IsNumbered(*record, i);
        }
        ASSERT_TRUE(sent) << "round " << round;
      }
    }
    ASSERT_LE(used + parser.GetCounts().DroppedBytes, bytes.size());
    ASSERT_GE(used + parser.GetCounts().DroppedBytes + messages.size(), bytes.size());
  }
}
