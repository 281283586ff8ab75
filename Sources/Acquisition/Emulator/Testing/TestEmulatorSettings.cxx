// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEmulatedChannel.h"
#include "lacunaEmulatorSettings.h"

#include <gtest/gtest.h>

#include <fstream>

using namespace lacuna;

namespace
{
std::string Complaint(const std::vector<std::string>& words)
{
  try
  {
    ReadEmulatorSettings(words);
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "none";
}

std::string WriteFile(const std::string& name, const std::string& text)
{
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}
}

TEST(EmulatorSettings, Defaults)
{
  const EmulatorSettings settings = ReadEmulatorSettings({});
  EXPECT_EQ(settings.Options.Baud, 19200);
  EXPECT_TRUE(settings.Events.empty());
  // never faster than a hand that the thesis allows to be told apart
  double fastest = 0;
  for (double time = 0; time < 100; time += 0.01)
  {
    const Vec3 way = settings.Motion(time + 0.01, 1).Column(3) - settings.Motion(time, 1).Column(3);
    fastest = std::max(fastest, Norm(way) / 0.01);
  }
  EXPECT_LT(fastest, 35);
  EXPECT_GT(fastest, 23);
}

TEST(EmulatorSettings, TakesEveryOption)
{
  const std::string poses =
    WriteFile("lacuna-settings-poses.txt", "0 2 100 0 0 0 0 0\n10 2 200 0 0 0 0 0\n");
  const EmulatorSettings settings = ReadEmulatorSettings(
    { "--link", "/tmp/x", "--baud", "9600", "--receivers", "2,4", "--poses", poses, "--loop",
      "--noise", "0.5", "0.1", "--latency", "0.002", "0.004", "--seed", "7", "--seconds", "3.5" });
  EXPECT_EQ(settings.Link, "/tmp/x");
  EXPECT_EQ(settings.Options.Baud, 9600);
  EXPECT_EQ(settings.Options.Receivers, (std::array<bool, 4>{ false, true, false, true }));
  EXPECT_EQ(settings.Options.PositionNoise, 0.5);
  EXPECT_EQ(settings.Options.AngularNoise, 0.1);
  EXPECT_EQ(settings.Options.SampleLatency, 0.002);
  EXPECT_EQ(settings.Options.AnswerLatency, 0.004);
  EXPECT_EQ(settings.Options.Seed, 7u);
  EXPECT_EQ(settings.Duration, 3.5);
  EXPECT_NEAR(settings.Motion(25, 2).Column(3)[0], 150, 1e-9);
  EXPECT_NEAR(settings.Motion(25, 4).Column(3)[1], 200, 1e-9);
  EXPECT_TRUE(ReadEmulatorSettings({ "--help" }).Help);
  const std::string help = EmulatorHelp;
  for (const char* option :
    { "--link", "--baud", "--receivers", "--poses", "--loop", "--noise", "--latency", "--seed",
      "--fault", "--button", "--seconds", "--help", "--video", "--scene", "--aim", "--calibration",
      "--depth", "--linear", "--bare", "--size", "--rate", "--speckle", "--video-latency" })
  {
    EXPECT_NE(help.find(std::string("  ") + option + " "), std::string::npos) << option;
  }
}

TEST(EmulatorSettings, FaultsAddUpInOrderOfTime)
{
  const EmulatorSettings settings = ReadEmulatorSettings({ "--fault", "5:none", "--fault",
    "2:silent", "--fault", "error=k", "--button", "3", "--fault", "lost=0.25" });
  ASSERT_EQ(settings.Events.size(), 6u);
  std::vector<double> times;
  for (const EmulatorEvent& event : settings.Events)
  {
    times.push_back(event.Time);
  }
  EXPECT_EQ(times, (std::vector<double>{ 0, 0, 2, 3, 3.2, 5 }));
  FastrakEmulator emulator(settings.Motion, settings.Options);
  EmulatedChannel channel(emulator, 19200);
  const auto ask = [&]
  {
    std::array<char, 200> bytes{};
    std::string answer;
    channel.Write("P");
    while (const std::size_t count = channel.Read(bytes.data(), bytes.size(), 0.2))
    {
      answer.append(bytes.data(), count);
    }
    return answer;
  };
  settings.Events[0].Apply(emulator, channel.Now());
  EXPECT_EQ(ask().substr(0, 3), "01k");
  settings.Events[1].Apply(emulator, channel.Now());
  EXPECT_LT(ask().size(), 47u);
  settings.Events[2].Apply(emulator, channel.Now());
  EXPECT_EQ(ask(), "");
  settings.Events[5].Apply(emulator, channel.Now());
  EXPECT_EQ(ask().size(), 47u);
}

TEST(EmulatorSettings, TakesTheVideosOptions)
{
  const VideoOptions none = ReadEmulatorSettings({}).Video;
  EXPECT_EQ(none.Service.Sender.URL, "");
  const EmulatorSettings settings =
    ReadEmulatorSettings({ "--video", "tcp://127.0.0.1:5004", "--scene", "Vessels", "--aim", "2.5",
      "--calibration", "c.xml", "--depth", "80", "--linear", "50", "--bare", "--size", "320", "240",
      "--rate", "30", "--speckle", "0.1", "--video-latency", "0.12" });
  const VideoOptions& video = settings.Video;
  EXPECT_EQ(video.Service.Sender.URL, "tcp://127.0.0.1:5004");
  EXPECT_EQ(video.Service.Sender.Rate, 30);
  EXPECT_EQ(video.Service.Latency, 0.12);
  EXPECT_EQ(video.Scene, "Vessels");
  EXPECT_EQ(video.Calibration, "c.xml");
  EXPECT_EQ(video.Aim, 2.5);
  EXPECT_EQ(video.Picture.SpeckleLevel, 0.1);
  EXPECT_EQ(video.Picture.Layout.Shape, ScannerLayout::Probe::Linear);
  EXPECT_EQ(video.Picture.Layout.Width, 50);
  EXPECT_EQ(video.Picture.Layout.Depth, 80);
  EXPECT_EQ(video.Picture.Layout.Columns, 320);
  EXPECT_EQ(video.Picture.Layout.Rows, 240);
  EXPECT_FALSE(video.Picture.Layout.Furniture);
  // half way
  EXPECT_EQ(ReadEmulatorSettings({ "--video", "a.mkv" }).Video.Aim, 4);
  const std::string poses =
    WriteFile("lacuna-settings-aim.txt", "0 1 100 0 0 0 0 0\n10 1 200 0 0 0 0 0\n");
  EXPECT_EQ(ReadEmulatorSettings({ "--video", "a.mkv", "--poses", poses }).Video.Aim, 5);
  for (const char* scene : { "Ellipsoids", "Kumara", "Vessels", "Linear", "Floor" })
  {
    EXPECT_NE(MakeEmulatedScene(scene), nullptr);
  }
}

TEST(EmulatorSettings, SaysWhatIsWrong)
{
  EXPECT_NE(Complaint({ "--baud", "1200" }).find("19200"), std::string::npos);
  EXPECT_NE(Complaint({ "--baud", "fast" }).find("'fast'"), std::string::npos);
  EXPECT_NE(Complaint({ "--baud" }).find("needs a value"), std::string::npos);
  EXPECT_NE(Complaint({ "--baut", "1" }).find("'--baut'"), std::string::npos);
  EXPECT_NE(Complaint({ "--noise", "1" }).find("needs a value"), std::string::npos);
  EXPECT_NE(Complaint({ "--poses", "/nowhere" }).find("/nowhere"), std::string::npos);
  EXPECT_NE(
    Complaint({ "--scene", "Liver", "--video", "a.mkv" }).find("'Liver'"), std::string::npos);
  EXPECT_NE(Complaint({ "--depth", "80" }).find("--depth belongs to --video"), std::string::npos);
  EXPECT_NE(Complaint({ "--depth", "8000" }).find("5 to 400 mm"), std::string::npos);
  EXPECT_NE(Complaint({ "--size", "320" }).find("needs a value"), std::string::npos);
  EXPECT_NE(Complaint({ "--rate", "24.5" }).find("whole numbers"), std::string::npos);
  EXPECT_NE(Complaint({ "--size", "320", "240.5" }).find("whole numbers"), std::string::npos);
  for (const char* list : { "", "0", "5", "1,", ",1", "12", "1 2" })
  {
    EXPECT_NE(Complaint({ "--receivers", list }).find("1 to 4"), std::string::npos) << list;
  }
  for (const char* fault : { "", "lost", "lost=2", "lost=nan", "error=", "error=kk",
         "ignored=", "refused", "silent=1", "x:silent", "-1:silent", "1:", "none=0", "loud" })
  {
    EXPECT_NE(Complaint({ "--fault", fault }).find("--help"), std::string::npos) << fault;
  }
}
