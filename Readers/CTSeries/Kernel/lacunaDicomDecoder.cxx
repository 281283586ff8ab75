// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include "lacunaDicomHeader.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::size_t RunHeader = 64;
// A stream of a hundred bytes can stand for an image of one value of any size, which is no CT.
constexpr std::int64_t FreeBytes = std::int64_t(32) << 20; // 4096 x 4096 of 16 bits
constexpr std::int64_t MostPerByte = 1000;
constexpr std::size_t Jpeg2000Header = 42; // up to the first component's subsampling

// Numbers of a stream; 0 beyond its end.
class Stream
{
public:
  explicit Stream(const std::vector<unsigned char>& bytes)
    : Bytes(bytes)
  {
  }
  std::uint32_t Big(std::size_t offset, int count) const
  {
    std::uint32_t number = 0;
    for (int i = 0; i < count; ++i)
    {
      const std::size_t at = offset + static_cast<std::size_t>(i);
      number = number << 8 | (at < this->Bytes.size() ? this->Bytes[at] : 0);
    }
    return number;
  }

private:
  const std::vector<unsigned char>& Bytes;
};

enum class Coding
{
  None,
  Jpeg,
  JpegLS,
  Jpeg2000
};

// Of transfer syntaxes 1.2.840.10008.1.2.4.*; others are for the codec to refuse.
Coding GetCoding(const std::string& transferSyntax)
{
  const auto is = [&](const char* kind)
  { return transferSyntax.rfind(std::string("1.2.840.10008.1.2.4.") + kind, 0) == 0; };
  if (is("9") || is("20"))
  {
    return Coding::Jpeg2000;
  }
  return is("8") ? Coding::JpegLS : Coding::Jpeg;
}

const char* GetName(Coding coding)
{
  switch (coding)
  {
    case Coding::Jpeg:
      return "JPEG";
    case Coding::JpegLS:
      return "JPEG-LS";
    case Coding::Jpeg2000:
      return "JPEG 2000";
    default:
      return "no known coding";
  }
}

struct ImageSize
{
  Coding Kind = Coding::None;
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  int Bits = 0;
  int Components = 0;
};

// Whether a JPEG-LS stream has an end: no other two bytes of it are these. CharLS looks for the end of a
// stream that is cut off for seconds.
bool HasEnd(const std::vector<unsigned char>& bytes)
{
  constexpr std::array<unsigned char, 2> End = { 0xFF, 0xD9 };
  return std::search(bytes.begin(), bytes.end(), End.begin(), End.end()) != bytes.end();
}

// JPEG 2000, a code stream without its file format: SOC, SIZ.
ImageSize ReadJpeg2000Size(const Stream& stream)
{
  ImageSize size;
  size.Kind = Coding::Jpeg2000;
  size.Columns = std::int64_t{ stream.Big(8, 4) } - stream.Big(16, 4);
  size.Rows = std::int64_t{ stream.Big(12, 4) } - stream.Big(20, 4);
  size.Components = static_cast<int>(stream.Big(40, 2));
  size.Bits = static_cast<int>(stream.Big(42, 1) & 0x7F) + 1;
  const bool whole = stream.Big(43, 1) == 1 && stream.Big(44, 1) == 1; // no subsampling
  return whole ? size : ImageSize();
}

constexpr std::uint32_t StartOfFrameLS = 0xF7;

bool IsStartOfFrame(std::uint32_t marker)
{
  return marker == StartOfFrameLS ||
    (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC);
}

// JPEG and JPEG-LS: the markers up to the first scan. A lossless one must name a predictor.
ImageSize ReadJpegSize(const Stream& stream, std::size_t length)
{
  constexpr std::uint32_t Lossless = 0xC3;
  constexpr std::uint32_t StartOfScan = 0xDA;
  ImageSize size;
  bool lossless = false;
  std::size_t at = 2;
  while (at + 4 <= length && stream.Big(at, 1) == 0xFF)
  {
    const std::uint32_t marker = stream.Big(at + 1, 1);
    if (marker == 0xFF) // fill byte
    {
      ++at;
      continue;
    }
    if (marker == StartOfScan)
    {
      const std::uint32_t predictor = stream.Big(at + 5 + 2 * stream.Big(at + 4, 1), 1);
      return lossless && (predictor < 1 || predictor > 7) ? ImageSize() : size;
    }
    if (IsStartOfFrame(marker))
    {
      lossless = marker == Lossless;
      size = { marker == StartOfFrameLS ? Coding::JpegLS : Coding::Jpeg, stream.Big(at + 7, 2),
        stream.Big(at + 5, 2), static_cast<int>(stream.Big(at + 4, 1)),
        static_cast<int>(stream.Big(at + 9, 1)) };
    }
    at += 2 + std::max<std::size_t>(2, stream.Big(at + 2, 2));
  }
  return {};
}
}

