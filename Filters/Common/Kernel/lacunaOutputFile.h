// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writing files so that nothing goes wrong in silence.
#ifndef lacunaOutputFile_h
#define lacunaOutputFile_h

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

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

  /// The error with the system's number error: "<what> '<path>': No space left on device".
  static FileError Make(const std::string& what, const std::string& path, int error);

private:
  Kind Reason;
};

/// A file is no longer what was written: its name is gone or another file's, or it was cut off.
class FileLost : public FileError
{
public:
  explicit FileLost(const std::string& message)
    : FileError(Kind::Other, message)
  {
  }
};

/// A file open for writing, without a buffer: what a function has written has left the program, so
/// that the program's end, however sudden, does not lose it. Offsets are 64 bits wide. All
/// functions throw FileError, with the name that errors shall show.
class OutputFile
{
public:
  enum class Mode
  {
    CreateNew,     ///< an error when the file exists
    CreatePrivate, ///< the same, for nobody else to read
    Existing       ///< a device, pipe or file that is there; not truncated
  };
  OutputFile(const std::string& path, Mode mode, const std::string& shownName);
  /// A new file in folder that has no name before Link: whatever ends the program, nothing is left
  /// of it. isPrivate: for nobody else to read. Null where the system or the disk has no such files.
  static std::unique_ptr<OutputFile> MakeUnnamed(
    const std::string& folder, bool isPrivate, const std::string& shownName);
  /// Closes, without a word about errors.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Writes at the current place and moves it on.
  void Write(const void* bytes, std::size_t size);
  /// Writes at offset; the current place stays. Not for pipes.
  void WriteAt(std::int64_t offset, std::string_view bytes);
  void WriteAt(std::int64_t offset, const void* bytes, std::size_t size);
  /// Cuts the file off at size.
  void Truncate(std::int64_t size);
  /// Waits until the disk has it all.
  void Sync();
  /// Throws FileLost when path does not name this file, or the file has fewer than size bytes.
  void CheckName(const std::string& path) const;
  void CheckSize(std::int64_t size) const;
  /// A name by which this process can read the file, also when it has no other.
  std::string GetOpenName() const;
  /// Gives the file the permissions, access list and, where the system allows it, owner and group of
  /// another one, which it is to replace; a link is none. What cannot be given is nobody's: not one
  /// user may do more than with the other file.
  void TakeAccess(const std::string& from);
  /// Names an unnamed file. False when there is another one of that name.
  bool Link(const std::string& path);
  /// Closes; the last chance for an error.
  void Close();

private:
  OutputFile(int descriptor, const std::string& shownName);
  [[noreturn]] void Throw(int error) const;

  std::string Name;
  int Descriptor = -1;
};

/// Waits until the disk has the names of new files in the folder of path: without them a failure of
/// the power takes the files, however synced. File systems that cannot do it are left alone.
void SyncFolderOf(const std::string& path);
}
#endif
