// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a recording whose files are taken away, or changed, by others.
#include "WrittenSequence.h"
#include "lacunaClock.h"
#include "lacunaOutputFile.h"
#include "lacunaSweepRecorder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <unistd.h>

using namespace lacuna;
namespace fs = std::filesystem;

namespace
{
struct Harm
{
  const char* Name;
  bool AllIsLeft; // else a part of the pixels is gone
  std::function<void(const fs::path& header, const fs::path& data)> Do;
};

const Harm Harms[] = {
  { "the folder is removed", true,
    [](const fs::path& header, const fs::path&) { fs::remove_all(header.parent_path()); } },
  { "the folder is renamed", true,
    [](const fs::path& header, const fs::path&)
    { fs::rename(header.parent_path(), header.parent_path().string() + "-moved"); } },
  { "the pixels are renamed", true,
    [](const fs::path&, const fs::path& data) { fs::rename(data, data.string() + ".old"); } },
  { "the header is removed", true,
    [](const fs::path& header, const fs::path&) { fs::remove(header); } },
  { "the pixels are replaced", true,
    [](const fs::path&, const fs::path& data)
    {
      fs::copy_file(data, data.string() + ".copy");
      fs::rename(data.string() + ".copy", data);
    } },
  { "the pixels are cut off", false,
    [](const fs::path&, const fs::path& data) { fs::resize_file(data, 45); } },
  { "the pixels are emptied", false,
    [](const fs::path&, const fs::path& data) { fs::resize_file(data, 0); } },
};

void Add(SweepRecorder& recorder, int frame)
{
  const std::string pixels = MakePixels(frame);
  recorder.Add(
    std::make_shared<std::vector<std::uint8_t>>(pixels.begin(), pixels.end()), MakeFields(frame));
}

// Waits for a state, and returns how long that took, s; a minute at most.
double WaitFor(
  const SweepRecorder& recorder, const std::function<bool(const SweepRecorder::State&)>& condition)
{
  const SteadyClock clock;
  const double begin = clock.Now();
  while (!condition(recorder.GetState()) && clock.Now() < begin + 60)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(condition(recorder.GetState()));
  return clock.Now() - begin;
}

// Whether a file has these frames and no others.
void ExpectFrames(const std::string& path, const std::vector<int>& frames)
{
  const ReadBack read(path);
  ASSERT_EQ(read.Frames.size(), frames.size()) << path;
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    ASSERT_EQ(read.Frames[i], MakePixels(frames[i])) << path << " " << i;
    ASSERT_EQ(read.GetFields(i), Sorted(MakeFields(frames[i]))) << path << " " << i;
  }
}

std::vector<int> Range(int begin, int end)
{
  std::vector<int> numbers;
  for (int i = begin; i < end; ++i)
  {
    numbers.push_back(i);
  }
  return numbers;
}
}

