// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomBegin.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace lacuna
{
namespace
{
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
}

//------------------------------------------------------------------------------
bool IsDicomVr(const char* letters)
{
  return IsAmong("AE AS AT CS DA DS DT FD FL IS LO LT OB OD OF OL OV OW PN SH SL SQ SS ST SV TM UC "
                 "UI UL UN UR US UT UV",
    letters);
}

//------------------------------------------------------------------------------
bool HasLongLength(const char* vr)
{
  return IsAmong("OB OD OF OL OV OW SQ SV UC UN UR UT UV", vr);
}

//------------------------------------------------------------------------------
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
}
