// SPDX-License-Identifier: BSD-3-Clause
#include "WrittenSequence.h"
#include "lacunaOutputFile.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <limits>

#include <sys/resource.h>

using namespace lacuna;

namespace
{
void Write(const std::string& path, const SequenceContent& content, int level, int threads = 2)
{
  ThreadExecution execution(threads);
  EXPECT_GT(WriteSequence(path, content, level, execution), 0);
}

std::string WriteError(
  const TemporaryFolder& folder, const SequenceContent& content, const std::string& name = "a.mha")
{
  return GetError([&] { Write(folder / name, content, 0); });
}

void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
}
}

TEST(SequenceWriter, EveryKindComesBack)
{
  for (const char* name : { "sweep.igs.mha", "sweep.mhd", "sweep.NRRD", "sweep.igs.nhdr" })
  {
    for (const int level : { 0, 1, 9 })
    {
      const TemporaryFolder folder;
      const SequenceContent content = MakeContent(7);
      Write(folder / name, content, level);
      const ReadBack read(folder / name);
      EXPECT_TRUE(read.Header.Warnings.empty()) << name;
      EXPECT_EQ(read.Warning, "");
      EXPECT_EQ(read.Header.Encoding, level ? PixelEncoding::Zlib : PixelEncoding::Raw);
      EXPECT_EQ(read.Header.CustomFields, content.Description.CustomFields) << name;
      EXPECT_EQ(read.Header.ImageType, "BRIGHTNESS");
      ASSERT_EQ(read.Frames.size(), 7u);
      for (int i = 0; i < 7; ++i)
      {
        const auto frame = static_cast<std::size_t>(i);
        EXPECT_EQ(read.Frames[frame], MakePixels(i)) << name << level;
        EXPECT_EQ(read.GetFields(frame), Sorted(MakeFields(i))) << name;
      }
    }
  }
}

TEST(SequenceWriter, FilesBesideTheHeader)
{
  const TemporaryFolder folder;
  Write(folder / "a.igs.mhd", MakeContent(2), 0);
  Write(folder / "b.mhd", MakeContent(2), 6);
  Write(folder / "c.nhdr", MakeContent(2), 0);
  Write(folder / "d.nhdr", MakeContent(2), 6);
  Write(folder / "e.mha", MakeContent(2), 6);
  EXPECT_EQ(folder.List(),
    (std::vector<std::string>{ "a.igs.mhd", "a.igs.raw", "b.mhd", "b.zraw", "c.nhdr", "c.raw",
      "d.nhdr", "d.raw.gz", "e.mha" }));
  EXPECT_EQ(ReadAll(folder / "a.igs.raw"), MakePixels(0) + MakePixels(1));
}

TEST(SequenceWriter, TheHeaderIsWhatOtherProgramsExpect)
{
  const TemporaryFolder folder;
  SequenceContent content = MakeContent(4);
  content.Description.ImageType = "RF_REAL";
  content.Description.Type = ScalarType::Int8;
  Write(folder / "a.mha", content, 6);
  const std::string text = ReadAll(folder / "a.mha");
  EXPECT_EQ(text.find("ObjectType = Image\nNDims = 3\n"), 0u);
  const auto padded = [](std::string value)
  {
    value.resize(40, ' ');
    return value + "\n";
  };
  ExpectContains(text, "\nDimSize = " + padded("5 4 4"));
  const std::string end = "ElementDataFile = LOCAL\n";
  const std::size_t pixels = text.find(end) + end.size();
  ExpectContains(text, "\nCompressedDataSize = " + padded(std::to_string(text.size() - pixels)));
  ExpectContains(text, "\nUltrasoundImageOrientation = FM\nUltrasoundImageType = RF_REAL\n");
  ExpectContains(text, "\nElementType = MET_CHAR\nKinds = domain domain list\n");
  ExpectContains(text,
    "\nSeq_Frame0003_FrameNumber = 103\nSeq_Frame0003_ProbeToTrackerTransform = 1 0 0 3 0 1 0 20 "
    "0 0 1 30 0 0 0 1\nSeq_Frame0003_ProbeToTrackerTransformStatus = OK\nSeq_Frame0003_Timestamp = "
    "13.25\nSeq_Frame0003_Zebra = sorted, but before ImageStatus\nSeq_Frame0003_ImageStatus = "
    "OK\nElementDataFile = LOCAL\n");
  Write(folder / "a.nrrd", content, 0);
  const std::string nrrd = ReadAll(folder / "a.nrrd");
  EXPECT_EQ(nrrd.find("NRRD0004\n"), 0u);
  ExpectContains(nrrd, "\nsizes: " + padded("5 4 4"));
  ExpectContains(nrrd, "\nultrasound image orientation:=FM\nultrasound image type:=RF_REAL\n");
  ExpectContains(nrrd, "\nA path:=C:\\\\new\\\\folder\n");
  ExpectContains(nrrd, "\nSeq_Frame0001_Status:=INVALID\n");
  ExpectContains(nrrd, "\nSeq_Frame0003_Status:=OK\n\n");
}

