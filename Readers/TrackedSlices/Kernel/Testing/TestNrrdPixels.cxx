// SPDX-License-Identifier: BSD-3-Clause
// Pixels of NRRD files in every encoding, and text in MetaImages.
#include "NrrdFile.h"
#include "lacunaByteStream.h"
#include "lacunaPixelSource.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

using namespace lacuna;

namespace
{
// A sequence on disk, opened, with another file beside it.
struct OpenedNrrd
{
  TemporaryFile File;
  SequenceHeader Header;
  std::unique_ptr<PixelSource> Pixels;

  explicit OpenedNrrd(const std::string& content, const std::string& beside = {})
    : File("sweep.nrrd", content)
  {
    if (!beside.empty())
    {
      this->File.WriteBeside("pixels", beside);
    }
    this->Header = ReadSequenceHeader(this->File.GetPath());
    this->Pixels = PixelSource::Open(this->Header);
  }
  std::string Read(std::int64_t frame)
  {
    std::string bytes(static_cast<std::size_t>(this->Pixels->GetFrameSize()), '?');
    this->Pixels->ReadFrame(frame, bytes.data());
    return bytes;
  }
};

std::string Frame(const std::string& pixels, int frame)
{
  return pixels.substr(static_cast<std::size_t>(frame) * 20, 20);
}

NrrdFile Encoded(int frames, const std::string& encoding)
{
  NrrdFile file = MakeNrrd(frames);
  file.Set("encoding", encoding);
  file.Pixels = encoding == "gzip" ? Gzip(file.Pixels)
    : encoding == "hex"            ? ToHex(file.Pixels)
    : encoding == "ascii"          ? ToText(file.Pixels)
                                   : file.Pixels;
  return file;
}

void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
}

// Numbers as text in a MetaImage.
template <class T>
std::vector<T> ReadText(const char* type, const std::string& text)
{
  SequenceFile file = MakeSequence(1, 2, 2);
  file.Set("BinaryData", "False");
  file.Set("ElementType", type);
  file.Pixels = text;
  OpenedNrrd opened(file.GetContent());
  EXPECT_EQ(opened.Pixels->GetFrameSize(), static_cast<std::int64_t>(4 * sizeof(T)));
  std::vector<T> values(4);
  opened.Pixels->ReadFrame(0, values.data());
  return values;
}
}

TEST(NrrdPixels, EveryEncodingInAnyOrder)
{
  const std::string pixels = MakeNrrd(9).Pixels;
  for (const char* encoding : { "raw", "gzip", "hex", "ascii" })
  {
    OpenedNrrd opened(Encoded(9, encoding).GetContent());
    EXPECT_EQ(opened.Pixels->GetNumberOfWholeFrames(), 9);
    EXPECT_EQ(opened.Pixels->GetWarning(), "");
    for (const int frame : { 4, 0, 1, 8, 8, 2, 3, 3, 7 })
    {
      EXPECT_EQ(opened.Read(frame), Frame(pixels, frame)) << encoding << frame;
    }
  }
}

TEST(NrrdPixels, DetachedWithSkips)
{
  const std::string pixels = MakeNrrd(4).Pixels;
  for (const char* encoding : { "raw", "gzip", "hex", "ascii" })
  {
    NrrdFile file = Encoded(4, encoding);
    file.Detached = true;
    file.Set("data file", "pixels");
    file.Set("line skip", "2");
    const std::string lines = "first line\nsecond : line\r\n";
    OpenedNrrd opened(file.GetContent(), lines + file.Pixels);
    EXPECT_EQ(opened.Read(3), Frame(pixels, 3)) << encoding;
    EXPECT_EQ(opened.Read(1), Frame(pixels, 1)) << encoding;

    // bytes are skipped after the lines, in what is decoded
    NrrdFile longer = MakeNrrd(4);
    longer.Pixels = "1234567" + longer.Pixels;
    const std::string more = std::string(encoding) == "gzip" ? Gzip(longer.Pixels)
      : std::string(encoding) == "hex"                       ? ToHex(longer.Pixels)
      : std::string(encoding) == "ascii"                     ? ToText(longer.Pixels)
                                                             : longer.Pixels;
    file.Set("byte skip", "7");
    OpenedNrrd skipping(file.GetContent(), lines + more);
    EXPECT_EQ(skipping.Read(3), Frame(pixels, 3)) << encoding;
    EXPECT_EQ(skipping.Read(0), Frame(pixels, 0)) << encoding;
    EXPECT_EQ(skipping.Pixels->GetNumberOfWholeFrames(), 4);

    file.Set("byte skip", "9223372036854775807");
    ExpectContains(GetError([&] { OpenedNrrd none(file.GetContent(), lines + more); }),
      "there are 0 bytes of pixels");
    file.Set("line skip", "5000000");
    ExpectContains(GetError([&] { OpenedNrrd none(file.GetContent(), lines + more); }),
      "line skip says that the pixels follow after 5000000");
  }
  NrrdFile atEnd = Encoded(4, "raw");
  atEnd.Detached = true;
  atEnd.Set("data file", "pixels");
  atEnd.Set("byte skip", "-1");
  OpenedNrrd opened(atEnd.GetContent(), "whatever comes before" + pixels);
  EXPECT_EQ(opened.Read(0), Frame(pixels, 0));
  EXPECT_EQ(opened.Read(3), Frame(pixels, 3));
  EXPECT_EQ(opened.Pixels->GetWarning(), "");
}

