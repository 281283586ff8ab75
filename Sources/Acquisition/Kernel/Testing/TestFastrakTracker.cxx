// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDeviceChoice.h"
#include "lacunaEmulatedChannel.h"
#include "lacunaExecution.h"
#include "lacunaFastrakCommand.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPairing.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
// An emulator, a line to it and a tracker at its other end.
struct Bench
{
  explicit Bench(const FastrakEmulatorOptions& options = {}, const FastrakSettings& settings = {},
    FastrakEmulator::PoseScript script = Sweep)
    : Emulator(std::move(script), options)
    , Channel(this->Emulator, options.Baud)
    , Tracker(this->Channel, this->Channel, settings)
  {
  }
  FastrakEmulator Emulator;
  EmulatedChannel Channel;
  FastrakTracker Tracker;
};

// What SetUp complains of.
std::string SetUpComplaint(Bench&& bench, TrackerError::Kind kind)
{
  try
  {
    bench.Tracker.SetUp();
  }
  catch (const TrackerError& e)
  {
    EXPECT_EQ(e.GetKind(), kind) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "no complaint";
  return {};
}

FastrakEmulatorOptions Baud(int baud)
{
  FastrakEmulatorOptions options;
  options.Baud = baud;
  return options;
}
}

TEST(FastrakTracker, FollowsTheProbeAtTheRateOfTheThesis)
{
  for (const int baud : { 19200, 115200 })
  {
    Bench bench(Baud(baud));
    bench.Tracker.SetUp();
    EXPECT_TRUE(bench.Tracker.GetStatus().Binary);
    std::vector<TrackedPose> poses;
    const double begin = bench.Channel.Now();
    while (bench.Channel.Now() < begin + 10)
    {
      EXPECT_TRUE(bench.Tracker.Poll(poses));
    }
    const double rate = static_cast<double>(poses.size()) / (bench.Channel.Now() - begin);
    EXPECT_GE(rate, baud == 19200 ? 46 : 120); // 46.3 in the thesis
    for (const TrackedPose& pose : poses)
    {
      EXPECT_LT(Distance(pose.ReceiverToTransmitter, Sweep(pose.Time, 1)), 2e-4);
      EXPECT_EQ(pose.Time, pose.Request + 0.0035);
    }
    EXPECT_EQ(bench.Tracker.GetWarning(), "");
  }
}

// A line on which some requests wait in the computer.
class BusyLine : public ByteChannel
{
public:
  explicit BusyLine(EmulatedChannel& line)
    : Line(line)
  {
  }
  std::size_t Read(char* bytes, std::size_t size, double seconds) override
  {
    return this->Line.Read(bytes, size, seconds);
  }
  void Write(std::string_view bytes) override
  {
    if (bytes == "P" && ++this->Requests % this->Every == 0)
    {
      char none[1];
      this->Line.Read(none, 1, this->Wait);
    }
    this->Line.Write(bytes);
  }
  std::string GetName() const override { return this->Line.GetName(); }
  int GetBaud() const override { return this->Line.GetBaud(); }

  double Wait = 0.06; // s
  int Every = 10;     // request waits

private:
  EmulatedChannel& Line;
  int Requests = 0;
};

TEST(FastrakTracker, AnswersThatComeLateAreLeftOut)
{
  Bench bench(Baud(115200));
  BusyLine line(bench.Channel);
  FastrakTracker tracker(line, bench.Channel);
  tracker.SetUp();
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 1000; ++i)
  {
    EXPECT_TRUE(tracker.Poll(poses)); // the line is in order
  }
  EXPECT_NEAR(tracker.GetCounts().Late, 100, 2);
  EXPECT_EQ(tracker.GetCounts().Records, 1001 - tracker.GetCounts().Late); // one by SetUp
  std::uint64_t late = 0;
  for (const TrackedPose& pose : poses)
  {
    late += pose.Usable ? 0 : 1;
    EXPECT_TRUE(!pose.Usable || Distance(pose.ReceiverToTransmitter, Sweep(pose.Time, 1)) < 2e-4);
  }
  EXPECT_EQ(poses.size(), 1000u);
  EXPECT_EQ(late, tracker.GetCounts().Late);
  EXPECT_EQ(tracker.GetWarning(), ""); // the unit has nothing to report
}

