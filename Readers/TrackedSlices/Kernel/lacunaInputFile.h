// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Opening files so that it is said why they cannot be read.
#ifndef lacunaInputFile_h
#define lacunaInputFile_h

#include <cstddef>
#include <fstream>
#include <string>

namespace lacuna
{
/// Opens a file for reading bytes. Throws std::runtime_error when it is absent, a folder or
/// anything else that is not a file, or when the system refuses: the message begins with shownName
/// and ends with the reason.
std::ifstream OpenForReading(const std::string& fileName, const std::string& shownName);

/// Reads up to size bytes and returns how many there were, fewer only at the end of the file.
/// Throws std::runtime_error, with the name and the reason, when the system reports an error.
std::size_t ReadBytes(
  std::ifstream& stream, void* bytes, std::size_t size, const std::string& shownName);
}
#endif
