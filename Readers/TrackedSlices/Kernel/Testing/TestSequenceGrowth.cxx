// SPDX-License-Identifier: BSD-3-Clause
// What reading takes grows as the bytes of the file: of many fields, names, frames, lines and transforms, and of
// bytes behind the last pixel.
#include "SequenceFile.h"
#include "lacunaCalibrationFile.h"
#include "lacunaDoubling.h"
#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSweep.h"

#include <gtest/gtest.h>
#include <zlib.h>

using namespace lacuna;

namespace
{
const std::string Unit = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

std::string Frame(int frame, const std::string& name, const std::string& value)
{
  return "Seq_Frame" + std::to_string(frame) + "_" + name + " = " + value + "\n";
}

std::string MetaImage(int frames, const std::string& fields)
{
  return "ObjectType = Image\nNDims = 3\nDimSize = 1 1 " + std::to_string(frames) +
    "\nElementType = MET_UCHAR\n" + fields + "ElementDataFile = LOCAL\n" +
    std::string(static_cast<std::size_t>(frames), 'p');
}

std::string Nrrd(const std::string& fields)
{
  return "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n" + fields +
    "Seq_Frame0_ImageToReferenceTransform:=" + Unit + "\nSeq_Frame0_Status:=OK\n\np";
}

const std::string Posed =
  Frame(0, "ImageToReferenceTransform", Unit) + Frame(0, "ImageStatus", "OK");

std::string Lines(int count, const std::string& before, const std::string& after)
{
  std::string text;
  for (int i = 0; i < count; ++i)
  {
    text += before + std::to_string(i) + after;
  }
  return text;
}

// Whatever comes of it.
void ReadAll(const std::string& file, const std::string& calibration)
{
  GetImageFileKind(file);
  try
  {
    const SequenceHeader header = ReadSequenceHeader(file);
    SweepOptions options;
    options.CalibrationFileName = calibration;
    BuildSweep(header, options);
  }
  catch (const std::runtime_error&)
  {
  }
}

void ExpectLinear(int size, const std::function<std::string(int)>& make,
  const std::function<std::string(int)>& makeCalibration = {})
{
  const double growth = GetGrowthOfThreeDoublings(size,
    [&](int n) -> std::function<void()>
    {
      const auto file = std::make_shared<TemporaryFile>("s.mha", make(n));
      std::string calibration;
      if (makeCalibration)
      {
        file->WriteBeside("c.xml",
          "<P><CoordinateDefinitions>\n" + makeCalibration(n) + "</CoordinateDefinitions></P>\n");
        calibration = (std::filesystem::path(file->GetPath()).parent_path() / "c.xml").string();
      }
      return [file, calibration] { ReadAll(file->GetPath(), calibration); };
    });
  EXPECT_LT(growth, MostGrowth);
}

std::string Compress(const std::string& text, int level = 9)
{
  z_stream zlib{};
  deflateInit2(&zlib, level, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&zlib, text.size()) + 100, '\0');
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  zlib.avail_in = static_cast<uInt>(text.size());
  zlib.next_out = reinterpret_cast<Bytef*>(packed.data());
  zlib.avail_out = static_cast<uInt>(packed.size());
  deflate(&zlib, Z_FINISH);
  packed.resize(packed.size() - zlib.avail_out);
  deflateEnd(&zlib);
  return packed;
}
}

TEST(SequenceGrowth, CustomFields)
{
  ExpectLinear(2500, [](int n) { return MetaImage(1, Lines(n, "C", " = v\n") + Posed); });
  ExpectLinear(2500, [](int n) { return Nrrd(Lines(n, "C", ":=v\n")); });
  ExpectLinear(2500,
    [](int n) { return MetaImage(1, Lines(n, "AToB", "Transform = " + Unit + "\n") + Posed); });
  ExpectLinear(2500, [](int n) { return MetaImage(1, Lines(n, "what is this ", "\n") + Posed); });

  const TemporaryFile many("s.mha", MetaImage(1, Lines(1003, "C", " = v\n") + Posed));
  const SequenceHeader header = ReadSequenceHeader(many.GetPath());
  EXPECT_EQ(header.CustomFields.size(), 1000U);
  EXPECT_EQ(header.Warnings.back(),
    "the header has 1003 fields of its own; the first 1000 are kept. Left out are C1000, C1001, "
    "C1002");
  // but what says where slices lie
  many.Write(MetaImage(1, Lines(1003, "C", " = v\n") + "FirstColumn = 7\n" + Posed));
  EXPECT_EQ(ReadSequenceHeader(many.GetPath()).CustomFields.back().first, "FirstColumn");
}

