// SPDX-License-Identifier: BSD-3-Clause
// What a codec does to its process is an error that names the file, and the program goes on.
#include "DicomTestFile.h"
#include "lacunaDicomDecoder.h"
#include "lacunaExecution.h"
#include "lacunaSanitized.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

using namespace lacuna;

namespace
{
constexpr const char* JpegLossless = "1.2.840.10008.1.2.4.70";
constexpr const char* JpegLS = "1.2.840.10008.1.2.4.80";
constexpr const char* Jpeg2000 = "1.2.840.10008.1.2.4.90";

std::string Big(std::uint32_t number, int bytes)
{
  const std::string little = Number(number, bytes);
  return { little.rbegin(), little.rend() };
}

const std::string JpegEnd("\xFF\xD9");

// Lossless JPEG of 12 bits: one bit for each pixel, which says that it is as the one before; the first is
// 2048.
std::string MakeJpeg(int columns, int rows)
{
  return std::string("\xFF\xD8\xFF\xC3\0\x0B\x0C", 7) + Big(rows, 2) + Big(columns, 2) +
    std::string("\1\1\x11\0", 4) + std::string("\xFF\xC4\0\x14\0\1", 6) + std::string(16, '\0') +
    std::string("\xFF\xDA\0\x08\1\1\0\1\0\0", 10) +
    std::string(static_cast<std::size_t>(columns * rows + 7) / 8, '\0') + JpegEnd;
}

// JPEG-LS that ends after its header.
std::string MakeCutJpegLS(int columns, int rows)
{
  return std::string("\xFF\xD8\xFF\xF7\0\x0B\x0C", 7) + Big(rows, 2) + Big(columns, 2) +
    std::string("\1\1\x11\0", 4) + std::string("\xFF\xDA\0\x08\1\1\0\0\0\0\0", 11);
}

// JPEG 2000 with an empty tile of precincts of 2 x 2 pixels, each of which takes the codec memory.
std::string MakePrecincts(int columns, int rows)
{
  std::string stream("\xFF\x4F\xFF\x51\0\x29\0\0", 8);
  for (const int number : { columns, rows, 0, 0, columns, rows, 0, 0 })
  {
    stream += Big(static_cast<std::uint32_t>(number), 4);
  }
  stream += std::string("\0\1\x0B\1\1", 5);
  stream += std::string("\xFF\x52\0\x12\1\0\0\1\0\5\4\4\0\1", 14) + std::string(6, '\x11');
  stream += std::string("\xFF\x5C\0\x13\x40", 5) + std::string(16, '\x70');
  return stream + std::string("\xFF\x90\0\x0A\0\0\0\0\0\x36\0\1\xFF\x93", 14) +
    std::string(40, '\0') + JpegEnd;
}

std::string MakeDicom(const std::string& syntax, const std::string& stream, int columns, int rows,
  int highBit = 11, int stored = 12)
{
  const auto number = [](DicomTag tag, int value)
  { return Short(tag, "US", Number(static_cast<std::uint32_t>(value), 2)); };
  const std::string even = stream + std::string(stream.size() % 2, '\0');
  return Head(syntax) + Short(0x00080060, "CS", "CT") + number(0x00280010, rows) +
    number(0x00280011, columns) + number(0x00280100, 16) + number(0x00280101, stored) +
    number(0x00280102, highBit) + number(0x00280103, 0) +
    Long(
      0x7FE00010, "OB", Implicit(0xFFFEE000, "") + Implicit(0xFFFEE000, even) + SequenceEnd, true);
}

std::string WhyNot(DicomDecoder& decoder, const CTFrame& frame)
{
  try
  {
    CTPixels pixels;
    decoder.Read(frame, pixels);
  }
  catch (const std::runtime_error& error)
  {
    return error.what();
  }
  return {};
}

void ExpectPart(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks\n" << part;
}
}

