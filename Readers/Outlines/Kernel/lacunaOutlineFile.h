// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which kind of file of outlines a file is, by its content.
#ifndef lacunaOutlineFile_h
#define lacunaOutlineFile_h

#include <string>

namespace lacuna
{
enum class OutlineFileKind
{
  Markups, ///< begins as JSON
  Dicom,   ///< DICOM, whatever is in it
  Table    ///< anything else
};

/// Throws std::runtime_error naming the file when it cannot be read or is empty.
OutlineFileKind GetOutlineFileKind(const std::string& path);

/// Whether a file has outlines: a DICOM RT structure set, JSON with "markups" near its beginning, or a
/// table whose header has the columns of outlines. Reads the beginning, of DICOM the headers. Throws
/// nothing.
bool IsOutlineFile(const std::string& path);

/// A whole file as text, without a byte order mark. Throws std::runtime_error naming the file when it
/// cannot be read or when memory does not suffice for it.
std::string ReadOutlineText(const std::string& path);
}
#endif
