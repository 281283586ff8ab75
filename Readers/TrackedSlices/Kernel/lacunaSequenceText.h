// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reading and writing the words and numbers of sequence headers. Independent of the locale, and
/// exact: a word is a number only when all of it is.
#ifndef lacunaSequenceText_h
#define lacunaSequenceText_h

#include "lacunaMatrix4.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// Without blanks, tabs and line ends on either side.
std::string_view Trim(std::string_view text);

/// The words between runs of blanks.
std::vector<std::string_view> SplitWords(std::string_view text);

/// ASCII letters in lower case, for names that are matched without regard to case.
std::string ToLower(std::string_view text);
bool EqualsIgnoringCase(std::string_view a, std::string_view b);
bool EndsWithIgnoringCase(std::string_view text, std::string_view end);

/// True when all of word is a decimal integer in range. A leading '+' is allowed.
bool ParseInteger(std::string_view word, std::int64_t& value);

/// True when all of word is a number, also with a three-digit exponent or a leading '+'. "nan",
/// "inf" and the forms of old Microsoft libraries ("-1.#IND") are numbers that are not finite.
bool ParseNumber(std::string_view word, double& value);

/// Reads 16 numbers, row by row. Returns an empty string, or what is wrong: another number of words
/// ("has 15 numbers, not 16"), a word that is no number, a number that is not finite.
std::string ParseMatrix(std::string_view text, Matrix4& matrix);

/// Whether a program that measures poses states this of one: "OK", "OUT_OF_VIEW" and the like, as PLUS
/// writes them.
bool IsPoseStatus(std::string_view text);

/// IdentifiesPatient of lacunaPatientIdentity.h, of a field with these texts. A transform of a frame with the word
/// "Patient" is kept (PatientToTrackerTransform, ...TransformStatus), if all texts that are not
/// empty are matrices of finite numbers or statuses.
bool IdentifiesPatient(std::string_view name, const std::vector<std::string>& texts);

/// 16 numbers as FormatNumber writes them, row by row.
std::string FormatMatrix(const Matrix4& matrix);

/// A list for a message: the first few items joined by ", ", then "and 12 more".
std::string JoinSome(const std::vector<std::string>& items, std::size_t most = 8);
}
#endif
