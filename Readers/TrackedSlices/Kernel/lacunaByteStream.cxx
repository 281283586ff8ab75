// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaByteStream.h"

#include "lacunaInputFile.h"
#include "lacunaSequenceText.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>

namespace lacuna
{
namespace
{
constexpr std::size_t BufferSize = 1 << 18;
constexpr std::size_t LongestWord = 400; // 1e308 written out has 309 digits

bool IsBlank(int c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

//------------------------------------------------------------------------------
class InflateStream : public ByteStream
{
public:
  InflateStream(const std::string& fileName, std::int64_t offset)
    : ByteStream(fileName, offset)
  {
    // + 32: the stream may have zlib's or gzip's wrapping
    if (inflateInit2(&this->Zlib, MAX_WBITS + 32) != Z_OK)
    {
      throw std::bad_alloc();
    }
  }
  ~InflateStream() override { inflateEnd(&this->Zlib); }

protected:
  void Reset() override { inflateReset(&this->Zlib); }

  std::int64_t Decode(unsigned char* output, std::int64_t size) override
  {
    std::int64_t done = 0;
    while (done < size && !this->Ended)
    {
      if (this->Position == this->Filled)
      {
        this->Fill();
      }
      this->Zlib.next_in = this->Input.data() + this->Position;
      this->Zlib.avail_in = static_cast<uInt>(this->Filled - this->Position);
      const auto room = static_cast<uInt>(std::min<std::int64_t>(size - done, 1 << 30));
      this->Zlib.next_out = output + done;
      this->Zlib.avail_out = room;
      const int result = inflate(&this->Zlib, Z_NO_FLUSH);
      this->Position = this->Filled - this->Zlib.avail_in;
      done += room - this->Zlib.avail_out;
      if (result == Z_STREAM_END)
      {
        this->StartNextMember();
      }
      else if (result == Z_MEM_ERROR)
      {
        throw std::bad_alloc();
      }
      else if (result != Z_OK)
      {
        this->Ended = true; // Z_BUF_ERROR: the file ends before the stream
        this->Damage = result == Z_BUF_ERROR ? "" : "are corrupt";
      }
    }
    return done;
  }

private:
  // What follows a gzip member is another one, or does not belong to the stream.
  void StartNextMember()
  {
    const int first = this->GetByte();
    this->Position -= first < 0 ? 0 : 1;
    this->Complete = first != 0x1f;
    this->Ended = this->Complete;
    if (!this->Ended)
    {
      inflateReset(&this->Zlib);
    }
  }

  z_stream Zlib{};
};

//------------------------------------------------------------------------------
class HexStream : public ByteStream
{
public:
  using ByteStream::ByteStream;

protected:
  void Reset() override {}

  std::int64_t Decode(unsigned char* output, std::int64_t size) override
  {
    std::int64_t done = 0;
    int high = -1;
    while (done < size && !this->Ended)
    {
      const int c = this->GetByte();
      const int digit = ToDigit(c);
      if (digit >= 0 && high >= 0)
      {
        output[done++] = static_cast<unsigned char>(16 * high + digit);
        high = -1;
      }
      else if (digit >= 0)
      {
        high = digit;
      }
      else if (c < 0)
      {
        this->Ended = this->Complete = true;
      }
      else if (!IsBlank(c))
      {
        this->Ended = true;
        this->Damage = "have the byte " + std::to_string(c) + " where a hexadecimal digit must be";
      }
    }
    return done;
  }

private:
  static int ToDigit(int c)
  {
    const bool decimal = c >= '0' && c <= '9';
    const int letter = c | 0x20;
    return decimal ? c - '0' : letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
  }
};

//------------------------------------------------------------------------------
template <class T>
bool ParseElement(const std::string& word, T& value)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    double number = 0;
    const bool parsed = ParseNumber(word, number);
    value = static_cast<T>(number);
    return parsed && (std::isfinite(value) || !std::isfinite(number));
  }
  else
  {
    const char* begin = word.data() + (word.size() > 1 && word[0] == '+' ? 1 : 0);
    const char* end = word.data() + word.size();
    const auto result = std::from_chars(begin, end, value);
    return result.ec == std::errc() && result.ptr == end;
  }
}

template <class T>
class TextStream : public ByteStream
{
public:
  using ByteStream::ByteStream;

protected:
  void Reset() override
  {
    this->Number = 0;
    this->Left = 0;
  }

