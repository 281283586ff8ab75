// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pixels that can only be read one after the other: compressed or written as text.
#ifndef lacunaByteStream_h
#define lacunaByteStream_h

#include "lacunaScalarType.h"

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
/// Decodes part of a file, forwards.
class ByteStream
{
public:
  /// Reads the file from its byte offset on. Throws std::runtime_error when it cannot be opened.
  ByteStream(const std::string& fileName, std::int64_t offset);
  virtual ~ByteStream() = default;

  /// Back to the beginning.
  void Rewind();
  /// Puts up to size decoded bytes into output and returns how many there were; fewer means that
  /// nothing more can be had: see the functions below.
  std::int64_t Read(unsigned char* output, std::int64_t size);
  /// Decodes what is left, but hardly more than most bytes, and returns how many bytes that was. More
  /// than most: there may be still more.
  std::int64_t CountBytes(std::int64_t most);

  /// Why nothing more can be had: "are corrupt" or such; empty when the stream just ended.
  const std::string& GetDamage() const { return this->Damage; }
  /// Whether the stream came to the end that its format demands.
  bool IsComplete() const { return this->Complete; }

protected:
  virtual void Reset() = 0;
  virtual std::int64_t Decode(unsigned char* output, std::int64_t size) = 0;

  /// The next encoded byte; -1 at the end of the file.
  int GetByte()
  {
    return this->Position < this->Filled || this->Fill() ? this->Input[this->Position++] : -1;
  }
  bool Fill();

  std::vector<unsigned char> Input;
  std::size_t Position = 0;
  std::size_t Filled = 0;
  std::string Damage;
  bool Ended = false;
  bool Complete = false;

private:
  std::string Name;
  std::ifstream Stream;
  std::int64_t Offset;
};

/// A zlib or gzip stream; gzip members one after the other are one stream.
std::unique_ptr<ByteStream> MakeInflateStream(const std::string& fileName, std::int64_t offset);
/// Two hexadecimal digits for each byte, blanks in between ignored.
std::unique_ptr<ByteStream> MakeHexStream(const std::string& fileName, std::int64_t offset);
/// Numbers between blanks or commas, as elements of type in this machine's byte order. A number
/// that type cannot hold is damage.
std::unique_ptr<ByteStream> MakeTextStream(
  const std::string& fileName, std::int64_t offset, ScalarType type);
}
#endif
