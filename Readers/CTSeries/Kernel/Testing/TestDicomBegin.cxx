// SPDX-License-Identifier: BSD-3-Clause
// Files without preamble, and files that are deflated: whole, cut off, damaged and of other kinds.
#include "DicomTestFile.h"
#include "lacunaDicomFolder.h"
#include "lacunaFileBytes.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

using namespace lacuna;

namespace
{
std::string Deflate(const std::string& bytes, int windowBits = -MAX_WBITS, int flush = Z_FINISH)
{
  z_stream zlib{};
  EXPECT_EQ(deflateInit2(&zlib, 6, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string stream(deflateBound(&zlib, bytes.size()) + 16, '\0');
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  zlib.avail_in = static_cast<uInt>(bytes.size());
  zlib.next_out = reinterpret_cast<Bytef*>(stream.data());
  zlib.avail_out = static_cast<uInt>(stream.size());
  EXPECT_EQ(deflate(&zlib, flush), flush == Z_FINISH ? Z_STREAM_END : Z_OK);
  stream.resize(zlib.total_out);
  deflateEnd(&zlib);
  return stream;
}

const std::string Deflated = "1.2.840.10008.1.2.1.99";

// Two frames of 2 x 2 pixels of 8 bits, explicit.
std::string MakeFrames()
{
  return Short(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1") + Short(0x00080060, "CS", "CT") +
    Short(0x0020000E, "UI", "1.2.3") + Short(0x00280008, "IS", "2") +
    Short(0x00280010, "US", Number(2, 2)) + Short(0x00280011, "US", Number(2, 2)) + Format(8) +
    Long(0x7FE00010, "OB", "abcdefgh");
}

std::string Error(const std::string& path)
{
  try
  {
    ReadDicomFrames(path);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return {};
}
}

TEST(DicomBegin, Deflated)
{
  const Temporary folder;
  const std::string whole = MakeFile();
  const std::size_t meta = Head("1.2.840.10008.1.2.1").size();
  const std::string deflated = Head(Deflated) + Deflate(whole.substr(meta));
  const std::vector<CTFrame> frames = ReadDicomFrames(folder.Write(deflated));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].Header->PixelError, "");
  EXPECT_FALSE(frames[0].Header->Compressed);
  EXPECT_EQ(*frames[0].Position, (Vec3{ 1, 2.5, -3 }));
  EXPECT_EQ(Pixels(frames[0]), "abcdefghijkl");

  const std::vector<CTFrame> two =
    ReadDicomFrames(folder.Write(Head(Deflated) + Deflate(MakeFrames())));
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(Pixels(two[0]) + Pixels(two[1]), "abcdefgh");

  // a pad byte makes it even
  EXPECT_EQ(
    Pixels(ReadDicomFrames(folder.Write(deflated + std::string(1, '\0')))[0]), "abcdefghijkl");
}

TEST(DicomBegin, DeflatedInPieces)
{
  // more than one window on either side
  std::mt19937 random(5);
  std::string pixels(std::size_t(600) * 600, '\0');
  for (char& c : pixels)
  {
    c = static_cast<char>(random() % 64);
  }
  const std::string data = Short(0x00080060, "CS", "CT") + Short(0x00280010, "US", Number(600, 2)) +
    Short(0x00280011, "US", Number(600, 2)) + Format(8) + Long(0x7FE00010, "OB", pixels);
  const Temporary folder;
  EXPECT_EQ(Pixels(ReadDicomFrames(folder.Write(Head(Deflated) + Deflate(data))).at(0)), pixels);
}

TEST(DicomBegin, DeflatedBadly)
{
  const Temporary folder;
  const std::string stream = Deflate(MakeFrames());
  for (std::size_t size = 0; size < stream.size(); ++size)
  {
    const std::string path = folder.Write(Head(Deflated) + stream.substr(0, size));
    const std::string error = Error(path);
    EXPECT_EQ(error.find(path + ": its deflated data set is cut off"), 0U) << size << " " << error;
  }
  const std::string wrapped = folder.Write(Head(Deflated) + Deflate(MakeFrames(), MAX_WBITS));
  EXPECT_EQ(Error(wrapped).find(wrapped + ": its deflated data set is damaged"), 0U);
  // the pixels are missing inside of a sound stream
  const std::string cut = MakeFrames().substr(0, MakeFrames().size() - 3);
  EXPECT_NE(ReadDicomFrames(folder.Write(Head(Deflated) + Deflate(cut)))
              .at(0)
              .Header->PixelError.find("it is cut off"),
    std::string::npos);
}

// 12 MiB of zeros in a file of 12 KiB, against a limit lower than that of files, which is the same
// code: it holds after several steps of growing and wherever the stream is.
TEST(DicomBegin, DeflatedBomb)
{
  EXPECT_EQ(FileBytes::MostInflated, std::size_t(1) << 30);
  constexpr std::size_t Mebibyte = std::size_t(1) << 20;
  const Temporary folder;
  const std::string stream = Deflate(std::string(12 * Mebibyte, '\0'));
  ASSERT_LT(stream.size(), 13000U);
  const std::string path = folder.Write(stream);
  for (const std::size_t most : { Mebibyte, 5 * Mebibyte, 12 * Mebibyte - 1 })
  {
    FileBytes bytes(path);
    try
    {
      bytes.Inflate(0, most);
      ADD_FAILURE() << most;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_EQ(e.what(),
        path + ": is deflated and holds more than " + std::to_string(most / Mebibyte) + " MiB");
    }
    EXPECT_EQ(bytes.GetInflated(), nullptr);
  }
  FileBytes bytes(path);
  bytes.Inflate(0, 12 * Mebibyte + 1);
  EXPECT_EQ(bytes.GetInflated()->Bytes, std::vector<unsigned char>(12 * Mebibyte));
}

TEST(DicomBegin, WithoutPreamble)
{
  const Temporary folder;
  const std::string implicit = Implicit(0x00080000, Number(8, 4)) +
    Implicit(0x00080016, "1.2.840.10008.5.1.4.1.1.2 ") + Implicit(0x00080060, "CT") +
    Implicit(0x0020000E, "1.2.3 ") + Implicit(0x00200032, "7\\8\\9 ") +
    Implicit(0x00280010, Number(1, 2)) + Implicit(0x00280011, Number(2, 2)) + ImplicitFormat(8) +
    Implicit(0x7FE00010, "xy");
  const std::string path = folder.Write(implicit);
  EXPECT_TRUE(IsCTFileOrFolder(path));
  const std::vector<CTFrame> frames = ReadDicomFrames(path);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].Header->IsBare);
  EXPECT_EQ(frames[0].Header->TransferSyntax, "1.2.840.10008.1.2");
  EXPECT_EQ(*frames[0].Position, (Vec3{ 7, 8, 9 }));
  EXPECT_EQ(Pixels(frames[0]), "xy");

