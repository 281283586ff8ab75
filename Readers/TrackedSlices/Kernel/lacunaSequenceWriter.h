// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes whole sequences.
#ifndef lacunaSequenceWriter_h
#define lacunaSequenceWriter_h

#include "lacunaExecution.h"
#include "lacunaSequenceFormat.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lacuna
{
struct SequenceContent
{
  SequenceDescription Description;
  std::vector<SequenceFields> Frames; ///< the fields of each frame
  /// Columns x Rows elements of a frame in this machine's byte order, x fastest; valid until the
  /// next call.
  std::function<const void*(std::int64_t frame)> GetPixels;
};

/// Writes content to fileName, .mha, .mhd (with .raw or .zraw), .nrrd or .nhdr (with .raw or
/// .raw.gz), always little-endian. compressionLevel: 0 (none; frames can be read one by one) to 9.
/// Files get their names when they are complete, the header last. Throws FileError,
/// std::invalid_argument when a field cannot be written, Aborted; then what was there stays.
/// Returns the bytes written.
std::int64_t WriteSequence(const std::string& fileName, const SequenceContent& content,
  int compressionLevel, Execution& execution);
}
#endif
