// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHeaderReader.h"

#include "lacunaInputFile.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSequenceText.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::size_t BufferSize = 1 << 14; // asking whether a file is ours reads one or two
constexpr std::size_t LongestLine = 1 << 20;
}

HeaderLines::HeaderLines(const std::string& fileName)
  : FileName(fileName)
  , Stream(OpenForReading(fileName, fileName))
  , Buffer(BufferSize)
{
  if (!this->Fill())
  {
    this->Fail("is empty", false);
  }
}

bool HeaderLines::Fill()
{
  this->Filled = ReadBytes(this->Stream, this->Buffer.data(), this->Buffer.size(), this->FileName);
  this->Position = 0;
  return this->Filled > 0;
}

// Skips the rest of the file if there are only zeros from so many bytes ahead on, for at most
// LongestLine; nothing of it is needed when there are not, as the file is refused then.
bool HeaderLines::OnlyZerosFrom(std::size_t ahead)
{
  std::size_t zeros = 0;
  this->Position += ahead;
  do
  {
    const auto begin = this->Buffer.begin() + static_cast<std::ptrdiff_t>(this->Position);
    const auto end = this->Buffer.begin() + static_cast<std::ptrdiff_t>(this->Filled);
    zeros += static_cast<std::size_t>(end - begin);
    if (zeros > LongestLine || std::any_of(begin, end, [](char c) { return c != 0; }))
    {
      return false;
    }
    this->Position = this->Filled;
  } while (this->Fill());
  return true;
}

bool HeaderLines::Next(std::string& line)
{
  line.clear();
  if (this->Position == this->Filled && !this->Fill())
  {
    return false;
  }
  ++this->LineNumber;
  bool ended = false;
  while (!ended && (this->Position < this->Filled || this->Fill()))
  {
    const char* begin = this->Buffer.data() + this->Position;
    const std::size_t rest = this->Filled - this->Position;
    const auto* end = static_cast<const char*>(std::memchr(begin, '\n', rest));
    ended = end != nullptr;
    const std::size_t size = ended ? static_cast<std::size_t>(end - begin) : rest;
    const auto* zero = static_cast<const char*>(std::memchr(begin, '\0', size));
    if (zero != nullptr && this->OnlyZerosFrom(static_cast<std::size_t>(zero - begin)))
    {
      line.append(begin, zero);
      this->Terminated = false;
      this->Offset += static_cast<std::int64_t>(line.size());
      this->LineNumber -= line.empty() ? 1 : 0;
      return !line.empty();
    }
    line.append(begin, size);
    this->Position += size + (ended ? 1 : 0);
    if (line.size() > LongestLine || zero != nullptr)
    {
      this->Fail("is not text; the file has no header, or its header has no end");
    }
  }
  this->Terminated = ended;
  this->Offset += static_cast<std::int64_t>(line.size()) + (ended ? 1 : 0);
  if (!line.empty() && line.back() == '\r')
  {
    line.pop_back();
  }
  return true;
}

void HeaderLines::Fail(const std::string& text, bool line) const
{
  throw std::runtime_error(
    this->FileName + (line ? ": line " + std::to_string(this->LineNumber) + " " : ": ") + text);
}

//------------------------------------------------------------------------------
namespace
{
constexpr std::string_view FramePrefix = "Seq_Frame";
constexpr const char* ImageStatus = "ImageStatus";

bool IsColourKind(const std::string& kind)
{
  static const std::set<std::string> kinds = { "vector", "3-vector", "4-vector", "3-color",
    "4-color", "rgb-color", "rgba-color", "scalar" };
  return kinds.count(kind) > 0;
}

bool IsFrameKind(const std::string& kind)
{
  return kind == "list" || kind == "time";
}

constexpr std::size_t LongestFrameFieldName = 256;

// Seq_Frame0012_Timestamp -> 12, Timestamp; there are INT_MAX frames at most
bool SplitFrameField(std::string_view name, std::int64_t& frame, std::string& field)
{
  name.remove_prefix(FramePrefix.size());
  const std::size_t underscore = name.find('_');
  if (underscore == std::string_view::npos || underscore + 1 == name.size() ||
    !ParseInteger(name.substr(0, underscore), frame) || frame < 0 || frame >= INT_MAX)
  {
    return false;
  }
  field = name.substr(underscore + 1);
  return true;
}
}