TEST(LostRecording, IsToldAndWrittenElsewhere)
{
  for (const Harm& harm : Harms)
  {
    for (const auto& [name, level] : { std::pair("sweep.mhd", 0), std::pair("sweep.nhdr", 6) })
    {
      for (const bool goesOn : { true, false }) // the capture
      {
        if (!goesOn && level > 0)
        {
          continue;
        }
        SCOPED_TRACE(std::string(harm.Name) + ", " + name + (goesOn ? ", goes on" : ", pauses"));
        const TemporaryFolder place;
        fs::create_directory(place / "sweeps");
        const std::string path = place / ("sweeps/" + std::string(name));
        SweepRecorder recorder(path, MakeDescription(), level);
        for (int i = 0; i < 20; ++i)
        {
          Add(recorder, i);
        }
        WaitFor(recorder, [](const auto& now) { return now.Synced == 20; });
        EXPECT_EQ(recorder.GetState().Notice, "");

        harm.Do(path, SequenceKind(path, level > 0).GetDataFileName());
        const int end = goesOn ? 30 : 20;
        for (int i = 20; i < end; ++i)
        {
          Add(recorder, i);
        }
        const double told = WaitFor(recorder, [](const auto& now) { return !now.Notice.empty(); });
        EXPECT_LT(told, 2) << "s";
        EXPECT_NE(recorder.GetState().Notice.find("sweeps/sweep."), std::string::npos);

        bool complained = false;
        try
        {
          recorder.Finish();
        }
        catch (const FileError& e)
        {
          complained = true;
          EXPECT_NE(std::string(e.what()).find("only in the memory"), std::string::npos)
            << e.what();
        }
        const SweepRecorder::State state = recorder.GetState();
        std::vector<int> left = Range(0, 20);
        if (!harm.AllIsLeft)
        {
          ASSERT_GT(state.Lost, 0);
          left.resize(static_cast<std::size_t>(20 - state.Lost));
          if (level == 0) // raw pixels of 20 bytes
          {
            EXPECT_EQ(
              state.Lost, std::string(harm.Name).find("emptied") != std::string::npos ? 20 : 18);
          }
        }
        EXPECT_EQ(complained, !harm.AllIsLeft);
        EXPECT_EQ(state.Lost, 20 - static_cast<std::int64_t>(left.size()));
        const std::vector<int> added = Range(20, end);
        left.insert(left.end(), added.begin(), added.end());
        EXPECT_EQ(state.Added, end);
        EXPECT_EQ(state.Synced, static_cast<std::int64_t>(left.size()));
        EXPECT_EQ(state.Verified, state.Synced);
        EXPECT_EQ(state.WaitingBytes, 0);
        EXPECT_EQ(state.Trouble, "");
        EXPECT_NE(state.FileName, path);
        EXPECT_NE(state.Notice.find("'" + state.FileName + "'"), std::string::npos) << state.Notice;
        if (left.empty())
        {
          EXPECT_THROW(ReadBack read(state.FileName), std::runtime_error);
        }
        else
        {
          ExpectFrames(state.FileName, left);
        }
      }
    }
  }
}

// Nobody looks at the content of files all the time; what ends the capture does.
TEST(LostRecording, WhatOthersHaveChangedIsFoundWhenItIsReadBack)
{
  for (const auto& [name, level] : { std::pair("sweep.mhd", 0), std::pair("sweep.mhd", 6) })
  {
    const TemporaryFolder folder;
    SweepRecorder recorder(folder / name, MakeDescription(), level);
    for (int i = 0; i < 20; ++i)
    {
      Add(recorder, i);
    }
    recorder.Verify();
    WaitFor(recorder, [](const auto& now) { return now.Verified == 20; });
    Add(recorder, 20);
    recorder.Verify();
    WaitFor(recorder, [](const auto& now) { return now.Verified == 21; });
    EXPECT_EQ(recorder.GetState().Notice, "");
    for (int i = 21; i < 40; ++i)
    {
      Add(recorder, i);
    }
    WaitFor(recorder, [](const auto& now) { return now.Synced == 40; });
    {
      std::fstream header(folder / name, std::ios::in | std::ios::out);
      std::string text(std::istreambuf_iterator<char>(header), {});
      const std::size_t at = text.find("40.25"); // the time of slice 30
      ASSERT_NE(at, std::string::npos);
      header.seekp(static_cast<std::streamoff>(at));
      header << "99.25";
    }
    recorder.Finish(); // the pixels are there, and the fields in memory
    EXPECT_EQ(recorder.GetState().FileName, folder / "sweep-2.mhd");
    EXPECT_NE(recorder.GetState().Notice.find("slice 30"), std::string::npos)
      << recorder.GetState().Notice;
    EXPECT_EQ(recorder.GetState().Verified, 40);
    ExpectFrames(folder / "sweep-2.mhd", Range(0, 40));
  }
}

