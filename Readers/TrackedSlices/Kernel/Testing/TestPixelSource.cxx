// SPDX-License-Identifier: BSD-3-Clause
#include "Compress.h"
#include "SequenceFile.h"
#include "lacunaPixelSource.h"

#include <gtest/gtest.h>

#include <cstring>

using namespace lacuna;

namespace
{
// A sequence on disk, opened.
struct OpenedSequence
{
  TemporaryFile File;
  SequenceHeader Header;
  std::unique_ptr<PixelSource> Pixels;

  explicit OpenedSequence(const std::string& content)
    : File("sweep.igs.mha", content)
    , Header(ReadSequenceHeader(this->File.GetPath()))
    , Pixels(PixelSource::Open(this->Header))
  {
  }
  std::string Read(std::int64_t frame)
  {
    std::string bytes(static_cast<std::size_t>(this->Pixels->GetFrameSize()), '?');
    this->Pixels->ReadFrame(frame, bytes.data());
    return bytes;
  }
};

std::string Frame(const SequenceFile& file, int frame, std::size_t size = 20)
{
  return file.Pixels.substr(static_cast<std::size_t>(frame) * size, size);
}

void ExpectError(const std::string& error, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(error.find(part), std::string::npos) << error << "\nlacks: " << part;
  }
}
}

TEST(PixelSource, ReadsRawFramesInAnyOrder)
{
  const SequenceFile file = MakeSequence();
  OpenedSequence sequence(file.GetContent());
  EXPECT_EQ(sequence.Pixels->GetNumberOfWholeFrames(), 3);
  EXPECT_EQ(sequence.Pixels->GetWarning(), "");
  for (const int frame : { 2, 0, 1, 1 })
  {
    EXPECT_EQ(sequence.Read(frame), Frame(file, frame));
  }
  ExpectError(GetError([&] { sequence.Read(3); }), { "frame 3 is not one of the 3" });
  ExpectError(GetError([&] { sequence.Read(-1); }), { "frame -1" });
}

TEST(PixelSource, ReadsCompressedFramesInAnyOrder)
{
  const SequenceFile file = MakeSequence(9);
  for (const bool sizeKnown : { true, false })
  {
    OpenedSequence sequence(Compressed(file, sizeKnown).GetContent());
    EXPECT_EQ(sequence.Pixels->GetNumberOfWholeFrames(), 9);
    for (const int frame : { 4, 0, 1, 8, 8, 2, 3, 3, 7 })
    {
      EXPECT_EQ(sequence.Read(frame), Frame(file, frame)) << frame;
    }
  }
}

TEST(PixelSource, AFileCutOffAtAnyByteIsReadableUpToItsLastWholeFrame)
{
  const SequenceFile file = MakeSequence(4);
  const std::string content = file.GetContent();
  const std::size_t header = file.GetHeader().size();
  for (std::size_t bytes = 0; bytes < 80; ++bytes)
  {
    const std::string cut = content.substr(0, header + bytes);
    if (bytes < 20)
    {
      ExpectError(GetError([&] { OpenedSequence sequence(cut); }),
        { std::to_string(bytes) + " bytes of pixels", "one frame has 20" });
      continue;
    }
    OpenedSequence sequence(cut);
    const auto whole = static_cast<int>(bytes / 20);
    ASSERT_EQ(sequence.Pixels->GetNumberOfWholeFrames(), whole);
    EXPECT_EQ(sequence.Read(whole - 1), Frame(file, whole - 1));
    ExpectError(sequence.Pixels->GetWarning(),
      { "cut off: " + std::to_string(whole) + " of the 4 frames are there" });
  }
}

TEST(PixelSource, ACompressedFileThatIsCutOff)
{
  const SequenceFile file = MakeSequence(40);
  const SequenceFile compressed = Compressed(file);
  const std::string content = compressed.GetContent();
  std::int64_t most = 0;
  for (std::size_t size = compressed.GetHeader().size(); size < content.size(); ++size)
  {
    std::unique_ptr<OpenedSequence> sequence;
    const std::string error =
      GetError([&] { sequence = std::make_unique<OpenedSequence>(content.substr(0, size)); });
    if (!sequence)
    {
      ExpectError(error, { "bytes of pixels, but one frame has 20" });
      continue;
    }
    const std::int64_t whole = sequence->Pixels->GetNumberOfWholeFrames();
    ASSERT_GE(whole, most);
    most = whole;
    ASSERT_EQ(sequence->Read(whole - 1), Frame(file, static_cast<int>(whole) - 1));
    ASSERT_EQ(sequence->Read(0), Frame(file, 0));
  }
  EXPECT_EQ(most, 40); // only the check sum was missing
}