//------------------------------------------------------------------------------
SequenceShape GetSequenceShape(const SequenceAxes& axes)
{
  SequenceShape shape;
  std::vector<std::int64_t> sizes = axes.Sizes;
  std::vector<std::string> kinds = axes.Kinds;
  const std::string sizeName = axes.SizeName;
  shape.Channels = std::max<std::int64_t>(1, axes.Channels);

  bool colourFirst = false;
  if (!kinds.empty() && IsColourKind(kinds[0]))
  {
    kinds.erase(kinds.begin());
    colourFirst = sizes.size() == kinds.size() + 1; // else the sizes leave it out
  }
  else if (axes.Channels > 1 && sizes.size() == (kinds.empty() ? 4 : kinds.size() + 1))
  {
    // '3 columns rows frames' under kinds, or a number of dimensions, that do not count the colours
    colourFirst = sizes[0] == axes.Channels && (!kinds.empty() || sizes[2] != 1);
  }
  else if (kinds.empty() && axes.MayBeginWithColour && sizes.size() == 4)
  {
    colourFirst = (sizes[0] == 3 || sizes[0] == 4) && sizes[2] != 1;
  }
  if (colourFirst)
  {
    if (axes.Channels != 0 && axes.Channels != sizes[0])
    {
      throw std::invalid_argument(sizeName + " gives " + std::to_string(sizes[0]) +
        " components but ElementNumberOfChannels " + std::to_string(axes.Channels));
    }
    shape.Channels = sizes[0];
    shape.ColourFirst = true;
    sizes.erase(sizes.begin());
  }

  if (sizes.size() < 2 || sizes.size() > 4)
  {
    throw std::invalid_argument(
      sizeName + " is " + axes.SizeText + "; it must be 'columns rows frames'");
  }
  if (!kinds.empty() && kinds.size() != sizes.size())
  {
    throw std::invalid_argument(std::string(axes.KindName) + " lists " +
      std::to_string(kinds.size()) + " dimensions, but " + sizeName + " (" + axes.SizeText +
      ") has " + std::to_string(sizes.size()));
  }
  const auto list = std::find_if(kinds.begin(), kinds.end(), IsFrameKind);
  if (list != kinds.end() && list + 1 != kinds.end())
  {
    throw std::invalid_argument(std::string(axes.KindName) + " has '" + *list +
      "' before the last dimension; frames must come last");
  }
  // Without kinds the last of three or four dimensions counts the frames.
  if (list != kinds.end() || (kinds.empty() && sizes.size() > 2))
  {
    shape.Frames = sizes.back();
    sizes.pop_back();
  }
  shape.Columns = sizes[0];
  shape.Rows = sizes.size() > 1 ? sizes[1] : 0;
  for (std::size_t i = 2; i < sizes.size(); ++i)
  {
    shape.Depth = sizes[i] == 1 ? shape.Depth : sizes[i];
  }
  return shape;
}

//------------------------------------------------------------------------------
bool HasSlices(const SequenceAxes& axes)
{
  try
  {
    return GetSequenceShape(axes).Depth == 1;
  }
  catch (const std::invalid_argument&)
  {
    return true;
  }
}

//------------------------------------------------------------------------------
HeaderReader::HeaderReader(const std::string& fileName, bool isVolume)
  : Lines(fileName)
{
  this->Header.FileName = fileName;
  this->Header.IsVolume = isVolume;
}

//------------------------------------------------------------------------------
bool HeaderReader::IsFrameField(std::string_view name)
{
  return EqualsIgnoringCase(name.substr(0, FramePrefix.size()), FramePrefix);
}

