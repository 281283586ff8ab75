// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEmulatedChannel.h"
#include "lacunaFastrakCommand.h"
#include "lacunaFastrakParser.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
Matrix4 Pose(double time, int station)
{
  return Matrix4::Translation({ 100.0 * station + 10 * time, 200, -50 }) *
    FastrakRotation(Vec3{ 20, 30, 40 });
}

// All that comes within some seconds.
std::string ReadAll(EmulatedChannel& channel, double seconds)
{
  std::string all;
  const double end = channel.Now() + seconds;
  char bytes[64];
  while (channel.Now() < end)
  {
    all.append(bytes, channel.Read(bytes, sizeof(bytes), end - channel.Now()));
  }
  return all;
}
}

TEST(FastrakEmulator, SendsTheDefaultRecordAtTheLinesPace)
{
  FastrakEmulator emulator(Pose);
  EmulatedChannel channel(emulator, 19200);
  channel.Write("P");
  char byte = 0;
  std::string record;
  double arrival = 0;
  while (channel.Read(&byte, 1, 1))
  {
    record += byte;
    arrival = record.size() == 47 ? channel.Now() : arrival;
  }
  ASSERT_EQ(record.size(), 47u);
  const auto read = DecodeFastrakRecord(record, FastrakLayout(), { false, LengthUnit::Inch });
  ASSERT_TRUE(read);
  EXPECT_NEAR((*read->Position)[1], 200, 0.13);
  EXPECT_EQ((*read->Angles)[2], 40);
  // request, measurement and computation, transfer
  EXPECT_NEAR(arrival, 10.0 / 19200 + 0.0055 + 470.0 / 19200, 1e-9);
}

TEST(FastrakEmulator, TheInstantOfAPoseIsKnown)
{
  FastrakEmulator emulator(Pose);
  EmulatedChannel channel(emulator, 19200);
  channel.Write("uf");
  ReadAll(channel, 1);
  const double request = channel.Now();
  channel.Write("P");
  const std::string record = ReadAll(channel, 0.1);
  const auto read = DecodeFastrakRecord(record, FastrakLayout(), { true, LengthUnit::Centimetre });
  ASSERT_TRUE(read);
  EXPECT_NEAR((*read->Position)[0], 100 + 10 * (request + 0.0035), 1e-4);
}

TEST(FastrakEmulator, AnswersForEveryActiveStationInOrder)
{
  FastrakEmulatorOptions options;
  options.Receivers = { true, true, true, true };
  options.Baud = 115200;
  FastrakEmulator emulator(Pose, options);
  EmulatedChannel channel(emulator, options.Baud);
  channel.Write("ufl2,0\rO1,2,4\rO3,2,11,0\rO4,2,5,6,7,16\rl1\rO4\rH1\r");
  const std::string answers = ReadAll(channel, 0.2);
  EXPECT_EQ(answers,
    "21l1011\r\n"
    "24O 2 5 6 716\r\n"
    "21H   1.00   0.00   0.00\r\n");
  channel.Write("P");
  FastrakParser parser({ true, LengthUnit::Centimetre });
  parser.SetLayout(1, FastrakLayout::FromNumbers({ 2, 4 }));
  parser.SetLayout(3, FastrakLayout::FromNumbers({ 2, 11, 0 }));
  parser.SetLayout(4, FastrakLayout::FromNumbers({ 2, 5, 6, 7, 16 }));
  std::vector<FastrakMessage> messages;
  parser.Feed(ReadAll(channel, 0.2), messages);
  ASSERT_EQ(messages.size(), 3u);
  int at = 0;
  for (const int station : { 1, 3, 4 })
  {
    const auto& record = std::get<FastrakRecord>(messages[at++]);
    EXPECT_EQ(record.Station, station);
    EXPECT_NEAR((*record.Position)[0], 100 * station, 10);
    EXPECT_LT(Norm(record.GetPose()->Column(0) - Pose(0, 1).Column(0)), 1e-5);
  }
}

