// SPDX-License-Identifier: BSD-3-Clause
#include "FileSizeLimit.h"
#include "WrittenSequence.h"
#include "lacunaClock.h"
#include "lacunaOutputFile.h"
#include "lacunaSequenceRecorder.h"
#include "lacunaSweepRecorder.h"
#include "lacunaTestDisk.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

using namespace lacuna;

namespace
{
void Add(SweepRecorder& recorder, int frame)
{
  const std::string pixels = MakePixels(frame);
  recorder.Add(
    std::make_shared<std::vector<std::uint8_t>>(pixels.begin(), pixels.end()), MakeFields(frame));
}

// Whether a file has the first slices of the recording, at least so many, and nothing else.
void ExpectBeginning(const std::string& path, std::size_t atLeast)
{
  const ReadBack read(path);
  ASSERT_GE(read.Frames.size(), atLeast);
  for (std::size_t i = 0; i < read.Frames.size(); ++i)
  {
    ASSERT_EQ(read.Frames[i], MakePixels(static_cast<int>(i))) << i;
    ASSERT_EQ(read.GetFields(i), Sorted(MakeFields(static_cast<int>(i)))) << i;
  }
}

// Waits for a state, for at most a minute.
bool Becomes(
  const SweepRecorder& recorder, const std::function<bool(const SweepRecorder::State&)>& condition)
{
  const SteadyClock clock;
  const double end = clock.Now() + 60;
  while (!condition(recorder.GetState()) && clock.Now() < end)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition(recorder.GetState());
}
}

TEST(SweepRecorder, WritesAgainWhatTheDiskHasDropped)
{
  for (const auto& [name, level] : { std::pair("dropped.mhd", 0), std::pair("dropped.nhdr", 6) })
  {
    const TemporaryFolder folder;
    SweepRecorder recorder(folder / name, MakeDescription(), level);
    for (int frame = 0; frame < 4; ++frame)
    {
      lacunaTest::DiskFailures = frame % 3 == 0 ? 1 : 0; // the first time, and later
      Add(recorder, frame);
      if (frame != 2)
      {
        ASSERT_TRUE(Becomes(recorder, [&](const auto& now) { return now.Synced == frame + 1; }));
        EXPECT_EQ(lacunaTest::DiskFailures, 0);
        EXPECT_EQ(recorder.GetState().Trouble, "");
        ExpectBeginning(folder / name, static_cast<std::size_t>(frame + 1));
      }
    }
    lacunaTest::DiskFailures = 1000;
    Add(recorder, 4);
    Add(recorder, 5);
    EXPECT_THROW(recorder.Finish(), FileError);
    EXPECT_EQ(recorder.GetState().Synced, 4);
    ExpectBeginning(folder / name, 6); // written again, and in the system's memory
    lacunaTest::DiskFailures = 0;
    recorder.Finish();
    ExpectBeginning(folder / name, 6);
    EXPECT_EQ(recorder.GetState().Written, 6);
    EXPECT_EQ(recorder.GetState().WaitingBytes, 0);
    EXPECT_EQ(recorder.GetState().Trouble, "");
  }
}

// The program ends while the disk fails once.
TEST(SweepRecorder, EndsWithAllSlicesAfterAFailure)
{
  for (const auto& [name, level] : { std::pair("ended.mhd", 6), std::pair("ended.nhdr", 0) })
  {
    const TemporaryFolder folder;
    {
      SweepRecorder recorder(folder / name, MakeDescription(), level);
      Add(recorder, 0);
      ASSERT_TRUE(Becomes(recorder, [&](const auto& now) { return now.Synced == 1; }));
      lacunaTest::DiskFailures = 1;
      Add(recorder, 1);
      Add(recorder, 2);
    }
    EXPECT_EQ(lacunaTest::DiskFailures, 0);
    ExpectBeginning(folder / name, 3);
  }
}

// The program ends while the disk is about to fail for the first slice, and others wait.
TEST(SweepRecorder, EndsWithAllSlicesWhileItFails)
{
  const TemporaryFolder folder;
  {
    SweepRecorder recorder(folder / "ended.mhd", MakeDescription());
    lacunaTest::DiskDelay = 400;
    lacunaTest::DiskFailures = 1;
    Add(recorder, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(500)); // it began 300 ms after the slice
    for (int frame = 1; frame < 50; ++frame)
    {
      Add(recorder, frame);
    }
  }
  lacunaTest::DiskDelay = 0;
  EXPECT_EQ(lacunaTest::DiskFailures, 0);
  ExpectBeginning(folder / "ended.mhd", 50);
}

