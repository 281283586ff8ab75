// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakReply.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
const std::string Status =
  "21S3F3    F30  2.00  3SPACE FASTRAK of room 12       \r\n"; // made by the columns of the manual
}

TEST(FastrakReply, ReadsTheStatus)
{
  ASSERT_EQ(Status.size(), 55u);
  const auto reply = DecodeFastrakReply(Status);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->Station, '1');
  EXPECT_EQ(reply->Command, 'S');
  const auto status = ReadFastrakStatus(*reply);
  ASSERT_TRUE(status);
  EXPECT_TRUE(status->Binary);
  EXPECT_TRUE(status->Centimetres);
  EXPECT_FALSE(status->Compensation);
  EXPECT_FALSE(status->Continuous);
  EXPECT_EQ(status->TestError, "");
  EXPECT_EQ(status->Firmware, "2.00");
  EXPECT_EQ(status->Identification, "3SPACE FASTRAK of room 12");

  std::string continuous = Status;
  continuous.replace(3, 3, "3F8");
  EXPECT_TRUE(ReadFastrakStatus(*DecodeFastrakReply(continuous))->Continuous);
  EXPECT_FALSE(ReadFastrakStatus(*DecodeFastrakReply(continuous))->Binary);
  // the compatible IS-900 sends one byte less
  std::string shorter = Status;
  shorter.erase(52, 1);
  EXPECT_TRUE(ReadFastrakStatus(*DecodeFastrakReply(shorter)));
}

TEST(FastrakReply, RefusesWhatIsNoStatus)
{
  for (const char* flags : { "0F3", "3E3", "3G3", " F3" })
  {
    std::string damaged = Status;
    damaged.replace(3, 3, flags);
    EXPECT_FALSE(ReadFastrakStatus(*DecodeFastrakReply(damaged))) << flags;
  }
  EXPECT_FALSE(ReadFastrakStatus(*DecodeFastrakReply(Status.substr(0, 40))));
  EXPECT_FALSE(DecodeFastrakReply("0" + Status.substr(1)));
  EXPECT_FALSE(DecodeFastrakReply("29S\r\n"));
  EXPECT_FALSE(DecodeFastrakReply("21\x90\r\n"));
  EXPECT_FALSE(DecodeFastrakReply("21S\x90\r\n"));
  EXPECT_FALSE(DecodeFastrakReply("2"));
  EXPECT_FALSE(DecodeFastrakReply(""));
}

TEST(FastrakReply, ReadsComplaints)
{
  const auto reply = DecodeFastrakReply("2 E*ERROR*Z9*ERROR* EC -99 *PS 0 *FL 0 *ST 0\r\n");
  ASSERT_TRUE(reply);
  const auto complaint = ReadFastrakComplaint(*reply);
  ASSERT_TRUE(complaint);
  EXPECT_EQ(complaint->Command, "Z9");
  EXPECT_EQ(complaint->Code, -99);
  EXPECT_NE(DescribeFastrakComplaint(*complaint).find("Z9"), std::string::npos);
  const auto range = ReadFastrakComplaint(
    *DecodeFastrakReply("2 E*ERROR*O1,99*ERROR* EC  -3 *PS 4 *FL 2 *ST 0\r\n"));
  EXPECT_EQ(range->Code, -3);
  EXPECT_NE(DescribeFastrakComplaint(*range).find("out of range"), std::string::npos);
  // blanks in unknown places, and a record cut short
  EXPECT_EQ(ReadFastrakComplaint(*DecodeFastrakReply("2 E *ERROR* H *ERROR* EC-1\r\n"))->Code, -1);
  EXPECT_EQ(ReadFastrakComplaint(*DecodeFastrakReply("2 E*ERROR*H\r\n"))->Code, -99);
  EXPECT_EQ(ReadFastrakComplaint(*DecodeFastrakReply("2 E*ERROR*H*ERROR* EC\r\n"))->Code, -99);
  EXPECT_FALSE(ReadFastrakComplaint(*DecodeFastrakReply(Status)));
}

TEST(FastrakReply, ErrorCodesHaveWords)
{
  EXPECT_NE(DescribeFastrakError('k').find("nearer"), std::string::npos);
  EXPECT_NE(DescribeFastrakError('A').find("hardware"), std::string::npos);
  EXPECT_NE(DescribeFastrakError('z').find("does not explain"), std::string::npos);
  for (char code = ' '; code <= 'z'; ++code)
  {
    EXPECT_FALSE(DescribeFastrakError(code).empty());
    EXPECT_TRUE(IsFastrakErrorCode(code));
    EXPECT_EQ(IsFastrakErrorHarmless(code), std::string(" msw").find(code) != std::string::npos);
  }
  EXPECT_FALSE(IsFastrakErrorCode('\x80'));
  EXPECT_FALSE(IsFastrakErrorCode('\n'));
}