  const std::vector<CTFrame> two = ReadDicomFrames(folder.Write(MakeFrames()));
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].Header->TransferSyntax, "1.2.840.10008.1.2.1");
  EXPECT_EQ(Pixels(two[0]) + Pixels(two[1]), "abcdefgh");

  // the meta information without preamble says the syntax
  const std::string head = Head("1.2.840.10008.1.2").substr(132);
  const std::vector<CTFrame> meta = ReadDicomFrames(folder.Write(head + implicit));
  EXPECT_FALSE(meta.at(0).Header->IsBare);
  EXPECT_EQ(Pixels(meta[0]), "xy");

  folder.Write(implicit, "other");
  folder.Write("no image", "text");
  DicomFolder files;
  ThreadExecution execution(2);
  files.Scan(folder.Path.string(), execution);
  ASSERT_EQ(files.GetNotes().size(), 2U);
  EXPECT_EQ(files.GetNotes()[1].find("1 files have no DICOM preamble"), 0U);
}

// What is not DICOM stays so, however it begins; cut-off bare data sets are named.
TEST(DicomBegin, NotDicom)
{
  const Temporary folder;
  const std::vector<std::string> others = { "", "DICM", std::string(500, '\0'),
    std::string(500, '\x08'), Implicit(0x00080000, Number(8, 4)),
    Implicit(0x00080016, "2.16.840.1.113883") + Implicit(0x00080060, "CT"),
    Implicit(0x00080060, "c\x01"), Implicit(0x00080060, ""),
    Implicit(0x00080016, "1.2.840.10008.1", true),
    Implicit(0x00080018, "1.2") + Implicit(0x00080016, "1.2.840.10008.5"),
    Implicit(0x00100010, "A^B") + Implicit(0x00080060, "CT"),
    Implicit(0x00080060, std::string(80, 'A')), Tag(0x00080060) + Number(2, 4) + "C" };
  for (const std::string& bytes : others)
  {
    const std::string path = folder.Write(bytes);
    EXPECT_THROW(ReadDicomFrames(path), NotDicomError) << bytes;
    EXPECT_FALSE(IsDicomFile(path));
  }
  const std::string whole = MakeFrames();
  for (std::size_t size = 0; size < whole.size(); ++size)
  {
    const std::string path = folder.Write(whole.substr(0, size));
    try
    {
      EXPECT_NE(ReadDicomFrames(path).at(0).Header->PixelError, "") << size;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_EQ(std::string(e.what()).find(path), 0U) << e.what();
    }
  }
}
