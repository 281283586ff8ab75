// SPDX-License-Identifier: BSD-3-Clause
#include "SequenceFile.h"
#include "lacunaSequenceHeader.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
SequenceHeader Read(const std::string& content)
{
  const TemporaryFile file("sweep.igs.mha", content);
  return ReadSequenceHeader(file.GetPath());
}

SequenceHeader Read(const SequenceFile& file)
{
  return Read(file.GetContent());
}

void ExpectError(const std::string& content, const std::vector<std::string>& parts)
{
  const std::string error = GetError([&] { Read(content); });
  EXPECT_NE(error.find("sweep.igs.mha: "), std::string::npos) << error;
  for (const std::string& part : parts)
  {
    EXPECT_NE(error.find(part), std::string::npos) << error << "\nlacks: " << part;
  }
}

// The file with one field changed.
void ExpectFieldError(const std::string& name, const std::string& value, const std::string& part)
{
  SequenceFile file = MakeSequence();
  file.Set(name, value);
  ExpectError(file.GetContent(), { part });
}

bool IsTracked(const std::string& content)
{
  const TemporaryFile file("sweep.mha", content);
  return IsTrackedSequence(file.GetPath());
}

void ExpectWarning(const SequenceHeader& header, const std::string& part)
{
  ASSERT_EQ(header.Warnings.size(), 1u);
  EXPECT_NE(header.Warnings[0].find(part), std::string::npos) << header.Warnings[0];
}
}

TEST(SequenceHeader, ReadsAGoodFile)
{
  const SequenceFile file = MakeSequence();
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.Columns, 5);
  EXPECT_EQ(header.Rows, 4);
  EXPECT_EQ(header.Frames, 3);
  EXPECT_EQ(header.Channels, 1);
  EXPECT_EQ(header.Type, ScalarType::UInt8);
  EXPECT_FALSE(header.BigEndian);
  EXPECT_EQ(header.Encoding, PixelEncoding::Raw);
  EXPECT_FALSE(header.Flips.X || header.Flips.Y);
  EXPECT_EQ(header.DataFileName, header.FileName);
  EXPECT_EQ(header.DataOffset, static_cast<std::int64_t>(file.GetHeader().size()));
  EXPECT_EQ(header.GetFrameSize(), 20);
  EXPECT_EQ(header.FrameFields.at("Timestamp")[2], "12.25");
  EXPECT_TRUE(header.CustomFields.empty());
  EXPECT_TRUE(header.Warnings.empty());
}

TEST(SequenceHeader, CarriageReturnsTrailingBlanksAndLongLines)
{
  SequenceFile file = MakeSequence();
  file.LineEnd = "  \t\r\n";
  file.Set("DimSize", "5 4                                     3     ");
  const std::string longText(70000, 'x'); // longer than any buffer on the way
  file.Set("Comment", longText);
  file.SetFrame(1, "Note", longText + " = y");
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.Frames, 3);
  EXPECT_EQ(header.DataOffset, static_cast<std::int64_t>(file.GetHeader().size()));
  ASSERT_EQ(header.CustomFields.size(), 1u);
  EXPECT_EQ(header.CustomFields[0].second, longText);
  EXPECT_EQ(header.FrameFields.at("Note")[1], longText + " = y");
  EXPECT_EQ(header.FrameFields.at("Note")[0], "");
  EXPECT_EQ(header.FrameFields.at("ImageStatus")[0], "OK");
}

TEST(SequenceHeader, EveryElementType)
{
  const std::pair<const char*, ScalarType> types[] = { { "MET_CHAR", ScalarType::Int8 },
    { "MET_UCHAR", ScalarType::UInt8 }, { "MET_SHORT", ScalarType::Int16 },
    { "MET_USHORT", ScalarType::UInt16 }, { "MET_INT", ScalarType::Int32 },
    { "MET_UINT", ScalarType::UInt32 }, { "MET_LONG", ScalarType::Int32 },
    { "MET_ULONG", ScalarType::UInt32 }, { "MET_LONG_LONG", ScalarType::Int64 },
    { "MET_ULONG_LONG", ScalarType::UInt64 }, { "MET_FLOAT", ScalarType::Float32 },
    { "MET_DOUBLE", ScalarType::Float64 } };
  for (const auto& [name, type] : types)
  {
    SequenceFile file = MakeSequence();
    file.Set("ElementType", name);
    EXPECT_EQ(Read(file).Type, type) << name;
  }
}

