// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPixelSource.h"

#include "lacunaByteOrder.h"
#include "lacunaByteStream.h"
#include "lacunaInputFile.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
/// Deflate cannot shrink data by more than this.
constexpr double BestCompression = 1032;

//------------------------------------------------------------------------------
// Where the encoded pixels begin, after the lines to be skipped.
std::int64_t FindDataStart(const SequenceHeader& header)
{
  if (header.SkippedLines == 0)
  {
    return header.DataOffset;
  }
  std::ifstream stream(header.DataFileName, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(header.DataOffset));
  std::vector<char> buffer(1 << 16);
  std::int64_t offset = header.DataOffset;
  std::int64_t lines = 0;
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), stream.gcount())
  {
    const char* const end = buffer.data() + stream.gcount();
    for (const char* p = buffer.data(); p < end; ++p, ++offset)
    {
      if (lines == header.SkippedLines)
      {
        return offset;
      }
      lines += *p == '\n' ? 1 : 0;
    }
  }
  if (lines < header.SkippedLines)
  {
    throw std::runtime_error(header.DataFileName + ": has " + std::to_string(lines) +
      " lines, but line skip says that the pixels follow after " +
      std::to_string(header.SkippedLines));
  }
  return offset;
}

//------------------------------------------------------------------------------
class RawPixelSource : public PixelSource
{
public:
  RawPixelSource(const SequenceHeader& header, std::int64_t fileSize)
    : PixelSource(header)
    , Offset(FindDataStart(header) +
        std::clamp<std::int64_t>(header.SkippedBytes, 0, fileSize)) // at most all there is
  {
    this->Divide(std::max<std::int64_t>(0, fileSize - this->Offset));
    if (header.SkippedBytes < 0)
    {
      // not before the end of a header in the same file
      this->Offset = std::max(this->Offset, fileSize - this->FrameSize * header.Frames);
    }
    this->Stream = OpenForReading(header.DataFileName, header.DataFileName);
  }

protected:
  void ReadStored(std::int64_t frame, unsigned char* pixels) override
  {
    this->Stream.clear();
    this->Stream.seekg(static_cast<std::streamoff>(this->Offset + frame * this->FrameSize));
    const auto size = static_cast<std::size_t>(this->FrameSize);
    if (ReadBytes(this->Stream, pixels, size, this->Header.DataFileName) < size)
    {
      this->Fail(
        "the pixels of " + this->FrameWord + " " + std::to_string(frame) + " cannot be read");
    }
  }

private:
  std::int64_t Offset;
  std::ifstream Stream;
};

