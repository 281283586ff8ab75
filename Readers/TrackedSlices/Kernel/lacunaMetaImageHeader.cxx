// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHeaderReader.h"
#include "lacunaSequenceText.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <system_error>

namespace lacuna
{
namespace
{
// Fields of MetaImage and of tracked sequences that are interpreted here or, like the position of
// the image in space, do not apply to sequences, which is told.
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

// MetaImage's own library separates names and values by a colon, too; names of frame fields may have one.
bool SplitField(
  std::string_view line, std::string& name, std::string& value, const char* separators = "=")
{
  const std::size_t equals = line.find_first_of(separators);
  if (equals == std::string_view::npos)
  {
    return false;
  }
  name = Trim(line.substr(0, equals));
  value = Trim(line.substr(equals + 1));
  return !name.empty();
}

std::vector<std::string> SplitKinds(const std::string& text)
{
  std::vector<std::string> kinds;
  for (const std::string_view kind : SplitWords(text))
  {
    kinds.push_back(ToLower(kind));
  }
  return kinds;
}

//------------------------------------------------------------------------------
class MetaImageHeaderReader : public HeaderReader
{
public:
  explicit MetaImageHeaderReader(const std::string& fileName, bool isVolume = false)
    : HeaderReader(fileName, isVolume)
  {
  }

  SequenceHeader Read()
  {
    this->ReadLines();
    this->SetShape(this->ReadSize());
    this->ReadType();
    this->SetOrientation("UltrasoundImageOrientation", this->Find("UltrasoundImageOrientation"),
      this->Find("UltrasoundImageType"));
    this->ReadSpace();
    this->ReadDataPlace();
    this->SortFrameFields();
    return std::move(this->Header);
  }

  VolumeHeader ReadVolume()
  {
    this->ReadLines();
    VolumeHeader volume;
    const SequenceAxes axes = this->ReadSize();
    volume.Axes = axes.Sizes.size();
    volume.FirstAxis = this->SetVolumeShape(axes);
    this->ReadType();
    this->ReadDataPlace();
    volume.Slices = std::move(this->Header);
    volume.Fields = std::move(this->Fields);
    return volume;
  }

private:
  const std::string* Find(const std::string& name) const
  {
    const auto found = this->Fields.find(name);
    return found == this->Fields.end() ? nullptr : &found->second;
  }
  std::vector<std::int64_t> FindIntegers(const std::string& name) const
  {
    return this->GetIntegers(name, this->Find(name));
  }
  bool FindBool(const std::string& name, bool otherwise) const;
  void ReadLines();
  void AddField(const std::string& name, const std::string& value);
  bool FindDataOfCutOffHeader();
  SequenceAxes ReadSize() const;
  void ReadType();
  void ReadSpace();
  void ReadDataPlace();
  void MoveDataPlace(std::int64_t headerSize);