TEST(SequenceHeader, ShapesOfFrames)
{
  SequenceFile file = MakeSequence();
  file.Remove("Kinds"); // old files
  file.Remove("NDims");
  EXPECT_EQ(Read(file).Frames, 3);
  file.Set("NDims", "4");
  file.Set("DimSize", "5 4 1 3");
  EXPECT_EQ(Read(file).Frames, 3);
  file.Set("Kinds", "domain Domain DOMAIN List");
  EXPECT_EQ(Read(file).Frames, 3);

  SequenceFile single = MakeSequence(1);
  single.Set("NDims", "2");
  single.Set("DimSize", "5 4");
  single.Set("Kinds", "domain domain");
  EXPECT_EQ(Read(single).Frames, 1);
  EXPECT_EQ(Read(single).Rows, 4);

  SequenceFile colour = MakeSequence();
  colour.Set("ElementNumberOfChannels", "3");
  EXPECT_EQ(Read(colour).Channels, 3);
  EXPECT_EQ(Read(colour).GetFrameSize(), 60);
  colour.Remove("ElementNumberOfChannels");
  colour.Set("NDims", "4");
  colour.Set("Kinds", "vector domain domain list");
  colour.Set("DimSize", "3 5 4 3");
  EXPECT_EQ(Read(colour).Channels, 3);
  EXPECT_EQ(Read(colour).Columns, 5);
}

TEST(SequenceHeader, ColoursHoweverTheyAreListed)
{
  // components before the columns, but kinds and dimensions that do not count them
  SequenceFile file = MakeSequence();
  file.Set("ElementNumberOfChannels", "3");
  file.Set("DimSize", "3 5 4 3");
  EXPECT_EQ(Read(file).Channels, 3);
  EXPECT_EQ(Read(file).Columns, 5);
  file.Remove("Kinds");
  EXPECT_EQ(Read(file).Columns, 5);
  file.Set("NDims", "4");
  EXPECT_EQ(Read(file).Columns, 5);
  file.Set("DimSize", "3 4 1 2"); // three columns, one layer
  EXPECT_EQ(Read(file).Columns, 3);
  EXPECT_EQ(Read(file).Frames, 2);
  file.Set("Kinds", "vector domain domain list");
  file.Set("DimSize", "4 5 4 3");
  ExpectError(file.GetContent(), { "DimSize gives 4 components but ElementNumberOfChannels 3" });
}

TEST(SequenceHeader, PosesWithoutPictures)
{
  SequenceFile file = MakeSequence();
  file.Set("DimSize", "0 0 0"); // no image
  file.Remove("ElementType");
  const SequenceHeader none = Read(file);
  EXPECT_TRUE(none.PosesOnly);
  EXPECT_EQ(none.Frames, 3); // those that the fields describe
  EXPECT_EQ(none.Columns * none.Rows, 1);
  ExpectWarning(none, "poses but no pictures");
  file.Set("DimSize", "0 0 2");
  EXPECT_EQ(Read(file).Frames, 2);
  EXPECT_TRUE(IsTracked(file.GetContent()));

  SequenceFile dummies = MakeSequence(3, 1, 1); // as PLUS writes them
  EXPECT_FALSE(Read(dummies).PosesOnly);
  for (int i = 0; i < 3; ++i)
  {
    dummies.RemoveFrame(i, "ImageStatus");
  }
  EXPECT_TRUE(Read(dummies).PosesOnly);
  ExpectWarning(Read(dummies), "poses but no pictures");
}

