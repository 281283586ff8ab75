// SPDX-License-Identifier: BSD-3-Clause
#include "NrrdFile.h"
#include "lacunaSequenceHeader.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
SequenceHeader Read(const NrrdFile& file)
{
  const TemporaryFile stored("sweep.nrrd", file.GetContent());
  return ReadSequenceHeader(stored.GetPath());
}

void ExpectError(const std::string& content, const std::vector<std::string>& parts)
{
  const TemporaryFile stored("sweep.nrrd", content);
  const std::string error = GetError([&] { ReadSequenceHeader(stored.GetPath()); });
  EXPECT_NE(error.find("sweep.nrrd: "), std::string::npos) << error;
  for (const std::string& part : parts)
  {
    EXPECT_NE(error.find(part), std::string::npos) << error << "\nlacks: " << part;
  }
}

void ExpectFieldError(const std::string& name, const std::string& value, const std::string& part)
{
  NrrdFile file = MakeNrrd();
  file.Set(name, value);
  ExpectError(file.GetContent(), { part });
}

bool IsTracked(const std::string& content)
{
  const TemporaryFile file("sweep.nrrd", content);
  return IsTrackedSequence(file.GetPath());
}
}

TEST(NrrdHeader, SaysTheSameAsTheMetaImage)
{
  const NrrdFile file = MakeNrrd();
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.Columns, 5);
  EXPECT_EQ(header.Rows, 4);
  EXPECT_EQ(header.Frames, 3);
  EXPECT_EQ(header.Channels, 1);
  EXPECT_EQ(header.Type, ScalarType::UInt8);
  EXPECT_EQ(header.Encoding, PixelEncoding::Raw);
  EXPECT_EQ(header.DataOffset, static_cast<std::int64_t>(file.GetHeader().size()));
  EXPECT_TRUE(header.CustomFields.empty());
  EXPECT_TRUE(header.Warnings.empty());
  const TemporaryFile other("sweep.mha", MakeSequence().GetContent());
  EXPECT_EQ(header.FrameFields, ReadSequenceHeader(other.GetPath()).FrameFields); // ImageStatus
}

TEST(NrrdHeader, Spellings)
{
  NrrdFile file = MakeNrrd();
  file.LineEnd = "\r\n";
  file.Magic = "NRRD0001";
  file.Remove("type");
  file.Set("TYPE", "Unsigned Short Int");
  file.Set("Endian", "BIG");
  file.Remove("endian");
  file.Set("sizes", "5 4                             3   ");
  file.SetPair("a key", "a value := with a sign");
  file.SetPair("escaped", R"(two\nlines, C:\\path, C:\temp)");
  file.Set("unknown field", "as PLUS writes custom strings: so"); // 'name: value'
  file.Set("content", "phantom");
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.Type, ScalarType::UInt16);
  EXPECT_TRUE(header.BigEndian);
  EXPECT_EQ(header.Frames, 3);
  EXPECT_EQ(header.DataOffset, static_cast<std::int64_t>(file.GetHeader().size()));
  const std::vector<std::pair<std::string, std::string>> expected = {
    { "unknown field", "as PLUS writes custom strings: so" }, { "content", "phantom" },
    { "a key", "a value := with a sign" }, { "escaped", "two\nlines, C:\\path, C:\\temp" }
  };
  EXPECT_EQ(header.CustomFields, expected);
}

TEST(NrrdHeader, EveryTypeAndEncoding)
{
  const std::pair<const char*, ScalarType> types[] = { { "signed char", ScalarType::Int8 },
    { "uchar", ScalarType::UInt8 }, { "int16_t", ScalarType::Int16 },
    { "unsigned short", ScalarType::UInt16 }, { "signed int", ScalarType::Int32 },
    { "uint32", ScalarType::UInt32 }, { "long long int", ScalarType::Int64 },
    { "ulonglong", ScalarType::UInt64 }, { "float", ScalarType::Float32 },
    { "double", ScalarType::Float64 } };
  for (const auto& [name, type] : types)
  {
    NrrdFile file = MakeNrrd();
    file.Set("type", name);
    EXPECT_EQ(Read(file).Type, type) << name;
    EXPECT_FALSE(Read(file).TypeIsLong);
  }
  const std::pair<const char*, PixelEncoding> encodings[] = { { "raw", PixelEncoding::Raw },
    { "gz", PixelEncoding::Zlib }, { "GZIP", PixelEncoding::Zlib }, { "hex", PixelEncoding::Hex },
    { "txt", PixelEncoding::Text }, { "text", PixelEncoding::Text },
    { "ascii", PixelEncoding::Text } };
  for (const auto& [name, encoding] : encodings)
  {
    NrrdFile file = MakeNrrd();
    file.Set("encoding", name);
    EXPECT_EQ(Read(file).Encoding, encoding) << name;
  }
  for (const char* name : { "bz2", "bzip2" })
  {
    ExpectFieldError("encoding", name, "compressed with bzip2, which is not read");
  }
}