//------------------------------------------------------------------------------
std::string WhyNotImage(const std::vector<unsigned char>& bytes, const std::string& transferSyntax,
  std::int64_t columns, std::int64_t rows, int allocated)
{
  const Stream stream(bytes);
  const std::uint32_t begin = stream.Big(0, 4);
  ImageSize size;
  if (begin == 0xFF4FFF51 && bytes.size() > Jpeg2000Header)
  {
    size = ReadJpeg2000Size(stream);
  }
  else if (begin >> 16 == 0xFFD8)
  {
    size = ReadJpegSize(stream, bytes.size());
  }
  const Coding wanted = GetCoding(transferSyntax);
  if (size.Kind != Coding::None && size.Kind != wanted)
  {
    return std::string("are ") + GetName(size.Kind) + ", not " + GetName(wanted);
  }
  if (size.Components == 1 && size.Columns == columns && size.Rows == rows &&
    (size.Bits + 7) / 8 * 8 == allocated)
  {
    const std::int64_t decoded = columns * rows * (allocated / 8);
    const auto stored = static_cast<std::int64_t>(bytes.size());
    if (decoded > FreeBytes && decoded / MostPerByte > stored)
    {
      return "are " + std::to_string(stored) + " bytes, too few for an image of " +
        std::to_string(decoded) + " (at most " + std::to_string(MostPerByte) +
        " times as many, or 32 MiB); the file is damaged, or no CT";
    }
    if (size.Kind == Coding::JpegLS && !HasEnd(bytes))
    {
      return "are cut off; get the file again from the archive";
    }
    return {};
  }
  return "are of " + std::to_string(size.Columns) + " x " + std::to_string(size.Rows) +
    " pixels of " + std::to_string(size.Components) + " times " + std::to_string(size.Bits) +
    " bits, not of " + std::to_string(columns) + " x " + std::to_string(rows) + " of " +
    (allocated > 8 ? std::to_string(allocated - 7) + " to " : "up to ") +
    std::to_string(allocated) + " (Bits Allocated, 0028,0100)";
}

