// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPrintableText.h"

namespace lacuna
{
//------------------------------------------------------------------------------
std::size_t Utf8Length(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1
    : lead >= 0xC2 && lead < 0xE0        ? 2
    : lead >= 0xE0 && lead < 0xF0        ? 3
    : lead >= 0xF0 && lead < 0xF5        ? 4
                                         : 0;
  if (length == 0 || text.size() < length)
  {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i)
  {
    if ((byte(i) & 0xC0) != 0x80)
    {
      return 0;
    }
  }
  // overlong forms, surrogates, beyond U+10FFFF
  if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
    (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F))
  {
    return 0;
  }
  return length;
}

//------------------------------------------------------------------------------
std::string ToPrintable(std::string_view text)
{
  constexpr const char* digits = "0123456789abcdef";
  std::string result;
  while (!text.empty())
  {
    const auto byte = static_cast<unsigned char>(text.front());
    const bool isControl = (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f;
    const std::size_t length = isControl ? 0 : Utf8Length(text);
    if (length == 0)
    {
      result += { '\\', 'x', digits[byte >> 4], digits[byte & 15] };
    }
    result += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}
}