TEST(DicomDecoder, ProgramIsNotThere)
{
  const Temporary folder;
  const CTFrame frame =
    ReadDicomFrames(folder.Write(MakeDicom(JpegLossless, MakeJpeg(12, 10), 12, 10))).at(0);
  const std::string program = folder.Path.string() + "/nothing";
  DicomDecoder decoder(program);
  ExpectPart(WhyNot(decoder, frame),
    "file: its compressed pixels cannot be decoded: there is no program " + program +
      ", which comes with Lacuna when it is built with GDCM; install Lacuna again");
  std::filesystem::create_directory(program);
  ExpectPart(WhyNot(decoder, frame), program + " cannot be started: Permission denied");
  // what needs no program
  const std::string runs = std::string("\2\0\0\0\x40\0\0\0\x42\0\0\0", 12) + std::string(52, '\0') +
    std::string("\xFD\7\xFD\1", 4);
  const CTFrame run =
    ReadDicomFrames(folder.Write(MakeDicom("1.2.840.10008.1.2.5", runs, 2, 2))).at(0);
  EXPECT_EQ(WhyNot(decoder, run), "");
}

TEST(DecoderProcess, Misbehaves)
{
  const Temporary folder;
  const auto why = [&](const std::string& name) -> std::string
  {
    const std::string program = (folder.Path / name).string();
    std::filesystem::create_symlink(LACUNA_FAKE_DECODER, program);
    try
    {
      DecoderProcess process(program, name == "silent" || name == "mute" ? 0.3 : 30);
      std::vector<unsigned char> pixels(240);
      DecoderRequest request;
      request.StreamBytes = 100;
      request.PixelBytes = pixels.size();
      DecoderFormat format;
      const std::string wrong = process.Decode(request, pixels.data(), pixels.data(), format);
      EXPECT_FALSE(process.IsAlive());
      return wrong;
    }
    catch (const std::runtime_error& error)
    {
      return error.what();
    }
  };
  ExpectPart(
    why("missing-library"), "missing-library does not start, since a library that it needs");
  ExpectPart(why("silent"), "silent does not start in 0 s");
  ExpectPart(why("another"), "another is of another version");
  ExpectPart(why("short"), "they end the program that decodes them (GDCM: no reason is known)");
  ExpectPart(why("mute"), "GDCM takes more time than an image of this size may");
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1); // nothing stays
}

#ifdef LACUNA_DECODER_PROGRAM
TEST(DicomDecoder, Decodes)
{
  const Temporary folder;
  std::vector<CTFrame> frames;
  for (int i = 1; i <= 40; ++i)
  {
    frames.push_back(
      ReadDicomFrames(folder.Write(MakeDicom(JpegLossless, MakeJpeg(10 * i, 7 * i), 10 * i, 7 * i),
        "file" + std::to_string(i)))[0]);
  }
  // whatever the program does with its signals, and whether or not it looks for its processes
  signal(SIGCHLD, SIG_IGN);
  signal(SIGPROF, SIG_IGN);
  DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
  ThreadExecution(4).For(40, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      CTPixels pixels;
      for (std::int64_t i = begin; i < end; ++i)
      {
        decoder.Read(frames[i], pixels);
        ASSERT_EQ(static_cast<std::int64_t>(pixels.Bytes.size()), frames[i].GetSize());
        EXPECT_EQ(pixels.Data, pixels.Bytes.data());
        EXPECT_EQ(pixels.Format.BitsStored, 12);
        for (std::size_t k = 0; k < pixels.Bytes.size(); k += 2)
        {
          ASSERT_EQ(pixels.Bytes[k] + 256 * pixels.Bytes[k + 1], 2048);
        }
      }
    });
  signal(SIGCHLD, SIG_DFL);
  signal(SIGPROF, SIG_DFL);
}

