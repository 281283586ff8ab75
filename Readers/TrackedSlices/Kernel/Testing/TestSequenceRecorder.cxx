// SPDX-License-Identifier: BSD-3-Clause
#include "FileSizeLimit.h"
#include "WrittenSequence.h"
#include "lacunaSequenceRecorder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <random>

#include <sys/wait.h>
#include <unistd.h>

using namespace lacuna;

namespace
{
const char* const Names[] = { "take.igs.mhd", "take.nhdr" };

void Append(SequenceRecorder& recorder, int frame)
{
  recorder.Append(MakePixels(frame).data(), MakeFields(frame));
}

std::string GetDataName(const std::string& fileName, int level)
{
  return SequenceKind(fileName, level > 0).GetDataFileName();
}

/// Whether what is read are the first slices of the recording, without a false note.
::testing::AssertionResult IsBeginning(const ReadBack& read, std::size_t atLeast)
{
  if (read.Frames.size() < atLeast)
  {
    return ::testing::AssertionFailure() << read.Frames.size() << " slices, not " << atLeast;
  }
  for (std::size_t i = 0; i < read.Frames.size(); ++i)
  {
    if (read.Frames[i] != MakePixels(static_cast<int>(i)))
    {
      return ::testing::AssertionFailure() << "wrong pixels in slice " << i;
    }
    if (read.GetFields(i) != Sorted(MakeFields(static_cast<int>(i))))
    {
      return ::testing::AssertionFailure() << "wrong fields of slice " << i;
    }
  }
  return ::testing::AssertionSuccess();
}
}

TEST(SequenceRecorder, IsReadableAfterEverySlice)
{
  for (const char* name : Names)
  {
    for (const int level : { 0, 6 })
    {
      const TemporaryFolder folder;
      SequenceRecorder recorder(folder / name, MakeDescription(), level);
      EXPECT_NE(GetError([&] { ReadBack read(folder / name); }), ""); // nothing yet
      for (int i = 0; i < 12; ++i)
      {
        Append(recorder, i);
        EXPECT_EQ(recorder.GetNumberOfSlices(), i + 1);
        const ReadBack read(folder / name);
        ASSERT_TRUE(IsBeginning(read, static_cast<std::size_t>(i + 1))) << name << level;
        EXPECT_TRUE(read.Header.Warnings.empty());
        EXPECT_EQ(read.Warning, "");
      }
      recorder.Sync();
      recorder.Close();
      recorder.Close();
      const ReadBack read(folder / name);
      EXPECT_TRUE(IsBeginning(read, 12));
      EXPECT_EQ(read.Header.CustomFields, MakeDescription().CustomFields);
      EXPECT_EQ(read.Header.Encoding, level ? PixelEncoding::Zlib : PixelEncoding::Raw);
      EXPECT_EQ(read.Warning, "");
      EXPECT_THROW(Append(recorder, 12), std::invalid_argument);
    }
  }
}

TEST(SequenceRecorder, MakesTheSameFilesAsTheWriter)
{
  for (const char* name : Names)
  {
    const TemporaryFolder recorded;
    const TemporaryFolder written;
    {
      SequenceRecorder recorder(recorded / name, MakeDescription());
      for (int i = 0; i < 4; ++i)
      {
        Append(recorder, i);
      }
    }
    ThreadExecution execution;
    WriteSequence(written / name, MakeContent(4), 0, execution);
    EXPECT_EQ(recorded.List(), written.List());
    for (const std::string& file : written.List())
    {
      EXPECT_EQ(ReadAll(recorded / file), ReadAll(written / file)) << file;
    }
  }
}

TEST(SequenceRecorder, CutOffAnywhereItIsReadableUpToTheLastWholeSlice)
{
  for (const char* name : Names)
  {
    for (const int level : { 0, 6 })
    {
      const TemporaryFolder folder;
      const std::string dataName = GetDataName(folder / name, level);
      std::vector<std::size_t> headerSizes; // after each slice, without the header's end
      std::vector<std::size_t> dataSizes;
      {
        SequenceRecorder recorder(folder / name, MakeDescription(), level);
        const std::size_t end = SequenceKind(folder / name, level > 0).GetEnd().size();
        for (int i = 0; i < 4; ++i)
        {
          Append(recorder, i);
          headerSizes.push_back(std::filesystem::file_size(folder / name) - end);
          dataSizes.push_back(std::filesystem::file_size(dataName));
        }
      }
      const std::string header = ReadAll(folder / name);
      const std::string data = ReadAll(dataName);
      const auto check = [&](std::size_t headerSize, std::size_t dataSize)
      {
        std::filesystem::resize_file(folder / name, headerSize);
        std::filesystem::resize_file(dataName, dataSize);
        std::size_t whole = 0;
        while (whole < 4 && headerSizes[whole] <= headerSize && dataSizes[whole] <= dataSize)
        {
          ++whole;
        }
        if (whole == 0 && level == 0)
        {
          const std::string error = GetError([&] { ReadBack read(folder / name); });
          ASSERT_NE(error, "") << headerSize << " " << dataSize;
        }
        if (whole == 0)
        {
          return;
        }
        const ReadBack read(folder / name);
        ASSERT_TRUE(IsBeginning(read, whole)) << name << " " << headerSize << " " << dataSize;
        if (level == 0) // the last bytes of a compressed slice may be a mark that nothing needs
        {
          ASSERT_EQ(read.Frames.size(), whole) << name << " " << headerSize << " " << dataSize;
        }
      };
      // cut from behind, so that the rest of the file is always there
      for (std::size_t size = data.size(); size-- > 0;)
      {
        check(header.size(), size);
        ASSERT_FALSE(HasFatalFailure());
      }
      {
        std::ofstream(dataName, std::ios::binary) << data;
      }
      for (std::size_t size = header.size(); size-- > 0;)
      {
        check(size, data.size());
        ASSERT_FALSE(HasFatalFailure());
      }
      std::mt19937 random(5);
      for (int round = 0; round < 100; ++round)
      {
        {
          std::ofstream(folder / name, std::ios::binary) << header;
        }
        {
          std::ofstream(dataName, std::ios::binary) << data;
        }
        check(random() % header.size(), random() % data.size());
        ASSERT_FALSE(HasFatalFailure());
      }
    }
  }
}

