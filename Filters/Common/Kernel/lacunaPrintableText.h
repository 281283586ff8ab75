// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Text of any bytes, made fit to be shown.
#ifndef lacunaPrintableText_h
#define lacunaPrintableText_h

#include <cstddef>
#include <string>
#include <string_view>

namespace lacuna
{
/// Bytes of the valid UTF-8 sequence at the beginning of text; 0 when there is none.
std::size_t Utf8Length(std::string_view text);

/// text as UTF-8: bytes that are none, and control characters other than line feed and tab, become
/// \\x and two digits, as "\\xdc". Messages quote files and names of any bytes; terminals obey some
/// of them, and Python and JSON refuse others.
std::string ToPrintable(std::string_view text);
}
#endif