TEST(SequenceWriter, EveryType)
{
  const TemporaryFolder folder;
  for (int type = 0; type <= static_cast<int>(ScalarType::Float64); ++type)
  {
    SequenceContent content = MakeContent(2);
    content.Description.Type = static_cast<ScalarType>(type);
    const std::size_t size = GetScalarSize(content.Description.Type) * 20;
    std::string pixels;
    for (std::size_t i = 0; i < 2 * size; ++i)
    {
      pixels += static_cast<char>(i * 37 + static_cast<std::size_t>(type));
    }
    content.GetPixels = [&](std::int64_t frame)
    { return pixels.data() + static_cast<std::size_t>(frame) * size; };
    for (const char* name : { "a.mha", "a.nrrd" })
    {
      Write(folder / name, content, type % 2);
      const ReadBack read(folder / name);
      EXPECT_EQ(read.Header.Type, content.Description.Type);
      EXPECT_EQ(read.Frames.at(0) + read.Frames.at(1), pixels);
    }
  }
}

TEST(SequenceWriter, OverTenThousandFramesAndLongLines)
{
  const TemporaryFolder folder;
  SequenceContent content;
  content.Description.Columns = content.Description.Rows = 1;
  const std::string longText(70000, 'y');
  content.Frames.assign(10003, { { "ImageStatus", "OK" } });
  content.Frames[10002].emplace_back("Note", longText + " = z");
  const unsigned char pixel = 7;
  content.GetPixels = [&](std::int64_t) { return &pixel; };
  for (const char* name : { "a.mha", "a.nrrd" })
  {
    Write(folder / name, content, 0);
    const ReadBack read(folder / name);
    EXPECT_EQ(read.Frames.size(), 10003u);
    EXPECT_EQ(read.Header.FrameFields.at("Note")[10002], longText + " = z");
  }
}

TEST(SequenceWriter, TheSameForAnyNumberOfThreads)
{
  const TemporaryFolder folder;
  SequenceContent content;
  content.Description.Columns = 1000;
  content.Description.Rows = 700;
  content.Frames.assign(50, { { "ImageStatus", "OK" } }); // 35 MB: several batches of blocks
  std::vector<unsigned char> pixels(700000 + 50);
  for (std::size_t i = 0; i < pixels.size(); ++i)
  {
    pixels[i] = static_cast<unsigned char>((i * i >> 7) & 0x3f);
  }
  content.GetPixels = [&](std::int64_t frame) { return pixels.data() + frame; };
  for (const char* name : { "a.mha", "a.nrrd" })
  {
    std::string first;
    for (const int threads : { 1, 2, 5 })
    {
      Write(folder / name, content, 1, threads);
      const std::string bytes = ReadAll(folder / name);
      first = first.empty() ? bytes : first;
      EXPECT_TRUE(bytes == first) << threads;
    }
    const ReadBack read(folder / name); // to the check sum
    ASSERT_EQ(read.Frames.size(), 50u);
    for (std::size_t i = 0; i < 50; ++i)
    {
      ASSERT_EQ(std::memcmp(read.Frames[i].data(), pixels.data() + i, 700000), 0) << i;
    }
    EXPECT_LT(first.size(), 50u * 700000 / 2);
  }
}

