// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pixel data of a sequence: where they are and how to get one frame of them.
#ifndef lacunaPixelSource_h
#define lacunaPixelSource_h

#include "lacunaScalarType.h"
#include "lacunaSequenceHeader.h"

#include <cstdint>
#include <memory>
#include <string>

namespace lacuna
{
/// Reads frames one at a time, as they are stored but in this machine's byte order. Offsets are 64
/// bits wide. Raw frames are read from where they are. Compressed ones are one stream over all
/// frames, and text is read in order, too: going forward decodes only what lies between, going back
/// starts afresh.
class PixelSource
{
public:
  /// Finds the data of header and compares their size with what header says, before anything is
  /// allocated. Where the size of the decoded data is not known from the file, they are decoded
  /// once to count them. header must outlive the source. Throws std::runtime_error when the data
  /// file is missing, holds not even one frame, or cannot hold as many as the header says.
  static std::unique_ptr<PixelSource> Open(const SequenceHeader& header);

  virtual ~PixelSource() = default;

  /// Number type of the elements; decides between the widths of MET_LONG by the size of the data.
  ScalarType GetScalarType() const { return this->Type; }
  /// Bytes of a frame.
  std::int64_t GetFrameSize() const { return this->FrameSize; }
  /// Frames whose pixels are there: fewer than the header says when the file is cut off. The blank
  /// frames of a file of poses are there.
  std::int64_t GetNumberOfWholeFrames() const { return this->WholeFrames; }

  /// A sentence when there are fewer or more data than the header says; otherwise empty.
  const std::string& GetWarning() const { return this->Warning; }

  /// Puts the GetFrameSize() bytes of a whole frame into pixels. Throws std::runtime_error when the
  /// data are corrupt or cannot be read.
  void ReadFrame(std::int64_t frame, void* pixels);

protected:
  explicit PixelSource(const SequenceHeader& header);
  virtual void ReadStored(std::int64_t frame, unsigned char* pixels) = 0;
  [[noreturn]] void Fail(const std::string& text) const;
  /// Sets the members below from the number of bytes there are. damage: why there are no more. all: no
  /// more of them follow.
  void Divide(std::int64_t bytes, const std::string& damage = {}, bool all = true);

  const SequenceHeader& Header;
  const std::string FrameWord; ///< what a frame is called in messages
  ScalarType Type;
  std::int64_t FrameSize = 0;
  std::int64_t WholeFrames = 0;
  std::string Warning;
};
}
#endif
