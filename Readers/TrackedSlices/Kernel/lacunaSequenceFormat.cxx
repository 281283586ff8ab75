// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceFormat.h"

#include "lacunaHeaderReader.h"
#include "lacunaSequenceText.h"
#include "lacunaSliceOrientation.h"

#include <algorithm>
#include <climits>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace lacuna
{
namespace
{
constexpr std::size_t PaddedColumns = 40;
constexpr const char* ImageStatus = "ImageStatus";

const char* GetMetaImageType(ScalarType type)
{
  constexpr const char* names[] = { "MET_CHAR", "MET_UCHAR", "MET_SHORT", "MET_USHORT", "MET_INT",
    "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT", "MET_DOUBLE" };
  return names[static_cast<int>(type)];
}

const char* GetNrrdType(ScalarType type)
{
  constexpr const char* names[] = { "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
    "uint64", "float", "double" };
  return names[static_cast<int>(type)];
}

// The orientation that pixels have in memory, see lacunaSliceOrientation.h.
const char* GetOrientation(const SequenceDescription& description)
{
  return description.ScanLines || description.ImageType.find("RF_") == 0 ? "FM" : "MFA";
}

std::string Pad(std::string text)
{
  text.resize(std::max(text.size(), PaddedColumns), ' ');
  return text;
}

std::string GetSizes(const SequenceDescription& description, std::int64_t frames)
{
  return Pad(std::to_string(description.Columns) + " " + std::to_string(description.Rows) + " " +
    std::to_string(frames));
}

bool HasAny(const std::string& text, std::string_view characters)
{
  return text.find_first_of(characters) != std::string::npos;
}

// A line break and a backslash in the value of a key are written \n and \\.
std::string Escape(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
  }
  return escaped;
}
}