TEST(SequenceRecorder, AFullDiskLosesNothingAndTheRecordingGoesOn)
{
  for (const char* name : Names)
  {
    for (const int level : { 0, 6 })
    {
      // Every size at which the disk may be full, and some more room later.
      const std::size_t step = 13;
      bool reached = false;
      for (std::size_t size = 1000; !reached; size += step)
      {
        const TemporaryFolder folder;
        std::unique_ptr<SequenceRecorder> recorder;
        int refused = -1;
        {
          const FileSizeLimit limit(size);
          const std::string error = GetError(
            [&]
            {
              recorder =
                std::make_unique<SequenceRecorder>(folder / name, MakeDescription(), level);
              for (int i = 0; i < 5; ++i)
              {
                refused = i;
                Append(*recorder, i);
              }
              refused = -1;
            });
          reached = error.empty();
          if (!reached)
          {
            EXPECT_NE(error.find("cannot write '" + (folder / "take")), std::string::npos) << error;
          }
        }
        if (!recorder)
        {
          EXPECT_TRUE(folder.List().empty());
          continue;
        }
        if (refused >= 0)
        {
          if (refused > 0)
          {
            const ReadBack read(folder / name); // as if nothing had happened
            ASSERT_TRUE(IsBeginning(read, static_cast<std::size_t>(refused))) << size;
            ASSERT_EQ(read.Frames.size(), static_cast<std::size_t>(refused));
            EXPECT_TRUE(read.Header.Warnings.empty()) << size << read.Header.Warnings[0];
            EXPECT_EQ(read.Warning, "");
          }
          for (int i = refused; i < 5; ++i) // there is room again
          {
            Append(*recorder, i);
          }
        }
        recorder->Close();
        const ReadBack read(folder / name);
        ASSERT_TRUE(IsBeginning(read, 5)) << name << size;
        EXPECT_EQ(read.Warning, "");
      }
    }
  }
}

TEST(SequenceRecorder, KilledAtRandomMomentsItLosesNoSlice)
{
  std::mt19937 random(11);
  for (int round = 0; round < 40; ++round)
  {
    const TemporaryFolder folder;
    const int level = round % 4 == 3 ? 1 : 0;
    const std::string path = folder / Names[round % 2];
    int channel[2];
    ASSERT_EQ(pipe(channel), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0)
    {
      try
      {
        SequenceRecorder recorder(path, MakeDescription(), level);
        for (int i = 0; i < 100000; ++i)
        {
          Append(recorder, i);
          const char done = 1; // a slice that the recorder has taken
          if (write(channel[1], &done, 1) != 1)
          {
            break;
          }
        }
      }
      catch (...)
      {
      }
      _exit(1);
    }
    close(channel[1]);
    std::size_t taken = 0;
    char done = 0;
    const std::size_t enough = 1 + random() % 50;
    while (taken < enough && read(channel[0], &done, 1) == 1)
    {
      ++taken;
    }
    usleep(static_cast<useconds_t>(random() % 500));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the recorder ended by itself";
    while (read(channel[0], &done, 1) == 1)
    {
      ++taken;
    }
    close(channel[0]);
    const ReadBack recording(path);
    ASSERT_TRUE(IsBeginning(recording, taken)) << round;
  }
}

TEST(SequenceRecorder, RefusesWhatItCannotDo)
{
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name)
  { return GetError([&] { SequenceRecorder recorder(folder / name, MakeDescription()); }); };
  for (const char* name : { "a.mha", "a.nrrd" })
  {
    EXPECT_NE(error(name).find("cannot grow; record to .mhd or .nhdr"), std::string::npos);
  }
  EXPECT_NE(error("a.txt"), "");
  EXPECT_NE(error("no/folder.mhd").find("No such file"), std::string::npos);
  EXPECT_TRUE(folder.List().empty());
  {
    std::ofstream(folder / "a.mhd") << "old header";
  }
  EXPECT_NE(error("a.mhd").find("File exists"), std::string::npos);
  EXPECT_EQ(folder.List(), (std::vector<std::string>{ "a.mhd" }));
  {
    std::ofstream(folder / "b.raw") << "old pixels";
  }
  EXPECT_NE(error("b.mhd").find("b.raw': File exists"), std::string::npos);
  EXPECT_EQ(ReadAll(folder / "a.mhd") + ReadAll(folder / "b.raw"), "old headerold pixels");

  SequenceRecorder recorder(folder / "c.mhd", MakeDescription());
  Append(recorder, 0);
  EXPECT_THROW(
    recorder.Append(MakePixels(1).data(), { { "Bad=Name", "1" } }), std::invalid_argument);
  Append(recorder, 1);
  recorder.Append(MakePixels(2).data(), { { "Only", "this" } });
  const ReadBack read(folder / "c.mhd");
  EXPECT_EQ(read.Frames.size(), 3u);
  EXPECT_EQ(read.Header.FrameFields.at("ImageStatus")[2], "OK");
}
