// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes whole sequences.
#ifndef lacunaSequenceWriter_h
#define lacunaSequenceWriter_h

#include "lacunaExecution.h"
#include "lacunaSequenceFormat.h"

#include <cstddef>
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

/// Puts fields into the content of a file of some kind. What the kind cannot hold is left out with a
/// warning, one sentence each. Kind, content and warnings must outlive it.
class SequenceFieldList
{
public:
  SequenceFieldList(
    const SequenceKind& kind, SequenceContent& content, std::vector<std::string>& warnings);

  /// A field of the whole sequence.
  void AddToHeader(const std::string& name, const std::string& text);
  /// A field of the frames, with a text for each; empty texts are not written.
  void AddToFrames(const std::string& name, const std::vector<std::string>& texts);
  /// Takes a field from all frames.
  void RemoveFromFrames(const std::string& name);
  /// The text of a frame's field; nullptr when it has none.
  const std::string* Find(std::size_t frame, const std::string& name) const;
  /// Warns of lines that other programs would cut.
  void CheckLines();

private:
  bool Accepts(const std::string& name, const std::vector<std::string>& texts, bool ofFrame);

  const SequenceKind& Kind;
  SequenceContent& Content;
  std::vector<std::string>& Warnings;
};
}
#endif