TEST(SequenceWriter, WhatCannotBeWrittenIsNamed)
{
  const TemporaryFolder folder;
  SequenceContent content = MakeContent(3);
  const SequenceContent good = content;
  ExpectContains(WriteError(folder, good, "a.png"), "must end in .mha, .mhd, .nrrd or .nhdr");
  ExpectContains(WriteError(folder, good, "a%3d.mhd"), "cannot name its pixels 'a%3d.raw'");
  ExpectContains(WriteError(folder, good, "no/such/folder.mha"), "No such file");
  content.Frames[1].emplace_back("Two", "lines\nhere");
  ExpectContains(WriteError(folder, content),
    "field Two of frame 1 cannot be written: its text has a line break");
  EXPECT_EQ(WriteError(folder, content, "escaped.nrrd"), "");
  EXPECT_EQ(ReadBack(folder / "escaped.nrrd").Header.FrameFields.at("Two")[1], "lines\nhere");
  content = good;
  content.Frames[2].emplace_back("Timestamp", "1");
  ExpectContains(WriteError(folder, content),
    "field Timestamp of frame 2 cannot be written: it is "
    "given twice");
  for (const char* name : { "", " x", "a=b", "a\nb" })
  {
    content = good;
    content.Frames[0].emplace_back(name, "1");
    ExpectContains(WriteError(folder, content), "of frame 0 cannot be written: a field's name");
  }
  for (const char* name : { "DimSize", "elementdatafile", "Seq_Frame0000_X", "#comment" })
  {
    content = good;
    content.Description.CustomFields.emplace_back(name, "1");
    ExpectContains(WriteError(folder, content), "a meaning of its own");
  }
  content = good;
  content.Description.CustomFields.emplace_back("Sizes", "1");
  EXPECT_EQ(WriteError(folder, content), "");
  ExpectContains(WriteError(folder, content, "a.nrrd"), "a meaning of its own");
  content = good;
  content.Frames[0].emplace_back("Status", "fine");
  EXPECT_EQ(WriteError(folder, content), "");
  ExpectContains(WriteError(folder, content, "a.nrrd"), "how NRRD sequences call ImageStatus");
  content = good;
  content.Description.ImageType = "DOPPLER";
  ExpectContains(WriteError(folder, content), "'DOPPLER' is unknown");
  content = good;
  content.Description.Columns = 0;
  ExpectContains(WriteError(folder, content), "0 x 4 pixels");
  content = good;
  content.Frames.clear();
  ExpectContains(WriteError(folder, content), "without slices");
}

// A limit of the file size stands for a full disk: writing stops halfway.
TEST(SequenceWriter, AFullDiskLeavesWhatWasThere)
{
  for (const char* name : { "a.mha", "a.mhd", "a.nrrd", "a.nhdr" })
  {
    const TemporaryFolder folder;
    Write(folder / name, MakeContent(2), 0);
    const std::vector<std::string> before = folder.List();
    SequenceContent content = MakeContent(4);
    content.Description.Columns = content.Description.Rows = 1000;
    const std::vector<unsigned char> pixels(1000000);
    content.GetPixels = [&](std::int64_t) { return pixels.data(); };
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = limit;
    small.rlim_cur = 2500000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    FileError::Kind kind = FileError::Kind::Other;
    try
    {
      Write(folder / name, content, 0);
    }
    catch (const FileError& e)
    {
      kind = e.GetKind();
    }
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(kind, FileError::Kind::NoSpace);
    EXPECT_EQ(folder.List(), before);
    EXPECT_EQ(ReadBack(folder / name).Frames.size(), 2u);
  }
}

TEST(SequenceWriter, StopsWhenAsked)
{
  const TemporaryFolder folder;
  for (const int level : { 0, 1 })
  {
    SequenceContent content = MakeContent(40);
    content.Description.Columns = content.Description.Rows = 1000;
    const std::vector<unsigned char> pixels(1000000);
    content.GetPixels = [&](std::int64_t) { return pixels.data(); };
    ThreadExecution execution(1, [](double fraction) { return fraction < 0.4; });
    EXPECT_THROW(WriteSequence(folder / "a.mha", content, level, execution), Aborted);
    EXPECT_TRUE(folder.List().empty());
  }
}
