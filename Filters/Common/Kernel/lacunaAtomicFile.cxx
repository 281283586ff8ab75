// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAtomicFile.h"

#include <cerrno>
#include <filesystem>
#include <random>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace lacuna
{
//------------------------------------------------------------------------------
AtomicFile::AtomicFile(const std::string& path, const std::string& companion)
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
  this->Companion = fs::canonical(companion, code).string(); // empty when it is not there
  const bool isNew = !fs::exists(status) && this->Companion.empty();
  const std::string folder = fs::path(this->Target).parent_path().string();
  this->File = OutputFile::MakeUnnamed(folder.empty() ? "." : folder, !isNew, path);
  if (!this->File)
  {
    const std::string temporary = this->MakeTemporary();
    this->File = std::make_unique<OutputFile>(
      temporary, isNew ? OutputFile::Mode::CreateNew : OutputFile::Mode::CreatePrivate, path);
    this->Temporary = temporary;
  }
}

//------------------------------------------------------------------------------
// A name beside the target that nobody can foresee.
std::string AtomicFile::MakeTemporary() const
{
  std::random_device random;
  std::ostringstream name;
  name << ".lacuna-" << std::hex << random() << random();
  return (std::filesystem::path(this->Target).parent_path() / name.str()).string();
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
    std::error_code code; // as it is now: it may have been changed meanwhile
    this->File->TakeAccess(
      std::filesystem::exists(this->Target, code) ? this->Target : this->Companion);
    this->File->Sync();
    while (this->Temporary.empty())
    {
      const std::string temporary = this->MakeTemporary();
      this->Temporary = this->File->Link(temporary) ? temporary : std::string();
    }
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
