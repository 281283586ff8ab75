// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDataSet.h"

#include "lacunaDicomText.h"
#include "lacunaFileBytes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
// Whether a file is DICOM, and where its first element is.

enum class DicomBegin
{
  None,     // not DICOM
  Preamble, // a preamble, DICM, then the file meta information (PS3.10, 7.1)
  Meta,     // the file meta information without preamble
  Implicit, // a bare data set, implicit VR little endian
  Explicit  // a bare data set, explicit VR little endian
};

constexpr std::int64_t PreambleSize = 132;
constexpr std::int64_t LongestIdentity = 64; // bytes of a UID or a code
constexpr unsigned int SopClass = 0x0016;
constexpr unsigned int Modality = 0x0060;

unsigned int Little(const unsigned char* bytes, int count)
{
  unsigned int number = 0;
  for (int i = 0; i < count; ++i)
  {
    number |= static_cast<unsigned int>(bytes[i]) << 8 * i;
  }
  return number;
}

template <std::size_t N>
bool IsAmong(const char (&all)[N], const char* vr)
{
  for (std::size_t i = 0; i + 2 < N; i += 3)
  {
    if (all[i] == vr[0] && all[i + 1] == vr[1])
    {
      return true;
    }
  }
  return false;
}

// Whether two letters are a value representation of DICOM.
bool IsDicomVr(const char* letters)
{
  return IsAmong("AE AS AT CS DA DS DT FD FL IS LO LT OB OD OF OL OV OW PN SH SL SQ SS ST SV TM UC "
                 "UI UL UN UR US UT UV",
    letters);
}

// Whether a value of it has a length of four bytes in explicit syntaxes.
bool HasLongLength(const char* vr)
{
  return IsAmong("OB OD OF OL OV OW SQ SV UC UN UR UT UV", vr);
}