TEST(FastrakTracker, AButtonIsPressedInAnswersThatComeLateToo)
{
  FastrakSettings settings;
  settings.Layout = ChooseFastrakLayout(115200, true);
  Bench bench(Baud(115200), settings);
  BusyLine line(bench.Channel);
  FastrakTracker tracker(line, bench.Channel, settings);
  tracker.SetUp();
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 5; ++i)
  {
    ASSERT_TRUE(tracker.Poll(poses));
  }
  line.Every = 1;
  poses.clear();
  for (const bool pressed : { true, false })
  {
    bench.Emulator.SetButton(pressed, bench.Channel.Now());
    ASSERT_TRUE(tracker.Poll(poses));
    ASSERT_FALSE(poses.empty());
    EXPECT_FALSE(poses.back().Usable);
    EXPECT_EQ(poses.back().Button, pressed);
  }
}

// So many that the motion before says nothing of the next poses, but for the half of space.
TEST(FastrakTracker, AReceiverInTheOtherHalfOfSpaceIsThereStillAfterLateAnswers)
{
  const auto script = [](double time, int) {
    return Matrix4::Translation({ 100 * std::cos(0.3 * time), 200 + 20 * time / 60, 50 });
  };
  Bench bench(Baud(115200), {}, script);
  BusyLine line(bench.Channel);
  FastrakTracker tracker(line, bench.Channel);
  tracker.SetUp();
  std::vector<TrackedPose> poses;
  while (bench.Channel.Now() < 6) // x changes its sign after 5.2 s
  {
    tracker.Poll(poses);
  }
  line.Every = 1;
  const double begin = bench.Channel.Now();
  while (bench.Channel.Now() < begin + 1)
  {
    tracker.Poll(poses);
    EXPECT_FALSE(poses.back().Usable);
  }
  line.Every = 10;
  while (bench.Channel.Now() < 10)
  {
    tracker.Poll(poses);
  }
  int late = 0;
  for (const TrackedPose& pose : poses)
  {
    late += pose.Usable ? 0 : 1;
    ASSERT_TRUE(!pose.Usable || Distance(pose.ReceiverToTransmitter, script(pose.Time, 1)) < 2e-4)
      << pose.Time;
  }
  EXPECT_LT(10 * late, static_cast<int>(poses.size()) * 2);
}

TEST(FastrakTracker, TwoReceiversAndAQuaternion)
{
  FastrakEmulatorOptions options = Baud(115200);
  options.Receivers = { true, true, true, false };
  FastrakSettings settings;
  settings.Stations = { 1, 3 };
  settings.Layout = FastrakLayout::FromNumbers({ 2, 11, 16, 0 });
  Bench bench(options, settings);
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 20; ++i)
  {
    ASSERT_TRUE(bench.Tracker.Poll(poses));
  }
  ASSERT_EQ(poses.size(), 40u);
  for (const TrackedPose& pose : poses)
  {
    EXPECT_LT(Distance(pose.ReceiverToTransmitter, Sweep(pose.Time, pose.Station)), 2e-4);
    EXPECT_TRUE(pose.Button.has_value());
  }
}

// In each format, as the line carries it; also one that the unit begins with.
TEST(FastrakTracker, AsciiAndInches)
{
  for (const bool binary : { true, false })
  {
    for (const LengthUnit unit : { LengthUnit::Centimetre, LengthUnit::Inch })
    {
      for (const int baud : { 19200, 38400, 57600, 115200 })
      {
        FastrakSettings settings;
        settings.Format = { binary, unit };
        settings.Layout = ChooseFastrakLayout(baud, false, binary);
        Bench bench(Baud(baud), settings);
        bench.Tracker.SetUp();
        EXPECT_EQ(bench.Tracker.GetStatus().Binary, binary);
        EXPECT_EQ(bench.Tracker.GetStatus().Centimetres, unit == LengthUnit::Centimetre);
        std::vector<TrackedPose> poses;
        const double begin = bench.Channel.Now();
        while (bench.Channel.Now() < begin + 4)
        {
          ASSERT_TRUE(bench.Tracker.Poll(poses));
        }
        // mm and rad; the last digit of ASCII is 0.01 of a unit where the line is slow
        const bool coarse = !binary && baud < 57600;
        const double digit = coarse ? 0.5 * 0.01 * GetMillimetres(unit) + 1e-4 : 2e-3;
        for (const TrackedPose& pose : poses)
        {
          EXPECT_LT(Distance(pose.ReceiverToTransmitter, Sweep(pose.Time, 1)), digit);
        }
        EXPECT_GE(static_cast<double>(poses.size()) / 4, binary || baud > 19200 ? 43 : 30);
      }
    }
  }
}

