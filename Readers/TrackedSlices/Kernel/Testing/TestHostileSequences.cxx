// SPDX-License-Identifier: BSD-3-Clause
// Whatever the bytes are, reading them ends in a sentence or in a consistent result. Most telling
// under the address and undefined-behaviour sanitizers.
#include "Compress.h"
#include "NrrdFile.h"
#include "SequenceFile.h"
#include "lacunaProcessMemory.h"
#include "lacunaSliceStack.h"
#include "lacunaSweep.h"

#include <gtest/gtest.h>

#include <random>

using namespace lacuna;

namespace
{
class HostileSequences : public ::testing::Test
{
protected:
  // Reads all there is; returns whether that worked.
  bool Survives(const std::string& content, const std::string& calibration = MakeCalibration())
  {
    this->File.Write(content);
    this->File.WriteBeside("calibration.xml", calibration);
    IsTrackedSequence(this->File.GetPath());
    try
    {
      this->ReadEverything();
      return true;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_GT(std::string(e.what()).size(), 20u) << "not much of a message: " << e.what();
      return false;
    }
  }

  void ReadEverything()
  {
    const SequenceHeader header = ReadSequenceHeader(this->File.GetPath());
    const auto pixels = PixelSource::Open(header);
    ASSERT_GE(pixels->GetNumberOfWholeFrames(), 1);
    ASSERT_LE(pixels->GetNumberOfWholeFrames(), header.Frames);
    SweepOptions options;
    options.CalibrationFileName =
      (std::filesystem::path(this->File.GetPath()).parent_path() / "calibration.xml").string();
    options.FramesWithPixels = pixels->GetNumberOfWholeFrames();
    const Sweep sweep = BuildSweep(header, options);
    const auto frames = static_cast<std::size_t>(header.Frames);
    ASSERT_EQ(sweep.Status.size(), frames);
    ASSERT_EQ(sweep.FrameNumbers.size(), frames);
    ASSERT_EQ(sweep.ImageToReference.size(), frames);
    for (std::size_t i = 0; i < frames; ++i)
    {
      ASSERT_EQ(sweep.ImageToReference[i].IsFinite(), (sweep.Status[i] & Sweep::PoseInvalid) == 0);
    }
    SliceRegion all;
    all.Columns = header.Columns;
    all.Rows = header.Rows;
    all.Frames = header.Frames;
    const std::int64_t size = header.Columns * header.Rows * header.Frames *
      static_cast<std::int64_t>(GetScalarSize(pixels->GetScalarType()));
    ASSERT_LT(size, 10000000) << "more than a file of this size can hold";
    std::vector<unsigned char> stack(static_cast<std::size_t>(size));
    ThreadExecution execution(1);
    ReadSliceStack(header, *pixels, all, stack.data(), execution);
  }

  TemporaryFile File{ "sweep.igs.mha" };
};

SequenceFile MakeRich()
{
  SequenceFile file = MakeSequence(3);
  file.Set("ElementNumberOfChannels", "1");
  file.Set("ElementSpacing", "1 1 1");
  file.SetFrame(1, "Note", "a custom text = with a sign");
  file.SetFrame(2, "FrameNumber", "42");
  return file;
}

std::string MakeRichNrrd(const std::string& encoding)
{
  NrrdFile file = MakeNrrd(3);
  file.Set("encoding", encoding);
  file.Set("byte skip", "0");
  file.SetPair("key", R"(a value with \n and \\)");
  file.SetFrame(1, "Note", "a custom text := with a sign");
  file.Pixels = encoding == "gzip" ? Gzip(file.Pixels)
    : encoding == "hex"            ? ToHex(file.Pixels)
    : encoding == "text"           ? ToText(file.Pixels)
                                   : file.Pixels;
  return file.GetContent();
}
}

TEST_F(HostileSequences, TheGoodFilesAreGood)
{
  EXPECT_TRUE(this->Survives(MakeRich().GetContent()));
  EXPECT_TRUE(this->Survives(Compressed(MakeRich()).GetContent()));
  for (const char* encoding : { "raw", "gzip", "hex", "text" })
  {
    EXPECT_TRUE(this->Survives(MakeRichNrrd(encoding))) << encoding;
  }
}

