// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Numbers and parameters as text that loses nothing; texts by their hashes.
#ifndef lacunaParameterText_h
#define lacunaParameterText_h

#include <string>
#include <string_view>
#include <type_traits>

namespace lacuna
{
/// The shortest text that reads as the same number, independent of the locale.
std::string FormatNumber(double value);
std::string FormatNumber(float value);

/// The 16 hexadecimal digits of its 64-bit FNV-1a hash; no protection from those who mean harm.
std::string HashText(std::string_view text);

/// A word as it is; in double quotes when it is empty or has a blank, a comma, an equals sign, a
/// quote, a backslash or a control character. Within quotes, `\"`, `\\`, `\n`, `\r` and `\t`
/// stand for these characters.
std::string QuoteWord(std::string_view word);

/// A number as FormatNumber writes it, true and false as on and off, a text (null is an empty one)
/// as QuoteWord does, a list of these with commas.
template <class T>
std::string FormatValue(const T& value)
{
  if constexpr (std::is_same_v<T, bool>)
  {
    return value ? "on" : "off";
  }
  else if constexpr (std::is_floating_point_v<T>)
  {
    return FormatNumber(value);
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    return std::to_string(value);
  }
  else if constexpr (std::is_pointer_v<T>)
  {
    return QuoteWord(value ? value : "");
  }
  else if constexpr (std::is_convertible_v<const T&, std::string_view>)
  {
    return QuoteWord(value);
  }
  else
  {
    std::string text;
    const char* separator = "";
    for (const auto& item : value)
    {
      text += separator + FormatValue(item);
      separator = ",";
    }
    return text;
  }
}

/// A line of parameters, "Name=value Name=1,2.5,3", with values as FormatValue writes them.
class ParameterText
{
public:
  template <class T>
  ParameterText& Add(std::string_view name, const T& value)
  {
    this->Text += this->Text.empty() ? "" : " ";
    this->Text += name;
    this->Text += '=' + FormatValue(value);
    return *this;
  }

  const std::string& Get() const { return this->Text; }

private:
  std::string Text;
};
}
#endif
