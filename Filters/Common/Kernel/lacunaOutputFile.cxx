// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutputFile.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

namespace lacuna
{
static_assert(sizeof(off_t) == 8, "files over 2 GiB need 64-bit offsets");

namespace
{
// The mode of a file that has not the owner or not the group of the one with mode old: who was that is
// one of its group or of the others then.
mode_t GetMode(mode_t old, bool sameOwner, bool sameGroup)
{
  const mode_t owner = sameOwner ? 7 : (old >> 6) & 7;
  const mode_t group = (old >> 3) & owner;
  const mode_t others = old & owner & (sameGroup ? 7 : group);
  return (old & 0700) | (sameGroup ? group << 3 : 0) | others;
}
}

//------------------------------------------------------------------------------
FileError FileError::Make(const std::string& what, const std::string& path, int error)
{
  Kind kind = Kind::CannotOpen;
  if (error == ENOSPC || error == EDQUOT || error == EFBIG)
  {
    kind = Kind::NoSpace;
  }
  else if (error == EIO)
  {
    kind = Kind::Other;
  }
  return { kind, what + " '" + path + "': " + std::generic_category().message(error) };
}

//------------------------------------------------------------------------------
OutputFile::OutputFile(const std::string& path, Mode mode, const std::string& shownName)
  : Name(shownName)
{
  const int flags = O_WRONLY | O_CLOEXEC | (mode == Mode::Existing ? 0 : O_CREAT | O_EXCL);
  this->Descriptor = open(path.c_str(), flags, mode == Mode::CreatePrivate ? 0600 : 0666);
  if (this->Descriptor < 0)
  {
    this->Throw(errno);
  }
}

//------------------------------------------------------------------------------
OutputFile::OutputFile(int descriptor, const std::string& shownName)
  : Name(shownName)
  , Descriptor(descriptor)
{
}

//------------------------------------------------------------------------------
std::unique_ptr<OutputFile> OutputFile::MakeUnnamed(
  const std::string& folder, bool isPrivate, const std::string& shownName)
{
  const int descriptor =
    open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, isPrivate ? 0600 : 0666);
  if (descriptor < 0)
  {
    return nullptr;
  }
  std::unique_ptr<OutputFile> file(new OutputFile(descriptor, shownName));
  const bool canBeLinked = access(file->GetOpenName().c_str(), F_OK) == 0;
  return canBeLinked ? std::move(file) : nullptr;
}

