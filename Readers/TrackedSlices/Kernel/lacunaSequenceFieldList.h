// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fields for a sequence file, which takes not every name and text.
#ifndef lacunaSequenceFieldList_h
#define lacunaSequenceFieldList_h

#include "lacunaSequenceWriter.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
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
