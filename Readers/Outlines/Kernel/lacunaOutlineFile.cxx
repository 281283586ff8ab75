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

// Empty when the file cannot be read.
std::string ReadText(FileBytes& bytes, std::int64_t most)
{
  std::string text(static_cast<std::size_t>(std::min(bytes.GetSize(), most)), '\0');
  const auto count = static_cast<std::int64_t>(text.size());
  if (!bytes.Read(0, count, reinterpret_cast<unsigned char*>(text.data())))
  {
    return {};
  }
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
  RequireMemory(path + ": its text", static_cast<double>(bytes.GetSize()));
  std::string text = ReadText(bytes, bytes.GetSize());
  if (text.empty())
  {
    throw std::runtime_error(path + ": cannot be read to its end");
  }
  return text;
}
}