TEST(SweepRecorder, WritesWhileTheDiskFails)
{
  const TemporaryFolder folder;
  SweepRecorder recorder(folder / "failing.nhdr", MakeDescription());
  lacunaTest::DiskFailures = 1000000;
  Add(recorder, 0);
  ASSERT_TRUE(Becomes(recorder, [](const auto& now) { return !now.Trouble.empty(); }));
  EXPECT_NE(recorder.GetState().Trouble.find("look after that disk"), std::string::npos);
  for (int frame = 1; frame < 200; ++frame)
  {
    Add(recorder, frame);
  }
  EXPECT_TRUE(Becomes(recorder, [](const auto& now) { return now.Written == 200; }));
  EXPECT_EQ(recorder.GetState().Synced, 0);
  EXPECT_NE(recorder.GetState().Trouble, "");
  ExpectBeginning(folder / "failing.nhdr", 200);
  lacunaTest::DiskFailures = 0;
  EXPECT_TRUE(Becomes(recorder, [](const auto& now) { return now.Synced == 200; }));
  EXPECT_EQ(recorder.GetState().Trouble, "");
}

TEST(SweepRecorder, WritesWhileTheDiskIsSlow)
{
  const TemporaryFolder folder;
  SweepRecorder recorder(folder / "slow.mhd", MakeDescription());
  lacunaTest::DiskDelay = 500; // for each of two files
  for (int frame = 0; frame < 200; ++frame)
  {
    Add(recorder, frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(Becomes(recorder, [](const auto& now) { return now.Synced == 200; }));
  lacunaTest::DiskDelay = 0;
  ExpectBeginning(folder / "slow.mhd", 200);
}

// Not even its beginning was on the disk when it was to end without a slice.
TEST(SweepRecorder, IsWholeAfterAnEndThatFailed)
{
  for (const auto& [name, level] : { std::pair("empty.mhd", 6), std::pair("empty.nhdr", 6) })
  {
    const TemporaryFolder folder;
    SequenceRecorder recorder(folder / name, MakeDescription(), level);
    lacunaTest::DiskFailures = 1;
    EXPECT_THROW(recorder.Close(), FileError);
    for (int frame = 0; frame < 3; ++frame)
    {
      recorder.Append(MakePixels(frame).data(), MakeFields(frame));
    }
    recorder.Close();
    ExpectBeginning(folder / name, 3);
  }
}

TEST(SweepRecorder, SlicesAreOnDiskWithoutBeingAskedFor)
{
  for (const int level : { 0, 6 })
  {
    const TemporaryFolder folder;
    const std::string path = folder / "sweep.igs.mhd";
    SweepRecorder recorder(path, MakeDescription(), level);
    for (int i = 0; i < 20; ++i)
    {
      Add(recorder, i);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(Becomes(recorder, [](const auto& state) { return state.Synced == 20; }));
    const SweepRecorder::State state = recorder.GetState();
    EXPECT_EQ(state.Added, 20);
    EXPECT_EQ(state.Written, 20);
    EXPECT_EQ(state.WaitingBytes, 0);
    EXPECT_EQ(state.Trouble, "");
    EXPECT_GT(state.LongestDelay, 0);
    EXPECT_GT(state.FreeBytes, 0);
    std::cout << "longest delay until a slice is on the disk: " << state.LongestDelay << " s\n";
    ExpectBeginning(path, 20); // while the recording goes on
    Add(recorder, 20);
    recorder.Finish();
    ExpectBeginning(path, 21);
    EXPECT_EQ(ReadBack(path).Warning, "");
    EXPECT_THROW(Add(recorder, 21), std::invalid_argument);
    recorder.Finish();
  }
}

TEST(SweepRecorder, ItsEndWritesWhatWaits)
{
  const TemporaryFolder folder;
  const std::string path = folder / "sweep.nhdr";
  {
    SweepRecorder recorder(path, MakeDescription());
    for (int i = 0; i < 200; ++i)
    {
      Add(recorder, i);
    }
  }
  ExpectBeginning(path, 200);
}

TEST(SweepRecorder, OnAFullDiskSlicesWaitInMemoryAndAreWrittenLater)
{
  for (const int level : { 0, 6 })
  {
    const TemporaryFolder folder;
    const std::string path = folder / "sweep.mhd";
    SweepRecorder recorder(path, MakeDescription(), level);
    Add(recorder, 0);
    ASSERT_TRUE(Becomes(recorder, [](const auto& state) { return state.Written == 1; }));
    {
      const FileSizeLimit limit(2500);
      for (int i = 1; i < 50; ++i)
      {
        Add(recorder, i);
      }
      ASSERT_TRUE(Becomes(recorder, [](const auto& state) { return !state.Trouble.empty(); }));
      const SweepRecorder::State state = recorder.GetState();
      EXPECT_EQ(state.Added, 50);
      EXPECT_LT(state.Written, 50);
      EXPECT_EQ(state.WaitingBytes, (50 - state.Written) * 20);
      EXPECT_NE(state.Trouble.find("make room"), std::string::npos) << state.Trouble;
      EXPECT_NE(state.Trouble.find("sweep."), std::string::npos) << state.Trouble;
      try
      {
        recorder.Finish();
        FAIL() << "no complaint";
      }
      catch (const FileError& e)
      {
        EXPECT_EQ(e.GetKind(), FileError::Kind::NoSpace) << e.what();
      }
      ExpectBeginning(path, static_cast<std::size_t>(state.Written)); // whole up to there
      Add(recorder, 50);                                              // and it goes on
    }
    ASSERT_TRUE(Becomes(recorder, [](const auto& state) { return state.Synced == 51; }));
    EXPECT_EQ(recorder.GetState().Trouble, "");
    recorder.Finish();
    ExpectBeginning(path, 51);
  }
}

TEST(SweepRecorder, SaysWhenOnlyItsEndDoesNotFit)
{
  const TemporaryFolder folder;
  const std::string path = folder / "sweep.mhd";
  SweepRecorder recorder(path, MakeDescription(), 6);
  for (int i = 0; i < 30; ++i)
  {
    Add(recorder, i);
  }
  ASSERT_TRUE(Becomes(recorder, [](const auto& state) { return state.Synced == 30; }));
  {
    const FileSizeLimit limit(std::filesystem::file_size(folder / "sweep.zraw"));
    EXPECT_THROW(recorder.Finish(), FileError);
    const std::string trouble = recorder.GetState().Trouble;
    EXPECT_NE(trouble.find("All its slices can be read"), std::string::npos) << trouble;
    EXPECT_NE(trouble.find("sweep.zraw"), std::string::npos) << trouble;
    ExpectBeginning(path, 30);
  }
  recorder.Finish();
  EXPECT_EQ(recorder.GetState().Trouble, "");
  ExpectBeginning(path, 30);
  EXPECT_EQ(ReadBack(path).Warning, "");
}

TEST(SweepRecorder, EndsOnAFullDisk)
{
  const TemporaryFolder folder;
  const std::string path = folder / "sweep.mhd";
  const FileSizeLimit limit(2500);
  {
    SweepRecorder recorder(path, MakeDescription());
    for (int i = 0; i < 50; ++i)
    {
      Add(recorder, i);
    }
  }
  ExpectBeginning(path, 1);
}

// A hundred times, at random moments: what was said to be written is there.
TEST(SweepRecorder, KilledItLosesNothingThatWasWritten)
{
  std::mt19937 random(5);
  for (int round = 0; round < 100; ++round)
  {
    const TemporaryFolder folder;
    const std::string path = folder / (round % 2 ? "sweep.mhd" : "sweep.nhdr");
    int channel[2];
    ASSERT_EQ(pipe(channel), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0)
    {
      SweepRecorder recorder(path, MakeDescription(), round % 4 == 3 ? 1 : 0);
      for (int i = 0;; ++i)
      {
        Add(recorder, i);
        const std::int64_t written = recorder.GetState().Written;
        if (write(channel[1], &written, sizeof(written)) != sizeof(written))
        {
          break;
        }
      }
      _exit(1);
    }
    close(channel[1]);
    std::int64_t written = 0;
    const auto enough = static_cast<std::int64_t>(1 + random() % 40);
    while (written < enough && read(channel[0], &written, sizeof(written)) == sizeof(written))
    {
    }
    usleep(static_cast<useconds_t>(random() % 500));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the recorder ended by itself";
    while (read(channel[0], &written, sizeof(written)) == sizeof(written))
    {
    }
    close(channel[0]);
    ExpectBeginning(path, static_cast<std::size_t>(written));
    ASSERT_FALSE(HasFatalFailure()) << round;
  }
}

TEST(SweepRecorder, RefusesWhatItCannotWrite)
{
  const TemporaryFolder folder;
  SequenceDescription description = MakeDescription();
  description.Type = ScalarType::Int16;
  EXPECT_THROW(SweepRecorder(folder / "a.mhd", description), std::invalid_argument);
  EXPECT_THROW(SweepRecorder(folder / "a.mha", MakeDescription()), std::invalid_argument);
  EXPECT_THROW(SweepRecorder(folder / "none/a.mhd", MakeDescription()), FileError);
  SweepRecorder recorder(folder / "a.mhd", MakeDescription());
  EXPECT_THROW(SweepRecorder(folder / "a.mhd", MakeDescription()), FileError); // is there
  const auto pixels = std::make_shared<std::vector<std::uint8_t>>(20);
  EXPECT_THROW(recorder.Add(nullptr, {}), std::invalid_argument);
  EXPECT_THROW(
    recorder.Add(std::make_shared<std::vector<std::uint8_t>>(19), {}), std::invalid_argument);
  EXPECT_THROW(recorder.Add(pixels, { { "A", "two\nlines" } }), std::invalid_argument);
  recorder.Add(pixels, { { "A", "one line" } });
  recorder.Finish();
  EXPECT_EQ(ReadBack(folder / "a.mhd").Frames.size(), 1u);
}
