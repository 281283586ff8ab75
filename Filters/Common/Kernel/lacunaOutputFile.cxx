// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutputFile.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace lacuna
{
static_assert(sizeof(off_t) == 8, "files over 2 GiB need 64-bit offsets");

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
