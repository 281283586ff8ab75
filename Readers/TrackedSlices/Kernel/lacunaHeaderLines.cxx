// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHeaderLines.h"

#include "lacunaInputFile.h"

#include <algorithm>
#include <cstring>
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
}
