// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAtomicFile.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
// Who may do what with a file goes over to the one that takes its place, as far as the system lets us, and
// nobody may do more.
void CopyAccess(const std::string& from, const std::string& to)
{
  struct stat old;
  struct stat made;
  if (stat(from.c_str(), &old) != 0 || stat(to.c_str(), &made) != 0)
  {
    return;
  }
  // of a folder's default list
  constexpr const char* list = "system.posix_acl_access";
  if (removexattr(to.c_str(), list) != 0 && errno != ENODATA && errno != ENOTSUP)
  {
    return;
  }
  const bool owned = (old.st_uid == made.st_uid && old.st_gid == made.st_gid) ||
    chown(to.c_str(), old.st_uid, old.st_gid) == 0 ||
    chown(to.c_str(), static_cast<uid_t>(-1), old.st_gid) == 0;
  std::array<char, 65536> entries;
  const ssize_t size = getxattr(from.c_str(), list, entries.data(), entries.size());
  const bool hasList = size >= 0 || (errno != ENODATA && errno != ENOTSUP);
  // what one group might do is nothing for another one, and of a list the mode has the most of all
  const bool listed = hasList && owned && size >= 0 &&
    setxattr(to.c_str(), list, entries.data(), static_cast<std::size_t>(size), 0) == 0;
  const mode_t group = listed || (owned && !hasList) ? 0070 : 0;
  chmod(to.c_str(), old.st_mode & (0707 | group));
}
}

//------------------------------------------------------------------------------
AtomicFile::AtomicFile(const std::string& path)
  : Path(path)
  , Target(path)
{
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::file_status whole = fs::status(path, code); // before links, which lie about pipes
  if (fs::exists(whole) && !fs::is_regular_file(whole) && !fs::is_directory(whole))
  {
    this->Stream = true;
    this->File = std::make_unique<OutputFile>(path, OutputFile::Mode::Existing, path);
    return;
  }
  for (int links = 0; fs::is_symlink(fs::symlink_status(this->Target, code)); ++links)
  {
    const fs::path next = fs::read_symlink(this->Target, code);
    if (code || links == 40)
    {
      throw FileError::Make("cannot write", path, code ? code.value() : ELOOP);
    }
    this->Target =
      (fs::path(this->Target).parent_path() / next).string(); // next alone if it is absolute
  }
  const fs::file_status status = fs::status(this->Target, code);
  if (fs::is_directory(status))
  {
    throw FileError::Make("cannot write", path, EISDIR);
  }
  if (fs::exists(status) && faccessat(AT_FDCWD, this->Target.c_str(), W_OK, AT_EACCESS) != 0)
  {
    throw FileError::Make("cannot overwrite", path, errno); // a rename would not ask
  }
  const std::string temporary = this->Target + ".part" + std::to_string(getpid());
  // One may be left over by a dead process of the same number.
  unlink(temporary.c_str());
  const bool replaces = fs::exists(status);
  this->File = std::make_unique<OutputFile>(
    temporary, replaces ? OutputFile::Mode::CreatePrivate : OutputFile::Mode::CreateNew, path);
  this->Temporary = temporary;
  if (replaces)
  {
    CopyAccess(this->Target, temporary);
  }
}

//------------------------------------------------------------------------------
AtomicFile::~AtomicFile()
{
  if (!this->Temporary.empty())
  {
    unlink(this->Temporary.c_str());
  }
}

//------------------------------------------------------------------------------
void AtomicFile::Write(const void* bytes, std::size_t size)
{
  this->File->Write(bytes, size);
}

//------------------------------------------------------------------------------
void AtomicFile::WriteAt(std::int64_t offset, std::string_view bytes)
{
  this->File->WriteAt(offset, bytes);
}

//------------------------------------------------------------------------------
void AtomicFile::Finish()
{
  if (!this->File)
  {
    return;
  }
  if (!this->IsStream())
  {
    this->File->Sync();
  }
  this->File->Close();
  this->File.reset();
}

//------------------------------------------------------------------------------
void AtomicFile::Commit()
{
  this->Finish();
  if (this->IsStream())
  {
    return;
  }
  if (rename(this->Temporary.c_str(), this->Target.c_str()) != 0)
  {
    throw FileError::Make("cannot write", this->Path, errno);
  }
  this->Temporary.clear();
}

//------------------------------------------------------------------------------
void WriteFileAtomically(const std::string& path, const std::string& content)
{
  AtomicFile file(path);
  file.Write(content);
  file.Commit();
}
}
