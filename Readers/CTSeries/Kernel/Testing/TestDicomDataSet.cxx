// SPDX-License-Identifier: BSD-3-Clause
// DICOM files made byte by byte, whole, cut off anywhere and damaged at random.
#include "DicomTestFile.h"
#include "lacunaDicomDataSet.h"
#include "lacunaDicomFolder.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <sys/stat.h>

using namespace lacuna;

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
  EXPECT_EQ(Pixels(frames[0]), "abcdefghijkl");
}

TEST(DicomDataSet, ReadsImplicit)
{
  const Temporary folder;
  const std::string item = Implicit(0xFFFEE000, Implicit(0x00200032, "7\\8\\9 "));
  const std::string group = Implicit(0xFFFEE000, Implicit(0x00209113, item));
  const std::string file = Head("1.2.840.10008.1.2 ") + Implicit(0x00080060, "CT") +
    Implicit(0x00280010, Number(1, 2)) + Implicit(0x00280011, Number(2, 2)) + ImplicitFormat(8) +
    Implicit(0x52009229, group) + Implicit(0x7FE00010, "xy");
  const std::vector<CTFrame> frames = ReadDicomFrames(folder.Write(file));
  EXPECT_EQ(*frames.at(0).Position, (Vec3{ 7, 8, 9 }));
  EXPECT_EQ(Pixels(frames[0]), "xy");
}

// What all frames share and what the file itself says is the same, or one of them is wrong.
TEST(DicomDataSet, RefusesGroupsThatContradictTheFile)
{
  const Temporary folder;
  const auto read = [&](const std::string& own, const std::string& group, const std::string& shared)
  {
    const std::string groups = Long(0x52009229, "SQ",
      Implicit(
        0xFFFEE000, Long(std::stoul(group, nullptr, 16), "SQ", Implicit(0xFFFEE000, shared))));
    const std::string file = Head("1.2.840.10008.1.2.1") + Short(0x00080060, "CS", "CT") + own +
      Short(0x00280010, "US", Number(1, 2)) + Short(0x00280011, "US", Number(2, 2)) + Format(8) +
      groups + Long(0x7FE00010, "OB", "xy");
    return ReadDicomFrames(folder.Write(file)).at(0);
  };
  const auto error = [&](
                       const std::string& own, const std::string& group, const std::string& shared)
  {
    try
    {
      read(own, group, shared);
    }
    catch (const std::exception& exception)
    {
      return std::string(exception.what());
    }
    return std::string();
  };
  const std::string axes = "1\\0\\0\\0\\1\\0";
  EXPECT_NE(
    error(Short(0x00200037, "DS", "-1\\0\\0\\0\\-1\\0"), "209116", Short(0x00200037, "DS", axes))
      .find("file: Image Orientation (Patient) (0020,0037) is 1\\0\\0\\0\\1\\0 in a "
            "functional group and -1\\0\\0\\0\\-1\\0 in the file itself"),
    std::string::npos);
  EXPECT_NE(error(Short(0x00200032, "DS", "1\\2\\3"), "209113", Short(0x00200032, "DS", "1\\2\\-3"))
              .find("(0020,0032)"),
    std::string::npos);
  EXPECT_NE(error(Short(0x00181050, "DS", "1") + Short(0x00280030, "DS", "1\\1"), "289110",
              Short(0x00280030, "DS", "2\\2"))
              .find("(0028,0030)"),
    std::string::npos);
  EXPECT_NE(error(Short(0x00281052, "DS", "-1024"), "289145", Short(0x00281052, "DS", "0"))
              .find("(0028,1052)"),
    std::string::npos);
  EXPECT_NE(
    error(Short(0x00281053, "DS", "1"), "289145", Short(0x00281053, "DS", "2")).find("(0028,1053)"),
    std::string::npos);
  // the same in other words
  const CTFrame frame = read(
    Short(0x00200037, "DS", "1.0\\0\\0\\0\\1\\-0.00001"), "209116", Short(0x00200037, "DS", axes));
  ASSERT_TRUE(frame.Axes);
  EXPECT_EQ((*frame.Axes)[0], 1);
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
          Pixels(frame);
        }
      }
    }
    catch (const std::runtime_error&)
    {
    }
  }
}

TEST(DicomDataSet, KeepsWhatIsSelected)
{
  const Temporary folder;
  const std::string text(20000, '1');
  const std::string file =
    folder.Write(Head("1.2.840.10008.1.2.1") + Short(0x00280030, "DS", text) +
      Long(0x30060039, "SQ", Implicit(0xFFFEE000, Short(0x30060084, "IS", "7"))));
  const DicomDataSet images = ReadDicomFile(file).Data;
  EXPECT_TRUE(images.GetBytes(0x00280030).empty());
  EXPECT_TRUE(images.GetItems(0x30060039).empty());
  DicomSelection selection;
  selection.Sequences = { 0x30060039 };
  selection.LongestValue = 20000;
  const DicomDataSet all = ReadDicomFile(file, selection).Data;
  EXPECT_EQ(all.GetBytes(0x00280030), text);
  ASSERT_EQ(all.GetItems(0x30060039).size(), 1U);
  EXPECT_EQ(all.GetItems(0x30060039)[0].GetInteger(0x30060084), 7);
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

// A pipe is refused at once, not waited for; nor is a folder a file.
TEST(DicomDataSet, RefusesWhatIsNoFile)
{
  const Temporary folder;
  const std::string pipe = (folder.Path / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : { pipe, folder.Path.string(), pipe + "-none" })
  {
    EXPECT_THROW(ReadDicomFrames(path), std::runtime_error);
    EXPECT_FALSE(IsDicomFile(path));
  }
  EXPECT_FALSE(IsCTFileOrFolder(pipe));
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