//------------------------------------------------------------------------------
void HeaderReader::FailTwice(
  const std::string& field, const std::string& first, const std::string& second) const
{
  this->Lines.Fail("gives header field " + field + " again" +
    (IdentifiesPatient(field, { first, second }) ? ", with another text"
                                                 : ", as '" + second + "' after '" + first + "'") +
    "; remove the wrong one");
}

//------------------------------------------------------------------------------
void HeaderReader::AddCustomField(const std::string& name, const std::string& value)
{
  // No crowd of other fields keeps away what says where slices lie.
  const bool isPlace = EndsWithIgnoringCase(name, "Transform") ||
    EndsWithIgnoringCase(name, "TransformStatus") || name == FirstColumnField ||
    name == FirstRowField;
  std::size_t& count = isPlace ? this->PlaceFields : this->OtherFields;
  if (count < MostFields)
  {
    ++count;
    this->Header.CustomFields.emplace_back(name, value);
  }
  else
  {
    this->Surplus.push_back(name);
  }
}

//------------------------------------------------------------------------------
void HeaderReader::AddFrameField(const std::string& name, const std::string& value)
{
  FrameField field;
  if (!SplitFrameField(name, field.Frame, field.Name))
  {
    this->Ignore("field " + name);
    return;
  }
  if (field.Name.size() > LongestFrameFieldName) // which may be read in as many ways as it has "To"
  {
    this->Lines.Fail("has a field of a frame with a name of " + std::to_string(field.Name.size()) +
      " characters; up to " + std::to_string(LongestFrameFieldName) + " are read");
  }
  field.Value = value;
  this->FrameFields.push_back(std::move(field));
}

//------------------------------------------------------------------------------
std::vector<std::int64_t> HeaderReader::GetIntegers(
  const std::string& name, const std::string* value) const
{
  std::vector<std::int64_t> numbers;
  for (const std::string_view word :
    SplitWords(value ? std::string_view(*value) : std::string_view()))
  {
    numbers.push_back(0);
    if (!ParseInteger(word, numbers.back()))
    {
      this->Fail("header field " + name + " is '" + *value + "'; '" + std::string(word) +
        "' is not an integer that can be represented");
    }
  }
  return numbers;
}

//------------------------------------------------------------------------------
std::int64_t HeaderReader::GetLastDescribedFrame() const
{
  std::int64_t last = -1;
  for (const FrameField& field : this->FrameFields)
  {
    last = std::max(last, field.Frame);
  }
  return last;
}

//------------------------------------------------------------------------------
void HeaderReader::CheckSizes(const std::string& size, std::int64_t columns, std::int64_t rows,
  std::int64_t frames, std::int64_t channels) const
{
  for (const std::int64_t n : { columns, rows, frames })
  {
    if (n < 1 || n > INT_MAX)
    {
      this->Fail(size + "; columns, rows and " + (this->Header.IsVolume ? "slices" : "frames") +
        " must each be from 1 to " + std::to_string(INT_MAX) +
        (n == 0 && n == frames && !this->Header.IsVolume
            ? " (a recording that ended before its first slice?)"
            : ""));
    }
  }
  // 2^31 * 2^31 pixels of one byte fit in 64 bits, but not with frames and elements on top
  const double bytes = 8.0 * static_cast<double>(columns) * static_cast<double>(rows) *
    static_cast<double>(frames) * static_cast<double>(channels);
  if (bytes > 1e18)
  {
    this->Fail(size + "; no file holds so much");
  }
}