// Wherever a stream ends, there is an error or the whole image: codecs fill the rest with what they like.
TEST(DicomDecoder, CutStreams)
{
  const std::pair<const char*, const char*> images[] = { { "jpeg-lossless-letter", JpegLossless },
    { "jpeg-ls-letter", JpegLS }, { "jpeg-2000-letter", Jpeg2000 } };
  for (const auto& [name, syntax] : images)
  {
    std::ifstream file(std::string(LACUNA_COMPRESSED_IMAGES) + "/" + name, std::ios::binary);
    const std::string image(std::istreambuf_iterator<char>(file), {});
    const std::string stream = image.substr(7); // behind what the fuzzer's target needs
    std::string flat = MakeJpeg(44, 36);
    flat[6] = 16; // bits
    const Temporary folder;
    DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
    const auto decode = [&](const char* codec, const std::string& bytes)
    {
      CTPixels pixels;
      const std::string dicom = MakeDicom(codec, bytes, 44, 36, 15, 16);
      try
      {
        decoder.Read(ReadDicomFrames(folder.Write(dicom)).at(0), pixels);
      }
      catch (const std::runtime_error&)
      {
        pixels.Bytes.clear();
      }
      return pixels.Bytes;
    };
    const std::vector<unsigned char> whole = decode(syntax, stream);
    ASSERT_EQ(whole.size(), 44u * 36 * 2) << name;
    for (std::size_t length = stream.size() - 1; length > 60; length -= 7)
    {
      for (const std::string& end : { std::string(), JpegEnd })
      {
        // another image before: what is left of it must not be taken for this one's
        EXPECT_FALSE(decode(JpegLossless, flat).empty());
        const std::vector<unsigned char> part = decode(syntax, stream.substr(0, length) + end);
        EXPECT_TRUE(part.empty() || part == whole) << name << " " << length << " " << end.size();
      }
    }
  }
}

// GDCM's assertion, which ends its process. The same decoder serves the next image.
TEST(DicomDecoder, CodecAborts)
{
  const Temporary folder;
  const CTFrame hostile =
    ReadDicomFrames(folder.Write(MakeDicom(JpegLossless, MakeJpeg(12, 10), 12, 10, 15))).at(0);
  const CTFrame good =
    ReadDicomFrames(folder.Write(MakeDicom(JpegLossless, MakeJpeg(12, 10), 12, 10), "good")).at(0);
  DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
  for (int i = 0; i < 3; ++i)
  {
    const std::string wrong = WhyNot(decoder, hostile);
    if (!wrong.empty()) // a GDCM without assertions decodes it
    {
      ExpectPart(wrong,
        "file: its compressed pixels cannot be decoded: they end the program that decodes them "
        "(GDCM: "
        "signal 6, Aborted); get this slice from the archive again");
      ExpectPart(wrong, JpegLossless);
    }
    EXPECT_EQ(WhyNot(decoder, good), "");
  }
}

// A cut stream, for which CharLS looks for seconds, is refused at once. Behind this check, its process ends.
TEST(DicomDecoder, CodecStalls)
{
  const Temporary folder;
  const std::string stream = MakeCutJpegLS(12, 10);
  const CTFrame cut = ReadDicomFrames(folder.Write(MakeDicom(JpegLS, stream, 12, 10))).at(0);
  DicomDecoder none(folder.Path.string() + "/nothing");
  ExpectPart(WhyNot(none, cut), "file: its compressed pixels are cut off; get the file again");

  const std::vector<unsigned char> bytes(stream.begin(), stream.end());
  std::vector<unsigned char> pixels(240);
  DecoderRequest request;
  request.StreamBytes = bytes.size();
  request.PixelBytes = pixels.size();
  request.Columns = 12;
  request.Rows = 10;
  request.Format = { 16, 12, 11, 0 };
  std::string(JpegLS).copy(request.TransferSyntax, sizeof request.TransferSyntax - 1);
  DecoderProcess process(LACUNA_DECODER_PROGRAM);
  DecoderFormat format;
  ExpectPart(process.Decode(request, bytes.data(), pixels.data(), format),
    "GDCM takes more time than an image of this size may (250 ms of processor)");
  EXPECT_FALSE(process.IsAlive());
}

// The process takes no more memory than the image may.
TEST(DicomDecoder, CodecTakesMemory)
{
  if (Sanitized)
  {
    GTEST_SKIP() << "a sanitizer takes the addresses, so that there is no limit";
  }
  const Temporary folder;
  constexpr int Edge = 2000;
  const CTFrame frame =
    ReadDicomFrames(folder.Write(MakeDicom(Jpeg2000, MakePrecincts(Edge, Edge), Edge, Edge))).at(0);
  {
    DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
    ExpectPart(WhyNot(decoder, frame), "file: its compressed pixels cannot be decoded: GDCM ");
  }
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const double most = (std::uint64_t{ 320 } << 20) + 17.0 * 2 * Edge * Edge;
  EXPECT_LT(1024.0 * static_cast<double>(usage.ru_maxrss), most) << usage.ru_maxrss;
}
#endif