TEST(SequenceHeader, AHeaderCutOffHasItsWholeFramesIfItsPixelsAreBesideIt)
{
  SequenceFile file = MakeSequence(3);
  file.DataFile = "sweep.raw";
  const std::string content = file.GetContent();
  for (const bool beside : { true, false })
  {
    const TemporaryFile stored("sweep.mhd");
    if (beside)
    {
      stored.WriteBeside("sweep.raw", file.Pixels);
    }
    for (std::size_t size = content.find("Seq_Frame0000"); size < content.size(); size += 3)
    {
      stored.Write(content.substr(0, size));
      std::int64_t whole = 0;
      for (int frame = 0; frame < 3; ++frame)
      {
        const std::size_t at =
          content.find("Seq_Frame000" + std::to_string(frame) + "_ImageStatus");
        whole += size >= content.find('\n', at) + 1 ? 1 : 0;
      }
      if (whole == 0 || !beside)
      {
        EXPECT_NE(GetError([&] { ReadSequenceHeader(stored.GetPath()); }).find("cut off"),
          std::string::npos)
          << size;
        continue;
      }
      const SequenceHeader header = ReadSequenceHeader(stored.GetPath());
      ASSERT_EQ(header.Frames, whole) << size;
      EXPECT_EQ(std::filesystem::path(header.DataFileName).filename(), "sweep.raw");
      EXPECT_EQ(header.FrameFields.at("Timestamp").back(), std::to_string(9 + whole) + ".25");
      EXPECT_EQ(header.FrameFields.at("ImageStatus").size(), static_cast<std::size_t>(whole));
    }
  }
}

TEST(SequenceHeader, ExternalData)
{
  SequenceFile file = MakeSequence();
  file.DataFile = "sub/pixels.raw";
  file.Set("HeaderSize", "17");
  const SequenceHeader header = Read(file);
  EXPECT_EQ(std::filesystem::path(header.DataFileName),
    std::filesystem::path(header.FileName).parent_path() / "sub" / "pixels.raw");
  EXPECT_EQ(header.DataOffset, 17);
  file.Set("HeaderSize", "-1");
  EXPECT_EQ(Read(file).SkippedBytes, -1);
  file.Set("HeaderSize", "-2");
  ExpectError(file.GetContent(), { "HeaderSize is -2" });
  file.Remove("HeaderSize");
  file.DataFile = "LIST";
  ExpectError(file.GetContent(), { "'LIST'", "one file per slice" });
  file.DataFile = "slice%03d.raw 1 3 1";
  ExpectError(file.GetContent(), { "one file per slice" });
}

TEST(SequenceHeader, FrameNumbers)
{
  SequenceFile file = MakeSequence();
  file.AddLine("seq_frame0001_Lower = prefix in any case");
  file.AddLine("Seq_Frame2_Short = few digits");
  file.AddLine("Seq_Frame000000002_Long = many digits");
  const SequenceHeader header = Read(file);
  EXPECT_EQ(header.FrameFields.at("Lower")[1], "prefix in any case");
  EXPECT_EQ(header.FrameFields.at("Short")[2], "few digits");
  EXPECT_EQ(header.FrameFields.at("Long")[2], "many digits");

  const SequenceFile many = MakeSequence(10003, 1, 1); // five digits
  EXPECT_EQ(Read(many).FrameFields.at("Timestamp")[10002], "10012.25");
}

TEST(SequenceHeader, OddLinesAreIgnoredWithAWarning)
{
  for (const char* line : { "no equals sign", "= no name", "Seq_Frame_X = 1", "Seq_Frame-1_X = 1",
         "Seq_Frame0001 = 1", "Seq_Frame0001_ = 1", "Seq_Frame99999999999999999999_X = 1" })
  {
    SequenceFile file = MakeSequence();
    file.AddLine(line);
    ExpectWarning(Read(file), "ignored what is neither");
  }
  SequenceFile file = MakeSequence();
  file.SetFrame(3, "Timestamp", "1");
  file.SetFrame(400, "Timestamp", "1");
  ExpectWarning(Read(file), "frames 3 to 400 are ignored: DimSize says 3");
}

TEST(SequenceHeader, GapsInFrames)
{
  SequenceFile file = MakeSequence();
  for (const char* name :
    { "ProbeToTrackerTransform", "ProbeToTrackerTransformStatus", "ReferenceToTrackerTransform",
      "ReferenceToTrackerTransformStatus", "Timestamp", "ImageStatus" })
  {
    file.RemoveFrame(1, name);
  }
  EXPECT_EQ(Read(file).FrameFields.at("Timestamp")[1], "");
  file.Set("DimSize", "5 4 1000000000");
  ExpectError(file.GetContent(), { "DimSize says 1000000000 frames", "only 2" });
}