TEST(FastrakEmulator, StatusAndComplaints)
{
  FastrakEmulator emulator(Pose);
  EmulatedChannel channel(emulator, 19200);
  const auto ask = [&](const char* bytes)
  {
    channel.Write(bytes);
    const std::string answer = ReadAll(channel, 0.5);
    EXPECT_EQ(answer.substr(answer.size() - std::min<std::size_t>(2, answer.size())), "\r\n");
    return DecodeFastrakReply(answer).value_or(FastrakReply());
  };
  const auto status = ReadFastrakStatus(ask("S"));
  ASSERT_TRUE(status);
  EXPECT_EQ(status->Flags, 0x3f0);
  EXPECT_EQ(status->Identification, "Lacuna FASTRAK emulator");
  EXPECT_EQ(ReadFastrakStatus(ask("fuS"))->Flags, 0x3f3);
  EXPECT_EQ(ReadFastrakStatus(ask("FUS"))->Flags, 0x3f0);
  EXPECT_EQ(ReadFastrakComplaint(ask("Z9\r"))->Code, -99);
  EXPECT_EQ(ReadFastrakComplaint(ask("Z9\r"))->Command, "Z9");
  EXPECT_EQ(ReadFastrakComplaint(ask("l7,1\r"))->Code, -3);
  EXPECT_EQ(ReadFastrakComplaint(ask("H,1,0,0\r"))->Code, -1);
  EXPECT_EQ(ReadFastrakComplaint(ask("Hx\r"))->Code, -2);
  EXPECT_EQ(ReadFastrakComplaint(ask("O1,2,99\r"))->Code, -3);
  EXPECT_EQ(ReadFastrakComplaint(ask("O1,1e300\r"))->Code, -3);
}

TEST(FastrakEmulator, ContinuousOutputAndHandshake)
{
  FastrakEmulatorOptions options;
  options.Baud = 115200;
  FastrakEmulator emulator(Pose, options);
  EmulatedChannel channel(emulator, options.Baud);
  channel.Write("fuO1,2,4\rC");
  const std::string second = ReadAll(channel, 1);
  EXPECT_NEAR(second.size() / 27.0, 120, 2);
  channel.Write("\x13");
  ReadAll(channel, 0.01);
  EXPECT_EQ(ReadAll(channel, 0.1), "");
  channel.Write("\x11");
  EXPECT_NE(ReadAll(channel, 0.1), "");
  channel.Write("l1,0\r"); // nobody to measure
  ReadAll(channel, 0.5);
  EXPECT_EQ(ReadAll(channel, 0.5), "");
  channel.Write("l1,1\r");
  EXPECT_NE(ReadAll(channel, 0.5), "");
  channel.Write("c");
  const std::string inFlight = ReadAll(channel, 0.5);
  EXPECT_LT(inFlight.size(), 30 * 27u);
  EXPECT_EQ(ReadAll(channel, 0.5), "");
}

TEST(FastrakEmulator, HemisphereButtonRestartAndFaults)
{
  FastrakEmulatorOptions options;
  options.StartTime = 10;
  FastrakEmulator emulator(Pose, options);
  EmulatedChannel channel(emulator, 19200);
  const FastrakLayout layout = FastrakLayout::FromNumbers({ 2, 4, 16 });
  const auto point = [&]()
  {
    channel.Write("P");
    return DecodeFastrakRecord(ReadAll(channel, 0.5), layout, { true, LengthUnit::Centimetre });
  };
  channel.Write("fuO1,2,4,16\rH1,-1,0,0\r");
  ReadAll(channel, 0.1);
  EXPECT_NEAR((*point()->Position)[1], -200, 1e-3);
  EXPECT_NEAR((*point()->Position)[2], 50, 1e-3);
  EXPECT_FALSE(*point()->Button);
  emulator.SetButton(true, channel.Now());
  EXPECT_EQ(ReadAll(channel, 0.5).size(), layout.GetLength(true));
  EXPECT_TRUE(*point()->Button);
  channel.Write("e1,0\r");
  ReadAll(channel, 0.1);
  emulator.SetButton(false, channel.Now());
  emulator.SetButton(true, channel.Now());
  EXPECT_EQ(ReadAll(channel, 0.5), "");

  FastrakFaults faults;
  faults.Error = 'k';
  emulator.SetFaults(faults);
  EXPECT_EQ(point()->Error, 'k');
  faults.Silent = true;
  emulator.SetFaults(faults);
  EXPECT_FALSE(point());
  emulator.SetFaults({});

  channel.Write("\x19");
  EXPECT_EQ(ReadAll(channel, 1), "");
  channel.Write("P");
  EXPECT_EQ(ReadAll(channel, 10), "");
  channel.Write("P");
  EXPECT_EQ(ReadAll(channel, 1).size(), 47u);
}
