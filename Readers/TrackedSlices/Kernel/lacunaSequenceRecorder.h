// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes a sequence while it is being taken.
///
/// The pixels go to a file of their own, the header stays readable after every slice:
///
/// 1. the pixels are written behind those that are there;
/// 2. the slice's fields, and for .mhd the line ElementDataFile that ends the header, are written
///    over the old end of the header;
/// 3. the number of slices is written over the old one.
///
/// Nothing is buffered in the program. So whatever ends it, and wherever either file is cut off,
/// ReadSequenceHeader and PixelSource find all slices up to the last whole one: surplus pixels and
/// fields are ignored, a header without its end is completed by the name of its pixels' file, and
/// of the last slice all fields must be there. A failure of the power can take what the system has
/// not yet put on the disk; Sync forces it to.
#ifndef lacunaSequenceRecorder_h
#define lacunaSequenceRecorder_h

#include "lacunaOutputFile.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSequenceHeader.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
class StreamCompressor;

class SequenceRecorder
{
public:
  /// Begins a recording: .mhd with .raw or .zraw, .nhdr with .raw or .raw.gz. compressionLevel: 0
  /// (none) to 9. Never writes over a file. Throws FileError, or std::invalid_argument for another
  /// extension: a single file has its header before the pixels and cannot grow; WriteSequence
  /// makes one of a finished recording.
  SequenceRecorder(
    const std::string& fileName, const SequenceDescription& description, int compressionLevel = 0);
  /// Closes, without a word about errors.
  ~SequenceRecorder();
  SequenceRecorder(const SequenceRecorder&) = delete;
  SequenceRecorder& operator=(const SequenceRecorder&) = delete;

  /// Adds a slice: Columns x Rows elements in this machine's byte order, and its fields;
  /// ImageStatus is OK unless given. Throws std::invalid_argument when a field cannot be written,
  /// FileError when the disk is full or fails. Then the recording is as it was before, and the same
  /// or another slice may be added later. Throws FileLost as Check does, but looks at no names.
  void Append(const void* pixels, SequenceFields fields);

  std::int64_t GetNumberOfSlices() const { return this->Now.Slices; }

  /// Throws FileLost when one of the files was removed, renamed, replaced or cut off. Nothing else
  /// tells: the system goes on writing to files without a name.
  void Check() const;
  /// Where PixelSource finds the pixels that are written, also when their file has no name any
  /// more. Without fields. Not after Close.
  SequenceHeader GetOpenHeader() const;

  /// Waits until the disk has all slices. Throws FileError: then the system may have dropped what it
  /// could not write, and says so only once. The recording is as it was after the last Sync that
  /// worked, and the slices since are to be appended again, at once: until then the file lacks them.
  void Sync();
  /// Ends the recording: compressed pixels get their end and check sum. Throws FileError; it may be
  /// called again, after appending the slices since the last Sync that worked.
  void Close();

private:
  // What there is of the recording.
  struct Extent
  {
    std::int64_t HeaderSize = 0; ///< without its end
    std::int64_t DataSize = 0;
    std::int64_t Slices = 0;
    std::shared_ptr<const StreamCompressor> Compressor; ///< null when the pixels are raw
  };
  void WriteHeader(const std::string& fields, std::int64_t slices, std::int64_t compressedSize);
  void RestoreHeader();
  void SyncFiles();
  void CheckSizes() const;
  void End();

  SequenceKind Kind;
  SequenceDescription Description;
  std::string HeaderName; ///< absolute, as the program may change its folder
  std::string DataName;
  std::string HeaderStart; ///< and the pixels', written again while no Sync has worked
  std::string DataStart;
  std::unique_ptr<OutputFile> Header;
  std::unique_ptr<OutputFile> Data;
  std::int64_t CountsOffset = 0;
  Extent Now;
  Extent Synced;
  bool Begun = false; ///< on the disk, by a Sync
  std::vector<unsigned char> Frame;
};
}
#endif