TEST(PixelSource, CorruptCompressedData)
{
  const SequenceFile file = MakeSequence(40);
  const SequenceFile good = Compressed(file);
  for (std::size_t at = 0; at < good.Pixels.size(); ++at)
  {
    SequenceFile bad = good;
    bad.Pixels[at] = static_cast<char>(bad.Pixels[at] ^ 0x10);
    bool noticed = true; // or no harm done: some bits of the stream mean nothing
    try
    {
      OpenedSequence sequence(bad.GetContent());
      for (int frame = 0; frame < 40; ++frame)
      {
        noticed = sequence.Read(frame) == Frame(file, frame) && noticed;
      }
    }
    catch (const std::runtime_error& e)
    {
      noticed = std::string(e.what()).find("corrupt") != std::string::npos ||
        std::string(e.what()).find("too early") != std::string::npos;
    }
    EXPECT_TRUE(noticed) << at;
  }
  SequenceFile garbage = good;
  garbage.Pixels = std::string(good.Pixels.size(), 'g');
  OpenedSequence sequence(garbage.GetContent());
  ExpectError(GetError([&] { sequence.Read(5); }), { "corrupt in frame 0" });
  ExpectError(GetError([&] { sequence.Read(5); }), { "corrupt in frame 0" }); // and again
}

TEST(PixelSource, SaysWhichFramesComeBeforeTheCorruptOne)
{
  const SequenceFile file = MakeSequence(3, 500, 400);
  SequenceFile stored = Compressed(file, true, 0); // stored blocks: damage shows where it is
  for (std::size_t i = stored.Pixels.size() * 9 / 10; i < stored.Pixels.size(); ++i)
  {
    stored.Pixels[i] = '\xff';
  }
  OpenedSequence sequence(stored.GetContent());
  EXPECT_EQ(sequence.Read(1), Frame(file, 1, 200000));
  ExpectError(GetError([&] { sequence.Read(2); }),
    { "sweep.igs.mha", "corrupt in frame 2", "FrameRange 0 1 reads the frames before it" });
}

TEST(PixelSource, SizesThatCannotBe)
{
  SequenceFile file = MakeSequence();
  file.Set("DimSize", "100000 100000 3");
  ExpectError(GetError([&] { OpenedSequence sequence(file.GetContent()); }),
    { "60 bytes of pixels", "one frame has 10000000000" });
  SequenceFile compressed = Compressed(MakeSequence());
  compressed.Set("DimSize", "100000 100000 3");
  ExpectError(GetError([&] { OpenedSequence sequence(compressed.GetContent()); }),
    { "cannot hold the 3 frames of 10000000000 bytes" });
  compressed.Set("CompressedDataSize", "9000000000000000000");
  ExpectError(GetError([&] { OpenedSequence sequence(compressed.GetContent()); }),
    { "bytes of pixels, but one frame has" });
}

TEST(PixelSource, SurplusDataAreReported)
{
  SequenceFile file = MakeSequence();
  file.Set("DimSize", "5 3 3");
  OpenedSequence sequence(file.GetContent());
  ExpectError(sequence.Pixels->GetWarning(), { "15 bytes after the last frame", "DimSize" });
}

TEST(PixelSource, ExternalFiles)
{
  SequenceFile file = MakeSequence();
  const std::string pixels = file.Pixels;
  file.DataFile = "pixels.raw";
  const TemporaryFile header("sweep.mhd", file.GetContent());
  const SequenceHeader read = ReadSequenceHeader(header.GetPath());
  ExpectError(GetError([&] { PixelSource::Open(read); }),
    { "sweep.mhd", "pixels.raw", "ElementDataFile", "there is no such file" });
  header.WriteBeside("pixels.raw", pixels);
  std::string frame(20, '?');
  PixelSource::Open(read)->ReadFrame(1, frame.data());
  EXPECT_EQ(frame, pixels.substr(20, 20));

  header.WriteBeside("pixels.raw", "header" + pixels);
  file.Set("HeaderSize", "6");
  header.Write(file.GetContent());
  const SequenceHeader skipping = ReadSequenceHeader(header.GetPath());
  PixelSource::Open(skipping)->ReadFrame(2, frame.data());
  EXPECT_EQ(frame, pixels.substr(40, 20));
  file.Set("HeaderSize", "-1");
  header.Write(file.GetContent());
  const SequenceHeader atEnd = ReadSequenceHeader(header.GetPath());
  PixelSource::Open(atEnd)->ReadFrame(0, frame.data());
  EXPECT_EQ(frame, pixels.substr(0, 20));

  const SequenceFile compressed = Compressed(MakeSequence());
  SequenceFile zraw = compressed;
  zraw.DataFile = "pixels.zraw";
  header.Write(zraw.GetContent());
  header.WriteBeside("pixels.zraw", compressed.Pixels);
  const SequenceHeader zheader = ReadSequenceHeader(header.GetPath());
  PixelSource::Open(zheader)->ReadFrame(2, frame.data());
  EXPECT_EQ(frame, pixels.substr(40, 20));
}