//------------------------------------------------------------------------------
bool OutputFile::Link(const std::string& path)
{
  if (linkat(AT_FDCWD, this->GetOpenName().c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0)
  {
    return true;
  }
  if (errno != EEXIST)
  {
    this->Throw(errno);
  }
  return false;
}

//------------------------------------------------------------------------------
OutputFile::~OutputFile()
{
  if (this->Descriptor >= 0)
  {
    close(this->Descriptor);
  }
}

//------------------------------------------------------------------------------
void OutputFile::Write(const void* bytes, std::size_t size)
{
  const auto* rest = static_cast<const char*>(bytes);
  while (size > 0)
  {
    const ssize_t part = write(this->Descriptor, rest, size);
    if (part >= 0)
    {
      rest += part;
      size -= static_cast<std::size_t>(part);
    }
    else if (errno != EINTR)
    {
      this->Throw(errno);
    }
  }
}

//------------------------------------------------------------------------------
void OutputFile::WriteAt(std::int64_t offset, std::string_view bytes)
{
  this->WriteAt(offset, bytes.data(), bytes.size());
}

//------------------------------------------------------------------------------
void OutputFile::WriteAt(std::int64_t offset, const void* bytes, std::size_t size)
{
  const auto* rest = static_cast<const char*>(bytes);
  while (size > 0)
  {
    const ssize_t part = pwrite(this->Descriptor, rest, size, static_cast<off_t>(offset));
    if (part >= 0)
    {
      rest += part;
      offset += part;
      size -= static_cast<std::size_t>(part);
    }
    else if (errno != EINTR)
    {
      this->Throw(errno);
    }
  }
}

//------------------------------------------------------------------------------
void OutputFile::Truncate(std::int64_t size)
{
  if (ftruncate(this->Descriptor, static_cast<off_t>(size)) != 0)
  {
    this->Throw(errno);
  }
}

//------------------------------------------------------------------------------
void OutputFile::Sync()
{
  if (fsync(this->Descriptor) != 0)
  {
    this->Throw(errno);
  }
}

//------------------------------------------------------------------------------
void OutputFile::CheckName(const std::string& path) const
{
  struct stat named;
  struct stat open;
  if (fstat(this->Descriptor, &open) != 0)
  {
    this->Throw(errno);
  }
  if (stat(path.c_str(), &named) != 0)
  {
    if (errno == ENOENT || errno == ENOTDIR || errno == ESTALE)
    {
      throw FileLost("'" + this->Name + "' is no longer there: it was removed or renamed");
    }
    throw FileError::Make("cannot look at", this->Name, errno);
  }
  if (named.st_dev != open.st_dev || named.st_ino != open.st_ino)
  {
    throw FileLost("'" + this->Name + "' is another file now");
  }
}

//------------------------------------------------------------------------------
void OutputFile::CheckSize(std::int64_t size) const
{
  struct stat open;
  if (fstat(this->Descriptor, &open) != 0)
  {
    this->Throw(errno);
  }
  if (open.st_size < size)
  {
    throw FileLost("'" + this->Name + "' was cut off: it has " + std::to_string(open.st_size) +
      " bytes, and " + std::to_string(size) + " were written");
  }
}

//------------------------------------------------------------------------------
std::string OutputFile::GetOpenName() const
{
  return "/proc/self/fd/" + std::to_string(this->Descriptor);
}

//------------------------------------------------------------------------------
// By the descriptor, as the name may be another file's by now, in a folder where others write.
void OutputFile::TakeAccess(const std::string& from)
{
  const int file = this->Descriptor;
  struct stat old;
  struct stat made;
  if (lstat(from.c_str(), &old) != 0 || !S_ISREG(old.st_mode))
  {
    return;
  }
  constexpr const char* list = "system.posix_acl_access";
  if (fchmod(file, 0600) != 0 ||
    (fremovexattr(file, list) != 0 && errno != ENODATA && errno != ENOTSUP) || // a folder's default
    fstat(file, &made) != 0)
  {
    return;
  }
  const uid_t sameOwner = static_cast<uid_t>(-1);
  if ((old.st_uid != made.st_uid && fchown(file, old.st_uid, old.st_gid) == 0) ||
    (old.st_gid != made.st_gid && fchown(file, sameOwner, old.st_gid) == 0))
  {
    fstat(file, &made);
  }
  mode_t mode = GetMode(old.st_mode, old.st_uid == made.st_uid, old.st_gid == made.st_gid);
  std::array<char, 65536> entries;
  const ssize_t size = lgetxattr(from.c_str(), list, entries.data(), entries.size());
  if (size < 0 ? errno != ENODATA && errno != ENOTSUP
               : old.st_gid != made.st_gid ||
        fsetxattr(file, list, entries.data(), static_cast<std::size_t>(size), 0) != 0)
  {
    mode &= 0700; // others are those whom a list does not name
  }
  fchmod(file, mode);
}

//------------------------------------------------------------------------------
void OutputFile::Close()
{
  const int descriptor = this->Descriptor;
  this->Descriptor = -1;
  if (descriptor >= 0 && close(descriptor) != 0)
  {
    this->Throw(errno);
  }
}

//------------------------------------------------------------------------------
void OutputFile::Throw(int error) const
{
  throw FileError::Make("cannot write", this->Name, error);
}

//------------------------------------------------------------------------------
void SyncFolderOf(const std::string& path)
{
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int descriptor =
    open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0)
  {
    fsync(descriptor);
    close(descriptor);
  }
}
}