TEST(FastrakTracker, AnAlignmentIsResetUnlessItIsToStay)
{
  // In inches, as after power-up: the origin 100 -200 -40 mm, and points 100 mm from it on y and z.
  // The receiver stays in the half of space of +x.
  const std::string align =
    "A1,3.9370,-7.8740,-1.5748,3.9370,-3.9370,-1.5748,3.9370,-7.8740,2.3622\r";
  for (const FastrakReset reset :
    { FastrakReset::Nothing, FastrakReset::Frames, FastrakReset::Factory })
  {
    FastrakSettings settings;
    settings.Reset = reset;
    Bench bench(Baud(115200), settings);
    bench.Channel.Write(align);
    bench.Tracker.SetUp();
    std::vector<TrackedPose> poses;
    for (int i = 0; i < 5; ++i)
    {
      ASSERT_TRUE(bench.Tracker.Poll(poses));
    }
    const Vec3 position = Sweep(poses.back().Time, 1).Column(3);
    const Vec3 seen = poses.back().ReceiverToTransmitter.Column(3);
    const Vec3 aligned{ position[1] + 200, position[2] + 40, position[0] - 100 };
    EXPECT_LT(Norm(seen - (reset == FastrakReset::Nothing ? aligned : position)), 1e-3);
  }
}

// The commands that a unit gets.
TEST(FastrakTracker, SendsTheSettingsThatAreSet)
{
  struct Listener : public EmulatedChannel
  {
    using EmulatedChannel::EmulatedChannel;
    void Write(std::string_view bytes) override
    {
      this->Sent += bytes;
      EmulatedChannel::Write(bytes);
    }
    std::string Sent;
  };
  const auto sent = [](const FastrakSettings& settings)
  {
    FastrakEmulatorOptions options = Baud(19200);
    options.Receivers = { true, true, true, true };
    FastrakEmulator emulator(Sweep, options);
    Listener channel(emulator, 19200);
    FastrakTracker(channel, channel, settings).SetUp();
    return channel.Sent;
  };
  const auto has = [](const std::string& text, const std::string& part)
  { return text.find(part) != std::string::npos; };
  FastrakSettings settings;
  const std::string usual = sent(settings);
  EXPECT_TRUE(has(usual, "cuf"));
  EXPECT_TRUE(has(usual, "H1,1"));
  EXPECT_TRUE(has(usual, "R1\r"));
  EXPECT_TRUE(has(usual, "l1,1\rl2,0\rl3,0\rl4,0\r"));
  EXPECT_FALSE(has(usual, "x,1\r"));
  EXPECT_FALSE(has(usual, "W"));
  settings.Stations = { 3 };
  settings.Format = { false, LengthUnit::Inch };
  settings.Hemisphere = { 0, 0, -1 };
  settings.FiltersOff = true;
  settings.Reset = FastrakReset::Factory;
  const std::string other = sent(settings);
  EXPECT_TRUE(has(other, "cUF"));
  EXPECT_TRUE(has(other, FastrakCommand::Hemisphere(3, { 0, 0, -1 })));
  EXPECT_TRUE(has(other, "l1,0\rl2,0\rl3,1\rl4,0\r"));
  EXPECT_TRUE(has(other, "x,1\rv,1\r"));
  EXPECT_LT(other.find('W'), other.find("cUF"));
  settings.Reset = FastrakReset::Nothing;
  EXPECT_FALSE(has(sent(settings), "R3\r"));
}

TEST(FastrakTracker, SaysWhatIsWrong)
{
  FastrakEmulatorOptions silent = Baud(19200);
  silent.Faults.Silent = true;
  EXPECT_NE(SetUpComplaint(Bench(silent), TrackerError::Kind::Silent).find("switched on"),
    std::string::npos);
  FastrakEmulatorOptions garbage = Baud(19200);
  garbage.Faults.Garbage = true;
  EXPECT_NE(SetUpComplaint(Bench(garbage), TrackerError::Kind::Garbage).find("baud rate"),
    std::string::npos);
  FastrakSettings second;
  second.Stations = { 2 };
  EXPECT_NE(SetUpComplaint(Bench(Baud(19200), second), TrackerError::Kind::WrongStation)
              .find("plugged into station 2"),
    std::string::npos);
}