TEST(PixelSource, HeaderSizeSaysWhereThePixelsAre)
{
  const auto read = [](const TemporaryFile& file)
  {
    const SequenceHeader header = ReadSequenceHeader(file.GetPath());
    const auto source = PixelSource::Open(header);
    std::string pixels(60, '?');
    for (int i = 0; i < 3; ++i)
    {
      source->ReadFrame(i, pixels.data() + 20 * static_cast<std::ptrdiff_t>(i));
    }
    return pixels;
  };
  const SequenceFile raw = MakeSequence();
  const SequenceFile zipped = Compressed(MakeSequence());
  for (const bool compressed : { false, true })
  {
    for (const bool local : { true, false })
    {
      SequenceFile file = compressed ? zipped : raw;
      file.Set("CompressedDataSize", std::to_string(zipped.Pixels.size()));
      file.DataFile = local ? "LOCAL" : "pixels.dat";
      const TemporaryFile written(local ? "sweep.mha" : "sweep.mhd");
      const auto write = [&](const std::string& headerSize, const std::string& before)
      {
        file.Set("HeaderSize", headerSize);
        written.Write(file.GetHeader() + (local ? before + file.Pixels : ""));
        written.WriteBeside(local ? "other" : "pixels.dat", before + file.Pixels);
      };
      for (const std::string before : { "", "some bytes that no one asked for\n" })
      {
        write("-1", before);
        EXPECT_EQ(read(written), raw.Pixels) << local << compressed;
        const std::size_t header = local ? file.GetHeader().size() : 0;
        write(std::to_string(header + before.size()), before);
        // the number's digits have made the header longer
        const std::size_t now = local ? file.GetHeader().size() : 0;
        write(std::to_string(now + before.size()), before);
        EXPECT_EQ(read(written), raw.Pixels) << local << compressed;
      }
      write("0", "");
      EXPECT_EQ(read(written), raw.Pixels);
    }
  }
  // contradictions
  SequenceFile file = raw;
  file.Set("HeaderSize", "100");
  ExpectError(GetError([&] { read(TemporaryFile("sweep.mha", file.GetContent())); }),
    { "sweep.mha", "HeaderSize is 100", "the header itself", "bytes" });
  file.Set("HeaderSize", "1000000");
  ExpectError(GetError([&] { read(TemporaryFile("sweep.mha", file.GetContent())); }),
    { "there are 0 bytes of pixels" });
  file.Set("HeaderSize", "-1");
  file.Set("BinaryData", "False");
  ExpectError(GetError([&] { read(TemporaryFile("sweep.mha", file.GetContent())); }),
    { "HeaderSize is -1", "must be the number of bytes" });
  file = zipped;
  file.Set("HeaderSize", "-1");
  file.Remove("CompressedDataSize");
  ExpectError(GetError([&] { read(TemporaryFile("sweep.mha", file.GetContent())); }),
    { "HeaderSize is -1", "CompressedDataSize" });
  file.Set("CompressedDataSize", std::to_string(zipped.Pixels.size() + 1));
  ExpectError(GetError([&] { read(TemporaryFile("sweep.mha", file.GetContent())); }),
    { "CompressedDataSize", "there are only " + std::to_string(zipped.Pixels.size()) });
  // a file that is cut off has no bytes of its header among the pixels
  file = raw;
  file.Set("HeaderSize", "-1");
  const std::string whole = file.GetContent();
  const TemporaryFile cut("sweep.mha", whole.substr(0, whole.size() - 5));
  const SequenceHeader header = ReadSequenceHeader(cut.GetPath());
  const auto source = PixelSource::Open(header);
  EXPECT_EQ(source->GetNumberOfWholeFrames(), 2);
  std::string frame(20, '?');
  source->ReadFrame(1, frame.data());
  EXPECT_EQ(frame, raw.Pixels.substr(20, 20));
}

