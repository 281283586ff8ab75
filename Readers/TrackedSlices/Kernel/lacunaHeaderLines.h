// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads the text lines at the start of a file that goes on with binary data.
#ifndef lacunaHeaderLines_h
#define lacunaHeaderLines_h

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
class HeaderLines
{
public:
  /// Opens the file. Throws std::runtime_error when it is absent, not a file, empty or unreadable.
  explicit HeaderLines(const std::string& fileName);

  /// The next line without its end (LF or CRLF); false at the end of the file. Throws
  /// std::runtime_error when the line is not text: it holds a zero byte or is over 1 MiB long. Zeros
  /// that end the file end the text: a power cut can leave a file with its size but not its bytes.
  bool Next(std::string& line);

  /// The first bytes of the file, fewer when it is shorter. Only before the first call of Next.
  std::string_view Peek(std::size_t size) const
  {
    return { this->Buffer.data(), std::min(size, this->Filled) };
  }

  /// Whether the line that Next gave last has an end: the last line of a file that is cut off has
  /// none.
  bool IsTerminated() const { return this->Terminated; }
  /// 1-based number of the line that Next gave last.
  std::int64_t GetLineNumber() const { return this->LineNumber; }
  /// Bytes from the start of the file to the end of that line, its LF included.
  std::int64_t GetOffset() const { return this->Offset; }

  /// Throws std::runtime_error with the file's name and, when line is set, the line's number.
  [[noreturn]] void Fail(const std::string& text, bool line = true) const;

private:
  bool Fill();
  bool OnlyZerosFrom(std::size_t ahead);

  std::string FileName;
  std::ifstream Stream;
  std::vector<char> Buffer;
  std::size_t Position = 0;
  std::size_t Filled = 0;
  bool Terminated = true;
  std::int64_t LineNumber = 0;
  std::int64_t Offset = 0;
};
}
#endif
