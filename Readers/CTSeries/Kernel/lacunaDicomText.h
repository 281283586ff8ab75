// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The text values of DICOM: trimmed, split, as numbers, as UTF-8.
#ifndef lacunaDicomText_h
#define lacunaDicomText_h

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// Without blanks and zero bytes at both ends.
std::string TrimDicomText(std::string_view text);

/// The values between backslashes, trimmed; none for an empty text.
std::vector<std::string> SplitDicomValues(std::string_view text);

/// count decimal numbers (DS, IS); nothing when there are more or fewer or one is malformed or not
/// finite. The decimal mark is a point whatever the locale says.
std::optional<std::vector<double>> ParseDicomNumbers(std::string_view text, std::size_t count);

/// Text in a character set of (0008,0005) as UTF-8. ISO_IR 100 (Latin 1) and ISO_IR 192 (UTF-8) are
/// converted; bytes that cannot be are replaced by '?', control characters by blanks.
std::string DicomTextToUtf8(std::string_view text, std::string_view characterSet);
}
#endif
