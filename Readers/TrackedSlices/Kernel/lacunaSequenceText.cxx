// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceText.h"

#include "lacunaParameterText.h"
#include "lacunaPatientIdentity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <limits>

namespace lacuna
{
namespace
{
constexpr std::string_view Blanks = " \t\r\n\v\f";

char Lower(char c)
{
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string_view WithoutPlus(std::string_view word)
{
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}
}

std::string_view Trim(std::string_view text)
{
  const std::size_t first = text.find_first_not_of(Blanks);
  if (first == std::string_view::npos)
  {
    return {};
  }
  return text.substr(first, text.find_last_not_of(Blanks) - first + 1);
}

std::vector<std::string_view> SplitWords(std::string_view text)
{
  std::vector<std::string_view> words;
  std::size_t begin = text.find_first_not_of(Blanks);
  while (begin != std::string_view::npos)
  {
    const std::size_t end = std::min(text.find_first_of(Blanks, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(Blanks, end);
  }
  return words;
}

std::string ToLower(std::string_view text)
{
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), Lower);
  return lower;
}

bool EqualsIgnoringCase(std::string_view a, std::string_view b)
{
  return a.size() == b.size() &&
    std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return Lower(x) == Lower(y); });
}

bool EndsWithIgnoringCase(std::string_view text, std::string_view end)
{
  return text.size() >= end.size() &&
    EqualsIgnoringCase(text.substr(text.size() - end.size()), end);
}

bool ParseInteger(std::string_view word, std::int64_t& value)
{
  word = WithoutPlus(word);
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

bool ParseNumber(std::string_view word, double& value)
{
  word = WithoutPlus(word);
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  const std::string_view rest(result.ptr, static_cast<std::size_t>(end - result.ptr));
  if (result.ec == std::errc() && rest.size() > 1 && rest[0] == '#')
  {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (result.ec == std::errc::result_out_of_range && rest.empty())
  {
    // Tells overflow from underflow, which is harmless: 1e-400 is 0.
    value = word.find("e-") == std::string_view::npos && word.find("E-") == std::string_view::npos
      ? std::numeric_limits<double>::infinity()
      : 0.0;
    return true;
  }
  return result.ec == std::errc() && rest.empty();
}

std::string ParseMatrix(std::string_view text, Matrix4& matrix)
{
  const std::vector<std::string_view> words = SplitWords(text);
  if (words.size() != 16)
  {
    return "has " + std::to_string(words.size()) + " numbers, not 16";
  }
  for (int i = 0; i < 16; ++i)
  {
    const std::string_view word = words[static_cast<std::size_t>(i)];
    double& element = matrix(i / 4, i % 4);
    if (!ParseNumber(word, element))
    {
      return "has '" + std::string(word) + "', which is not a number";
    }
    if (!std::isfinite(element))
    {
      return "has '" + std::string(word) + "', which is not finite";
    }
  }
  return {};
}

bool IsPoseStatus(std::string_view text)
{
  static constexpr std::string_view states[] = { "OK", "MISSING", "OUT_OF_VIEW", "OUT_OF_VOLUME",
    "SWITCH1_IS_ON", "SWITCH2_IS_ON", "SWITCH3_IS_ON", "REQ_TIMEOUT", "INVALID", "PATH_NOT_FOUND",
    "UNKNOWN" };
  return std::find(std::begin(states), std::end(states), text) != std::end(states);
}

bool IdentifiesPatient(std::string_view name, const std::vector<std::string>& texts)
{
  const bool matrix = EndsWithIgnoringCase(name, "Transform");
  const bool status = EndsWithIgnoringCase(name, "TransformStatus");
  const bool transform = (matrix || status) && name.find("To", 1) != std::string_view::npos &&
    std::all_of(texts.begin(), texts.end(),
      [&](const std::string& text)
      {
        Matrix4 ignored;
        return text.empty() || (status ? IsPoseStatus(text) : ParseMatrix(text, ignored).empty());
      });
  return !transform && IdentifiesPatient(name);
}

std::string FormatMatrix(const Matrix4& matrix)
{
  std::string text;
  for (int i = 0; i < 16; ++i)
  {
    text += (i > 0 ? " " : "") + FormatNumber(matrix(i / 4, i % 4));
  }
  return text;
}

std::string JoinSome(const std::vector<std::string>& items, std::size_t most)
{
  std::string text;
  for (std::size_t i = 0; i < items.size() && i < most; ++i)
  {
    text += (i > 0 ? ", " : "") + items[i];
  }
  if (items.size() > most)
  {
    text += " and " + std::to_string(items.size() - most) + " more";
  }
  return text;
}
}
