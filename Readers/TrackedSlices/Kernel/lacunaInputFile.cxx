// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaInputFile.h"

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace lacuna
{
namespace
{
// ": reason", as far as the system tells.
std::string GetReason(int error)
{
  return error ? ": " + std::generic_category().message(error) : std::string();
}
}

//------------------------------------------------------------------------------
std::ifstream OpenForReading(const std::string& fileName, const std::string& shownName)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(fileName, error);
  if (status.type() == fs::file_type::not_found)
  {
    throw std::runtime_error(shownName + ": there is no such file");
  }
  if (fs::is_directory(status))
  {
    throw std::runtime_error(shownName + ": is not a file but a folder");
  }
  if (fs::status_known(status) && !fs::is_regular_file(status))
  {
    throw std::runtime_error(shownName + ": is not a file but a device or pipe");
  }
  errno = 0;
  std::ifstream stream(fileName, std::ios::binary);
  if (!stream)
  {
    throw std::runtime_error(shownName + ": cannot be opened for reading" + GetReason(errno));
  }
  return stream;
}

//------------------------------------------------------------------------------
std::size_t ReadBytes(
  std::ifstream& stream, void* bytes, std::size_t size, const std::string& shownName)
{
  errno = 0;
  stream.read(static_cast<char*>(bytes), static_cast<std::streamsize>(size));
  if (stream.bad())
  {
    throw std::runtime_error(shownName + ": cannot be read" + GetReason(errno));
  }
  return static_cast<std::size_t>(stream.gcount());
}
}