//------------------------------------------------------------------------------
std::size_t HeaderReader::SetVolumeShape(const SequenceAxes& axes)
{
  std::vector<std::int64_t> sizes = axes.Sizes;
  std::vector<std::string> kinds = axes.Kinds;
  const std::string size = std::string(axes.SizeName) + " is " + axes.SizeText;
  if (!kinds.empty() && kinds.size() != sizes.size())
  {
    this->Fail(std::string(axes.KindName) + " lists " + std::to_string(kinds.size()) +
      " dimensions, but " + size);
  }
  std::int64_t channels = std::max<std::int64_t>(1, axes.Channels);
  const bool colourFirst = !kinds.empty() && IsColourKind(kinds[0]);
  if (colourFirst)
  {
    channels = sizes[0];
    sizes.erase(sizes.begin());
    kinds.erase(kinds.begin());
  }
  for (const std::string& kind : kinds)
  {
    if (!IsFrameKind(kind) && kind != "domain" && kind != "space" && kind != "none" &&
      kind != "???")
    {
      this->Fail(std::string(axes.KindName) + " has '" + kind +
        "'; a volume has three axes of kind domain, before them perhaps one of components "
        "(vector, RGB-color)");
    }
  }
  while (sizes.size() > 3 && sizes.back() == 1)
  {
    sizes.pop_back();
  }
  kinds.resize(std::min(kinds.size(), sizes.size()));
  const bool listed = std::any_of(kinds.begin(), kinds.end(), IsFrameKind);
  if (sizes.size() != 3 || listed)
  {
    this->Fail(size + ": " +
      (sizes.size() < 3
          ? "an image, not a volume, which has three axes"
          : "the file has several volumes or slices in a row. Save one volume in a file of its "
            "own (3D Slicer: the proxy node of a sequence). Slices with the poses "
            "of a tracker are opened by Tracked Slice Reader"));
  }
  if (channels < 1 || channels > 64)
  {
    this->Fail(size + "; voxels of " + std::to_string(channels) +
      " components are not read, only of 1 to 64");
  }
  this->CheckSizes(size, sizes[0], sizes[1], sizes[2], channels);
  this->Header.Columns = sizes[0];
  this->Header.Rows = sizes[1];
  this->Header.Frames = sizes[2];
  this->Header.Channels = channels;
  return colourFirst ? 1 : 0;
}

//------------------------------------------------------------------------------
void HeaderReader::SetShape(const SequenceAxes& axes)
{
  if (this->FrameFields.empty())
  {
    const bool slicer =
      std::any_of(this->Header.CustomFields.begin(), this->Header.CustomFields.end(),
        [](const auto& field) { return EndsWithIgnoringCase(field.first, " index values"); });
    this->Fail(this->CutOff ? "the header is cut off before the fields of the first frame"
        : slicer
        ? "these are pictures of 3D Slicer, whose poses are in another file. Export both to "
          "one .mhd with Slicer's extension SlicerIGSIO (WriteSequenceMetafile), or give the "
          "poses as a table to Assemble Tracked Slices"
        : "no field Seq_Frame0000_... describes a slice: this is an ordinary image without "
          "poses; open it with Volume Reader, or ParaView's own reader");
  }
  this->SizeName = axes.SizeName;
  SequenceShape shape;
  try
  {
    shape = GetSequenceShape(axes);
  }
  catch (const std::invalid_argument& e)
  {
    this->Fail(e.what());
  }
  this->FirstAxis = shape.ColourFirst ? 1 : 0;
  const std::string size = std::string(axes.SizeName) + " is " + axes.SizeText;
  if (shape.Columns == 0 && shape.Rows == 0)
  {
    this->Header.PosesOnly = true;
    shape.Columns = shape.Rows = shape.Depth = shape.Channels = 1;
    shape.Frames = shape.Frames == 0 ? this->GetLastDescribedFrame() + 1 : shape.Frames;
  }
  if (shape.Depth != 1)
  {
    this->Fail("the frames are volumes of " + std::to_string(shape.Depth) + " layers (" + size +
      "), not slices; open a volume with Volume Reader");
  }
  if (shape.Channels != 1 && shape.Channels != 3 && shape.Channels != 4)
  {
    this->Fail("pixels have " + std::to_string(shape.Channels) +
      " components; known are 1 (grey), 3 (RGB) and 4 (RGBA)");
  }
  this->CheckSizes(size, shape.Columns, shape.Rows, shape.Frames, shape.Channels);
  this->Header.Columns = shape.Columns;
  this->Header.Rows = shape.Rows;
  this->Header.Frames = shape.Frames;
  this->Header.Channels = shape.Channels;
}

