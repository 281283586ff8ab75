// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outlines in a table: text with commas (RFC 4180) and a header, one row a point.
#ifndef lacunaOutlineTable_h
#define lacunaOutlineTable_h

#include "lacunaOutlineSet.h"

#include <string>
#include <string_view>

namespace lacuna
{
/// Whether the first line of text is a header with the columns that outlines need.
bool IsOutlineTable(std::string_view text);

/// Needed are the columns structure (name), outline (whole number), x, y, z (mm), in any order; slice
/// (whole number, empty or -1: not known) is read where it is there, others are ignored. Points are in
/// the order of the rows. The rows of an outline follow one another. Outlines are told apart by their
/// structure and number. Throws std::runtime_error naming path and line.
OutlineSet ReadOutlineTable(const std::string& path);
}
#endif
