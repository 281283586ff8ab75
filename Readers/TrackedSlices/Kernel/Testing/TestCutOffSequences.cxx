// SPDX-License-Identifier: BSD-3-Clause
// Files of every kind cut off at every byte: what is read is right, and what is not is said.
#include "WrittenSequence.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr int Frames = 4;
constexpr std::size_t FrameSize = 20;

struct Kind
{
  const char* Name;
  const char* DataName; // null: in the same file
  int Level;
};
const Kind Kinds[] = { { "sweep.mha", nullptr, 0 }, { "sweep.mha", nullptr, 1 },
  { "sweep.mhd", "sweep.raw", 0 }, { "sweep.mhd", "sweep.zraw", 1 }, { "sweep.nrrd", nullptr, 0 },
  { "sweep.nrrd", nullptr, 1 }, { "sweep.nhdr", "sweep.raw", 0 },
  { "sweep.nhdr", "sweep.raw.gz", 1 } };

std::string DescribeKind(const Kind& kind)
{
  return kind.Name + std::string(" level ") + std::to_string(kind.Level);
}

void WriteFile(const std::string& path, const std::string& content)
{
  std::ofstream(path, std::ios::binary) << content;
}

class CutOffSequences : public ::testing::TestWithParam<Kind>
{
protected:
  void SetUp() override
  {
    ThreadExecution execution(1);
    WriteSequence(
      this->Folder / this->GetParam().Name, MakeContent(Frames), this->GetParam().Level, execution);
  }

  /// How many whole frames are read, all of them right; -1: an error that names the file.
  int Read()
  {
    try
    {
      const ReadBack read(this->Folder / this->GetParam().Name);
      for (std::size_t i = 0; i < read.Frames.size(); ++i)
      {
        EXPECT_EQ(read.Frames[i], MakePixels(static_cast<int>(i))) << i;
        EXPECT_EQ(Sorted(read.GetFields(i)), Sorted(MakeFields(static_cast<int>(i)))) << i;
      }
      const auto count = static_cast<int>(read.Frames.size());
      if (count < Frames) // said by the header or by the pixels
      {
        EXPECT_FALSE(read.Warning.empty() && read.Header.Warnings.empty()) << count;
      }
      return count;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_NE(std::string(e.what()).find(this->Folder / "sweep."), std::string::npos) << e.what();
      EXPECT_GT(std::string(e.what()).size(), std::string(this->Folder / "sweep.").size() + 10);
      return -1;
    }
  }

  TemporaryFolder Folder;
};
}

TEST_P(CutOffSequences, Pixels)
{
  const Kind& kind = this->GetParam();
  ASSERT_EQ(this->Read(), Frames);
  const std::string path = this->Folder / (kind.DataName ? kind.DataName : kind.Name);
  const std::string content = ReadAll(path);
  const std::string header = ReadAll(this->Folder / kind.Name);
  const bool metaImage = std::string(kind.Name).find(".mh") != std::string::npos;
  const std::string end = metaImage ? "ElementDataFile = LOCAL\n" : "\n\n";
  const std::size_t start = kind.DataName ? 0 : header.find(end) + end.size();
  int before = -1;
  for (std::size_t size = start; size < content.size(); ++size)
  {
    WriteFile(path, content.substr(0, size));
    const int count = this->Read();
    if (kind.Level == 0)
    {
      const int whole = static_cast<int>((size - start) / FrameSize);
      ASSERT_EQ(count, whole > 0 ? whole : -1) << size;
    }
    ASSERT_GE(count, before) << size; // more bytes, no fewer frames
    before = count;
  }
  ASSERT_GE(before, Frames - 1); // a check sum at the end may be all that is missing
}

TEST_P(CutOffSequences, Header)
{
  const Kind& kind = this->GetParam();
  const std::string path = this->Folder / kind.Name;
  const std::string content = ReadAll(path);
  const bool metaImage = std::string(kind.Name).find(".mh") != std::string::npos;
  const std::string end = metaImage ? "ElementDataFile = LOCAL\n" : "\n\n";
  const std::size_t size = kind.DataName ? content.size() : content.find(end) + end.size();
  int before = -1;
  for (std::size_t cut = 0; cut < size; ++cut)
  {
    WriteFile(path, content.substr(0, cut));
    const int count = this->Read();
    if (!kind.DataName)
    {
      ASSERT_EQ(count, -1) << cut; // the pixels are gone with the end of the header
    }
    ASSERT_GE(count, before) << cut;
    before = count;
    if (kind.DataName && cut > 0)
    {
      WriteFile(path, content.substr(0, cut) + std::string(cut % 2 ? 300 : 40000, '\0'));
      ASSERT_EQ(this->Read(), count) << cut << " and zeros, as after a power cut";
    }
  }
  // in .nhdr the last line of the last frame is that which lacks its end
  ASSERT_GE(before, kind.DataName ? (metaImage ? Frames : Frames - 1) : -1);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, CutOffSequences, ::testing::ValuesIn(Kinds),
  [](const auto& info)
  {
    std::string name = DescribeKind(info.param);
    std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
    return name;
  });