// A unit that does not know or obey a command.
TEST(FastrakTracker, ComplaintsAndOtherStationsAreSaid)
{
  for (const char* letter : { "H", "O", "f" })
  {
    FastrakEmulatorOptions old = Baud(19200);
    old.Faults.Refused = letter;
    const std::string text = SetUpComplaint(Bench(old), TrackerError::Kind::Complaint);
    EXPECT_HAS(text, "did not understand the command '" + std::string(letter));
    EXPECT_HAS(text, "firmware");
  }
  FastrakEmulatorOptions stubborn = Baud(19200);
  stubborn.Faults.Ignored = "f";
  EXPECT_HAS(
    SetUpComplaint(Bench(stubborn), TrackerError::Kind::Complaint), "switch it off and on");

  // the second station was asked for, and the first one's receiver answers
  FastrakEmulatorOptions options = Baud(19200);
  options.Faults.Ignored = "l";
  FastrakSettings second;
  second.Stations = { 2 };
  const std::string text = SetUpComplaint(Bench(options, second), TrackerError::Kind::WrongStation);
  EXPECT_HAS(text, "answers for station 1 and not as asked for 2");
  EXPECT_HAS(text, "set Station to 1");

  // later, too: the complaint is told for a while and the poses go on
  Bench bench(Baud(19200));
  bench.Tracker.SetUp();
  bench.Channel.Write("Z9\r");
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 20 && bench.Tracker.GetWarning().empty(); ++i)
  {
    bench.Tracker.Poll(poses);
  }
  EXPECT_HAS(bench.Tracker.GetWarning(), "did not understand the command 'Z9'");
  EXPECT_TRUE(bench.Tracker.Poll(poses));
}

TEST(FastrakTracker, RefusesSettingsThatCannotBe)
{
  FastrakSettings settings;
  settings.Stations = { 2, 1 };
  EXPECT_THROW(Bench(Baud(19200), settings), std::invalid_argument);
  settings.Stations = { 5 };
  EXPECT_THROW(Bench(Baud(19200), settings), std::invalid_argument);
  settings = {};
  settings.Layout = FastrakLayout::FromNumbers({ 2, 16 });
  EXPECT_THROW(Bench(Baud(19200), settings), std::invalid_argument);
}

TEST(FastrakTracker, EndsContinuousOutputAndBegunCommands)
{
  Bench bench(Baud(19200));
  bench.Channel.Write("C");
  char bytes[1000];
  for (int i = 0; i < 100; ++i)
  {
    bench.Channel.Read(bytes, sizeof(bytes), 0.1);
  }
  bench.Channel.Write("O1,2"); // never ended
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  EXPECT_TRUE(bench.Tracker.Poll(poses));
}

TEST(FastrakTracker, ErrorCodesMakePosesUnusable)
{
  FastrakEmulatorOptions options = Baud(19200);
  options.Faults.Error = 'k';
  Bench bench(options);
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(bench.Tracker.Poll(poses));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_FALSE(poses[0].Usable);
  EXPECT_NE(bench.Tracker.GetWarning().find("weak"), std::string::npos);
  options.Faults.Error = 's';
  bench.Emulator.SetFaults(options.Faults);
  poses.clear();
  for (int i = 0; i < 3; ++i)
  {
    ASSERT_TRUE(bench.Tracker.Poll(poses));
  }
  EXPECT_EQ(poses.size(), 3u);
  EXPECT_TRUE(poses[0].Usable);
  // what was wrong is to be read for a while, and not for ever
  EXPECT_NE(bench.Tracker.GetWarning(), "");
  const double begin = bench.Channel.Now();
  while (bench.Channel.Now() < begin + 6)
  {
    ASSERT_TRUE(bench.Tracker.Poll(poses));
  }
  EXPECT_EQ(bench.Tracker.GetWarning(), "");
}

TEST(FastrakTracker, SetsARestartedUnitUpAgain)
{
  Bench bench(Baud(19200));
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 5; ++i)
  {
    ASSERT_TRUE(bench.Tracker.Poll(poses));
  }
  bench.Channel.Write("\x19"); // silent for 10 s, then ASCII and inches
  const double begin = bench.Channel.Now();
  while (!bench.Tracker.Poll(poses) && bench.Channel.Now() < begin + 60)
  {
  }
  EXPECT_LT(bench.Channel.Now(), begin + 20);
  EXPECT_NE(bench.Tracker.GetWarning().find("restarted"), std::string::npos);
  for (int i = 0; i < 5; ++i)
  {
    ASSERT_TRUE(bench.Tracker.Poll(poses));
  }
  EXPECT_LT(Distance(poses.back().ReceiverToTransmitter, Sweep(poses.back().Time, 1)), 2e-4);
}

