// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bytes of a file by their place, read in pieces.
#ifndef lacunaFileBytes_h
#define lacunaFileBytes_h

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace lacuna
{
class FileBytes
{
public:
  /// Throws std::runtime_error naming the file when it cannot be opened.
  explicit FileBytes(const std::string& path);

  std::int64_t GetSize() const { return this->Size; }
  /// count bytes from offset on, valid until the next call; nullptr when the file has not so many.
  const unsigned char* Get(std::int64_t offset, std::int64_t count);
  /// Copies them; false when the file has not so many or cannot be read.
  bool Read(std::int64_t offset, std::int64_t count, unsigned char* bytes);

private:
  std::ifstream File;
  std::int64_t Size = 0;
  std::int64_t First = 0; // of the bytes at hand
  std::vector<unsigned char> Window;
};
}
#endif