bool IsIdentity(unsigned int element, const std::string& value)
{
  if (element == SopClass)
  {
    return value.rfind("1.2.840.10008.", 0) == 0;
  }
  const std::string code = value.substr(0, value.find_last_not_of(" \0") + 1);
  return code.size() >= 2 &&
    std::all_of(code.begin(), code.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

// Walks through group 0008 up to what only DICOM has.
bool IsBareDataSet(FileBytes& bytes, bool implicit)
{
  std::int64_t offset = 0;
  for (int last = -1; const unsigned char* head = bytes.Get(offset, 8);)
  {
    const unsigned int element = Little(head + 2, 2);
    if (Little(head, 2) != 0x0008 || static_cast<int>(element) <= last || element > Modality)
    {
      return false;
    }
    last = static_cast<int>(element);
    const char* vr = reinterpret_cast<const char*>(head) + 4;
    if (!implicit && (!IsDicomVr(vr) || HasLongLength(vr)))
    {
      return false;
    }
    const std::int64_t length = implicit ? Little(head + 4, 4) : Little(head + 6, 2);
    if (length % 2 == 1 || length > bytes.GetSize() - offset - 8)
    {
      return false;
    }
    offset += 8;
    if (element == SopClass || element == Modality)
    {
      const unsigned char* value = length <= LongestIdentity ? bytes.Get(offset, length) : nullptr;
      return value &&
        IsIdentity(element,
          std::string(reinterpret_cast<const char*>(value), static_cast<std::size_t>(length)));
    }
    offset += length;
  }
  return false;
}

//------------------------------------------------------------------------------
// A bare data set, as old scanners and networks leave it, counts as DICOM only when it begins with
// elements of group 0008 in ascending order, among them a SOP class or a modality as DICOM has it.
DicomBegin FindDicomBegin(FileBytes& bytes)
{
  const unsigned char* preamble = bytes.Get(0, PreambleSize);
  if (preamble && std::memcmp(preamble + PreambleSize - 4, "DICM", 4) == 0)
  {
    return DicomBegin::Preamble;
  }
  const unsigned char* head = bytes.Get(0, 8);
  if (head && Little(head, 2) == 0x0002 && Little(head + 2, 2) <= 0x0010 &&
    IsDicomVr(reinterpret_cast<const char*>(head) + 4))
  {
    return DicomBegin::Meta;
  }
  if (IsBareDataSet(bytes, false))
  {
    return DicomBegin::Explicit;
  }
  return IsBareDataSet(bytes, true) ? DicomBegin::Implicit : DicomBegin::None;
}

//------------------------------------------------------------------------------
constexpr std::uint32_t Undefined = 0xFFFFFFFF;
constexpr int DeepestSequence = 16;
constexpr DicomTag GroupLengthTag = 0x00020000;
constexpr DicomTag TransferSyntaxTag = 0x00020010;
constexpr DicomTag PixelTag = 0x7FE00010;
constexpr DicomTag ItemTag = 0xFFFEE000;
constexpr DicomTag ItemEndTag = 0xFFFEE00D;
constexpr DicomTag SequenceEndTag = 0xFFFEE0DD;
constexpr const char* DeflatedSyntax = "1.2.840.10008.1.2.1.99";
constexpr const char* BigEndianSyntax = "1.2.840.10008.1.2.2";
constexpr const char* ImplicitSyntax = "1.2.840.10008.1.2";
constexpr const char* ExplicitSyntax = "1.2.840.10008.1.2.1";

std::string Name(DicomTag tag)
{
  char text[16];
  std::snprintf(text, sizeof(text), "(%04X,%04X)", tag >> 16, tag & 0xFFFFU);
  return text;
}

/// What a file is that is no DICOM file, with what to do; empty when that is not known.
std::string DescribeOther(FileBytes& bytes)
{
  constexpr std::int64_t niftiMark = 344;
  const std::int64_t count = std::min<std::int64_t>(bytes.GetSize(), niftiMark + 4);
  const unsigned char* first = count > 0 ? bytes.Get(0, count) : nullptr;
  if (!first)
  {
    return {};
  }
  const std::string begin(first, first + count);
  const auto startsWith = [&](const char* mark) { return begin.rfind(mark, 0) == 0; };
  if (startsWith("\xFF\xD8\xFF") || startsWith("\x89PNG"))
  {
    return " but a picture (JPEG or PNG). Choose a file that the scanner wrote, or its folder";
  }
  const bool isNifti = begin.size() > niftiMark &&
    (begin.compare(niftiMark, 3, "n+1") == 0 || begin.compare(niftiMark, 3, "ni1") == 0);
  if (startsWith("ObjectType") || startsWith("NDims") || startsWith("NRRD0") || isNifti)
  {
    return " but MetaImage, NRRD or NIfTI: open it by Volume Reader";
  }
  return {};
}
}

/// Reads elements one after the other; no length is believed that goes beyond what holds it.
class DicomParser
{
public:
  DicomParser(const std::string& path, const DicomSelection& selection)
    : Path(path)
    , Selection(selection)
    , Bytes(path)
  {
  }

  DicomFile Parse();

private:
  struct Element
  {
    DicomTag Tag = 0;
    std::string Vr; // empty in implicit syntaxes and of items
    std::uint32_t Length = 0;
    std::int64_t Value = 0; // offset
  };

  [[noreturn]] void Fail(const std::string& what) const
  {
    throw std::runtime_error(this->Path + ": " + what);
  }
  const unsigned char* Get(std::int64_t offset, std::int64_t count, DicomTag tag)
  {
    const unsigned char* bytes = this->Bytes.Get(offset, count);
    if (!bytes)
    {
      this->Fail("is cut off near element " + Name(tag) + ", at byte " +
        std::to_string(this->Bytes.GetSize()));
    }
    return bytes;
  }
  std::uint32_t Number(const unsigned char* bytes, int count) const
  {
    std::uint32_t number = 0;
    for (int i = 0; i < count; ++i)
    {
      const int shift = 8 * (this->BigEndian ? count - 1 - i : i);
      number |= static_cast<std::uint32_t>(bytes[i]) << shift;
    }
    return number;
  }
  bool IsKnownSequence(DicomTag tag) const
  {
    const std::vector<DicomTag>& known = this->Selection.Sequences;
    return std::find(known.begin(), known.end(), tag) != known.end();
  }
  Element ReadElement(std::int64_t offset, bool implicit, DicomTag before);
  std::int64_t ReadValue(
    const Element& element, DicomDataSet& data, std::int64_t end, bool implicit, int depth);
  std::int64_t ReadDataSet(std::int64_t offset, std::int64_t end, DicomDataSet& data, bool implicit,
    int depth, Element* pixels);
  std::int64_t ReadSequence(const Element& element, std::int64_t end,
    std::vector<DicomDataSet>& items, bool implicit, int depth);
  std::int64_t SkipFragments(const Element& element, std::int64_t end);
  std::int64_t ReadMeta(DicomFile& file);
  void ReadFragments(DicomFile& file);

  std::string Path;
  const DicomSelection& Selection;
  FileBytes Bytes;
  bool BigEndian = false;
};

//------------------------------------------------------------------------------
DicomParser::Element DicomParser::ReadElement(std::int64_t offset, bool implicit, DicomTag before)
{
  Element element;
  const unsigned char* bytes = this->Get(offset, 8, before);
  element.Tag = this->Number(bytes, 2) << 16 | this->Number(bytes + 2, 2);
  if (implicit || element.Tag >> 16 == 0xFFFE)
  {
    element.Length = this->Number(bytes + 4, 4);
    element.Value = offset + 8;
    return element;
  }
  element.Vr.assign(reinterpret_cast<const char*>(bytes) + 4, 2);
  if (!std::all_of(
        element.Vr.begin(), element.Vr.end(), [](char c) { return c >= 'A' && c <= 'Z'; }))
  {
    this->Fail("element " + Name(element.Tag) + " has no valid type (VR)");
  }
  if (HasLongLength(element.Vr.c_str()))
  {
    element.Length = this->Number(this->Get(offset + 8, 4, element.Tag), 4);
    element.Value = offset + 12;
    return element;
  }
  element.Length = this->Number(bytes + 6, 2);
  element.Value = offset + 8;
  return element;
}

//------------------------------------------------------------------------------
// Returns the offset after the value.
std::int64_t DicomParser::ReadValue(
  const Element& element, DicomDataSet& data, std::int64_t end, bool implicit, int depth)
{
  const bool undefined = element.Length == Undefined;
  const bool sequence = element.Vr == "SQ" || (undefined && (implicit || element.Vr == "UN")) ||
    (element.Vr.empty() && this->IsKnownSequence(element.Tag));
  if (sequence && !undefined && !this->IsKnownSequence(element.Tag) &&
    element.Length <= end - element.Value)
  {
    return element.Value + element.Length;
  }
  if (sequence)
  {
    std::vector<DicomDataSet> items;
    // a sequence of unknown type is implicit (CP 246)
    const std::int64_t next =
      this->ReadSequence(element, end, items, implicit || element.Vr == "UN", depth + 1);
    if (this->IsKnownSequence(element.Tag) &&
      !data.Sequences.emplace(element.Tag, std::move(items)).second)
    {
      this->Fail("has sequence " + Name(element.Tag) + " twice");
    }
    return next;
  }
  if (undefined)
  {
    return this->SkipFragments(element, end);
  }
  if (element.Length > end - element.Value)
  {
    this->Fail("is cut off or damaged: element " + Name(element.Tag) + " shall have " +
      std::to_string(element.Length) + " bytes, " +
      std::to_string(std::max<std::int64_t>(0, end - element.Value)) + " are there");
  }
  if (element.Length <= this->Selection.LongestValue && (element.Tag >> 16) % 2 == 0)
  {
    const unsigned char* bytes = this->Get(element.Value, element.Length, element.Tag);
    const std::string value(
      reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(element.Length));
    const auto [known, isNew] = data.Values.emplace(element.Tag, value);
    if (!isNew && known->second != value)
    {
      this->Fail("has element " + Name(element.Tag) + " twice with different values");
    }
  }
  return element.Value + element.Length;
}

//------------------------------------------------------------------------------
// Compressed pixels in an item, such as those of an icon.
std::int64_t DicomParser::SkipFragments(const Element& element, std::int64_t end)
{
  std::int64_t offset = element.Value;
  while (offset < end)
  {
    const Element item = this->ReadElement(offset, true, element.Tag);
    if (item.Tag == SequenceEndTag)
    {
      return item.Value;
    }
    if (item.Tag != ItemTag || item.Length > end - item.Value)
    {
      break;
    }
    offset = item.Value + item.Length;
  }
  this->Fail("is cut off or damaged: element " + Name(element.Tag) + " has no end");
}

//------------------------------------------------------------------------------
// Up to end, to the end of an item, or to the pixels, when pixels is not null.
std::int64_t DicomParser::ReadDataSet(std::int64_t offset, std::int64_t end, DicomDataSet& data,
  bool implicit, int depth, Element* pixels)
{
  data.BigEndian = this->BigEndian;
  DicomTag before = 0;
  while (offset < end)
  {
    const Element element = this->ReadElement(offset, implicit, before);
    if (element.Tag == ItemEndTag && depth > 0)
    {
      return element.Value;
    }
    if (pixels && element.Tag == PixelTag)
    {
      *pixels = element;
      return element.Value;
    }
    if (element.Tag >> 16 == 0xFFFE && element.Length > 0)
    {
      // a length before it was wrong, and what follows may belong to another item
      this->Fail("has " + Name(element.Tag) + " outside of a sequence");
    }
    offset = this->ReadValue(element, data, end, implicit, depth);
    before = element.Tag;
  }
  return offset;
}

//------------------------------------------------------------------------------
std::int64_t DicomParser::ReadSequence(const Element& element, std::int64_t end,
  std::vector<DicomDataSet>& items, bool implicit, int depth)
{
  if (depth > DeepestSequence)
  {
    this->Fail("sequences within sequences at " + Name(element.Tag) + " are too deep");
  }
  const bool undefined = element.Length == Undefined;
  if (!undefined && element.Length > end - element.Value)
  {
    this->Fail("is cut off or damaged: sequence " + Name(element.Tag) + " shall have " +
      std::to_string(element.Length) + " bytes");
  }
  const std::int64_t last = undefined ? end : element.Value + element.Length;
  std::int64_t offset = element.Value;
  while (offset < last)
  {
    const Element item = this->ReadElement(offset, true, element.Tag);
    if (item.Tag == SequenceEndTag)
    {
      return item.Value;
    }
    if (item.Tag != ItemTag)
    {
      this->Fail("sequence " + Name(element.Tag) + " holds " + Name(item.Tag) +
        " where an item "
        "should begin");
    }
    const bool open = item.Length == Undefined;
    if (!open && item.Length > last - item.Value)
    {
      this->Fail("is cut off or damaged: an item of " + Name(element.Tag) + " is longer than it");
    }
    items.emplace_back();
    offset = this->ReadDataSet(
      item.Value, open ? last : item.Value + item.Length, items.back(), implicit, depth, nullptr);
  }
  if (undefined)
  {
    this->Fail("is cut off in sequence " + Name(element.Tag));
  }
  return last;
}

//------------------------------------------------------------------------------
// The file meta information, always explicit and little endian. Returns where the data begin.
std::int64_t DicomParser::ReadMeta(DicomFile& file)
{
  const DicomBegin begin = FindDicomBegin(this->Bytes);
  if (begin == DicomBegin::None)
  {
    throw NotDicomError(this->Path + ": is not a DICOM file" + DescribeOther(this->Bytes));
  }
  if (begin == DicomBegin::Implicit || begin == DicomBegin::Explicit)
  {
    file.IsBare = true;
    file.TransferSyntax = begin == DicomBegin::Implicit ? ImplicitSyntax : ExplicitSyntax;
    return 0;
  }
  DicomDataSet meta;
  std::int64_t offset = begin == DicomBegin::Preamble ? PreambleSize : 0;
  std::int64_t end = -1; // as its group length says; what follows need not be elements
  while (const unsigned char* bytes = this->Bytes.Get(offset, 4))
  {
    if (this->Number(bytes, 2) != 2 || offset == end)
    {
      break;
    }
    const Element element = this->ReadElement(offset, false, TransferSyntaxTag);
    offset = this->ReadValue(element, meta, this->Bytes.GetSize(), false, 0);
    if (element.Tag == GroupLengthTag)
    {
      end = offset + meta.GetBinary(GroupLengthTag, false).value_or(0);
    }
  }
  file.TransferSyntax = meta.GetText(TransferSyntaxTag);
  if (file.TransferSyntax.empty())
  {
    this->Fail("has no Transfer Syntax UID (0002,0010)");
  }
  return offset;
}

//------------------------------------------------------------------------------
void DicomParser::ReadFragments(DicomFile& file)
{
  std::int64_t offset = file.PixelOffset;
  bool table = true;
  while (const unsigned char* bytes = this->Bytes.Get(offset, 8))
  {
    const DicomTag tag = this->Number(bytes, 2) << 16 | this->Number(bytes + 2, 2);
    const std::int64_t length = this->Number(bytes + 4, 4);
    offset += 8;
    if (tag == SequenceEndTag)
    {
      file.FragmentsComplete = true;
      return;
    }
    if (tag != ItemTag || length > this->Bytes.GetSize() - offset)
    {
      return;
    }
    if (table)
    {
      table = false;
      const unsigned char* offsets = this->Bytes.Get(offset, length);
      for (std::int64_t i = 0; offsets && i + 4 <= length; i += 4)
      {
        file.FrameOffsets.push_back(this->Number(offsets + i, 4));
      }
    }
    else
    {
      file.Fragments.push_back({ offset, length });
    }
    offset += length;
  }
}

//------------------------------------------------------------------------------
DicomFile DicomParser::Parse()
{
  DicomFile file;
  const std::int64_t begin = this->ReadMeta(file);
  if (file.TransferSyntax == DeflatedSyntax)
  {
    this->Bytes.Inflate(begin);
    file.Inflated = this->Bytes.GetInflated();
  }
  file.State = this->Bytes.GetState();
  file.FileSize = this->Bytes.GetSize();
  this->BigEndian = file.BigEndian = file.TransferSyntax == BigEndianSyntax;
  Element pixels;
  this->ReadDataSet(
    begin, file.FileSize, file.Data, file.TransferSyntax == ImplicitSyntax, 0, &pixels);
  if (pixels.Tag == PixelTag)
  {
    file.PixelOffset = pixels.Value;
    file.PixelLength = pixels.Length == Undefined ? -1 : std::int64_t{ pixels.Length };
    if (file.PixelLength == -1)
    {
      this->ReadFragments(file);
    }
  }
  return file;
}

//------------------------------------------------------------------------------
std::string DicomDataSet::GetBytes(DicomTag tag) const
{
  const auto found = this->Values.find(tag);
  return found == this->Values.end() ? std::string() : found->second;
}

//------------------------------------------------------------------------------
std::string DicomDataSet::GetText(DicomTag tag) const
{
  return TrimDicomText(this->GetBytes(tag));
}

//------------------------------------------------------------------------------
std::optional<std::vector<double>> DicomDataSet::GetNumbers(DicomTag tag, std::size_t count) const
{
  return ParseDicomNumbers(this->GetBytes(tag), count);
}

//------------------------------------------------------------------------------
std::optional<double> DicomDataSet::GetNumber(DicomTag tag) const
{
  const auto numbers = this->GetNumbers(tag, 1);
  return numbers ? std::optional<double>((*numbers)[0]) : std::nullopt;
}

//------------------------------------------------------------------------------
std::optional<int> DicomDataSet::GetInteger(DicomTag tag) const
{
  const auto number = this->GetNumber(tag);
  if (!number || *number != std::nearbyint(*number) ||
    std::abs(*number) > std::numeric_limits<int>::max())
  {
    return std::nullopt;
  }
  return static_cast<int>(*number);
}

//------------------------------------------------------------------------------
std::optional<std::int64_t> DicomDataSet::GetBinary(DicomTag tag, bool isSigned) const
{
  const std::string bytes = this->GetBytes(tag);
  if (bytes.size() != 2 && bytes.size() != 4)
  {
    return std::nullopt;
  }
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
  {
    const std::size_t shift = 8 * (this->BigEndian ? bytes.size() - 1 - i : i);
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << shift;
  }
  if (!isSigned)
  {
    return number;
  }
  return bytes.size() == 2 ? std::int64_t{ static_cast<std::int16_t>(number) }
                           : std::int64_t{ static_cast<std::int32_t>(number) };
}

//------------------------------------------------------------------------------
const std::vector<DicomDataSet>& DicomDataSet::GetItems(DicomTag tag) const
{
  static const std::vector<DicomDataSet> none;
  const auto found = this->Sequences.find(tag);
  return found == this->Sequences.end() ? none : found->second;
}

//------------------------------------------------------------------------------
bool IsDicomFile(const std::string& path)
{
  try
  {
    FileBytes bytes(path);
    return FindDicomBegin(bytes) != DicomBegin::None;
  }
  catch (const std::exception&)
  {
    return false;
  }
}

//------------------------------------------------------------------------------
DicomFile ReadDicomFile(const std::string& path, const DicomSelection& selection)
{
  return DicomParser(path, selection).Parse();
}
}
