// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Compresses on all cores into one ordinary zlib or gzip stream.
#ifndef lacunaStreamCompressor_h
#define lacunaStreamCompressor_h

#include "lacunaExecution.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
/// Deflates bytes in blocks, each primed with the 32 KiB before it, so that the blocks can be
/// compressed at the same time and nearly as well as in one go. What has been given out can be
/// decoded at any time up to its last byte: every call ends at a byte border. The result depends on
/// how the bytes are divided into calls, not on the number of threads. A copy is a point to return
/// to.
class StreamCompressor
{
public:
  enum class Wrapping
  {
    Zlib,
    Gzip
  };
  /// level: 1 (quick) to 9 (small).
  StreamCompressor(Wrapping wrapping, int level);

  /// The bytes that come first.
  std::string GetBeginning() const;
  /// Compresses the next bytes. Throws Aborted when stopped, std::bad_alloc.
  std::string Compress(const unsigned char* bytes, std::size_t size, Execution& execution);
  /// The bytes that come last.
  std::string GetEnd() const;

private:
  Wrapping Wrap;
  int Level;
  unsigned long CheckSum;
  std::uint64_t Size = 0;
  std::vector<unsigned char> Before; ///< the last 32 KiB
};
}
#endif