// Nothing but the list of its records tells that it was restarted.
TEST(FastrakTracker, SetsARestartedUnitUpAgainThatKeepsItsFormat)
{
  FastrakSettings settings;
  settings.Format = { false, LengthUnit::Inch };
  settings.Layout = ChooseFastrakLayout(115200, false, false);
  Bench bench(Baud(115200), settings);
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(bench.Tracker.Poll(poses));
  bench.Channel.Write("W");
  const double begin = bench.Channel.Now();
  while (!bench.Tracker.Poll(poses) && bench.Channel.Now() < begin + 60)
  {
  }
  EXPECT_LT(bench.Channel.Now(), begin + 5);
  EXPECT_HAS(bench.Tracker.GetWarning(), "restarted");
}

TEST(FastrakTracker, ADamagedStatusIsNotWaitedFor)
{
  FastrakEmulatorOptions options = Baud(115200);
  options.Faults.Changed = 0.02; // two records of three, and so many in a row that it makes sure
  FastrakSettings settings;
  settings.Layout = FastrakLayout::FromNumbers({ 2, 4, 2, 4 });
  Bench bench(options, settings);
  bench.Tracker.SetUp();
  std::vector<TrackedPose> poses;
  double longest = 0;
  for (int i = 0; i < 20000; ++i)
  {
    const double begin = bench.Channel.Now();
    bench.Tracker.Poll(poses);
    longest = std::max(longest, bench.Channel.Now() - begin);
  }
  EXPECT_LT(longest, 0.15); // s of simulated time
  EXPECT_GT(poses.size(), 5000u);
}

TEST(FastrakTracker, StopsWhenTold)
{
  FastrakEmulatorOptions options = Baud(19200);
  options.Faults.Silent = true;
  FastrakEmulator emulator(Sweep, options);
  EmulatedChannel channel(emulator, options.Baud);
  int asked = 0;
  FastrakTracker tracker(channel, channel, {}, [&]() { return ++asked > 5; });
  EXPECT_THROW(tracker.SetUp(), Aborted);
  EXPECT_LT(channel.Now(), 1);
}

// Video at 25 frames a second while one byte in a hundred is damaged: every frame gets its pose and
// every pose is right. Simulated time.
class FastrakSoak : public testing::TestWithParam<double>
{
};

TEST_P(FastrakSoak, NoFrameIsLostOrMispaired)
{
  const double seconds = GetParam();
  for (const bool twice : { false, true })
  {
    FastrakEmulatorOptions options = Baud(twice ? 115200 : 19200);
    options.Faults.Changed = 0.01;
    FastrakSettings settings;
    settings.Layout =
      FastrakLayout::FromNumbers(twice ? std::vector<int>{ 2, 4, 2, 4 } : std::vector<int>{ 2, 4 });
    settings.Motion = { 600, 6, 0.1, 0.001 }; // the sweep's, with a margin
    Bench bench(options, settings);
    bench.Tracker.SetUp();
    const Pairing pairing = PairFrames(bench.Tracker, bench.Channel, seconds);
    const auto counts = bench.Tracker.GetCounts();
    EXPECT_EQ(pairing.Lost, 0);
    // listed twice: exact; once: what the limits of motion let pass in the longest gaps, less than the tracker's own error of 1.38 mm
    EXPECT_LT(pairing.Worst, twice ? 0.05 : 1.38);
    EXPECT_GT(counts.Damaged + counts.Implausible, counts.Requests / 10);
    std::cout << (twice ? "listed twice, 115200: " : "listed once, 19200: ") << counts.Requests
              << " requests, " << counts.Records << " records, " << counts.Damaged << " damaged, "
              << counts.Implausible << " implausible, worst " << pairing.Worst << " mm\n";
  }
}

INSTANTIATE_TEST_SUITE_P(Short, FastrakSoak, testing::Values(60.0));
INSTANTIATE_TEST_SUITE_P(Soak, FastrakSoak, testing::Values(1800.0));
