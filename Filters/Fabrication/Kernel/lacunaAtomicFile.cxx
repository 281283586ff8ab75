// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAtomicFile.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
FileError::Kind KindOf(int error)
{
  switch (error)
  {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return FileError::Kind::NoSpace;
    case EIO:
      return FileError::Kind::Other;
    default:
      return FileError::Kind::CannotOpen;
  }
}

[[noreturn]] void Throw(const std::string& what, const std::string& path, int error)
{
  throw FileError(
    KindOf(error), what + " '" + path + "': " + std::generic_category().message(error));
}

// Returns 0 or the error. Always closes.
int WriteAndClose(int file, const std::string& content, bool sync)
{
  int error = 0;
  std::size_t done = 0;
  while (done < content.size() && error == 0)
  {
    const ssize_t part = write(file, content.data() + done, content.size() - done);
    if (part >= 0)
    {
      done += static_cast<std::size_t>(part);
    }
    else if (errno != EINTR)
    {
      error = errno;
    }
  }
  if (error == 0 && sync && fsync(file) != 0)
  {
    error = errno;
  }
  if (close(file) != 0 && error == 0)
  {
    error = errno;
  }
  return error;
}
}

//------------------------------------------------------------------------------
void WriteFileAtomically(const std::string& path, const std::string& content)
{
  namespace fs = std::filesystem;
  std::error_code code;
  std::string target = path;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, code)); ++links)
  {
    const fs::path next = fs::read_symlink(target, code);
    if (code || links == 40)
    {
      Throw("cannot write", path, code ? code.value() : ELOOP);
    }
    target = (fs::path(target).parent_path() / next).string(); // next alone if it is absolute
  }
  const fs::file_status status = fs::status(target, code);
  if (fs::is_directory(status))
  {
    Throw("cannot write", path, EISDIR);
  }
  if (fs::exists(status) && !fs::is_regular_file(status))
  {
    const int file = open(target.c_str(), O_WRONLY | O_CLOEXEC);
    const int error = file < 0 ? errno : WriteAndClose(file, content, false);
    if (error != 0)
    {
      Throw("cannot write", path, error);
    }
    return;
  }
  if (fs::exists(status) && faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
  {
    Throw("cannot overwrite", path, errno); // a rename would not ask
  }

  const std::string temporary = target + ".part" + std::to_string(getpid());
  int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST)
  {
    // Left over by a dead process of the same number.
    unlink(temporary.c_str());
    file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  if (file < 0)
  {
    Throw("cannot write", path, errno);
  }
  int error = WriteAndClose(file, content, true);
  if (error == 0 && rename(temporary.c_str(), target.c_str()) != 0)
  {
    error = errno;
  }
  if (error != 0)
  {
    unlink(temporary.c_str());
    Throw("cannot write", path, error);
  }
}
}