TEST_F(HostileSequences, CutOffAnywhere)
{
  for (const SequenceFile& file : { MakeRich(), Compressed(MakeRich()) })
  {
    const std::string content = file.GetContent();
    const std::size_t header = file.GetHeader().size();
    for (std::size_t size = 0; size < content.size(); ++size)
    {
      const bool good = this->Survives(content.substr(0, size));
      ASSERT_FALSE(good && size < header - 1) << size; // the last line feed may be missing
    }
  }
}

TEST_F(HostileSequences, NrrdCutOffAnywhere)
{
  const std::string content = MakeRichNrrd("gzip");
  const std::size_t header = content.find("\n\n") + 2;
  for (std::size_t size = 0; size < content.size(); ++size)
  {
    const bool good = this->Survives(content.substr(0, size));
    ASSERT_FALSE(good && size < header) << size;
  }
}

TEST_F(HostileSequences, EveryByteReplaced)
{
  for (const std::string& content : { MakeRich().GetContent(), Compressed(MakeRich()).GetContent(),
         MakeRichNrrd("raw"), MakeRichNrrd("text") })
  {
    for (std::size_t at = 0; at < content.size(); ++at)
    {
      const char bytes[] = { '\0', '\n', ' ', '=', '-', '9', '\xff' };
      std::string bad = content;
      bad[at] = bytes[at % 7];
      this->Survives(bad);
      ASSERT_FALSE(this->HasFatalFailure()) << at << " " << static_cast<int>(bad[at]);
    }
  }
}

// Each "To" is a way to read a name; a megabyte of them took hundreds of gigabytes.
TEST_F(HostileSequences, NamesOfManyFrames)
{
  for (const std::size_t length : { std::size_t{ 200 }, std::size_t{ 1000000 } })
  {
    SequenceFile file = MakeRich();
    std::string name;
    while (name.size() < length)
    {
      name += "AToB";
    }
    file.Append(0, name + "Transform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
    const double before = GetProcessMemory("VmHWM");
    EXPECT_EQ(this->Survives(file.GetContent()), length < 256);
    EXPECT_LT(GetProcessMemory("VmHWM") - before, 100e6);
  }
}

TEST_F(HostileSequences, RandomDamage)
{
  std::mt19937 random(20240229);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  const std::string contents[] = { MakeRich().GetContent(), Compressed(MakeRich()).GetContent(),
    MakeRichNrrd("raw"), MakeRichNrrd("gzip"), MakeRichNrrd("hex"), MakeRichNrrd("text") };
  const std::string words[] = { "99999999999", "-1", "nan", "1e999", "Seq_Frame", "= ", "MET_LONG",
    "domain", "list", "True", "LOCAL", "To", "Transform", "0 0 0", "CompressedData = True\n",
    "DimSize = 1 1 1\n", "UltrasoundImageOrientation = UN\n", "ElementNumberOfChannels = 3\n",
    "byte skip: ", "encoding: hex\n", "vector", "\n\n", ":=" };
  for (int round = 0; round < 6000; ++round)
  {
    std::string bad = contents[round % 6];
    for (std::size_t k = 1 + below(6); k > 0 && !bad.empty(); --k)
    {
      const std::size_t at = below(bad.size());
      const std::size_t length = below(40);
      switch (below(5))
      {
        case 0:
          bad[at] = static_cast<char>(random());
          break;
        case 1:
          bad.erase(at, length);
          break;
        case 2:
          bad.insert(at, bad.substr(below(bad.size()), length));
          break;
        case 3:
          bad.insert(at, words[below(std::size(words))]);
          break;
        default:
        {
          // swap two lines' worth of text
          const std::size_t other = below(bad.size());
          std::swap(bad[at], bad[other]);
          break;
        }
      }
    }
    this->Survives(bad);
    ASSERT_FALSE(this->HasFatalFailure()) << "round " << round;
  }
}

TEST_F(HostileSequences, DamagedCalibrations)
{
  const std::string content = MakeRich().GetContent();
  const std::string calibration = MakeCalibration();
  for (std::size_t at = 0; at < calibration.size(); ++at)
  {
    this->Survives(content, calibration.substr(0, at));
    for (const char c : { '\0', '<', '>', '"', ' ', '9', '&', '\xff' })
    {
      std::string bad = calibration;
      bad[at] = c;
      this->Survives(content, bad);
      ASSERT_FALSE(this->HasFatalFailure()) << at;
    }
  }
}