//------------------------------------------------------------------------------
class StreamPixelSource : public PixelSource
{
public:
  StreamPixelSource(const SequenceHeader& header, std::int64_t fileSize)
    : PixelSource(header)
  {
    const std::int64_t start = FindDataStart(header);
    this->MostBehind = fileSize + (std::int64_t(1) << 16);
    switch (header.Encoding)
    {
      case PixelEncoding::Hex:
        this->Stream = MakeHexStream(header.DataFileName, start);
        break;
      case PixelEncoding::Text:
        this->Stream = MakeTextStream(header.DataFileName, start, header.Type);
        break;
      default:
        this->Stream = MakeInflateStream(header.DataFileName, start);
        this->Name = "the compressed pixels";
        this->SizeKnown = this->IsSizeKnown(std::max<std::int64_t>(0, fileSize - start));
    }
    if (this->SizeKnown && !header.TypeIsLong)
    {
      this->Divide(header.GetFrameSize() * header.Frames);
    }
    else
    {
      this->SkipBytes();
      const std::int64_t most =
        (header.TypeIsLong ? 2 : 1) * header.GetFrameSize() * header.Frames + this->MostBehind;
      const std::int64_t bytes = this->Stream->CountBytes(most);
      this->Divide(bytes, this->Stream->GetDamage(), bytes <= most);
      if (header.IsVolume && header.Encoding == PixelEncoding::Zlib && bytes <= most &&
        !this->Stream->IsComplete() &&
        this->WholeFrames == header.Frames) // else the reader reports the missing slices
      {
        this->Fail(this->Name + " are corrupt: their check sum is wrong or missing");
      }
    }
    this->Restart();
  }

protected:
  void ReadStored(std::int64_t frame, unsigned char* pixels) override
  {
    if (frame < this->Next)
    {
      this->Restart();
    }
    for (; this->Next <= frame; ++this->Next) // the frames before this one are overwritten by it
    {
      if (this->Stream->Read(pixels, this->FrameSize) < this->FrameSize)
      {
        const std::string& damage = this->Stream->GetDamage();
        const std::string last = std::to_string(this->Next - 1);
        this->Fail(this->Name + " " + (damage.empty() ? "end too early" : damage) + " in " +
          this->FrameWord + " " + std::to_string(this->Next) +
          (this->Next > 0 && !this->Header.IsVolume
              ? "; FrameRange 0 " + last + " reads the frames before it"
              : ""));
      }
    }
    if (this->SizeKnown && this->Next == this->Header.Frames)
    {
      this->CheckEnd();
    }
  }

private:
  /// Whether the file as it is should give all frames. Fails when there are by far too few bytes.
  bool IsSizeKnown(std::int64_t bytes) const
  {
    const SequenceHeader& header = this->Header;
    const std::int64_t wanted = header.GetFrameSize() * header.Frames;
    const bool sizeGiven = header.CompressedDataSize > 0;
    if (!sizeGiven && !this->EndsWithGzipSize(wanted))
    {
      return false;
    }
    const std::int64_t stated = sizeGiven ? header.CompressedDataSize : bytes;
    if (static_cast<double>(wanted) > (static_cast<double>(stated) + 16) * BestCompression)
    {
      this->Fail(std::to_string(stated) + " bytes of compressed data cannot hold the " +
        std::to_string(header.Frames) + " " + this->FrameWord + "s of " +
        std::to_string(header.GetFrameSize()) +
        " bytes that the size and the element type call for");
    }
    return stated <= bytes;
  }

  /// A gzip stream ends with the size of its content, modulo 2^32.
  bool EndsWithGzipSize(std::int64_t size) const
  {
    const auto all =
      static_cast<std::uint64_t>(size) + static_cast<std::uint64_t>(this->Header.SkippedBytes);
    std::ifstream stream(this->Header.DataFileName, std::ios::binary);
    std::array<unsigned char, 4> end{};
    stream.seekg(-4, std::ios::end);
    stream.read(reinterpret_cast<char*>(end.data()), 4);
    std::uint32_t stated = 0;
    for (std::size_t i = 4; i-- > 0;)
    {
      stated = stated << 8 | end[i];
    }
    return stream && stated == static_cast<std::uint32_t>(all);
  }

  void SkipBytes()
  {
    std::vector<unsigned char> scratch(1 << 16);
    for (std::int64_t left = this->Header.SkippedBytes; left > 0;)
    {
      const std::int64_t part =
        this->Stream->Read(scratch.data(), std::min<std::int64_t>(left, 1 << 16));
      left = part > 0 ? left - part : 0;
    }
  }

  void Restart()
  {
    this->Stream->Rewind();
    this->SkipBytes();
    this->Next = 0;
  }

  /// After the last frame: damage may show only in what follows, at the latest in the check sum.
  void CheckEnd()
  {
    if (this->Stream->CountBytes(this->MostBehind) > this->MostBehind)
    {
      this->Fail(this->Name + " go on after the last " + this->FrameWord +
        "; are the size (DimSize or sizes) and the element type in the header right?");
    }
    if (!this->Stream->IsComplete())
    {
      this->Fail(this->Name + " are corrupt: their check sum is wrong or missing");
    }
  }

  std::unique_ptr<ByteStream> Stream;
  std::string Name = "the pixels";
  bool SizeKnown = false; ///< without decoding
  /// What follows the last frame is decoded up to so many bytes: a file of 1 MB can hold 1 GB of it.
  std::int64_t MostBehind = 0;
  std::int64_t Next = 0; ///< frame at which the stream stands
};

