// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceHeader.h"

#include "lacunaHeaderLines.h"
#include "lacunaSequenceText.h"

#include <algorithm>
#include <climits>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::string_view FramePrefix = "Seq_Frame";
// Fields of MetaImage and of tracked sequences that are interpreted here or, like the position of
// the image in space, do not apply to sequences.
const std::set<std::string> KnownFields = { "ObjectType", "ObjectSubType", "NDims", "BinaryData",
  "BinaryDataByteOrderMSB", "ElementByteOrderMSB", "CompressedData", "CompressedDataSize",
  "DimSize", "Kinds", "ElementNumberOfChannels", "ElementType", "ElementSpacing", "ElementSize",
  "Offset", "Position", "Origin", "Orientation", "Rotation", "CenterOfRotation", "TransformMatrix",
  "AnatomicalOrientation", "UltrasoundImageOrientation", "UltrasoundImageType", "HeaderSize" };

struct Type
{
  const char* Name;
  ScalarType Value;
  bool IsLong;
};
const Type Types[] = { { "MET_CHAR", ScalarType::Int8, false },
  { "MET_UCHAR", ScalarType::UInt8, false }, { "MET_SHORT", ScalarType::Int16, false },
  { "MET_USHORT", ScalarType::UInt16, false }, { "MET_INT", ScalarType::Int32, false },
  { "MET_UINT", ScalarType::UInt32, false }, { "MET_LONG", ScalarType::Int32, true },
  { "MET_ULONG", ScalarType::UInt32, true }, { "MET_LONG_LONG", ScalarType::Int64, false },
  { "MET_ULONG_LONG", ScalarType::UInt64, false }, { "MET_FLOAT", ScalarType::Float32, false },
  { "MET_DOUBLE", ScalarType::Float64, false } };

bool SplitField(std::string_view line, std::string& name, std::string& value)
{
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos)
  {
    return false;
  }
  name = Trim(line.substr(0, equals));
  value = Trim(line.substr(equals + 1));
  return !name.empty();
}

bool IsFrameField(std::string_view name)
{
  return EqualsIgnoringCase(name.substr(0, FramePrefix.size()), FramePrefix);
}

// Seq_Frame0012_Timestamp -> 12, Timestamp
bool SplitFrameField(std::string_view name, std::int64_t& frame, std::string& field)
{
  name.remove_prefix(FramePrefix.size());
  const std::size_t underscore = name.find('_');
  if (underscore == std::string_view::npos || underscore + 1 == name.size() ||
    !ParseInteger(name.substr(0, underscore), frame) || frame < 0)
  {
    return false;
  }
  field = name.substr(underscore + 1);
  return true;
}

class MetaImageHeaderReader
{
public:
  explicit MetaImageHeaderReader(const std::string& fileName)
    : Lines(fileName)
  {
    this->Header.FileName = fileName;
  }

  SequenceHeader Read()
  {
    this->ReadLines();
    this->ReadSize();
    this->ReadType();
    this->ReadOrientation();
    this->ReadDataPlace();
    this->SortFrameFields();
    return std::move(this->Header);
  }

private:
  struct FrameField
  {
    std::int64_t Frame;
    std::string Name;
    std::string Value;
  };

  [[noreturn]] void Fail(const std::string& text) const { this->Lines.Fail(text, false); }

  [[noreturn]] void FailTwice(
    const std::string& field, const std::string& first, const std::string& second) const
  {
    this->Lines.Fail(
      "gives " + field + " again, as '" + second + "' after '" + first + "'; remove the wrong one");
  }

  const std::string* Find(const std::string& name) const
  {
    const auto found = this->Fields.find(name);
    return found == this->Fields.end() ? nullptr : &found->second;
  }

  bool FindBool(const std::string& name, bool otherwise) const
  {
    const std::string* value = this->Find(name);
    if (!value)
    {
      return otherwise;
    }
    const std::string lower = ToLower(*value);
    const bool yes = lower == "true" || lower == "1";
    if (!yes && lower != "false" && lower != "0")
    {
      this->Fail("header field " + name + " is '" + *value + "'; it must be True or False");
    }
    return yes;
  }