//------------------------------------------------------------------------------
void HeaderReader::SetOrientation(
  const std::string& name, const std::string* orientation, const std::string* type)
{
  if (this->Header.PosesOnly)
  {
    return; // nothing that could be turned
  }
  if (!orientation || !IsKnownOrientation(*orientation))
  {
    this->Header.Warnings.push_back(name +
      (orientation ? " is '" + *orientation + "', which says that it is not known"
                   : " is missing") +
      "; the slices are taken as they are stored");
    orientation = nullptr;
  }
  if (type && !GetImageTypeName(*type).empty() && GetImageTypeName(*type) != "XX")
  {
    this->Header.ImageType = GetImageTypeName(*type);
  }
  const bool signal = this->Header.ImageType.find("RF_") == 0;
  try
  {
    this->Header.Flips = GetSliceFlips(orientation ? *orientation
        : signal                                   ? "FM"
                                                   : "MF",
      this->Header.ImageType);
  }
  catch (const std::invalid_argument& e)
  {
    this->Fail(e.what());
  }
}

//------------------------------------------------------------------------------
void HeaderReader::ReportPlace(const std::string& name, const std::string* value, bool turns)
{
  if (!value || this->Header.PosesOnly)
  {
    return;
  }
  std::string numbers = *value;
  std::replace_if(
    numbers.begin(), numbers.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  const auto words = SplitWords(numbers);
  std::size_t size = 0; // of the matrix
  while (turns && size * size < words.size())
  {
    ++size;
  }
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    double number = 0;
    const double none = turns && i / size == i % size ? 1 : 0;
    if (ParseNumber(words[i], number) && number != none)
    {
      this->Header.Warnings.push_back("header field " + name + " is '" + *value +
        "', which places the image in space. It is not used: each slice lies where its own "
        "transforms put it");
      return;
    }
  }
}

//------------------------------------------------------------------------------
void HeaderReader::SetPixelSpacing(const std::vector<std::string>& spacings)
{
  if (this->FirstAxis + 1 < spacings.size())
  {
    this->Header.PixelSpacing = spacings[this->FirstAxis] + " " + spacings[this->FirstAxis + 1];
  }
}

//------------------------------------------------------------------------------
void HeaderReader::SetDataFile(const std::string& name, const std::string& value)
{
  if (value == "LIST" || value.substr(0, 5) == "LIST " || value.find('%') != std::string::npos)
  {
    this->Fail(name + " is '" + value + "'; pixels in one file per slice are not read, only " +
      (name == "ElementDataFile" ? "LOCAL or " : "") + "the name of one file");
  }
  const std::filesystem::path folder = std::filesystem::path(this->Header.FileName).parent_path();
  this->Header.DataFileName = (folder / value).string(); // value alone if it is absolute
}

//------------------------------------------------------------------------------
bool HeaderReader::IsLastFrameWhole() const
{
  const std::int64_t last = this->GetLastDescribedFrame();
  bool others = false;
  for (const FrameField& field : this->FrameFields)
  {
    const bool ends = field.Name == ImageStatus;
    if (ends && field.Frame == last)
    {
      return true;
    }
    others = others || ends;
  }
  return !others;
}

//------------------------------------------------------------------------------
// A frame's fields are whole when another frame follows, or when ImageStatus, the last one, is
// there.
void HeaderReader::DropUnfinishedFrames()
{
  const std::int64_t last = this->GetLastDescribedFrame();
  const bool whole = std::any_of(this->FrameFields.begin(), this->FrameFields.end(),
    [&](const FrameField& field) { return field.Frame == last && field.Name == ImageStatus; });
  const std::int64_t frames = std::min(this->Header.Frames, whole ? last + 1 : last);
  if (frames < 1)
  {
    this->Fail("the header is cut off before the fields of the first frame are complete");
  }
  this->Header.Frames = frames;
  this->Header.Warnings.push_back("the header is cut off, as after a recording that was "
                                  "interrupted: " +
    std::to_string(frames) + " frames are described completely");
  const auto end = std::remove_if(this->FrameFields.begin(), this->FrameFields.end(),
    [&](const FrameField& field) { return field.Frame >= frames; });
  this->FrameFields.erase(end, this->FrameFields.end());
}