TEST(LostRecording, ChangedPixelsAreFoundWhenTheyAreReadBack)
{
  const TemporaryFolder folder;
  SweepRecorder recorder(folder / "sweep.mhd", MakeDescription());
  for (int i = 0; i < 40; ++i)
  {
    Add(recorder, i);
  }
  WaitFor(recorder, [](const auto& now) { return now.Synced == 40; });
  {
    std::fstream pixels(folder / "sweep.raw", std::ios::in | std::ios::out | std::ios::binary);
    pixels.seekp(20 * 33 + 7);
    pixels.put(static_cast<char>(MakePixels(33)[7] + 1));
  }
  EXPECT_THROW(recorder.Finish(), FileError);
  EXPECT_EQ(recorder.GetState().Lost, 1);
  std::vector<int> others = Range(0, 40);
  others.erase(others.begin() + 33);
  ExpectFrames(folder / "sweep-2.mhd", others);
  EXPECT_EQ(recorder.GetState().Verified, 39);
  EXPECT_THROW(recorder.Finish(), FileError); // as long as nobody gives it up
}

// A disk that gives back other slices, however often they are written, does not fill with copies.
TEST(LostRecording, IsNotWrittenAnewForEver)
{
  const TemporaryFolder folder;
  SweepRecorder recorder(folder / "sweep.mhd", MakeDescription());
  SequenceFields fields; // more than are read
  for (int i = 0; i < 1100; ++i)
  {
    fields.emplace_back("Field" + std::to_string(i), "1");
  }
  const std::string pixels = MakePixels(0);
  recorder.Add(std::make_shared<std::vector<std::uint8_t>>(pixels.begin(), pixels.end()), fields);
  recorder.Verify();
  WaitFor(recorder,
    [&](const auto& now) { return !now.Trouble.empty() || fs::exists(folder / "sweep-9.mhd"); });
  EXPECT_FALSE(fs::exists(folder / "sweep-5.mhd"));
  EXPECT_THROW(recorder.Finish(), FileError);
  const SweepRecorder::State state = recorder.GetState();
  EXPECT_NE(state.Trouble.find("sweep-4.mhd' was changed: its slice 0 is not what was recorded, as "
                               "in 3 files before: the disk may be failing"),
    std::string::npos)
    << state.Trouble;
  EXPECT_EQ(state.Synced, 1);
  EXPECT_EQ(state.Verified, 0);
}

// The new one is lost, too, and at last there is no place: what comes then waits in memory.
TEST(LostRecording, IsFollowedFromPlaceToPlace)
{
  const TemporaryFolder place;
  fs::create_directories(place / "a/b");
  SweepRecorder recorder(place / "a/b/sweep.mhd", MakeDescription());
  Add(recorder, 0);
  WaitFor(recorder, [](const auto& now) { return now.Synced == 1; });
  fs::remove_all(place / "a/b");
  WaitFor(recorder, [](const auto& now) { return now.Synced == 1 && !now.Notice.empty(); });
  EXPECT_EQ(recorder.GetState().FileName, place / "a/sweep.mhd");
  Add(recorder, 1);
  WaitFor(recorder, [](const auto& now) { return now.Synced == 2; });
  fs::remove(place / "a/sweep.raw");
  WaitFor(recorder, [&](const auto& now) { return now.FileName == place / "a/sweep-2.mhd"; });
  Add(recorder, 2);
  recorder.Finish();
  ExpectFrames(place / "a/sweep-2.mhd", { 0, 1, 2 });
  EXPECT_EQ(recorder.GetState().Verified, 3);
}

// A program may go to another folder: a name without one is of the folder where it began.
TEST(LostRecording, ARelativeNameIsNotLostInAnotherFolder)
{
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder / "");
  SweepRecorder recorder("sweep.mhd", MakeDescription());
  fs::current_path(before);
  Add(recorder, 0);
  WaitFor(recorder, [](const auto& now) { return now.Synced == 1; });
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  recorder.Finish();
  EXPECT_EQ(recorder.GetState().Notice, "");
  EXPECT_EQ(recorder.GetState().FileName, "sweep.mhd");
  ExpectFrames(folder / "sweep.mhd", { 0 });
}
