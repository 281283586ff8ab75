// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutlineFile.h"

#include "lacunaDicomDataSet.h"
#include "lacunaFileBytes.h"
#include "lacunaMemory.h"
#include "lacunaOutlineTable.h"
#include "lacunaStructureSet.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr std::int64_t Beginning = 65536; // bytes that are looked at
constexpr std::string_view ByteOrderMark = "\xEF\xBB\xBF";

std::string ReadText(FileBytes& bytes, std::int64_t most)
{
  const std::int64_t count = std::min(bytes.GetSize(), most);
  const unsigned char* data = bytes.Get(0, count);
  if (!data)
  {
    return {};
  }
  std::string text(reinterpret_cast<const char*>(data), static_cast<std::size_t>(count));
  if (text.compare(0, ByteOrderMark.size(), ByteOrderMark) == 0)
  {
    text.erase(0, ByteOrderMark.size());
  }
  return text;
}

bool IsJson(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && (text[first] == '{' || text[first] == '[');
}
}

//------------------------------------------------------------------------------
OutlineFileKind GetOutlineFileKind(const std::string& path)
{
  FileBytes bytes(path);
  if (bytes.GetSize() == 0)
  {
    throw std::runtime_error(path + ": is empty; save the outlines again");
  }
  if (IsDicomFile(path))
  {
    return OutlineFileKind::Dicom;
  }
  return IsJson(ReadText(bytes, Beginning)) ? OutlineFileKind::Markups : OutlineFileKind::Table;
}

//------------------------------------------------------------------------------
bool IsOutlineFile(const std::string& path)
{
  try
  {
    const OutlineFileKind kind = GetOutlineFileKind(path);
    if (kind == OutlineFileKind::Dicom)
    {
      return IsStructureSet(path);
    }
    FileBytes bytes(path);
    const std::string text = ReadText(bytes, Beginning);
    return kind == OutlineFileKind::Markups ? text.find("\"markups\"") != std::string::npos
                                            : IsOutlineTable(text);
  }
  catch (const std::exception&)
  {
    return false;
  }
}

//------------------------------------------------------------------------------
std::string ReadOutlineText(const std::string& path)
{
  FileBytes bytes(path);
  // twice: as it is read, and as it is kept
  RequireMemory(path + ": its text", 2 * static_cast<double>(bytes.GetSize()));
  std::string text = ReadText(bytes, bytes.GetSize());
  if (text.empty())
  {
    throw std::runtime_error(path + ": cannot be read to its end");
  }
  return text;
}
}
