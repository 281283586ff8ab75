// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Files that appear whole or not at all.
#ifndef lacunaAtomicFile_h
#define lacunaAtomicFile_h

#include "lacunaOutputFile.h"

#include <memory>
#include <string>
#include <string_view>

namespace lacuna
{
/// A file that takes its name when it is complete: it is written without a name, seen on the disk,
/// named at random beside its place and renamed, so that path is either what it was before or the
/// whole new content, also after a crash, which leaves nothing else. Where the disk has no files
/// without a name it has the random one from the beginning, and a crash leaves it. A file that is there before passes on its permissions, access list
/// and, where the system allows it, owner and group (OutputFile::TakeAccess). A symbolic link is
/// followed; a device or pipe is written to directly. All functions throw FileError.
class AtomicFile
{
public:
  /// Where there is no path before, companion passes on who may do what: another file of the same
  /// data. Without it, or where it is not there, either, the umask decides.
  explicit AtomicFile(const std::string& path, const std::string& companion = {});
  /// Throws away what was written unless Commit came before.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(const void* bytes, std::size_t size);
  void Write(std::string_view text) { this->Write(text.data(), text.size()); }
  /// Writes over what is at offset already. Not for devices and pipes.
  void WriteAt(std::int64_t offset, std::string_view bytes);
  /// Whether path is a device or a pipe, where WriteAt cannot be used.
  bool IsStream() const { return this->Stream; }
  /// Puts the content on the disk under its temporary name, so that little is left to fail.
  void Finish();
  /// Finishes, and gives the file its name.
  void Commit();

private:
  std::string MakeTemporary() const;

  std::string Path;      ///< as the caller knows it
  std::string Target;    ///< the file itself, links followed
  std::string Companion; ///< links followed; empty: none
  std::string Temporary; ///< empty when there is nothing to remove
  bool Stream = false;
  std::unique_ptr<OutputFile> File;
};

/// Writes content as an AtomicFile.
void WriteFileAtomically(const std::string& path, const std::string& content);
}
#endif
