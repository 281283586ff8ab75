// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the readers of MetaImage and NRRD headers share: the shape of the data and the fields of
/// the frames.
#ifndef lacunaHeaderReader_h
#define lacunaHeaderReader_h

#include "lacunaSequenceHeader.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
class HeaderLines
{
public:
  /// Opens the file. Throws std::runtime_error when it is absent, not a file, empty or unreadable.
  explicit HeaderLines(const std::string& fileName);

  /// The next line without its end (LF or CRLF); false at the end of the file. Throws
  /// std::runtime_error when the line is not text: it holds a zero byte or is over 1 MiB long. Zeros
  /// that end the file end the text: a power cut can leave a file with its size but not its bytes.
  bool Next(std::string& line);

  /// The first bytes of the file, fewer when it is shorter. Only before the first call of Next.
  std::string_view Peek(std::size_t size) const
  {
    return { this->Buffer.data(), std::min(size, this->Filled) };
  }

  /// Whether the line that Next gave last has an end: the last line of a file that is cut off has
  /// none.
  bool IsTerminated() const { return this->Terminated; }
  /// 1-based number of the line that Next gave last.
  std::int64_t GetLineNumber() const { return this->LineNumber; }
  /// Bytes from the start of the file to the end of that line, its LF included.
  std::int64_t GetOffset() const { return this->Offset; }

  /// Throws std::runtime_error with the file's name and, when line is set, the line's number.
  [[noreturn]] void Fail(const std::string& text, bool line = true) const;

private:
  bool Fill();
  bool OnlyZerosFrom(std::size_t ahead);

  std::string FileName;
  std::ifstream Stream;
  std::vector<char> Buffer;
  std::size_t Position = 0;
  std::size_t Filled = 0;
  bool Terminated = true;
  std::int64_t LineNumber = 0;
  std::int64_t Offset = 0;
};

/// The axes of the data as a header lists them, fastest first.
struct SequenceAxes
{
  const char* SizeName = "DimSize"; ///< of the field, for messages
  const char* KindName = "Kinds";
  std::string SizeText;
  std::vector<std::int64_t> Sizes;
  std::vector<std::string> Kinds; ///< in lower case; empty when the header has none
  std::int64_t Channels = 0;      ///< when given elsewhere; else 0
  /// Without kinds, whether a first axis of 3 or 4 of four axes is colour.
  bool MayBeginWithColour = false;
};

struct SequenceShape
{
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  std::int64_t Depth = 1;
  std::int64_t Frames = 1;
  std::int64_t Channels = 1;
  bool ColourFirst = false; ///< the first of the sizes counts the channels
};

/// Finds out which axis is what: colour first if any, columns, rows, layers if any, frames last. A
/// list of kinds decides; without one, the last of three or more axes counts the frames. Sizes are
/// not judged. Throws std::invalid_argument when the axes make no sense.
SequenceShape GetSequenceShape(const SequenceAxes& axes);

/// Whether frames with these axes are slices. Axes that make no sense count as such: reading them
/// tells what is wrong.
bool HasSlices(const SequenceAxes& axes);

/// The base of the readers: collects fields, then turns them into a SequenceHeader.
class HeaderReader
{
public:
  /// Whether name is that of a frame's field: it begins with Seq_Frame in any case.
  static bool IsFrameField(std::string_view name);

protected:
  HeaderReader(const std::string& fileName, bool isVolume);

  [[noreturn]] void Fail(const std::string& text) const { this->Lines.Fail(text, false); }
  [[noreturn]] void FailTwice(
    const std::string& field, const std::string& first, const std::string& second) const;

  /// Keeps a field that the format does not define. Beyond MostFields it is left out, and a warning.
  void AddCustomField(const std::string& name, const std::string& value);
  /// Keeps Seq_Frame0012_Timestamp. A name that is not of this form is noted as ignored.
  void AddFrameField(const std::string& name, const std::string& value);
  void Ignore(const std::string& what) { this->Ignored.push_back(what); }

  /// The integers of the field name's value, which may be null.
  std::vector<std::int64_t> GetIntegers(const std::string& name, const std::string* value) const;

  /// Sets the header's shape. Fails when there are no frame fields, when frames are not slices, or
  /// when sizes are impossible.
  void SetShape(const SequenceAxes& axes);
  /// The same for one volume, whose third axis counts the frames. Returns the number of the axis of
  /// the columns, 0 or 1. Fails for several volumes.
  std::size_t SetVolumeShape(const SequenceAxes& axes);
  /// Either may be null: name is the orientation field's.
  void SetOrientation(
    const std::string& name, const std::string* orientation, const std::string* type);
  /// Warns of a field that places or turns the image in space: of slices, each has its own
  /// transforms. value may be null, and of other characters than numbers. turns: the numbers are a
  /// square matrix, which does nothing when it is the identity; else a vector.
  void ReportPlace(const std::string& name, const std::string* value, bool turns);
  /// Takes the pixel's size from the spacings of all axes in the file's order, one text for each.
  void SetPixelSpacing(const std::vector<std::string>& spacings);
  /// Sets the place of the pixels to a file named in the header; name is the field's.
  void SetDataFile(const std::string& name, const std::string& value);
  /// Names of fields that are kept: of frames, of transforms in the header, and of other fields. Each becomes an array, and what passes arrays on
  /// compares each name with all others.
  static constexpr std::size_t MostFields = 1000;
  /// Gives the frames their fields; reports what was ignored. The last step.
  void SortFrameFields();

  /// Of the last frame that fields describe; -1 when there is none.
  std::int64_t GetLastDescribedFrame() const;

  /// Whether that frame has ImageStatus, the last of a frame's fields, or no frame has it.
  bool IsLastFrameWhole() const;

  HeaderLines Lines;
  SequenceHeader Header;
  /// The end of the header is missing: frames count only as far as their fields are whole.
  bool CutOff = false;

private:
  struct FrameField
  {
    std::int64_t Frame;
    std::string Name;
    std::string Value;
  };
  void CheckSizes(const std::string& size, std::int64_t columns, std::int64_t rows,
    std::int64_t frames, std::int64_t channels) const;
  void DropUnfinishedFrames();
  void CheckFrameFields() const;

  std::string SizeName;
  std::size_t FirstAxis = 0; ///< of the columns: colours may come before it
  std::vector<FrameField> FrameFields;
  std::vector<std::string> Ignored;
  std::size_t PlaceFields = 0;      ///< custom fields that say where slices lie
  std::size_t OtherFields = 0;      ///< all others
  std::vector<std::string> Surplus; ///< what either has beyond MostFields
};

/// The readers proper.
SequenceHeader ReadMetaImageHeader(const std::string& fileName);
SequenceHeader ReadNrrdHeader(const std::string& fileName);
VolumeHeader ReadMetaImageVolumeHeader(const std::string& fileName);
VolumeHeader ReadNrrdVolumeHeader(const std::string& fileName);

/// Whether a header field of this name has a meaning in the format, so that no custom field can.
bool IsMetaImageField(const std::string& name);
bool IsNrrdField(const std::string& name);

/// See GetImageFileKind. May throw.
ImageFileKind GetMetaImageKind(HeaderLines& lines);
ImageFileKind GetNrrdKind(HeaderLines& lines);
}
#endif