//------------------------------------------------------------------------------
class BlankPixelSource : public PixelSource
{
public:
  explicit BlankPixelSource(const SequenceHeader& header)
    : PixelSource(header)
  {
    this->WholeFrames = header.Frames;
  }

protected:
  void ReadStored(std::int64_t, unsigned char* pixels) override
  {
    std::memset(pixels, 0, static_cast<std::size_t>(this->FrameSize));
  }
};
}

//------------------------------------------------------------------------------
PixelSource::PixelSource(const SequenceHeader& header)
  : Header(header)
  , FrameWord(header.IsVolume ? "slice" : "frame")
  , Type(header.Type)
  , FrameSize(header.GetFrameSize())
{
}

//------------------------------------------------------------------------------
std::unique_ptr<PixelSource> PixelSource::Open(const SequenceHeader& header)
{
  if (header.PosesOnly)
  {
    return std::make_unique<BlankPixelSource>(header);
  }
  OpenForReading(header.DataFileName,
    header.DataFileName == header.FileName ? header.FileName
                                           : header.FileName + ": the file of its pixels '" +
        header.DataFileName + "' (ElementDataFile or data file)");
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(header.DataFileName));
  if (header.Encoding == PixelEncoding::Raw)
  {
    return std::make_unique<RawPixelSource>(header, size);
  }
  return std::make_unique<StreamPixelSource>(header, size);
}

//------------------------------------------------------------------------------
void PixelSource::Divide(std::int64_t bytes, const std::string& damage, bool all)
{
  if (this->Header.TypeIsLong && bytes >= 2 * this->FrameSize * this->Header.Frames)
  {
    this->Type = this->Type == ScalarType::Int32 ? ScalarType::Int64 : ScalarType::UInt64;
    this->FrameSize *= 2;
  }
  const std::int64_t whole = bytes / this->FrameSize;
  this->WholeFrames = std::min(this->Header.Frames, whole);
  if (this->WholeFrames == 0)
  {
    this->Fail(damage.empty() ? "there are " + std::to_string(bytes) +
          " bytes of pixels, but one " + this->FrameWord + " has " +
          std::to_string(this->FrameSize) + " (by the size and the element type in the header)"
                              : "the pixels " + damage + " in " + this->FrameWord + " 0");
  }
  if (whole < this->Header.Frames)
  {
    this->Warning = "the pixels " + (damage.empty() ? "are cut off" : damage) + ": " +
      std::to_string(whole) + " of the " + std::to_string(this->Header.Frames) + " " +
      this->FrameWord + "s are there";
  }
  else if (bytes > this->FrameSize * this->Header.Frames && this->Header.SkippedBytes >= 0)
  {
    this->Warning = (all ? "" : "more than ") +
      std::to_string(bytes - this->FrameSize * this->Header.Frames) + " bytes after the last " +
      this->FrameWord +
      " are ignored; are the size (DimSize or sizes) and the element type in the header right?";
  }
}

//------------------------------------------------------------------------------
void PixelSource::ReadFrame(std::int64_t frame, void* pixels)
{
  if (frame < 0 || frame >= this->WholeFrames)
  {
    this->Fail(this->FrameWord + " " + std::to_string(frame) + " is not one of the " +
      std::to_string(this->WholeFrames) + " " + this->FrameWord + "s in the file");
  }
  this->ReadStored(frame, static_cast<unsigned char*>(pixels));
  if (this->Header.Encoding != PixelEncoding::Text &&
    this->Header.BigEndian != IsBigEndianMachine())
  {
    const std::size_t elementSize = GetScalarSize(this->Type);
    SwapElementBytes(pixels, static_cast<std::size_t>(this->FrameSize) / elementSize, elementSize);
  }
}

//------------------------------------------------------------------------------
void PixelSource::Fail(const std::string& text) const
{
  throw std::runtime_error(this->Header.DataFileName + ": " + text);
}
}
