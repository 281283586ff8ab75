// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomText.h"

#include "lacunaPrintableText.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lacuna
{
//------------------------------------------------------------------------------
std::string TrimDicomText(std::string_view text)
{
  const std::string_view blanks(" \t\r\n\0", 5);
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos)
  {
    return {};
  }
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

//------------------------------------------------------------------------------
std::vector<std::string> SplitDicomValues(std::string_view text)
{
  std::vector<std::string> values;
  if (TrimDicomText(text).empty())
  {
    return values;
  }
  for (std::size_t begin = 0; begin <= text.size();)
  {
    const std::size_t end = std::min(text.find('\\', begin), text.size());
    values.push_back(TrimDicomText(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return values;
}

//------------------------------------------------------------------------------
std::optional<std::vector<double>> ParseDicomNumbers(std::string_view text, std::size_t count)
{
  const std::vector<std::string> values = SplitDicomValues(text);
  if (values.size() != count)
  {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (const std::string& value : values)
  {
    const char* begin = value.data();
    const char* end = begin + value.size();
    if (value.size() > 1 && value[0] == '+' && value[1] != '-')
    {
      ++begin; // which from_chars does not take
    }
    double number = 0;
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || rest != end || !std::isfinite(number))
    {
      return std::nullopt;
    }
    numbers.push_back(number);
  }
  return numbers;
}

//------------------------------------------------------------------------------
std::string DicomTextToUtf8(std::string_view text, std::string_view characterSet)
{
  std::string trimmed = TrimDicomText(text);
  if (std::all_of(trimmed.begin(), trimmed.end(), [](char c) { return c >= 0x20 && c < 0x7F; }))
  {
    return trimmed; // most values of many files
  }
  const std::string set = TrimDicomText(characterSet);
  std::string result;
  for (std::size_t i = 0; i < trimmed.size();)
  {
    const auto c = static_cast<unsigned char>(trimmed[i]);
    const std::size_t length =
      set == "ISO_IR 192" || c < 0x80 ? Utf8Length(std::string_view(trimmed).substr(i)) : 0;
    if (c < 0x20 || c == 0x7F)
    {
      result += ' ';
    }
    else if (length > 0)
    {
      result.append(trimmed, i, length);
      i += length;
      continue;
    }
    else if (set == "ISO_IR 100" && c >= 0xA0)
    {
      result += static_cast<char>(0xC0 | (c >> 6));
      result += static_cast<char>(0x80 | (c & 0x3F));
    }
    else
    {
      result += '?';
    }
    ++i;
  }
  return result;
}
}
