// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaParameterText.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cstdint>
#include <cstdio>

namespace lacuna
{
namespace
{
template <class T>
std::string Shortest(T value)
{
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return { text.data(), result.ptr };
}

bool NeedsQuotes(char c)
{
  const auto code = static_cast<unsigned char>(c);
  return code <= ' ' || code == 0x7f || c == ',' || c == '=' || c == '"' || c == '\\';
}
}

std::string FormatNumber(double value)
{
  return Shortest(value);
}

std::string FormatNumber(float value)
{
  return Shortest(value);
}

std::string HashText(std::string_view text)
{
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text)
  {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  }
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016" PRIx64, hash);
  return digits;
}

std::string QuoteWord(std::string_view word)
{
  if (!word.empty() && std::none_of(word.begin(), word.end(), NeedsQuotes))
  {
    return std::string(word);
  }
  std::string text = "\"";
  for (const char c : word)
  {
    switch (c)
    {
      case '\n':
        text += "\\n";
        break;
      case '\r':
        text += "\\r";
        break;
      case '\t':
        text += "\\t";
        break;
      case '"':
      case '\\':
        text += '\\';
        [[fallthrough]];
      default:
        text += c;
    }
  }
  return text + '"';
}
}
