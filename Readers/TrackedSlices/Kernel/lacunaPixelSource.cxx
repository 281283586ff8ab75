// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPixelSource.h"

#include "lacunaByteOrder.h"

#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
/// Deflate cannot shrink data by more than this.
constexpr double BestCompression = 1032;

std::int64_t FileSize(const std::string& name)
{
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(name, error);
  return error ? -1 : static_cast<std::int64_t>(size);
}

//------------------------------------------------------------------------------
class RawPixelSource : public PixelSource
{
public:
  RawPixelSource(const SequenceHeader& header, std::int64_t fileSize)
    : PixelSource(header)
    , Offset(std::max<std::int64_t>(0, header.DataOffset))
  {
    this->Divide(std::max<std::int64_t>(0, fileSize - this->Offset));
    if (header.DataOffset < 0)
    {
      this->Offset = std::max<std::int64_t>(0, fileSize - this->FrameSize * header.Frames);
    }
    this->Stream.open(header.DataFileName, std::ios::binary);
    if (!this->Stream)
    {
      this->Fail("cannot be opened for reading");
    }
  }

protected:
  void ReadStored(std::int64_t frame, unsigned char* pixels) override
  {
    this->Stream.clear();
    this->Stream.seekg(static_cast<std::streamoff>(this->Offset + frame * this->FrameSize));
    this->Stream.read(
      reinterpret_cast<char*>(pixels), static_cast<std::streamsize>(this->FrameSize));
    if (!this->Stream)
    {
      this->Fail("the pixels of frame " + std::to_string(frame) + " cannot be read");
    }
  }

private:
  std::int64_t Offset;
  std::ifstream Stream;
};

//------------------------------------------------------------------------------
class Inflater
{
public:
  z_stream Stream{};