TEST(NrrdHeader, ShapesOfFrames)
{
  NrrdFile file = MakeNrrd();
  file.Set("kinds", "space space TIME");
  EXPECT_EQ(Read(file).Frames, 3);
  file.Remove("kinds");
  EXPECT_EQ(Read(file).Frames, 3);
  file.Set("dimension", "4");
  file.Set("sizes", "5 4 1 3");
  EXPECT_EQ(Read(file).Frames, 3);
  EXPECT_EQ(Read(file).Channels, 1);
  for (const char* kinds : { "", "vector domain domain list", "RGB-color space space list" })
  {
    file.Set("sizes", "3 5 4 3");
    file.Set("kinds", kinds);
    EXPECT_EQ(Read(file).Channels, 3) << kinds;
    EXPECT_EQ(Read(file).Columns, 5) << kinds;
    EXPECT_EQ(Read(file).Frames, 3) << kinds;
  }
  file.Set("sizes", "4 5 4 3");
  EXPECT_EQ(Read(file).Channels, 4);
}

TEST(NrrdHeader, DetachedData)
{
  NrrdFile file = MakeNrrd();
  file.Detached = true;
  for (const char* name : { "data file", "datafile", "Data File" })
  {
    file.Set(name, "./sub/pixels.raw");
    file.Set("byte skip", "17");
    file.Set("line skip", "2");
    const TemporaryFile stored("sweep.nhdr", file.GetContent());
    const SequenceHeader header = ReadSequenceHeader(stored.GetPath());
    EXPECT_EQ(std::filesystem::path(header.DataFileName).lexically_normal(),
      std::filesystem::path(stored.GetPath()).parent_path() / "sub" / "pixels.raw");
    EXPECT_EQ(header.DataOffset, 0);
    EXPECT_EQ(header.SkippedBytes, 17);
    EXPECT_EQ(header.SkippedLines, 2);
    EXPECT_TRUE(header.Warnings.empty());
    file.Remove(name);
  }
  file.Set("data file", "/elsewhere/pixels.raw");
  EXPECT_EQ(Read(file).DataFileName, "/elsewhere/pixels.raw");
  file.Set("data file", "/elsewhere/LISTEN.raw");
  EXPECT_EQ(Read(file).DataFileName, "/elsewhere/LISTEN.raw");
  file.Set("byte skip", "-1");
  EXPECT_EQ(Read(file).SkippedBytes, -1);
  file.Set("encoding", "gzip");
  ExpectError(file.GetContent(), { "byte skip is -1" });
  file.Set("encoding", "raw");
  file.Set("byte skip", "-2");
  ExpectError(file.GetContent(), { "byte skip is -2" });
  file.Set("byte skip", "0");
  file.Set("line skip", "-1");
  ExpectError(file.GetContent(), { "line skip is -1" });
  file.Set("line skip", "0");
  for (const char* name : { "LIST", "LIST 2", "slice%03d.raw 1 3 1" })
  {
    file.Set("data file", name);
    ExpectError(file.GetContent(), { "data file is", "one file per slice" });
  }
}

TEST(NrrdHeader, ADetachedHeaderCutOffAnywhereHasItsWholeFrames)
{
  NrrdFile file = MakeNrrd(4);
  file.Detached = true;
  file.Set("data file", "pixels.raw");
  const std::string content = file.GetContent();
  const TemporaryFile stored("sweep.nhdr");
  for (std::size_t size = content.find("Seq_Frame0000"); size < content.size(); size += 3)
  {
    stored.Write(content.substr(0, size));
    // a frame is whole with the line feed of its last field
    std::int64_t whole = 0;
    for (int frame = 0; frame < 4; ++frame)
    {
      const std::size_t at = content.find("Seq_Frame000" + std::to_string(frame) + "_Status");
      whole += size >= content.find('\n', at) + 1 ? 1 : 0;
    }
    if (whole == 0)
    {
      EXPECT_NE(GetError([&] { ReadSequenceHeader(stored.GetPath()); }), "") << size;
      continue;
    }
    const SequenceHeader header = ReadSequenceHeader(stored.GetPath());
    ASSERT_EQ(header.Frames, whole) << size;
    ASSERT_EQ(header.Warnings.size(), 1u);
    EXPECT_NE(header.Warnings[0].find("cut off"), std::string::npos);
    EXPECT_EQ(header.FrameFields.at("Timestamp").back(), std::to_string(9 + whole) + ".25");
  }
}

TEST(NrrdHeader, FrameNumbersThatNoFileReachesAreIgnored)
{
  NrrdFile file = MakeNrrd();
  file.Detached = true;
  file.Set("data file", "pixels.raw");
  file.SetPair("Seq_Frame9223372036854775807_ImageStatus", "OK");
  file.SetPair("Seq_Frame2147483647_ImageStatus", "OK");
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.Frames, 3);
  ASSERT_FALSE(header.Warnings.empty());
  EXPECT_NE(header.Warnings[0].find("Seq_Frame9223372036854775807_ImageStatus"), std::string::npos)
    << header.Warnings[0];
}