TEST(SequenceHeader, NoQuadraticMemory)
{
  std::string content = "DimSize = 1 1 20000\nElementType = MET_UCHAR\n";
  for (int i = 0; i < 20000; ++i)
  {
    content += "Seq_Frame" + std::to_string(i) + "_F" + std::to_string(i) + " = 1\n";
  }
  ExpectError(content + "ElementDataFile = LOCAL\n", { "20000 different fields" });
}

TEST(SequenceHeader, DuplicateFields)
{
  SequenceFile file = MakeSequence();
  file.AddLine("DimSize = 5 4 3");
  file.AddLine("Seq_Frame0001_Timestamp = 11.25");
  EXPECT_EQ(Read(file).Frames, 3); // twice the same is no contradiction
  SequenceFile sizes = file;
  sizes.AddLine("DimSize = 4 5 3");
  ExpectError(sizes.GetContent(), { "DimSize again", "4 5 3", "5 4 3", "line " });
  file.AddLine("Seq_Frame0001_Timestamp = 99");
  ExpectError(file.GetContent(), { "frame 1", "Timestamp twice", "'11.25'", "'99'" });
}

TEST(SequenceHeader, WrongSizes)
{
  for (const char* size :
    { "0 4 3", "5 0 3", "5 4 0", "5 -4 3", "5 4 2147483648", "2147483648 4 3" })
  {
    ExpectFieldError("DimSize", size, "must each be from 1 to 2147483647");
  }
  ExpectFieldError("DimSize", "2000000000 2000000000 3", "no file holds so much");
  ExpectFieldError(
    "DimSize", "5 4 99999999999999999999", "'99999999999999999999' is not an integer");
  ExpectFieldError("DimSize", "5 4 3.0", "'3.0' is not an integer");
  ExpectFieldError("DimSize", "5", "NDims is 3 but DimSize");
  ExpectFieldError("DimSize", "5 4 3 1", "NDims is 3 but DimSize");
  ExpectFieldError("NDims", "2", "NDims is 2");
  ExpectFieldError("Kinds", "domain domain", "Kinds lists 2");
  ExpectFieldError("Kinds", "list domain domain", "frames must come last");
  ExpectFieldError("ElementNumberOfChannels", "2", "2 components");
  ExpectFieldError("ElementNumberOfChannels", "-1", "-1 components");
  SequenceFile file = MakeSequence();
  file.Remove("DimSize");
  file.Remove("NDims");
  file.Remove("Kinds");
  ExpectError(file.GetContent(), { "DimSize is missing" });
}

TEST(SequenceHeader, WrongFields)
{
  ExpectFieldError("ElementType", "MET_STRING", "'MET_STRING'");
  ExpectFieldError("ElementType", "met_uchar", "known are MET_CHAR, MET_UCHAR");
  ExpectFieldError("BinaryData", "perhaps", "'perhaps'; it must be True or False");
  ExpectFieldError("CompressedData", "maybe", "'maybe'; it must be True or False");
  ExpectFieldError("CompressedDataSize", "many", "CompressedDataSize is 'many'");
  ExpectFieldError("UltrasoundImageOrientation", "AMF", "'AMF'");
  ExpectFieldError("UltrasoundImageType", "DOPPLER", "'DOPPLER'");
  SequenceFile file = MakeSequence();
  file.Remove("ElementType");
  ExpectError(file.GetContent(), { "ElementType is missing" });
  file = MakeSequence();
  file.DataFile = "";
  ExpectError(file.GetContent(), { "ElementDataFile without a value" });
  file = MakeSequence();
  file.Remove("UltrasoundImageOrientation");
  ExpectWarning(Read(file), "UltrasoundImageOrientation is missing");
}

TEST(SequenceHeader, OrientationsThatAreNotKnown)
{
  for (const char* unknown : { "XX", "??" })
  {
    SequenceFile file = MakeSequence();
    file.Set("UltrasoundImageOrientation", unknown);
    file.Set("UltrasoundImageType", "XX");
    const SequenceHeader header = Read(file);
    ExpectWarning(
      header, "which says that it is not known; the slices are taken as they are stored");
    EXPECT_EQ(header.ImageType, "BRIGHTNESS");
    EXPECT_FALSE(header.Flips.X || header.Flips.Y || header.Flips.Lines);
  }
}

