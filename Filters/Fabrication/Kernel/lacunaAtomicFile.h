// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Files that appear whole or not at all.
#ifndef lacunaAtomicFile_h
#define lacunaAtomicFile_h

#include <stdexcept>
#include <string>

namespace lacuna
{
/// Why a file could not be written; the text names the file.
class FileError : public std::runtime_error
{
public:
  enum class Kind
  {
    CannotOpen, ///< no such folder, read-only, is a folder
    NoSpace,    ///< the disk or the quota is full
    Other
  };
  FileError(Kind kind, const std::string& message)
    : std::runtime_error(message)
    , Reason(kind)
  {
  }
  Kind GetKind() const { return this->Reason; }

private:
  Kind Reason;
};

/// Writes content to a temporary file beside path, sees it on the disk and renames it, so that path
/// is either what it was before or the whole content, also after a crash. A symbolic link is
/// followed; a device or pipe is written to directly. Throws FileError.
void WriteFileAtomically(const std::string& path, const std::string& content);
}
#endif