TEST(NrrdHeader, WhatIsWrong)
{
  ExpectError("NRRD0009\n", { "line 1", "NRRD0001 to NRRD0005" });
  ExpectError("NRRD0004\ntype: uint8\n", { "line 2", "cut off" });
  ExpectError(MakeNrrd().GetHeader().substr(0, 500), { "cut off" });
  NrrdFile plain = MakeNrrd(0);
  plain.Set("sizes", "5 4 3");
  ExpectError(plain.GetContent(), { "ordinary image" });
  ExpectFieldError("type", "block", "type is 'block'");
  ExpectFieldError("encoding", "zstd", "encoding is 'zstd'");
  ExpectFieldError("endian", "middle", "endian is 'middle'");
  ExpectFieldError("dimension", "2", "dimension is 2 but sizes");
  ExpectFieldError("sizes", "5 x 3", "'x' is not an integer");
  ExpectFieldError("sizes", "5 -4 3", "must each be from 1");
  ExpectFieldError("sizes", "2000000000 2000000000 3", "no file holds so much");
  ExpectFieldError("sizes", "5 4 1000000000", "sizes says 1000000000 frames");
  ExpectFieldError("kinds", "list domain domain", "frames must come last");
  ExpectFieldError("kinds", "domain domain domain", "volumes of 3 layers");
  for (const char* missing : { "type", "encoding", "sizes" })
  {
    NrrdFile file = MakeNrrd();
    file.Remove("dimension");
    file.Remove(missing);
    ExpectError(file.GetContent(), { std::string(missing) + " is missing" });
  }
  NrrdFile wide = MakeNrrd();
  wide.Remove("endian");
  wide.Set("type", "int16");
  ASSERT_EQ(Read(wide).Warnings.size(), 1u);
  EXPECT_NE(Read(wide).Warnings[0].find("endian is missing"), std::string::npos);
  NrrdFile twice = MakeNrrd();
  twice.Set("Sizes", "4 5 3");
  ExpectError(twice.GetContent(), { "gives header field Sizes again" });
}

TEST(NrrdHeader, RecognisesItsFiles)
{
  EXPECT_TRUE(IsTracked(MakeNrrd().GetContent()));
  EXPECT_TRUE(IsTracked(MakeNrrd().GetContent().substr(0, 500)));
  NrrdFile volume = MakeNrrd();
  volume.Set("kinds", "domain domain domain"); // as the reconstructor of PLUS writes it
  EXPECT_FALSE(IsTracked(volume.GetContent()));
  NrrdFile plain = MakeNrrd(0);
  plain.Pixels = "\nSeq_Frame0000_Status:=OK\n"; // pixels, not fields
  EXPECT_FALSE(IsTracked(plain.GetContent()));
  EXPECT_FALSE(IsTracked("NRRD"));
  EXPECT_FALSE(IsTracked("NRRD0004\n\n"));
}

TEST(NrrdHeader, SpaceSaysThePixelsSizeAndNoPlace)
{
  NrrdFile file = MakeNrrd();
  EXPECT_EQ(Read(file).PixelSpacing, "1 1");
  EXPECT_TRUE(Read(file).Warnings.empty());
  file.Set("space directions", "(0.25,0) (0, 0.5) none");
  file.Set("space origin", "(0,0)");
  EXPECT_EQ(Read(file).PixelSpacing, "0.25 0.5");
  EXPECT_TRUE(Read(file).Warnings.empty());
  file.Set("space directions", "(0,0.25) (0.5,0) none");
  file.Set("space origin", "(0,7)");
  const SequenceHeader turned = Read(file);
  EXPECT_EQ(turned.PixelSpacing, "0.25 0.5");
  ASSERT_EQ(turned.Warnings.size(), 2u);
  EXPECT_NE(turned.Warnings[0].find("space origin is '(0,7)', which places"), std::string::npos);
  EXPECT_NE(turned.Warnings[1].find("space directions"), std::string::npos);
  file.Set("space origin", "(0,0)");
  file.Set("space directions", "(-0.25,0) (0,0.5) none");
  EXPECT_EQ(Read(file).Warnings.size(), 1u);
  for (const char* odd : { "", "(", "none", "(a,b) (c,d) none", "((((", ") ) )" })
  {
    file.Set("space directions", odd);
    EXPECT_NO_THROW(Read(file)) << odd;
  }
  file.Set("spacings", "0.3 0.4 NaN");
  file.Set("space directions", "none");
  EXPECT_EQ(Read(file).PixelSpacing, "0.3 0.4");
}

TEST(NrrdHeader, PicturesOfSlicerHaveTheirPosesElsewhere)
{
  const std::string header = "NRRD0005\ntype: uint8\ndimension: 4\nsizes: 2 2 1 3\n"
                             "kinds: domain domain domain list\nencoding: raw\n"
                             "DataNodeClassName:=vtkMRMLScalarVolumeNode\n"
                             "axis 3 index values:=0 0.1 0.2\n\n";
  ExpectError(header + std::string(12, 'x'),
    { "pictures of 3D Slicer, whose poses are in another file", "WriteSequenceMetafile",
      "Assemble Tracked Slices" });
}