//------------------------------------------------------------------------------
bool DecodeRunLength(
  const std::vector<unsigned char>& stream, int bytesPerPixel, std::vector<unsigned char>& pixels)
{
  const auto width = static_cast<std::size_t>(bytesPerPixel);
  const std::size_t count = pixels.size() / width;
  const auto little = [&](std::size_t at)
  {
    return static_cast<std::size_t>(stream[at]) | static_cast<std::size_t>(stream[at + 1]) << 8 |
      static_cast<std::size_t>(stream[at + 2]) << 16 |
      static_cast<std::size_t>(stream[at + 3]) << 24;
  };
  if (stream.size() < RunHeader || little(0) != width)
  {
    return false;
  }
  // a segment for each byte of a pixel, the highest first
  for (std::size_t segment = 0; segment < width; ++segment)
  {
    std::size_t at = little(4 + 4 * segment);
    const std::size_t end = segment + 1 < width ? little(8 + 4 * segment) : stream.size();
    if (at < RunHeader || end > stream.size())
    {
      return false;
    }
    const std::size_t place = width - 1 - segment;
    std::size_t written = 0;
    while (written < count)
    {
      if (at >= end)
      {
        return false;
      }
      const int code = static_cast<signed char>(stream[at++]);
      if (code == -128)
      {
        continue;
      }
      const std::size_t length = static_cast<std::size_t>(code >= 0 ? code + 1 : 1 - code);
      const std::size_t needed = code >= 0 ? length : 1;
      if (needed > end - at || length > count - written)
      {
        return false;
      }
      for (std::size_t i = 0; i < length; ++i)
      {
        pixels[(written + i) * width + place] = stream[code >= 0 ? at + i : at];
      }
      at += needed;
      written += length;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
namespace
{
constexpr const char* RunLengthSyntax = "1.2.840.10008.1.2.5";
constexpr std::int64_t LongestRun = 64; // bytes for each of a run-length stream

void MakeRoom(const CTFrame& frame, CTPixels& pixels)
{
  const auto size = static_cast<std::size_t>(frame.GetSize());
  if (size > pixels.Bytes.capacity())
  {
    RequireMemory(frame.GetName() + ": its image", static_cast<double>(size));
  }
  pixels.Bytes.resize(size);
}

DecoderRequest MakeRequest(const CTFrame& frame, const CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  DecoderRequest request;
  request.StreamBytes = pixels.Stream.size();
  request.PixelBytes = pixels.Bytes.size();
  request.Columns = static_cast<std::uint32_t>(header.Columns);
  request.Rows = static_cast<std::uint32_t>(header.Rows);
  request.Format = { header.Format.BitsAllocated, header.Format.BitsStored, header.Format.HighBit,
    header.Format.Signed ? 1 : 0 };
  header.TransferSyntax.copy(request.TransferSyntax, sizeof request.TransferSyntax - 1);
  return request;
}
}

//------------------------------------------------------------------------------
DicomDecoder::DicomDecoder(std::string program)
  : Program(std::move(program))
{
}

//------------------------------------------------------------------------------
std::string DicomDecoder::DecodeByProcess(const CTFrame& frame, CTPixels& pixels)
{
  constexpr std::size_t LongestFragment = 0xFFFFFFFE;
  pixels.Stream.resize(pixels.Stream.size() + pixels.Stream.size() % 2); // fragments are even
  if (pixels.Stream.size() > LongestFragment)
  {
    return "are too long";
  }
  std::unique_ptr<DecoderProcess> process;
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    if (!this->Idle.empty())
    {
      process = std::move(this->Idle.back());
      this->Idle.pop_back();
    }
  }
  if (!process)
  {
    process = std::make_unique<DecoderProcess>(this->Program);
  }
  DecoderFormat found;
  std::string wrong =
    process->Decode(MakeRequest(frame, pixels), pixels.Stream.data(), pixels.Bytes.data(), found);
  if (wrong.empty())
  {
    pixels.Format = { found.BitsAllocated, found.BitsStored, found.HighBit, found.Signed == 1 };
  }
  if (process->IsAlive())
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    this->Idle.push_back(std::move(process));
  }
  return wrong;
}

//------------------------------------------------------------------------------
// Returns what is wrong with the stream. The header's size is believed only when the stream bears it
// out: a few bytes may claim an image of gigabytes.
std::string DicomDecoder::Decode(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  if (header.TransferSyntax == RunLengthSyntax)
  {
    if (frame.GetSize() / LongestRun > static_cast<std::int64_t>(pixels.Stream.size()))
    {
      return "are too few for its Rows (0028,0010) and Columns (0028,0011)";
    }
    MakeRoom(frame, pixels);
    const bool decoded =
      DecodeRunLength(pixels.Stream, header.Format.BitsAllocated / 8, pixels.Bytes);
    return decoded ? "" : "cannot be decoded";
  }
  std::string wrong = WhyNotImage(
    pixels.Stream, header.TransferSyntax, header.Columns, header.Rows, header.Format.BitsAllocated);
  if (wrong.empty())
  {
    MakeRoom(frame, pixels);
    wrong = this->DecodeByProcess(frame, pixels);
  }
  return wrong;
}

//------------------------------------------------------------------------------
void DicomDecoder::Read(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  pixels.Format = header.Format;
  if (!header.Compressed)
  {
    unsigned char* target = pixels.Room;
    if (!target)
    {
      MakeRoom(frame, pixels);
      target = pixels.Bytes.data();
    }
    ReadDicomBytes(frame, target);
    pixels.Data = target;
    return;
  }
  pixels.Stream.resize(static_cast<std::size_t>(GetDicomSize(frame)));
  ReadDicomBytes(frame, pixels.Stream.data());
  std::string wrong;
  try
  {
    wrong = this->Decode(frame, pixels);
  }
  catch (const MemoryExceeded&)
  {
    throw;
  }
  catch (const std::runtime_error& error) // of a process that does not start
  {
    wrong = error.what();
  }
  pixels.Data = pixels.Bytes.data();
  if (wrong.empty() && pixels.Format.BitsAllocated != header.Format.BitsAllocated)
  {
    wrong = "have " + std::to_string(pixels.Format.BitsAllocated) + " bits, not " +
      std::to_string(header.Format.BitsAllocated) + " as Bits Allocated (0028,0100) says";
  }
  if (!wrong.empty())
  {
    throw std::runtime_error(frame.GetName() + ": its compressed pixels " + wrong +
      " (transfer syntax " + header.TransferSyntax + ")");
  }
}
}
