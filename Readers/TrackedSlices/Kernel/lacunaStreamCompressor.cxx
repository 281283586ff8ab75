// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaStreamCompressor.h"

#include <zlib.h>

#include <algorithm>
#include <new>

namespace lacuna
{
namespace
{
constexpr std::size_t BlockSize = 1 << 19;
constexpr std::size_t Window = 1 << 15;

struct Block
{
  std::string Bytes;
  unsigned long CheckSum = 0;
};

// Deflates bytes that follow upon dictionary, up to a byte border.
std::string Deflate(const unsigned char* bytes, std::size_t size, const unsigned char* dictionary,
  std::size_t dictionarySize, int level)
{
  z_stream zlib{};
  if (deflateInit2(&zlib, level, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
  {
    throw std::bad_alloc();
  }
  std::string output(deflateBound(&zlib, static_cast<uLong>(size)) + 16, '\0');
  if (dictionarySize > 0)
  {
    deflateSetDictionary(&zlib, dictionary, static_cast<uInt>(dictionarySize));
  }
  zlib.next_in = const_cast<Bytef*>(bytes);
  zlib.avail_in = static_cast<uInt>(size);
  zlib.next_out = reinterpret_cast<Bytef*>(output.data());
  zlib.avail_out = static_cast<uInt>(output.size());
  deflate(&zlib, Z_SYNC_FLUSH);
  output.resize(zlib.total_out);
  output.shrink_to_fit(); // else blocks that wait take what they would without compression
  deflateEnd(&zlib);
  return output;
}
}

//------------------------------------------------------------------------------
StreamCompressor::StreamCompressor(Wrapping wrapping, int level)
  : Wrap(wrapping)
  , Level(level)
  , CheckSum(wrapping == Wrapping::Zlib ? adler32(0, nullptr, 0) : crc32(0, nullptr, 0))
{
}

//------------------------------------------------------------------------------
std::string StreamCompressor::GetBeginning() const
{
  // zlib: deflate, window of 32 KiB, default level; gzip: no name, no time, unknown system
  return this->Wrap == Wrapping::Zlib ? std::string("\x78\x9c", 2)
                                      : std::string("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
}

//------------------------------------------------------------------------------
std::string StreamCompressor::Compress(
  const unsigned char* bytes, std::size_t size, Execution& execution)
{
  std::vector<Block> blocks((size + BlockSize - 1) / BlockSize);
  execution.For(static_cast<std::int64_t>(blocks.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const std::size_t first = static_cast<std::size_t>(i) * BlockSize;
        const std::size_t length = std::min(BlockSize, size - first);
        Block& block = blocks[static_cast<std::size_t>(i)];
        block.Bytes = i == 0
          ? Deflate(bytes, length, this->Before.data(), this->Before.size(), this->Level)
          : Deflate(bytes + first, length, bytes + first - Window, Window, this->Level);
        block.CheckSum = this->Wrap == Wrapping::Zlib
          ? adler32(adler32(0, nullptr, 0), bytes + first, static_cast<uInt>(length))
          : crc32(crc32(0, nullptr, 0), bytes + first, static_cast<uInt>(length));
      }
    });
  std::string output;
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    const auto length = static_cast<z_off_t>(std::min(BlockSize, size - i * BlockSize));
    output += blocks[i].Bytes;
    this->CheckSum = this->Wrap == Wrapping::Zlib
      ? adler32_combine(this->CheckSum, blocks[i].CheckSum, length)
      : crc32_combine(this->CheckSum, blocks[i].CheckSum, length);
  }
  this->Size += size;
  this->Before.insert(this->Before.end(), bytes + (size - std::min(size, Window)), bytes + size);
  if (this->Before.size() > Window)
  {
    this->Before.erase(this->Before.begin(), this->Before.end() - Window);
  }
  return output;
}

//------------------------------------------------------------------------------
std::string StreamCompressor::GetEnd() const
{
  std::string end("\x03\0", 2); // an empty block that is the last
  if (this->Wrap == Wrapping::Zlib)
  {
    for (int shift = 24; shift >= 0; shift -= 8)
    {
      end += static_cast<char>(this->CheckSum >> shift & 255);
    }
    return end;
  }
  for (int shift = 0; shift < 32; shift += 8)
  {
    end += static_cast<char>(this->CheckSum >> shift & 255);
  }
  for (int shift = 0; shift < 32; shift += 8)
  {
    end += static_cast<char>(this->Size >> shift & 255);
  }
  return end;
}
}