TEST(NrrdPixels, GzipInSeveralMembers)
{
  const std::string pixels = MakeNrrd(6).Pixels;
  NrrdFile file = Encoded(6, "gzip");
  file.Pixels = Gzip(pixels.substr(0, 31)) + Gzip(pixels.substr(31, 60)) + Gzip(pixels.substr(91));
  OpenedNrrd opened(file.GetContent());
  EXPECT_EQ(opened.Pixels->GetNumberOfWholeFrames(), 6);
  for (const int frame : { 5, 0, 3 })
  {
    EXPECT_EQ(opened.Read(frame), Frame(pixels, frame));
  }
  file.Pixels += "junk";
  OpenedNrrd junk(file.GetContent());
  EXPECT_EQ(junk.Read(5), Frame(pixels, 5));
}

TEST(NrrdPixels, GzipAndTextCutOffAnywhere)
{
  const std::string pixels = MakeNrrd(6).Pixels;
  for (const std::string encoding : { "gzip", "hex", "ascii" })
  {
    const NrrdFile file = Encoded(6, encoding);
    const std::string content = file.GetContent();
    std::int64_t most = 0;
    for (std::size_t size = file.GetHeader().size(); size < content.size(); ++size)
    {
      std::unique_ptr<OpenedNrrd> opened;
      const std::string error =
        GetError([&] { opened = std::make_unique<OpenedNrrd>(content.substr(0, size)); });
      if (!opened)
      {
        ExpectContains(error, "bytes of pixels, but one frame has 20");
        continue;
      }
      const std::int64_t whole = opened->Pixels->GetNumberOfWholeFrames();
      ASSERT_GE(whole, most);
      most = whole;
      if (encoding == "ascii") // the last number may have lost digits
      {
        ASSERT_EQ(opened->Read(whole - 1).substr(0, 19),
          Frame(pixels, static_cast<int>(whole) - 1).substr(0, 19));
      }
      else
      {
        ASSERT_EQ(opened->Read(whole - 1), Frame(pixels, static_cast<int>(whole) - 1));
      }
    }
    EXPECT_EQ(most, encoding == "hex" ? 5 : 6) << encoding; // gzip lacked only its check sum
  }
}

TEST(NrrdPixels, CorruptText)
{
  NrrdFile hex = Encoded(3, "hex");
  hex.Pixels[2 * 25] = 'g';
  OpenedNrrd opened(hex.GetContent());
  EXPECT_EQ(opened.Pixels->GetNumberOfWholeFrames(), 1);
  ExpectContains(opened.Pixels->GetWarning(), "have the byte 103 where a hexadecimal digit");
  ExpectContains(opened.Pixels->GetWarning(), "1 of the 3 frames");
  hex.Pixels[0] = '\0';
  ExpectContains(GetError([&] { OpenedNrrd none(hex.GetContent()); }), "in frame 0");

  NrrdFile text = MakeNrrd(2, 2, 1);
  text.Set("encoding", "text");
  for (const char* bad : { "256", "-1", "1.5", "x", "1e2", "" })
  {
    text.Pixels = "1, 2\n3 " + std::string(bad) + " 5";
    if (*bad)
    {
      OpenedNrrd some(text.GetContent());
      EXPECT_EQ(some.Pixels->GetNumberOfWholeFrames(), 1);
      ExpectContains(
        some.Pixels->GetWarning(), "have '" + std::string(bad) + "' as number 3, which");
    }
  }
  text.Pixels = std::string(100000, '1');
  ExpectContains(GetError([&] { OpenedNrrd none(text.GetContent()); }), "as number 0");
}

TEST(NrrdPixels, TextOfEveryKindOfNumber)
{
  EXPECT_EQ(ReadText<std::int8_t>("MET_CHAR", "-128 127 +1 0"),
    (std::vector<std::int8_t>{ -128, 127, 1, 0 }));
  EXPECT_EQ(ReadText<std::uint64_t>("MET_ULONG_LONG", "18446744073709551615\n0\n1\n2\n"),
    (std::vector<std::uint64_t>{ ~0ull, 0, 1, 2 }));
  EXPECT_EQ(ReadText<std::int32_t>("MET_LONG", "-2147483648 1 2 3"),
    (std::vector<std::int32_t>{ std::numeric_limits<std::int32_t>::min(), 1, 2, 3 }));
  const auto doubles = ReadText<double>("MET_DOUBLE", "1e-005 nan -inf\t4.25");
  EXPECT_EQ(doubles[0], 1e-5);
  EXPECT_TRUE(std::isnan(doubles[1]));
  EXPECT_EQ(doubles[2], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(doubles[3], 4.25);
  EXPECT_EQ(
    ReadText<float>("MET_FLOAT", "0.1 1e30 -2 3"), (std::vector<float>{ 0.1f, 1e30f, -2, 3 }));
  ExpectContains(
    GetError([] { ReadText<float>("MET_FLOAT", "1e39 1 1 1"); }), "'1e39' as number 0");
  ExpectContains(
    GetError([] { ReadText<std::int32_t>("MET_LONG", "3000000000 1 1 1"); }), "as number 0");
}

TEST(NrrdPixels, BigEndian)
{
  NrrdFile file = MakeNrrd(2, 2, 1);
  file.Set("type", "int16");
  file.Set("endian", "big");
  for (const char* encoding : { "raw", "gzip", "hex" })
  {
    const std::string bytes("\x01\x02\x03\x04\xff\xfe\x00\x07", 8);
    file.Set("encoding", encoding);
    file.Pixels = std::string(encoding) == "gzip" ? Gzip(bytes)
      : std::string(encoding) == "hex"            ? ToHex(bytes)
                                                  : bytes;
    OpenedNrrd opened(file.GetContent());
    std::int16_t values[2] = {};
    opened.Pixels->ReadFrame(1, values);
    EXPECT_EQ(values[0], -2);
    EXPECT_EQ(values[1], 7);
  }
}
