// SPDX-License-Identifier: BSD-3-Clause
// DICOM files made byte by byte, whole, cut off anywhere and damaged at random.
#include "lacunaDicomDataSet.h"
#include "lacunaDicomFolder.h"
#include "lacunaDicomHeader.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <unistd.h>

using namespace lacuna;

namespace
{
class Temporary
{
public:
  Temporary()
    : Path(std::filesystem::temp_directory_path() / ("lacuna-dicom-" + std::to_string(getpid())))
  {
    std::filesystem::create_directories(this->Path);
  }
  ~Temporary() { std::filesystem::remove_all(this->Path); }
  std::string Write(const std::string& bytes, const std::string& name = "file") const
  {
    const std::string path = (this->Path / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::filesystem::path Path;
};

std::string Number(std::uint32_t number, int bytes)
{
  std::string text;
  for (int i = 0; i < bytes; ++i)
  {
    text += static_cast<char>(number >> 8 * i & 0xFF);
  }
  return text;
}

std::string Tag(DicomTag tag)
{
  return Number(tag >> 16, 2) + Number(tag & 0xFFFF, 2);
}

std::string Short(DicomTag tag, const std::string& vr, std::string value)
{
  value += value.size() % 2 ? " " : "";
  return Tag(tag) + vr + Number(static_cast<std::uint32_t>(value.size()), 2) + value;
}

std::string Long(DicomTag tag, const std::string& vr, const std::string& value, bool open = false)
{
  return Tag(tag) + vr + Number(0, 2) +
    Number(open ? 0xFFFFFFFF : static_cast<std::uint32_t>(value.size()), 4) + value;
}

std::string Implicit(DicomTag tag, const std::string& value, bool open = false)
{
  return Tag(tag) + Number(open ? 0xFFFFFFFF : static_cast<std::uint32_t>(value.size()), 4) + value;
}

const std::string ItemEnd = Tag(0xFFFEE00D) + Number(0, 4);
const std::string SequenceEnd = Tag(0xFFFEE0DD) + Number(0, 4);

std::string Head(const std::string& syntax)
{
  const std::string meta = Short(0x00020010, "UI", syntax);
  return std::string(128, '\0') + "DICM" + Short(0x00020000, "UL", Number(60, 4)) + meta;
}

// Sequences of all kinds around what matters.
std::string MakeFile()
{
  const std::string position = Short(0x00200032, "DS", "1\\2.5\\-3");
  const std::string closed = Implicit(0xFFFEE000, position);
  const std::string open = Implicit(0xFFFEE000, position, true) + ItemEnd;
  const std::string unknown = Implicit(0xFFFEE000, Implicit(0x00080100, "CODE"), true) + ItemEnd;
  const std::string plain = Implicit(0xFFFEE000, Short(0x00080100, "SH", "CODE"), true) + ItemEnd;
  const std::string icon = Implicit(0xFFFEE000,
    Long(0x7FE00010, "OB", Implicit(0xFFFEE000, "") + Implicit(0xFFFEE000, "JPEG") + SequenceEnd,
      true));
  return Head("1.2.840.10008.1.2.1") + Short(0x00080060, "CS", "CT") +
    Long(0x00081140, "SQ", plain + SequenceEnd, true) +
    Long(0x00091010, "UN", unknown + SequenceEnd, true) + Short(0x00280010, "US", Number(2, 2)) +
    Short(0x00280011, "US", Number(3, 2)) + Short(0x00280100, "US", Number(16, 2)) +
    Short(0x00280101, "US", Number(16, 2)) + Short(0x00280103, "US", Number(1, 2)) +
    Short(0x00280120, "SS", Number(0xFF38, 2)) + Long(0x00880200, "SQ", icon + SequenceEnd, true) +
    Long(0x52009229, "SQ", Implicit(0xFFFEE000, Long(0x00209113, "SQ", closed))) +
    Long(0x52009230, "SQ",
      Implicit(0xFFFEE000, Long(0x00209113, "SQ", open + SequenceEnd, true), true) + ItemEnd +
        SequenceEnd,
      true) +
    Long(0x7FE00010, "OW", std::string("abcdefghijkl"));
}
}

TEST(DicomDataSet, ReadsSequencesOfAllKinds)
{
  const Temporary folder;
  const std::vector<CTFrame> frames = ReadDicomFrames(folder.Write(MakeFile()));
  ASSERT_EQ(frames.size(), 1U);
  const CTFileHeader& header = *frames[0].Header;
  EXPECT_EQ(header.Modality, "CT");
  EXPECT_EQ(header.Rows, 2);
  EXPECT_EQ(header.Columns, 3);
  EXPECT_EQ(header.Padding, -200);
  EXPECT_EQ(header.PixelError, "");
  ASSERT_TRUE(frames[0].Position);
  EXPECT_EQ(*frames[0].Position, (Vec3{ 1, 2.5, -3 }));
  const std::vector<unsigned char> bytes = ReadDicomBytes(frames[0]);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "abcdefghijkl");
}

TEST(DicomDataSet, ReadsImplicit)
{
  const Temporary folder;
  const std::string item = Implicit(0xFFFEE000, Implicit(0x00200032, "7\\8\\9 "));
  const std::string group = Implicit(0xFFFEE000, Implicit(0x00209113, item));
  const std::string file = Head("1.2.840.10008.1.2 ") + Implicit(0x00080060, "CT") +
    Implicit(0x00280010, Number(1, 2)) + Implicit(0x00280011, Number(2, 2)) +
    Implicit(0x00280100, Number(8, 2)) + Implicit(0x52009229, group) + Implicit(0x7FE00010, "xy");
  const std::vector<CTFrame> frames = ReadDicomFrames(folder.Write(file));
  EXPECT_EQ(*frames.at(0).Position, (Vec3{ 7, 8, 9 }));
  EXPECT_EQ(ReadDicomBytes(frames[0]), (std::vector<unsigned char>{ 'x', 'y' }));
}

TEST(DicomDataSet, CutOffAnywhere)
{
  const Temporary folder;
  const std::string file = MakeFile();
  for (std::size_t size = 0; size < file.size(); ++size)
  {
    const std::string path = folder.Write(file.substr(0, size));
    try
    {
      const std::vector<CTFrame> frames = ReadDicomFrames(path);
      EXPECT_NE(frames.at(0).Header->PixelError, "") << size;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_EQ(std::string(e.what()).find(path), 0U) << e.what();
    }
  }
}

// Anything may come out, but no crash, no hang and no memory beyond the file's size.
TEST(DicomDataSet, DamagedAtRandom)
{
  const Temporary folder;
  const std::string whole = MakeFile();
  std::mt19937 random(3);
  for (int trial = 0; trial < 3000; ++trial)
  {
    std::string file = whole;
    for (int i = 0; i < 3; ++i)
    {
      file[132 + random() % (file.size() - 132)] = static_cast<char>(random());
    }
    try
    {
      for (const CTFrame& frame : ReadDicomFrames(folder.Write(file)))
      {
        if (frame.Header->PixelError.empty())
        {
          ReadDicomBytes(frame);
        }
      }
    }
    catch (const std::runtime_error&)
    {
    }
  }
}

TEST(DicomDataSet, RefusesDepth)
{
  const Temporary folder;
  std::string deep;
  for (int i = 0; i < 100000; ++i)
  {
    deep += Tag(0x00081140) + "SQ" + Number(0, 2) + Number(0xFFFFFFFF, 4) + Tag(0xFFFEE000) +
      Number(0xFFFFFFFF, 4);
  }
  EXPECT_THROW(
    ReadDicomFrames(folder.Write(Head("1.2.840.10008.1.2.1") + deep)), std::runtime_error);
}

TEST(DicomFolder, RemembersAndNotices)
{
  const Temporary folder;
  ThreadExecution execution(2);
  DicomFolder files;
  folder.Write(MakeFile(), "a b");
  folder.Write("text", "c");
  files.Scan(folder.Path.string(), execution);
  EXPECT_EQ(files.GetFrames().size(), 1U);
  EXPECT_EQ(files.GetNotes().size(), 1U);
  const auto header = files.GetFrames()[0].Header;
  folder.Write(MakeFile().substr(0, 200), "d");
  files.Scan(folder.Path.string(), execution);
  ASSERT_EQ(files.GetFrames().size(), 1U);
  EXPECT_EQ(files.GetFrames()[0].Header, header); // not read again
  EXPECT_EQ(files.GetWarnings().size(), 1U);
  EXPECT_TRUE(IsCTFileOrFolder(folder.Path.string()));
  EXPECT_TRUE(IsCTFileOrFolder((folder.Path / "a b").string()));
  EXPECT_FALSE(IsCTFileOrFolder((folder.Path / "c").string()));
  files.Scan((folder.Path / "c").string(), execution);
  EXPECT_THROW(files.GetOpenedSeries(), std::runtime_error);
  EXPECT_THROW(files.Scan((folder.Path / "none").string(), execution), std::runtime_error);
}