  Inflater()
  {
    // + 32: the stream may have zlib's or gzip's wrapping
    if (inflateInit2(&this->Stream, MAX_WBITS + 32) != Z_OK)
    {
      throw std::bad_alloc();
    }
  }
  ~Inflater() { inflateEnd(&this->Stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

class ZlibPixelSource : public PixelSource
{
public:
  ZlibPixelSource(const SequenceHeader& header, std::int64_t fileSize)
    : PixelSource(header)
    , Input(1 << 18)
  {
    this->Stream.open(header.DataFileName, std::ios::binary);
    if (!this->Stream)
    {
      this->Fail("cannot be opened for reading");
    }
    const std::int64_t there = std::max<std::int64_t>(0, fileSize - header.DataOffset);
    this->Whole = header.CompressedDataSize <= there;
    const std::int64_t stated = header.CompressedDataSize > 0 ? header.CompressedDataSize : there;
    if (static_cast<double>(header.GetFrameSize() * header.Frames) >
      (static_cast<double>(stated) + 16) * BestCompression)
    {
      this->Fail(std::to_string(stated) + " bytes of compressed data cannot hold the " +
        std::to_string(header.Frames) + " frames of " + std::to_string(header.GetFrameSize()) +
        " bytes that DimSize and ElementType call for");
    }
    this->Rewind();
    if (this->Whole && !header.TypeIsLong)
    {
      this->Divide(header.GetFrameSize() * header.Frames);
    }
    else
    {
      this->Divide(this->CountBytes());
      this->Rewind();
    }
  }

protected:
  void ReadStored(std::int64_t frame, unsigned char* pixels) override
  {
    if (frame < this->Next)
    {
      this->Rewind();
    }
    for (; this->Next <= frame; ++this->Next) // the frames before this one are overwritten by it
    {
      if (this->Inflate(pixels, this->FrameSize) < this->FrameSize)
      {
        const std::string last = std::to_string(this->Next - 1);
        this->Fail("the compressed pixels " +
          std::string(this->Corrupt ? "are corrupt" : "end too early") + " in frame " +
          std::to_string(this->Next) +
          (this->Next > 0 ? "; FrameRange 0 " + last + " reads the frames before it" : ""));
      }
    }
    if (this->Next == this->Header.Frames)
    {
      this->CheckEnd();
    }
  }

private:
  void Rewind()
  {
    this->Stream.clear();
    this->Stream.seekg(static_cast<std::streamoff>(this->Header.DataOffset));
    inflateReset(&this->Zlib.Stream);
    this->Zlib.Stream.avail_in = 0;
    this->Next = 0;
    this->Ended = false;
    this->Corrupt = false;
    this->Complete = false;
  }

  /// Puts up to size bytes into output and returns how many there were.
  std::int64_t Inflate(unsigned char* output, std::int64_t size)
  {
    z_stream& zlib = this->Zlib.Stream;
    std::int64_t done = 0;
    while (done < size && !this->Ended)
    {
      if (zlib.avail_in == 0)
      {
        this->Stream.read(reinterpret_cast<char*>(this->Input.data()),
          static_cast<std::streamsize>(this->Input.size()));
        zlib.next_in = this->Input.data();
        zlib.avail_in = static_cast<uInt>(this->Stream.gcount());
      }
      const auto room = static_cast<uInt>(std::min<std::int64_t>(size - done, 1 << 30));
      zlib.next_out = output + done;
      zlib.avail_out = room;
      const int result = inflate(&zlib, Z_NO_FLUSH);
      done += room - zlib.avail_out;
      this->Corrupt = result == Z_DATA_ERROR || result == Z_NEED_DICT;
      this->Complete = result == Z_STREAM_END;
      this->Ended = result != Z_OK; // Z_BUF_ERROR: the file ends before the stream
    }
    return done;
  }

  /// After the last frame: damage may show only in what follows, at the latest in the check sum.
  void CheckEnd()
  {
    this->CountBytes();
    if (this->Corrupt || (this->Whole && !this->Complete))
    {
      this->Fail("the compressed pixels are corrupt: their check sum is wrong or missing");
    }
  }

  /// Inflates what is left and returns how many bytes that was.
  std::int64_t CountBytes()
  {
    std::vector<unsigned char> scratch(1 << 18);
    std::int64_t bytes = 0;
    while (!this->Ended)
    {
      bytes += this->Inflate(scratch.data(), static_cast<std::int64_t>(scratch.size()));
    }
    return bytes;
  }

  std::ifstream Stream;
  std::vector<unsigned char> Input;
  Inflater Zlib;
  bool Whole = false;    ///< the file is as long as the header says
  bool Ended = false;    ///< nothing more to be had, for whatever reason
  bool Corrupt = false;  ///< because the data are wrong
  bool Complete = false; ///< because the stream came to its proper end
  std::int64_t Next = 0; ///< frame at which the inflater stands
};
}

//------------------------------------------------------------------------------
PixelSource::PixelSource(const SequenceHeader& header)
  : Header(header)
  , Type(header.Type)
  , FrameSize(header.GetFrameSize())
{
}

std::unique_ptr<PixelSource> PixelSource::Open(const SequenceHeader& header)
{
  const std::int64_t size = FileSize(header.DataFileName);
  if (size < 0)
  {
    throw std::runtime_error(header.FileName + ": the file of its pixels, '" + header.DataFileName +
      "' (ElementDataFile), does not exist or cannot be read");
  }
  if (header.Compressed)
  {
    return std::make_unique<ZlibPixelSource>(header, size);
  }
  return std::make_unique<RawPixelSource>(header, size);
}

void PixelSource::Divide(std::int64_t bytes)
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
    this->Fail("there are " + std::to_string(bytes) + " bytes of pixels, but one frame has " +
      std::to_string(this->FrameSize) + " (DimSize, ElementType)");
  }
  if (whole < this->Header.Frames)
  {
    this->Warning = "the pixels are cut off: " + std::to_string(whole) + " of the " +
      std::to_string(this->Header.Frames) + " frames are there";
  }
  else if (bytes > this->FrameSize * this->Header.Frames && this->Header.DataOffset >= 0)
  {
    this->Warning = std::to_string(bytes - this->FrameSize * this->Header.Frames) +
      " bytes after the last frame are ignored; are DimSize and ElementType right?";
  }
}

void PixelSource::ReadFrame(std::int64_t frame, void* pixels)
{
  if (frame < 0 || frame >= this->WholeFrames)
  {
    this->Fail("frame " + std::to_string(frame) + " is not one of the " +
      std::to_string(this->WholeFrames) + " frames in the file");
  }
  this->ReadStored(frame, static_cast<unsigned char*>(pixels));
  if (this->Header.BigEndian != IsBigEndianMachine())
  {
    const std::size_t elementSize = GetScalarSize(this->Type);
    SwapElementBytes(pixels, static_cast<std::size_t>(this->FrameSize) / elementSize, elementSize);
  }
}

void PixelSource::Fail(const std::string& text) const
{
  throw std::runtime_error(this->Header.DataFileName + ": " + text);
}
}