  std::map<std::string, std::string> Fields;
  std::string DataFile;
};

//------------------------------------------------------------------------------
bool MetaImageHeaderReader::FindBool(const std::string& name, bool otherwise) const
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

//------------------------------------------------------------------------------
void MetaImageHeaderReader::ReadLines()
{
  std::string line;
  std::string name;
  std::string value;
  while (this->DataFile.empty())
  {
    if (!this->Lines.Next(line))
    {
      if (!this->Header.IsVolume && this->FindDataOfCutOffHeader())
      {
        return;
      }
      this->Lines.Fail("is the last one, but no ElementDataFile came before it: the header is cut "
                       "off, or the file is not a MetaImage");
    }
    if (Trim(line).empty())
    {
      continue;
    }
    const bool isField = SplitField(line, name, value, this->Header.IsVolume ? "=:" : "=");
    const bool isDataFile = isField && EqualsIgnoringCase(name, "ElementDataFile");
    if (!this->Lines.IsTerminated() && (!isDataFile || !EqualsIgnoringCase(value, "LOCAL")))
    {
      // Of a line that is cut off the value may be, too.
      if (isDataFile &&
        std::filesystem::exists(std::filesystem::path(this->Header.FileName).parent_path() / value))
      {
        this->DataFile = value;
      }
      continue;
    }
    if (!isField)
    {
      if (this->Fields.empty())
      {
        this->Lines.Fail("is not of the form 'Name = Value': the file is not a MetaImage");
      }
      this->Ignore("line " + std::to_string(this->Lines.GetLineNumber()));
    }
    else if (isDataFile)
    {
      if (value.empty())
      {
        this->Lines.Fail("has an ElementDataFile without a value; it must be LOCAL or a file name");
      }
      this->DataFile = value;
    }
    else if (IsFrameField(name))
    {
      this->AddFrameField(name, value);
    }
    else
    {
      this->AddField(name, value);
    }
  }
}

//------------------------------------------------------------------------------
void MetaImageHeaderReader::AddField(const std::string& givenName, const std::string& value)
{
  std::string name = givenName;
  if (this->Header.IsVolume) // no other spelling hides where a volume lies
  {
    const auto known = std::find_if(KnownFields.begin(), KnownFields.end(),
      [&](const std::string& field) { return EqualsIgnoringCase(field, name); });
    name = known == KnownFields.end() ? name : *known;
  }
  const auto inserted = this->Fields.emplace(name, value);
  if (!inserted.second && inserted.first->second != value)
  {
    this->FailTwice(name, inserted.first->second, value);
  }
  if (inserted.second && KnownFields.count(name) == 0)
  {
    this->AddCustomField(name, value);
  }
}

//------------------------------------------------------------------------------
// The name of the pixels' file ends the header. Where that end is missing, pixels in a file of the
// header's own name are its pixels.
bool MetaImageHeaderReader::FindDataOfCutOffHeader()
{
  std::filesystem::path name = this->Header.FileName;
  if (this->Fields.empty() || !EqualsIgnoringCase(name.extension().string(), ".mhd"))
  {
    return false;
  }
  name.replace_extension(this->FindBool("CompressedData", false) ? ".zraw" : ".raw");
  if (!std::filesystem::exists(name))
  {
    return false;
  }
  this->CutOff = true;
  this->DataFile = name.filename().string();
  return true;
}

//------------------------------------------------------------------------------
SequenceAxes MetaImageHeaderReader::ReadSize() const
{
  SequenceAxes axes;
  const std::string* size = this->Find("DimSize");
  axes.SizeText = size ? *size : "missing";
  axes.Sizes = this->FindIntegers("DimSize");
  axes.Kinds = SplitKinds(this->Find("Kinds") ? *this->Find("Kinds") : std::string());
  const std::vector<std::int64_t> channels = this->FindIntegers("ElementNumberOfChannels");
  if (!channels.empty())
  {
    axes.Channels = channels[0];
    if (channels[0] < 1)
    {
      this->Fail("pixels have " + std::to_string(channels[0]) + " components");
    }
  }
  const std::vector<std::int64_t> dimensions = this->FindIntegers("NDims");
  const auto listed = static_cast<std::int64_t>(axes.Sizes.size());
  const bool mayListColours = listed > 0 &&
    ((!axes.Kinds.empty() && axes.Kinds[0] == "vector") ||
      (axes.Channels > 1 && axes.Channels == axes.Sizes[0]));
  if (!dimensions.empty() && dimensions[0] != listed &&
    !(mayListColours && dimensions[0] == listed - 1))
  {
    this->Fail("NDims is " + std::to_string(dimensions[0]) + " but DimSize (" + axes.SizeText +
      ") has " + std::to_string(listed) + " numbers");
  }
  return axes;
}

//------------------------------------------------------------------------------
void MetaImageHeaderReader::ReadType()
{
  const std::string* name = this->Find("ElementType");
  const auto found = std::find_if(std::begin(Types), std::end(Types),
    [&](const Type& type) { return name && *name == type.Name; });
  if (found != std::end(Types))
  {
    this->Header.Type = found->Value;
    this->Header.TypeIsLong = found->IsLong;
  }
  else if (!this->Header.PosesOnly)
  {
    std::vector<std::string> known;
    std::transform(std::begin(Types), std::end(Types), std::back_inserter(known),
      [](const Type& type) { return type.Name; });
    this->Fail((name ? "ElementType is '" + *name + "'" : std::string("ElementType is missing")) +
      "; known are " + JoinSome(known, known.size()));
  }
  this->Header.BigEndian =
    this->FindBool("BinaryDataByteOrderMSB", this->FindBool("ElementByteOrderMSB", false));
}

//------------------------------------------------------------------------------
void MetaImageHeaderReader::ReadSpace()
{
  const std::string* spacing = this->Find("ElementSpacing");
  spacing = spacing ? spacing : this->Find("ElementSize");
  const auto words = SplitWords(spacing ? std::string_view(*spacing) : std::string_view());
  this->SetPixelSpacing({ words.begin(), words.end() });
  for (const char* name : { "Offset", "Position", "Origin" })
  {
    this->ReportPlace(name, this->Find(name), false);
  }
  for (const char* name : { "TransformMatrix", "Orientation", "Rotation" })
  {
    this->ReportPlace(name, this->Find(name), true);
  }
}

//------------------------------------------------------------------------------
void MetaImageHeaderReader::ReadDataPlace()
{
  if (this->FindBool("CompressedData", false))
  {
    this->Header.Encoding = PixelEncoding::Zlib;
  }
  else if (!this->FindBool("BinaryData", true))
  {
    this->Header.Encoding = PixelEncoding::Text;
    this->Header.TypeIsLong = false; // bytes do not count
  }
  const std::vector<std::int64_t> compressedSize = this->FindIntegers("CompressedDataSize");
  if (!compressedSize.empty() && compressedSize[0] > 0)
  {
    this->Header.CompressedDataSize = compressedSize[0];
  }
  if (EqualsIgnoringCase(this->DataFile, "LOCAL"))
  {
    this->Header.DataFileName = this->Header.FileName;
    this->Header.DataOffset = this->Lines.GetOffset();
  }
  else
  {
    this->SetDataFile("ElementDataFile", this->DataFile);
  }
  const std::vector<std::int64_t> skip = this->FindIntegers("HeaderSize");
  if (!skip.empty() && skip[0] != 0)
  {
    this->MoveDataPlace(skip[0]);
  }
}

//------------------------------------------------------------------------------
// HeaderSize is the number of bytes before the pixels in their file, -1: they are its last bytes.
void MetaImageHeaderReader::MoveDataPlace(std::int64_t headerSize)
{
  std::int64_t& offset = this->Header.DataOffset;
  const std::string given = "HeaderSize is " + std::to_string(headerSize);
  if (headerSize == -1 && this->Header.Encoding == PixelEncoding::Raw)
  {
    this->Header.SkippedBytes = -1;
  }
  else if (headerSize == -1 && this->Header.Encoding == PixelEncoding::Zlib &&
    this->Header.CompressedDataSize > 0)
  {
    std::error_code error; // that there is no such file is said when it is opened
    const auto size =
      static_cast<std::int64_t>(std::filesystem::file_size(this->Header.DataFileName, error));
    if (!error && size - offset < this->Header.CompressedDataSize)
    {
      this->Fail(given + ": the pixels are the last " +
        std::to_string(this->Header.CompressedDataSize) + " bytes (CompressedDataSize) of '" +
        this->Header.DataFileName + "', but there are only " + std::to_string(size - offset));
    }
    offset = error ? offset : size - this->Header.CompressedDataSize;
  }
  else if (headerSize < 0)
  {
    this->Fail(given +
      "; it must be the number of bytes before the pixels, or -1 for pixels at the end of the "
      "file that are uncompressed or have a CompressedDataSize");
  }
  else if (headerSize < offset)
  {
    this->Fail(given + ", but the header itself, which ends with ElementDataFile = LOCAL, has " +
      std::to_string(offset) + " bytes");
  }
  else
  {
    offset = headerSize;
  }
}
}

//------------------------------------------------------------------------------
SequenceHeader ReadMetaImageHeader(const std::string& fileName)
{
  return MetaImageHeaderReader(fileName).Read();
}

//------------------------------------------------------------------------------
bool IsMetaImageField(const std::string& name)
{
  return KnownFields.count(name) > 0 || EqualsIgnoringCase(name, "ElementDataFile");
}

//------------------------------------------------------------------------------
VolumeHeader ReadMetaImageVolumeHeader(const std::string& fileName)
{
  return MetaImageHeaderReader(fileName, true).ReadVolume();
}

//------------------------------------------------------------------------------
ImageFileKind GetMetaImageKind(HeaderLines& lines)
{
  std::string line;
  std::string name;
  std::string value;
  SequenceAxes axes;
  bool tracked = false;
  bool whole = false;
  while ((!tracked || axes.Kinds.empty()) && lines.Next(line)) // kinds may come late, or never
  {
    if (Trim(line).empty())
    {
      continue;
    }
    const bool isField = SplitField(line, name, value, tracked ? "=" : "=:");
    whole = isField && EqualsIgnoringCase(name, "ElementDataFile");
    if (!isField || whole)
    {
      break;
    }
    if (name == "Kinds")
    {
      axes.Kinds = SplitKinds(value);
    }
    else if (name == "ElementNumberOfChannels" && !ParseInteger(value, axes.Channels))
    {
      axes.Channels = 0;
    }
    else if (name == "DimSize")
    {
      for (const std::string_view word : SplitWords(value))
      {
        axes.Sizes.push_back(0);
        ParseInteger(word, axes.Sizes.back()); // what it is not the reader will say
      }
    }
    else if (HeaderReader::IsFrameField(name))
    {
      tracked = true;
    }
  }
  if (tracked && HasSlices(axes))
  {
    return ImageFileKind::Sequence;
  }
  return (tracked || whole) && axes.Sizes.size() >= 3 ? ImageFileKind::Volume
                                                      : ImageFileKind::Other;
}
}