TEST(SequenceGrowth, FrameFields)
{
  const auto names = [](int n)
  {
    std::string text;
    for (int i = 0; i < n; ++i)
    {
      text += Frame(0, "F" + std::to_string(i), "v");
    }
    return MetaImage(1, text + Posed);
  };
  ExpectLinear(2500, names);
  const TemporaryFile many("s.mha", names(998));
  EXPECT_EQ(ReadSequenceHeader(many.GetPath()).FrameFields.size(), 1000U);
  many.Write(names(1100));
  EXPECT_NE(GetError([&] { ReadSequenceHeader(many.GetPath()); })
              .find("the frames have 1102 different fields; up to 1000 are read"),
    std::string::npos);
}

TEST(SequenceGrowth, Frames)
{
  ExpectLinear(4000,
    [](int n)
    {
      std::string text;
      for (int i = 0; i < n; ++i)
      {
        const std::string number = std::to_string(i);
        text += Frame(i, "ImageToReferenceTransform", i % 3 == 0 ? "1 0 " + number : Unit) +
          Frame(i, "ImageToReferenceTransformStatus", i % 3 == 1 ? "bad " + number : "OK") +
          Frame(i, "ImageStatus", "state " + number) + Frame(i, "SliceStatus", "flag " + number) +
          Frame(i, "Timestamp", "time " + number) +
          Frame(i, "PixelSpacing", "0.1 0." + number + "1") + Frame(i, "Depth", "depth " + number);
      }
      return MetaImage(n, text);
    });
}

TEST(SequenceGrowth, Calibrations)
{
  const auto transform = [](const std::string& from, const std::string& to)
  { return "<Transform From=\"" + from + "\" To=\"" + to + "\" Matrix=\"" + Unit + "\"/>\n"; };
  const auto frames = [](int n)
  {
    std::string text;
    for (int i = 0; i < n; ++i)
    {
      text += Frame(i, "ProbeToReferenceTransform", Unit) + Frame(i, "ImageStatus", "OK");
    }
    return MetaImage(n, text);
  };
  const auto chain = [&](int n)
  {
    std::string text = transform("Image", "A0");
    for (int i = 0; i < n; ++i)
    {
      text +=
        transform("A" + std::to_string(i), i + 1 == n ? "Probe" : "A" + std::to_string(i + 1));
    }
    return text;
  };
  const auto star = [&](int n)
  {
    std::string text = transform("Image", "Probe");
    for (int i = 0; i < n; ++i)
    {
      text += transform("Image", "A" + std::to_string(i));
    }
    return text;
  };
  // there are 1000 at most
  ExpectLinear(
    1000, [&](int) { return frames(200); }, chain);
  ExpectLinear(
    1000, [&](int) { return frames(200); }, star);

  const TemporaryFile file("s.mha", frames(2));
  file.WriteBeside(
    "c.xml", "<P><CoordinateDefinitions>\n" + chain(70) + "</CoordinateDefinitions></P>\n");
  SweepOptions options;
  options.CalibrationFileName =
    (std::filesystem::path(file.GetPath()).parent_path() / "c.xml").string();
  EXPECT_NE(
    GetError([&] { BuildSweep(ReadSequenceHeader(file.GetPath()), options); })
      .find("a chain of 72 transforms leads from 'Image' to 'Reference'; up to 64 are read"),
    std::string::npos);
}

// Of what follows the last pixel, no more is inflated than the file has bytes.
TEST(SequenceGrowth, TrailingBytes)
{
  std::string gzip =
    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: gzip\nSeq_Frame0_Status:=OK\n\n";
  gzip += Compress("p");
  const std::string member = Compress(std::string(std::size_t(64) << 20, '\0'));
  const std::string whole = gzip;
  for (int i = 0; i < 4; ++i)
  {
    gzip += member;
  }
  const TemporaryFile file("s.nrrd", gzip);
  const SequenceHeader header = ReadSequenceHeader(file.GetPath());
  const std::string warning = PixelSource::Open(header)->GetWarning();
  EXPECT_EQ(warning.find("more than "), 0U) << warning;
  EXPECT_LT(std::stod(warning.substr(10)), 1.1e6) << warning; // of 268435456
  EXPECT_NE(
    warning.find(" bytes after the last frame are ignored; are the size"), std::string::npos);
  // few are counted
  file.Write(whole + Compress(std::string(50000, 'q')));
  EXPECT_EQ(
    PixelSource::Open(ReadSequenceHeader(file.GetPath()))->GetWarning().find("50000 bytes after"),
    0U);

  // where the header says how many bytes are compressed, that is an error of the last frame
  std::string meta = "ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nElementType = MET_UCHAR\n"
                     "CompressedData = True\nCompressedDataSize = 30\n" +
    Frame(0, "ImageStatus", "OK") + "ElementDataFile = LOCAL\n" + Compress("p") + member;
  file.Write(meta);
  const SequenceHeader stated = ReadSequenceHeader(file.GetPath());
  unsigned char pixel = 0;
  EXPECT_NE(GetError([&] { PixelSource::Open(stated)->ReadFrame(0, &pixel); })
              .find("go on after the last frame; are the size"),
    std::string::npos);
}