//------------------------------------------------------------------------------
SequenceKind::SequenceKind(const std::string& fileName, bool compressed)
  : Compressed(compressed)
{
  std::filesystem::path path = fileName;
  const std::string extension = ToLower(path.extension().string());
  this->Nrrd = extension == ".nrrd" || extension == ".nhdr";
  if (!this->Nrrd && extension != ".mha" && extension != ".mhd")
  {
    throw std::invalid_argument("'" + fileName +
      "' does not name a kind of sequence file; the name must end in .mha, .mhd, .nrrd or .nhdr");
  }
  if (extension == ".mhd" || extension == ".nhdr")
  {
    path.replace_extension(!compressed ? ".raw" : this->Nrrd ? ".raw.gz" : ".zraw");
    this->DataFileName = path.string();
    const std::string name = path.filename().string();
    if (HasAny(name, std::string_view("%\r\n\0", 4)) || Trim(name) != name || name[0] == '.' ||
      name.substr(0, 5) == "LIST ")
    {
      throw std::invalid_argument("the header '" + fileName + "' cannot name its pixels '" + name +
        "': a name with % or a line break, or that begins with 'LIST ', a dot or a blank, would be "
        "misread");
    }
  }
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetProblem(
  const std::string& name, const std::string& text, bool ofFrame) const
{
  if (name.empty() || Trim(name) != name ||
    HasAny(name, std::string_view(this->Nrrd ? ":\r\n\0" : "=\r\n\0", 4)))
  {
    return std::string("a field's name must have letters, and no line break, ") +
      (this->Nrrd ? "colon" : "equals sign") + " or blanks at its ends";
  }
  const bool known = this->Nrrd ? IsNrrdField(name) : IsMetaImageField(name);
  if (!ofFrame && (known || HeaderReader::IsFrameField(name) || name[0] == '#'))
  {
    return "the format gives this name a meaning of its own";
  }
  if (ofFrame && this->Nrrd && name == "Status")
  {
    return "Status is how NRRD sequences call ImageStatus";
  }
  if (HasAny(text, std::string_view(this->Nrrd ? "\r\0" : "\r\n\0", this->Nrrd ? 2 : 3)))
  {
    return "its text has a line break";
  }
  return {};
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetLine(
  const std::string& name, const std::string& text, bool custom) const
{
  return !this->Nrrd ? name + " = " + text + "\n"
    : custom         ? name + ":=" + Escape(text) + "\n"
                     : name + ": " + text + "\n";
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetCounts(
  const SequenceDescription& description, std::int64_t frames, std::int64_t compressedSize) const
{
  if (this->Nrrd)
  {
    return this->GetLine("sizes", GetSizes(description, frames), false);
  }
  // neighbours in alphabetical order, so that one stroke changes both
  return (this->Compressed
             ? this->GetLine("CompressedDataSize", Pad(std::to_string(compressedSize)), false)
             : std::string()) +
    this->GetLine("DimSize", GetSizes(description, frames), false);
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetMetaImageBeginning(const SequenceDescription& description) const
{
  return "ObjectType = Image\n"
         "NDims = 3\n"
         "AnatomicalOrientation = RAI\n"
         "BinaryData = True\n"
         "BinaryDataByteOrderMSB = False\n"
         "CenterOfRotation = 0 0 0\n"
         "CompressedData = " +
    std::string(this->Compressed ? "True\n" : "False\n") + this->GetCounts(description, 0, 0) +
    "ElementNumberOfChannels = 1\n"
    "ElementSpacing = 1 1 1\n"
    "ElementType = " +
    GetMetaImageType(description.Type) +
    "\n"
    "Kinds = domain domain list\n"
    "Offset = 0 0 0\n"
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\n"
    "UltrasoundImageOrientation = " +
    GetOrientation(description) +
    "\n"
    "UltrasoundImageType = " +
    description.ImageType + "\n";
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetNrrdBeginning(const SequenceDescription& description) const
{
  // No fields of space: PLUS needs none, and VTK's reader would count two of the three dimensions.
  return "NRRD0004\n"
         "# Complete NRRD file format specification at:\n"
         "# http://teem.sourceforge.net/nrrd/format.html\n"
         "type: " +
    std::string(GetNrrdType(description.Type)) +
    "\n"
    "dimension: 3\n" +
    this->GetCounts(description, 0, 0) +
    "kinds: domain domain list\n"
    "endian: little\n"
    "encoding: " +
    (this->Compressed ? "gzip\n" : "raw\n") +
    (this->IsDetached()
        ? "data file: " + std::filesystem::path(this->DataFileName).filename().string() + "\n"
        : "") +
    "ultrasound image orientation:=" + GetOrientation(description) +
    "\n"
    "ultrasound image type:=" +
    description.ImageType + "\n";
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetBeginning(const SequenceDescription& description) const
{
  for (const std::int64_t n : { description.Columns, description.Rows })
  {
    if (n < 1 || n > INT_MAX)
    {
      throw std::invalid_argument("slices of " + std::to_string(description.Columns) + " x " +
        std::to_string(description.Rows) + " pixels cannot be written");
    }
  }
  GetSliceFlips(GetOrientation(description), description.ImageType); // throws for unknown types
  std::string text =
    this->Nrrd ? this->GetNrrdBeginning(description) : this->GetMetaImageBeginning(description);
  for (const auto& [name, value] : description.CustomFields)
  {
    const std::string problem = this->GetProblem(name, value, false);
    if (!problem.empty())
    {
      throw std::invalid_argument("field " + name + " cannot be written: " + problem);
    }
    text += this->GetLine(name, value, true);
  }
  return text;
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetFrame(std::int64_t frame, const SequenceFields& fields) const
{
  SequenceFields sorted = fields;
  std::sort(sorted.begin(), sorted.end(),
    [](const auto& a, const auto& b)
    {
      const bool aLast = a.first == ImageStatus;
      const bool bLast = b.first == ImageStatus;
      return aLast != bLast ? bLast : a.first < b.first;
    });
  const std::string digits = std::to_string(frame);
  const std::string prefix =
    "Seq_Frame" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits + "_";
  std::string text;
  for (std::size_t i = 0; i < sorted.size(); ++i)
  {
    const auto& [name, value] = sorted[i];
    std::string problem = this->GetProblem(name, value, true);
    if (i > 0 && sorted[i - 1].first == name)
    {
      problem = "it is given twice";
    }
    if (!problem.empty())
    {
      throw std::invalid_argument(
        "field " + name + " of frame " + digits + " cannot be written: " + problem);
    }
    if (!value.empty())
    {
      text +=
        this->GetLine(prefix + (this->Nrrd && name == ImageStatus ? "Status" : name), value, true);
    }
  }
  return text;
}

//------------------------------------------------------------------------------
std::string SequenceKind::GetEnd() const
{
  if (this->Nrrd)
  {
    return this->IsDetached() ? "" : "\n";
  }
  return "ElementDataFile = " +
    (this->IsDetached() ? std::filesystem::path(this->DataFileName).filename().string() : "LOCAL") +
    "\n";
}

namespace
{
bool Exists(const std::string& path)
{
  std::error_code none;
  return std::filesystem::exists(std::filesystem::symlink_status(path, none));
}
}

//------------------------------------------------------------------------------
std::string FindFreeSweepName(const std::string& fileName, int compressionLevel)
{
  const std::filesystem::path path(fileName);
  // sweep.igs.mhd becomes sweep-2.igs.mhd
  const std::string name = path.filename().string();
  const std::size_t dot = name.find('.', 1);
  std::string candidate = fileName;
  for (int i = 2;; ++i)
  {
    if (!Exists(candidate) &&
      !Exists(SequenceKind(candidate, compressionLevel > 0).GetDataFileName()))
    {
      return candidate;
    }
    candidate =
      (path.parent_path() / (name.substr(0, dot) + "-" + std::to_string(i) + name.substr(dot)))
        .string();
  }
}
}