  std::vector<std::int64_t> FindIntegers(const std::string& name) const
  {
    std::vector<std::int64_t> numbers;
    const std::string* value = this->Find(name);
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

  void ReadLines();
  void ReadSize();
  void ReadType();
  void ReadOrientation();
  void ReadDataPlace();
  void SortFrameFields();

  HeaderLines Lines;
  SequenceHeader Header;
  std::map<std::string, std::string> Fields;
  std::vector<FrameField> FrameFields;
  std::string DataFile;
};

void MetaImageHeaderReader::ReadLines()
{
  std::string line;
  std::string name;
  std::string value;
  std::vector<std::string> ignored;
  while (this->DataFile.empty())
  {
    if (!this->Lines.Next(line))
    {
      this->Lines.Fail("is the last one, but no ElementDataFile came before it: the header is cut "
                       "off, or the file is not a MetaImage");
    }
    FrameField frame;
    if (Trim(line).empty())
    {
      continue;
    }
    if (!SplitField(line, name, value))
    {
      if (this->Fields.empty())
      {
        this->Lines.Fail("is not of the form 'Name = Value': the file is not a MetaImage");
      }
      ignored.push_back("line " + std::to_string(this->Lines.GetLineNumber()));
    }
    else if (EqualsIgnoringCase(name, "ElementDataFile"))
    {
      if (value.empty())
      {
        this->Lines.Fail("has an ElementDataFile without a value; it must be LOCAL or a file name");
      }
      this->DataFile = value;
    }
    else if (!IsFrameField(name))
    {
      const auto inserted = this->Fields.emplace(name, value);
      if (!inserted.second && inserted.first->second != value)
      {
        this->FailTwice("header field " + name, inserted.first->second, value);
      }
      if (inserted.second && KnownFields.count(name) == 0)
      {
        this->Header.CustomFields.emplace_back(name, value);
      }
    }
    else if (SplitFrameField(name, frame.Frame, frame.Name))
    {
      frame.Value = value;
      this->FrameFields.push_back(std::move(frame));
    }
    else
    {
      ignored.push_back("field " + name);
    }
  }
  if (!ignored.empty())
  {
    this->Header.Warnings.push_back(
      "ignored what is not of the form 'Name = Value' or 'Seq_Frame0000_Name = Value': " +
      JoinSome(ignored));
  }
}

void MetaImageHeaderReader::ReadSize()
{
  if (this->FrameFields.empty())
  {
    this->Fail("no field Seq_Frame0000_... describes a slice: this is an ordinary image without "
               "poses; open it with ParaView's MetaImage reader");
  }
  std::vector<std::int64_t> size = this->FindIntegers("DimSize");
  const std::string text = this->Find("DimSize") ? *this->Find("DimSize") : "missing";
  std::vector<std::string> kinds;
  if (const std::string* value = this->Find("Kinds"))
  {
    for (const std::string_view kind : SplitWords(*value))
    {
      kinds.push_back(ToLower(kind));
    }
  }
  const std::vector<std::int64_t> channels = this->FindIntegers("ElementNumberOfChannels");
  if (!channels.empty())
  {
    this->Header.Channels = channels[0];
  }
  const std::size_t listed = size.size();
  if (!kinds.empty() && kinds[0] == "vector")
  {
    kinds.erase(kinds.begin());
    if (size.size() == kinds.size() + 1)
    {
      if (!channels.empty() && channels[0] != size[0])
      {
        this->Fail("DimSize gives " + std::to_string(size[0]) +
          " components but ElementNumberOfChannels " + std::to_string(channels[0]));
      }
      this->Header.Channels = size[0];
      size.erase(size.begin());
    }
  }
  const std::vector<std::int64_t> dimensions = this->FindIntegers("NDims");
  const auto matches = [&](std::size_t n) { return static_cast<std::int64_t>(n) == dimensions[0]; };
  if (!dimensions.empty() && !matches(size.size()) && !matches(listed))
  {
    this->Fail("NDims is " + std::to_string(dimensions[0]) + " but DimSize (" + text + ") has " +
      std::to_string(listed) + " numbers");
  }
  if (size.size() < 2 || size.size() > 4)
  {
    this->Fail("DimSize is " + text + "; it must be 'columns rows frames'");
  }
  if (!kinds.empty() && kinds.size() != size.size())
  {
    this->Fail("Kinds lists " + std::to_string(kinds.size()) + " dimensions, but DimSize (" + text +
      ") has " + std::to_string(size.size()));
  }
  const auto list = std::find(kinds.begin(), kinds.end(), "list");
  if (list != kinds.end() && list + 1 != kinds.end())
  {
    this->Fail("Kinds has 'list' before the last dimension; frames must come last");
  }
  // Without Kinds the last of three or four dimensions counts the frames.
  const bool framesGiven = list != kinds.end() || (kinds.empty() && size.size() > 2);
  this->Header.Frames = framesGiven ? size.back() : 1;
  if (framesGiven)
  {
    size.pop_back();
  }
  this->Header.Columns = size[0];
  this->Header.Rows = size.size() > 1 ? size[1] : 0;
  if (size.size() == 3 && size[2] != 1)
  {
    this->Fail("the frames are volumes of " + std::to_string(size[2]) + " layers (DimSize " + text +
      "), not slices; open a volume with ParaView's MetaImage reader");
  }
  for (const std::int64_t n : { this->Header.Columns, this->Header.Rows, this->Header.Frames })
  {
    if (n < 1 || n > INT_MAX)
    {
      this->Fail("DimSize is " + text + "; columns, rows and frames must each be from 1 to " +
        std::to_string(INT_MAX));
    }
  }
  if (this->Header.Channels != 1 && this->Header.Channels != 3 && this->Header.Channels != 4)
  {
    this->Fail("pixels have " + std::to_string(this->Header.Channels) +
      " components; known are 1 (grey), 3 (RGB) and 4 (RGBA)");
  }
  // 2^31 * 2^31 pixels of one byte fit in 64 bits, but not with frames and elements on top
  const double bytes = 8.0 * static_cast<double>(this->Header.Columns) *
    static_cast<double>(this->Header.Rows) * static_cast<double>(this->Header.Frames) *
    static_cast<double>(this->Header.Channels);
  if (bytes > 1e18)
  {
    this->Fail("DimSize is " + text + "; no file holds so much");
  }
}

void MetaImageHeaderReader::ReadType()
{
  const std::string* name = this->Find("ElementType");
  const auto found = std::find_if(std::begin(Types), std::end(Types),
    [&](const Type& type) { return name && *name == type.Name; });
  if (found == std::end(Types))
  {
    std::vector<std::string> known;
    std::transform(std::begin(Types), std::end(Types), std::back_inserter(known),
      [](const Type& type) { return type.Name; });
    this->Fail((name ? "ElementType is '" + *name + "'" : std::string("ElementType is missing")) +
      "; known are " + JoinSome(known, known.size()));
  }
  this->Header.Type = found->Value;
  this->Header.TypeIsLong = found->IsLong;
  this->Header.BigEndian =
    this->FindBool("BinaryDataByteOrderMSB", this->FindBool("ElementByteOrderMSB", false));
  if (!this->FindBool("BinaryData", true))
  {
    this->Fail("BinaryData is False: pixels written as text are not read");
  }
}

void MetaImageHeaderReader::ReadOrientation()
{
  const std::string* orientation = this->Find("UltrasoundImageOrientation");
  const std::string* type = this->Find("UltrasoundImageType");
  if (!orientation)
  {
    this->Header.Warnings.emplace_back(
      "UltrasoundImageOrientation is missing; the slices are taken as they are stored");
  }
  const bool lines = type && type->find("RF_") != std::string::npos;
  try
  {
    this->Header.Flips = GetSliceFlips(orientation ? *orientation
        : lines                                    ? "FM"
                                                   : "MF",
      type ? *type : "");
  }
  catch (const std::invalid_argument& e)
  {
    this->Fail(e.what());
  }
}

void MetaImageHeaderReader::ReadDataPlace()
{
  this->Header.Compressed = this->FindBool("CompressedData", false);
  const std::vector<std::int64_t> compressedSize = this->FindIntegers("CompressedDataSize");
  if (this->Header.Compressed && !compressedSize.empty() && compressedSize[0] > 0)
  {
    this->Header.CompressedDataSize = compressedSize[0];
  }
  if (EqualsIgnoringCase(this->DataFile, "LOCAL"))
  {
    this->Header.DataFileName = this->Header.FileName;
    this->Header.DataOffset = this->Lines.GetOffset();
    return;
  }
  if (this->DataFile == "LIST" || this->DataFile.find('%') != std::string::npos)
  {
    this->Fail("ElementDataFile is '" + this->DataFile +
      "'; pixels in one file per slice are not read, only LOCAL or the name of one file");
  }
  const std::filesystem::path folder = std::filesystem::path(this->Header.FileName).parent_path();
  this->Header.DataFileName = (folder / this->DataFile).string();
  const std::vector<std::int64_t> skip = this->FindIntegers("HeaderSize");
  if (!skip.empty())
  {
    this->Header.DataOffset = skip[0];
    if (skip[0] < -1 || (skip[0] == -1 && this->Header.Compressed))
    {
      this->Fail("HeaderSize is " + std::to_string(skip[0]) +
        "; it must be the number of bytes before the pixels, or -1 for uncompressed pixels at the "
        "end of the file");
    }
  }
}

void MetaImageHeaderReader::SortFrameFields()
{
  const auto count = static_cast<std::size_t>(this->Header.Frames);
  std::set<std::int64_t> described;
  std::set<std::int64_t> outside;
  for (const FrameField& field : this->FrameFields)
  {
    (field.Frame < this->Header.Frames ? described : outside).insert(field.Frame);
  }
  // Both checks also keep what is allocated below in proportion to the length of the header.
  if (described.size() * 2 < count)
  {
    this->Fail("DimSize says " + std::to_string(count) +
      " frames, but fields Seq_Frame... describe "
      "only " +
      std::to_string(described.size()) + " of them");
  }
  std::set<std::string> names;
  for (const FrameField& field : this->FrameFields)
  {
    names.insert(field.Name);
  }
  if (names.size() * count > 100 * this->FrameFields.size() + 1000000)
  {
    this->Fail("the frames have " + std::to_string(names.size()) +
      " different fields, nearly all of them missing in nearly all frames");
  }
  if (!outside.empty())
  {
    this->Header.Warnings.push_back("fields of frames " + std::to_string(*outside.begin()) +
      " to " + std::to_string(*outside.rbegin()) + " are ignored: DimSize says " +
      std::to_string(count) + " frames, numbered from 0");
  }
  for (FrameField& field : this->FrameFields)
  {
    if (field.Frame >= this->Header.Frames)
    {
      continue;
    }
    std::vector<std::string>& values = this->Header.FrameFields[field.Name];
    values.resize(count);
    std::string& value = values[static_cast<std::size_t>(field.Frame)];
    if (!value.empty() && value != field.Value)
    {
      this->Fail("frame " + std::to_string(field.Frame) + " has field " + field.Name +
        " twice, as '" + value + "' and as '" + field.Value + "'; remove the wrong one");
    }
    value = std::move(field.Value);
  }
}
}

SequenceHeader ReadMetaImageHeader(const std::string& fileName)
{
  return MetaImageHeaderReader(fileName).Read();
}

bool IsTrackedMetaImage(const std::string& fileName)
{
  try
  {
    HeaderLines lines(fileName);
    std::string line;
    std::string name;
    std::string value;
    std::string kinds;
    std::vector<std::string> size;
    while (lines.Next(line))
    {
      if (Trim(line).empty())
      {
        continue;
      }
      if (!SplitField(line, name, value) || EqualsIgnoringCase(name, "ElementDataFile"))
      {
        return false;
      }
      if (name == "Kinds")
      {
        kinds = ToLower(value);
      }
      else if (name == "DimSize")
      {
        for (const std::string_view word : SplitWords(value))
        {
          size.emplace_back(word);
        }
      }
      else if (IsFrameField(name))
      {
        const bool thick = size.size() > 2 && size[2] != "1";
        const bool thirdIsFrames = size.size() < 4 &&
          (kinds.empty() || kinds.find("list") != kinds.npos || kinds.find("vector") != kinds.npos);
        return !thick || thirdIsFrames;
      }
    }
  }
  catch (const std::exception&)
  {
    // Whatever it is, it is not ours.
  }
  return false;
}
}