TEST(SequenceHeader, ScanLinesOfGreyLevels)
{
  SequenceFile file = MakeSequence();
  file.Set("UltrasoundImageOrientation", "NM");
  const SequenceHeader header = Read(file);
  EXPECT_TRUE(header.Warnings.empty());
  EXPECT_TRUE(header.Flips.Lines && header.Flips.X && !header.Flips.Y);
  EXPECT_EQ(header.ImageType, "BRIGHTNESS");
}

// A message goes to logs and screens: it has no patient's name.
TEST(SequenceHeader, MessagesDoNotQuoteThePatient)
{
  SequenceFile file = MakeSequence();
  file.AddLine("StudyPatientName = Doe^Jane");
  file.AddLine("StudyPatientName = Roe^Jane");
  std::string error = GetError([&] { Read(file); });
  EXPECT_NE(error.find("StudyPatientName again, with another text"), std::string::npos) << error;
  EXPECT_EQ(error.find("Jane"), std::string::npos) << error;
  file = MakeSequence();
  file.Append(1, "OperatorsName", "Roe");
  file.Append(1, "OperatorsName", "Doe");
  error = GetError([&] { Read(file); });
  EXPECT_NE(error.find("OperatorsName twice, with two texts"), std::string::npos) << error;
  EXPECT_EQ(error.find("oe'"), std::string::npos) << error;
}

TEST(SequenceHeader, ByteOrder)
{
  SequenceFile file = MakeSequence();
  file.Set("BinaryDataByteOrderMSB", "True");
  EXPECT_TRUE(Read(file).BigEndian);
  file.Remove("BinaryDataByteOrderMSB");
  EXPECT_FALSE(Read(file).BigEndian);
  file.Set("ElementByteOrderMSB", "True");
  EXPECT_TRUE(Read(file).BigEndian);
}

TEST(SequenceHeader, WhatIsNotASequence)
{
  ExpectError("", { "empty" });
  ExpectError("hello\nworld\n", { "line 1", "not of the form 'Name = Value'" });
  ExpectError(std::string("ObjectType = Image\nX = \0\1\2", 26), { "line 2", "not text" });
  ExpectError(std::string(3000000, 'x'), { "line 1", "not text" });
  ExpectError("ObjectType = Image\nNDims = 3\n", { "line 2", "ElementDataFile", "cut off" });
  ExpectError(
    "ObjectType = Image\nDimSize = 5 4 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
    { "ordinary image", "own reader" });
  EXPECT_NE(GetError([] { ReadSequenceHeader("/nonexistent.mha"); }).find("no such file"),
    std::string::npos);
  EXPECT_NE(GetError([] { ReadSequenceHeader("/"); }).find("is not a file"), std::string::npos);
}

TEST(SequenceHeader, VolumesAreForOtherReaders)
{
  SequenceFile volume = MakeSequence();
  volume.Set("Kinds", "domain domain domain"); // as the reconstructor of PLUS writes it
  ExpectError(volume.GetContent(), { "volumes of 3 layers" });
  EXPECT_FALSE(IsTracked(volume.GetContent()));
  SequenceFile volumes = MakeSequence(2);
  volumes.Set("NDims", "4");
  volumes.Set("DimSize", "5 4 3 2");
  volumes.Set("Kinds", "domain domain domain list");
  ExpectError(volumes.GetContent(), { "volumes of 3 layers" });
  EXPECT_FALSE(IsTracked(volumes.GetContent()));
}

TEST(SequenceHeader, RecognisesItsFiles)
{
  EXPECT_TRUE(IsTracked(MakeSequence().GetContent()));
  SequenceFile file = MakeSequence();
  file.LineEnd = "\r\n";
  file.Remove("Kinds");
  EXPECT_TRUE(IsTracked(file.GetContent()));
  EXPECT_TRUE(IsTracked(MakeSequence().GetContent().substr(0, 700))); // never reads to the end
  EXPECT_FALSE(IsTracked("ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementDataFile = LOCAL\n"
                         "Seq_Frame0000_Timestamp = this is pixel data\n"));
  EXPECT_FALSE(IsTracked(""));
  EXPECT_FALSE(IsTracked("text\n"));
  EXPECT_FALSE(IsTracked(std::string(5000000, '\7')));
  EXPECT_FALSE(IsTracked("ObjectType = Image\n"));
  EXPECT_FALSE(IsTrackedSequence("/nonexistent.mha"));
  EXPECT_FALSE(IsTrackedSequence("/"));
}
