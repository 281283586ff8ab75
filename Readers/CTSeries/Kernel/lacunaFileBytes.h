// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bytes of a file by their place, read in pieces.
#ifndef lacunaFileBytes_h
#define lacunaFileBytes_h

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
/// The end of a file that is a deflate stream, inflated.
struct InflatedBytes
{
  std::int64_t First = 0; ///< where in the file the stream begins
  std::vector<unsigned char> Bytes;
};

/// By which a file is known to be the same as before.
struct FileState
{
  std::int64_t Size = -1; ///< bytes
  std::int64_t Time = 0;  ///< of the last change, ns

  bool operator==(const FileState& other) const
  {
    return this->Size == other.Size && this->Time == other.Time;
  }
};

class FileBytes
{
public:
  static constexpr std::size_t MostInflated = std::size_t(1) << 30; ///< bytes

  /// Throws std::runtime_error naming the file when it cannot be opened or is no regular file.
  explicit FileBytes(const std::string& path);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  /// When it was opened.
  const FileState& GetState() const { return this->State; }
  /// Bytes at hand, with what was inflated.
  std::int64_t GetSize() const { return this->Size; }
  /// count bytes from offset on, valid until the next call; nullptr when the file has not so many.
  const unsigned char* Get(std::int64_t offset, std::int64_t count);
  /// Copies them; false when the file has not so many or cannot be read.
  bool Read(std::int64_t offset, std::int64_t count, unsigned char* bytes);

  /// The file is a deflate stream (RFC 1951) from first on; inflated bytes take its place. Throws
  /// std::runtime_error naming the file when it is cut off, damaged or gives more than most bytes or
  /// than there is memory: two bytes of a stream can stand for 2 KiB.
  void Inflate(std::int64_t first, std::size_t most = MostInflated);
  /// Of Inflate; it may be kept and given to another FileBytes of the same file.
  std::shared_ptr<const InflatedBytes> GetInflated() const { return this->Inflated; }
  void SetInflated(std::shared_ptr<const InflatedBytes> inflated);

private:
  std::string Path;
  int File = -1; // descriptor
  FileState State;
  std::int64_t Size = 0;
  std::int64_t First = 0; // of the bytes at hand
  std::vector<unsigned char> Window;
  std::shared_ptr<const InflatedBytes> Inflated;
};
}
#endif
