// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHeaderReader.h"
#include "lacunaParameterText.h"
#include "lacunaSequenceText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace lacuna
{
namespace
{
// Fields of NRRD that are interpreted here or, like the position of the image in space, do not
// apply to sequences.
const std::set<std::string> KnownFields = { "dimension", "type", "block size", "blocksize",
  "encoding", "endian", "min", "max", "old min", "oldmin", "old max", "oldmax", "data file",
  "datafile", "line skip", "lineskip", "byte skip", "byteskip", "number", "sample units",
  "sampleunits", "sizes", "spacings", "thicknesses", "axis mins", "axismins", "axis maxs",
  "axismaxs", "centers", "centerings", "labels", "units", "kinds", "space", "space dimension",
  "space units", "space origin", "space directions", "measurement frame" };

const std::set<std::string> OwnKeys = { "ultrasound image orientation", "ultrasound image type" };

const std::map<std::string, ScalarType> Types = { { "signed char", ScalarType::Int8 },
  { "int8", ScalarType::Int8 }, { "int8_t", ScalarType::Int8 }, { "uchar", ScalarType::UInt8 },
  { "unsigned char", ScalarType::UInt8 }, { "uint8", ScalarType::UInt8 },
  { "uint8_t", ScalarType::UInt8 }, { "short", ScalarType::Int16 },
  { "short int", ScalarType::Int16 }, { "signed short", ScalarType::Int16 },
  { "signed short int", ScalarType::Int16 }, { "int16", ScalarType::Int16 },
  { "int16_t", ScalarType::Int16 }, { "ushort", ScalarType::UInt16 },
  { "unsigned short", ScalarType::UInt16 }, { "unsigned short int", ScalarType::UInt16 },
  { "uint16", ScalarType::UInt16 }, { "uint16_t", ScalarType::UInt16 },
  { "int", ScalarType::Int32 }, { "signed int", ScalarType::Int32 }, { "int32", ScalarType::Int32 },
  { "int32_t", ScalarType::Int32 }, { "uint", ScalarType::UInt32 },
  { "unsigned int", ScalarType::UInt32 }, { "uint32", ScalarType::UInt32 },
  { "uint32_t", ScalarType::UInt32 }, { "longlong", ScalarType::Int64 },
  { "long long", ScalarType::Int64 }, { "long long int", ScalarType::Int64 },
  { "signed long long", ScalarType::Int64 }, { "signed long long int", ScalarType::Int64 },
  { "int64", ScalarType::Int64 }, { "int64_t", ScalarType::Int64 },
  { "ulonglong", ScalarType::UInt64 }, { "unsigned long long", ScalarType::UInt64 },
  { "unsigned long long int", ScalarType::UInt64 }, { "uint64", ScalarType::UInt64 },
  { "uint64_t", ScalarType::UInt64 }, { "float", ScalarType::Float32 },
  { "double", ScalarType::Float64 } };

struct NrrdLine
{
  enum class Kind
  {
    Comment,
    Field, ///< 'name: value'
    Pair,  ///< 'key:=value'
    Other
  };
  Kind What = Kind::Other;
  std::string Name; ///< of fields in lower case
  std::string Value;
};

// A line break and a backslash in a value are written \n and \\.
std::string Unescape(std::string_view text)
{
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const char next = text[i] == '\\' && i + 1 < text.size() ? text[i + 1] : '\0';
    if (next == '\\' || next == 'n')
    {
      plain += next == 'n' ? '\n' : '\\';
      ++i;
    }
    else
    {
      plain += text[i];
    }
  }
  return plain;
}

NrrdLine SplitLine(std::string_view text)
{
  NrrdLine line;
  const std::size_t colon = text.find(':');
  if (text[0] == '#')
  {
    line.What = NrrdLine::Kind::Comment;
  }
  else if (colon != std::string_view::npos && !Trim(text.substr(0, colon)).empty())
  {
    const bool pair = text.substr(colon, 2) == ":=";
    line.What = pair ? NrrdLine::Kind::Pair : NrrdLine::Kind::Field;
    line.Name = Trim(text.substr(0, colon));
    line.Value =
      pair ? Unescape(Trim(text.substr(colon + 2))) : std::string(Trim(text.substr(colon + 1)));
  }
  return line;
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
class NrrdHeaderReader : public HeaderReader
{
public:
  explicit NrrdHeaderReader(const std::string& fileName, bool isVolume = false)
    : HeaderReader(fileName, isVolume)
  {
  }

  SequenceHeader Read()
  {
    this->ReadLines();
    const SequenceAxes axes = this->ReadSize();
    this->SetShape(axes);
    this->FindCutOff();
    this->ReadType();
    this->ReadEncoding();
    this->SetOrientation("ultrasound image orientation", this->Find("ultrasound image orientation"),
      this->Find("ultrasound image type"));
    this->ReadSpace();
    this->ReadDataPlace();
    this->SortFrameFields();
    return std::move(this->Header);
  }

  VolumeHeader ReadVolume()
  {
    this->ReadLines();
    VolumeHeader volume;
    SequenceAxes axes = this->ReadSize();
    // without a kind, an axis that has no direction in space and comes first is of components
    const std::string* directions = this->Find("space directions");
    if (!axes.Sizes.empty() && directions && ToLower(*directions).rfind("none", 0) == 0 &&
      (axes.Kinds.empty() || axes.Kinds[0] == "???" || axes.Kinds[0] == "none"))
    {
      axes.Kinds.resize(axes.Sizes.size(), "domain");
      axes.Kinds[0] = "vector";
    }
    volume.IsNrrd = true;
    volume.Axes = axes.Sizes.size();
    volume.FirstAxis = this->SetVolumeShape(axes);
    this->ReadType();
    this->ReadEncoding();
    this->ReadDataPlace();
    volume.Slices = std::move(this->Header);
    volume.Fields = std::move(this->Fields);
    return volume;
  }

private:
  const std::string* Find(const std::string& name, const std::string& otherName = {}) const
  {
    auto found = this->Fields.find(name);
    found = found == this->Fields.end() ? this->Fields.find(otherName) : found;
    return found == this->Fields.end() ? nullptr : &found->second;
  }
  void ReadLines();
  void AddField(const NrrdLine& line);
  SequenceAxes ReadSize() const;
  void FindCutOff();
  void ReadType();
  void ReadEncoding();
  void ReadSpace();
  void ReadDataPlace();
  std::int64_t FindSkip(const std::string& name, const std::string& otherName) const;

  std::map<std::string, std::string> Fields;
  bool Ended = false; ///< by a blank line
};

//------------------------------------------------------------------------------
void NrrdHeaderReader::ReadLines()
{
  std::string text;
  this->Lines.Next(text);
  if (text.size() != 8 || text.substr(0, 7) != "NRRD000" || text[7] < '1' || text[7] > '5')
  {
    this->Lines.Fail(
      "is '" + text.substr(0, 20) + "'; an NRRD file begins with NRRD0001 to NRRD0005");
  }
  bool terminated = true;
  while (!this->Ended && this->Lines.Next(text))
  {
    terminated = this->Lines.IsTerminated();
    if (Trim(text).empty())
    {
      this->Ended = true;
      continue;
    }
    const NrrdLine line = SplitLine(text);
    if (line.What == NrrdLine::Kind::Other)
    {
      if (terminated)
      {
        this->Ignore("line " + std::to_string(this->Lines.GetLineNumber()));
      }
    }
    else if (IsFrameField(line.Name))
    {
      if (terminated) // of a line that is cut off the value may be, too
      {
        const std::string suffix = "_Status";
        const bool isStatus = line.Name.find('_', 9) + suffix.size() == line.Name.size() &&
          EndsWithIgnoringCase(line.Name, suffix);
        this->AddFrameField(isStatus
            ? line.Name.substr(0, line.Name.size() - suffix.size()) + "_ImageStatus"
            : line.Name,
          line.Value);
      }
    }
    else if (line.What != NrrdLine::Kind::Comment)
    {
      this->AddField(line);
    }
  }
  const bool detached = this->Find("data file", "datafile") != nullptr;
  if (!detached && !this->Ended)
  {
    this->Lines.Fail("is the last one, but there is no blank line before the pixels and no 'data "
                     "file' is named: the header is cut off");
  }
  this->CutOff = detached && !this->Ended && !terminated;
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::AddField(const NrrdLine& line)
{
  const std::string name = ToLower(line.Name);
  const bool ours = OwnKeys.count(name) > 0;
  const bool known = ours || (line.What == NrrdLine::Kind::Field && KnownFields.count(name) > 0);
  const std::string key = known ? name : ":=" + line.Name; // a pair is no field of its name
  const auto inserted = this->Fields.emplace(key, line.Value);
  if (!inserted.second && inserted.first->second != line.Value)
  {
    this->FailTwice(line.Name, inserted.first->second, line.Value);
  }
  if (inserted.second && !known)
  {
    this->AddCustomField(line.Name, line.Value);
  }
}

//------------------------------------------------------------------------------
SequenceAxes NrrdHeaderReader::ReadSize() const
{
  SequenceAxes axes;
  axes.SizeName = "sizes";
  axes.KindName = "kinds";
  axes.MayBeginWithColour = true;
  const std::string* sizes = this->Find("sizes");
  axes.SizeText = sizes ? *sizes : "missing";
  axes.Sizes = this->GetIntegers("sizes", sizes);
  axes.Kinds = SplitKinds(this->Find("kinds") ? *this->Find("kinds") : std::string());
  const std::vector<std::int64_t> dimension =
    this->GetIntegers("dimension", this->Find("dimension"));
  if (!dimension.empty() && dimension[0] != static_cast<std::int64_t>(axes.Sizes.size()))
  {
    this->Fail("dimension is " + std::to_string(dimension[0]) + " but sizes (" + axes.SizeText +
      ") has " + std::to_string(axes.Sizes.size()) + " numbers");
  }
  return axes;
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::FindCutOff()
{
  // A detached header has no mark at its end: it is complete when its last frame is described.
  this->CutOff = this->CutOff ||
    (this->Find("data file", "datafile") && !this->Ended &&
      (this->GetLastDescribedFrame() + 1 < this->Header.Frames || !this->IsLastFrameWhole()));
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::ReadType()
{
  const std::string* name = this->Find("type");
  const auto found = Types.find(name ? ToLower(*name) : std::string());
  if (found != Types.end())
  {
    this->Header.Type = found->second;
  }
  else if (!this->Header.PosesOnly)
  {
    this->Fail((name ? "type is '" + *name + "'" : std::string("type is missing")) +
      "; known are int8, uint8, int16, uint16, int32, uint32, int64, uint64, float, double and "
      "their C names");
  }
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::ReadEncoding()
{
  const std::string* encoding = this->Find("encoding");
  const std::string name = encoding ? ToLower(*encoding) : std::string();
  if (name == "gz" || name == "gzip")
  {
    this->Header.Encoding = PixelEncoding::Zlib;
  }
  else if (name == "hex")
  {
    this->Header.Encoding = PixelEncoding::Hex;
  }
  else if (name == "txt" || name == "text" || name == "ascii")
  {
    this->Header.Encoding = PixelEncoding::Text;
  }
  else if (name == "bz2" || name == "bzip2")
  {
    this->Fail("the pixels are compressed with bzip2, which is not read; store them with encoding "
               "gzip or raw, for example by 'unu save -e gzip -f nrrd'");
  }
  else if (name != "raw" && !this->Header.PosesOnly)
  {
    this->Fail((encoding ? "encoding is '" + *encoding + "'" : std::string("encoding is missing")) +
      "; known are raw, gzip, hex and ascii");
  }
  const std::string* endian = this->Find("endian");
  const std::string order = endian ? ToLower(*endian) : "little";
  if (order != "little" && order != "big")
  {
    this->Fail("endian is '" + *endian + "'; it must be little or big");
  }
  this->Header.BigEndian = order == "big";
  if (!endian && GetScalarSize(this->Header.Type) > 1 && !this->Header.PosesOnly &&
    this->Header.Encoding != PixelEncoding::Text)
  {
    this->Header.Warnings.emplace_back("endian is missing; taken as little");
  }
}

//------------------------------------------------------------------------------
std::int64_t NrrdHeaderReader::FindSkip(const std::string& name, const std::string& otherName) const
{
  const std::vector<std::int64_t> skip = this->GetIntegers(name, this->Find(name, otherName));
  const std::int64_t n = skip.empty() ? 0 : skip[0];
  const bool fromEnd =
    n == -1 && name == "byte skip" && this->Header.Encoding == PixelEncoding::Raw;
  if (n < 0 && !fromEnd)
  {
    this->Fail(name + " is " + std::to_string(n) + "; it must be 0 or more" +
      (name == "byte skip" ? ", or -1 for raw pixels at the end of the file" : ""));
  }
  return n;
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::ReadSpace()
{
  this->ReportPlace("space origin", this->Find("space origin"), false);
  if (const std::string* spacings = this->Find("spacings"))
  {
    const auto words = SplitWords(*spacings);
    this->SetPixelSpacing({ words.begin(), words.end() });
  }
  const std::string* directions = this->Find("space directions");
  std::vector<std::string> lengths; // of the axes, "none" where one is not of space
  std::string turns;                // the axes of unit length, which make a matrix
  for (std::size_t at = 0; directions && at < directions->size();)
  {
    const std::size_t begin = directions->find_first_not_of(" \t", at);
    if (begin == std::string::npos)
    {
      break;
    }
    const bool isVector = (*directions)[begin] == '(';
    at =
      std::min(directions->find_first_of(isVector ? ")" : " \t", begin), directions->size() - 1) +
      1;
    std::string text = directions->substr(begin, at - begin);
    if (!isVector)
    {
      lengths.emplace_back(Trim(text));
      continue;
    }
    std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    double squares = 0;
    std::vector<double> numbers;
    for (const std::string_view word : SplitWords(text))
    {
      double number = std::numeric_limits<double>::quiet_NaN();
      ParseNumber(word, number);
      numbers.push_back(number);
      squares += number * number;
    }
    const double length = std::sqrt(squares);
    lengths.push_back(FormatNumber(length));
    for (const double number : numbers)
    {
      turns += FormatNumber(number / length) + " ";
    }
  }
  if (!lengths.empty())
  {
    this->SetPixelSpacing(lengths);
    this->ReportPlace("space directions", &turns, true);
  }
}

//------------------------------------------------------------------------------
void NrrdHeaderReader::ReadDataPlace()
{
  if (const std::string* file = this->Find("data file", "datafile"))
  {
    this->SetDataFile("data file", *file);
  }
  else
  {
    this->Header.DataFileName = this->Header.FileName;
    this->Header.DataOffset = this->Lines.GetOffset();
  }
  this->Header.SkippedLines = this->FindSkip("line skip", "lineskip");
  this->Header.SkippedBytes = this->FindSkip("byte skip", "byteskip");
}
}

//------------------------------------------------------------------------------
SequenceHeader ReadNrrdHeader(const std::string& fileName)
{
  return NrrdHeaderReader(fileName).Read();
}

//------------------------------------------------------------------------------
bool IsNrrdField(const std::string& name)
{
  const std::string lower = ToLower(name);
  return KnownFields.count(lower) > 0 || OwnKeys.count(lower) > 0;
}

//------------------------------------------------------------------------------
VolumeHeader ReadNrrdVolumeHeader(const std::string& fileName)
{
  return NrrdHeaderReader(fileName, true).ReadVolume();
}

//------------------------------------------------------------------------------
ImageFileKind GetNrrdKind(HeaderLines& lines)
{
  std::string text;
  SequenceAxes axes;
  axes.MayBeginWithColour = true;
  bool tracked = false;
  // kinds may come late, or never
  while ((!tracked || axes.Kinds.empty()) && lines.Next(text) && !Trim(text).empty())
  {
    const NrrdLine line = SplitLine(text);
    const std::string name =
      line.What == NrrdLine::Kind::Field ? ToLower(line.Name) : std::string();
    if (name == "kinds")
    {
      axes.Kinds = SplitKinds(line.Value);
    }
    else if (name == "sizes")
    {
      for (const std::string_view word : SplitWords(line.Value))
      {
        axes.Sizes.push_back(0);
        ParseInteger(word, axes.Sizes.back()); // what it is not the reader will say
      }
    }
    else if (HeaderReader::IsFrameField(line.Name))
    {
      tracked = true;
    }
  }
  if (tracked && HasSlices(axes))
  {
    return ImageFileKind::Sequence;
  }
  return axes.Sizes.size() >= 3 ? ImageFileKind::Volume : ImageFileKind::Other;
}
}