//------------------------------------------------------------------------------
// Keeps what is allocated for fields in proportion to the length of the header.
void HeaderReader::CheckFrameFields() const
{
  const auto count = static_cast<std::size_t>(this->Header.Frames);
  std::set<std::int64_t> described;
  std::set<std::string> names;
  for (const FrameField& field : this->FrameFields)
  {
    if (field.Frame < this->Header.Frames)
    {
      described.insert(field.Frame);
    }
    names.insert(field.Name);
  }
  if (described.size() * 2 < count)
  {
    this->Fail(this->SizeName + " says " + std::to_string(count) +
      " frames, but fields Seq_Frame... describe only " + std::to_string(described.size()) +
      " of them");
  }
  if (names.size() > MostFields)
  {
    this->Fail("the frames have " + std::to_string(names.size()) + " different fields; up to " +
      std::to_string(MostFields) + " are read: is the file damaged?");
  }
  if (names.size() * count > 100 * this->FrameFields.size() + 1000000)
  {
    this->Fail("the frames have " + std::to_string(names.size()) +
      " different fields, nearly all of them missing in nearly all frames");
  }
}

//------------------------------------------------------------------------------
void HeaderReader::SortFrameFields()
{
  if (!this->Ignored.empty())
  {
    this->Header.Warnings.push_back(
      "ignored what is neither a field of the header nor of the form Seq_Frame0000_Name: " +
      JoinSome(this->Ignored));
  }
  if (!this->Surplus.empty())
  {
    const std::size_t kept = this->Header.CustomFields.size();
    this->Header.Warnings.push_back("the header has " +
      std::to_string(kept + this->Surplus.size()) + " fields of its own; the first " +
      std::to_string(kept) + " are kept. Left out are " + JoinSome(this->Surplus));
  }
  if (this->CutOff)
  {
    this->DropUnfinishedFrames();
  }
  this->CheckFrameFields();
  const auto count = static_cast<std::size_t>(this->Header.Frames);
  std::set<std::int64_t> outside;
  for (FrameField& field : this->FrameFields)
  {
    if (field.Frame >= this->Header.Frames)
    {
      outside.insert(field.Frame);
      continue;
    }
    std::vector<std::string>& values = this->Header.FrameFields[field.Name];
    values.resize(count);
    std::string& value = values[static_cast<std::size_t>(field.Frame)];
    if (!value.empty() && value != field.Value)
    {
      this->Fail("frame " + std::to_string(field.Frame) + " has field " + field.Name + " twice, " +
        (IdentifiesPatient(field.Name, { value, field.Value })
            ? "with two texts"
            : "as '" + value + "' and as '" + field.Value + "'") +
        "; remove the wrong one");
    }
    value = std::move(field.Value);
  }
  if (!outside.empty())
  {
    this->Header.Warnings.push_back("fields of frames " + std::to_string(*outside.begin()) +
      " to " + std::to_string(*outside.rbegin()) + " are ignored: " + this->SizeName + " says " +
      std::to_string(count) + " frames, numbered from 0");
  }
  // PLUS writes one dummy pixel per frame, and no state of the image, when it keeps poses only.
  if (this->Header.Columns == 1 && this->Header.Rows == 1 && this->Header.Channels == 1 &&
    this->Header.FrameFields.count(ImageStatus) == 0)
  {
    this->Header.PosesOnly = true;
  }
  if (this->Header.PosesOnly)
  {
    this->Header.Type = ScalarType::UInt8;
    this->Header.TypeIsLong = false;
    this->Header.Warnings.emplace_back(
      "the file has poses but no pictures: every slice is one blank pixel, marked as having no "
      "valid image; the poses and fields are complete");
  }
}
}