  std::int64_t Decode(unsigned char* output, std::int64_t size) override
  {
    std::int64_t done = 0;
    while (done < size)
    {
      if (this->Left == 0 && !this->ParseNext())
      {
        break;
      }
      // an element may be asked for in parts
      const auto part = static_cast<std::size_t>(
        std::min<std::int64_t>(size - done, static_cast<std::int64_t>(this->Left)));
      std::memcpy(output + done, this->Element + (sizeof(T) - this->Left), part);
      this->Left -= part;
      done += static_cast<std::int64_t>(part);
    }
    return done;
  }

private:
  bool ParseNext()
  {
    int c = this->GetByte();
    while (IsBlank(c) || c == ',')
    {
      c = this->GetByte();
    }
    std::string word;
    for (; c >= 0 && !IsBlank(c) && c != ',' && word.size() < LongestWord; c = this->GetByte())
    {
      word += static_cast<char>(c);
    }
    if (word.empty())
    {
      this->Ended = this->Complete = true;
    }
    T value{};
    if (!this->Ended && !ParseElement(word, value))
    {
      this->Ended = true;
      this->Damage = "have '" + word.substr(0, 40) + "' as number " + std::to_string(this->Number) +
        ", which the element type cannot hold";
    }
    std::memcpy(this->Element, &value, sizeof(T));
    this->Left = this->Ended ? 0 : sizeof(T);
    ++this->Number;
    return !this->Ended;
  }

  std::int64_t Number = 0; ///< of the next element
  unsigned char Element[sizeof(T)]{};
  std::size_t Left = 0; ///< bytes of Element not yet given
};
}

//------------------------------------------------------------------------------
ByteStream::ByteStream(const std::string& fileName, std::int64_t offset)
  : Input(BufferSize)
  , Name(fileName)
  , Stream(OpenForReading(fileName, fileName))
  , Offset(offset)
{
  this->Stream.seekg(static_cast<std::streamoff>(offset));
}

//------------------------------------------------------------------------------
void ByteStream::Rewind()
{
  this->Stream.clear();
  this->Stream.seekg(static_cast<std::streamoff>(this->Offset));
  this->Position = this->Filled = 0;
  this->Damage.clear();
  this->Ended = this->Complete = false;
  this->Reset();
}

//------------------------------------------------------------------------------
std::int64_t ByteStream::Read(unsigned char* output, std::int64_t size)
{
  return this->Ended ? 0 : this->Decode(output, size);
}

//------------------------------------------------------------------------------
std::int64_t ByteStream::CountBytes(std::int64_t most)
{
  std::vector<unsigned char> scratch(BufferSize);
  std::int64_t bytes = 0;
  while (!this->Ended && bytes <= most)
  {
    bytes += this->Read(scratch.data(), static_cast<std::int64_t>(scratch.size()));
  }
  return bytes;
}

//------------------------------------------------------------------------------
bool ByteStream::Fill()
{
  this->Filled = ReadBytes(this->Stream, this->Input.data(), this->Input.size(), this->Name);
  this->Position = 0;
  return this->Filled > 0;
}

//------------------------------------------------------------------------------
std::unique_ptr<ByteStream> MakeInflateStream(const std::string& fileName, std::int64_t offset)
{
  return std::make_unique<InflateStream>(fileName, offset);
}

//------------------------------------------------------------------------------
std::unique_ptr<ByteStream> MakeHexStream(const std::string& fileName, std::int64_t offset)
{
  return std::make_unique<HexStream>(fileName, offset);
}

//------------------------------------------------------------------------------
std::unique_ptr<ByteStream> MakeTextStream(
  const std::string& fileName, std::int64_t offset, ScalarType type)
{
  return DispatchScalarType(type,
    [&](auto zero) -> std::unique_ptr<ByteStream>
    { return std::make_unique<TextStream<decltype(zero)>>(fileName, offset); });
}
}