TEST(PixelSource, ByteOrderAndEveryType)
{
  const auto check = [](const char* name, auto example)
  {
    using T = decltype(example);
    SequenceFile file = MakeSequence();
    file.Set("ElementType", name);
    std::vector<T> values(60);
    for (std::size_t i = 0; i < 60; ++i)
    {
      values[i] = static_cast<T>(static_cast<T>(i * 2) + example);
    }
    for (const bool big : { false, true })
    {
      file.Pixels.assign(reinterpret_cast<const char*>(values.data()), 60 * sizeof(T));
      if (big)
      {
        for (std::size_t i = 0; i < 60; ++i)
        {
          std::reverse(file.Pixels.begin() + static_cast<std::ptrdiff_t>(i * sizeof(T)),
            file.Pixels.begin() + static_cast<std::ptrdiff_t>((i + 1) * sizeof(T)));
        }
      }
      file.Set("BinaryDataByteOrderMSB", big ? "True" : "False");
      for (const bool compress : { false, true })
      {
        OpenedSequence sequence((compress ? Compressed(file) : file).GetContent());
        EXPECT_EQ(GetScalarSize(sequence.Pixels->GetScalarType()), sizeof(T)) << name;
        const std::string bytes = sequence.Read(1);
        ASSERT_EQ(bytes.size(), 20 * sizeof(T));
        EXPECT_EQ(std::memcmp(bytes.data(), values.data() + 20, bytes.size()), 0) << name << big;
      }
    }
  };
  check("MET_CHAR", std::int8_t(-100));
  check("MET_UCHAR", std::uint8_t(100));
  check("MET_SHORT", std::int16_t(-30000));
  check("MET_USHORT", std::uint16_t(60000));
  check("MET_INT", std::int32_t(-2000000000));
  check("MET_UINT", std::uint32_t(4000000000u));
  check("MET_LONG", std::int32_t(-2000000000)); // MetaImage: four bytes
  check("MET_ULONG", std::uint32_t(4000000000u));
  check("MET_LONG", std::int64_t(-9000000000000000000)); // a machine's long
  check("MET_ULONG", std::uint64_t(18000000000000000000u));
  check("MET_LONG_LONG", std::int64_t(-9000000000000000000));
  check("MET_ULONG_LONG", std::uint64_t(18000000000000000000u));
  check("MET_FLOAT", 1.5e30f);
  check("MET_DOUBLE", -1.5e300);
}

TEST(PixelSource, FilesOverFourGigabytes)
{
  // A sparse file: more than 4 GiB long, a few hundred kilobytes on disk.
  const int frames = 1100;
  SequenceFile file = MakeSequence(frames, 1, 1);
  file.Set("DimSize", "4096 1024 " + std::to_string(frames));
  file.Pixels.clear();
  const TemporaryFile sparse("sweep.igs.mha", file.GetContent());
  const auto offset = static_cast<std::int64_t>(file.GetHeader().size());
  const std::int64_t frameSize = 4096 * 1024;
  std::error_code error;
  std::filesystem::resize_file(
    sparse.GetPath(), static_cast<std::uintmax_t>(offset + frames * frameSize), error);
  if (error)
  {
    GTEST_SKIP() << "no sparse files here: " << error.message();
  }
  {
    std::fstream stream(sparse.GetPath(), std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(offset + frames * frameSize - 3));
    stream << "END";
    stream.seekp(static_cast<std::streamoff>(offset + 1030 * frameSize));
    stream << "START";
  }
  const SequenceHeader header = ReadSequenceHeader(sparse.GetPath());
  const auto pixels = PixelSource::Open(header);
  EXPECT_EQ(pixels->GetNumberOfWholeFrames(), frames);
  std::string frame(static_cast<std::size_t>(frameSize), '?');
  pixels->ReadFrame(frames - 1, frame.data());
  EXPECT_EQ(frame.substr(frame.size() - 4), std::string("\0END", 4));
  pixels->ReadFrame(1030, frame.data());
  EXPECT_EQ(frame.substr(0, 6), std::string("START\0", 6));
}
