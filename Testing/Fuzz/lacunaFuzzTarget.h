// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the fuzz targets share: the entry point, checks that stop the run, and a file in memory for
/// readers that take a path.
#ifndef lacunaFuzzTarget_h
#define lacunaFuzzTarget_h

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

/// libFuzzer's entry point; ReplayCorpus.cxx calls it where that is not there.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lacuna_fuzz
{
/// What must hold for every input; libFuzzer keeps the input that breaks it.
inline void Require(bool condition, const char* what)
{
  if (!condition)
  {
    std::fprintf(stderr, "broken: %s\n", what);
    std::abort();
  }
}

/// A refusal is fine when it tells the user something.
inline void RequireSentence(const std::exception& error)
{
  Require(std::strlen(error.what()) > 20, "an error says what is wrong");
}

/// The next bytes of an input, zeros behind its end.
class Bytes
{
public:
  Bytes(const std::uint8_t* data, std::size_t size)
    : Data(data)
    , Size(size)
  {
  }
  std::uint8_t Take()
  {
    if (this->Size == 0)
    {
      return 0;
    }
    --this->Size;
    return *this->Data++;
  }
  double TakeDouble()
  {
    std::uint8_t bytes[sizeof(double)];
    for (std::uint8_t& byte : bytes)
    {
      byte = this->Take();
    }
    double value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  /// The rest up to a zero byte, or all of it.
  std::string TakeText()
  {
    std::string text;
    while (this->Size > 0)
    {
      const auto c = static_cast<char>(this->Take());
      if (c == 0)
      {
        break;
      }
      text += c;
    }
    return text;
  }
  std::size_t GetSize() const { return this->Size; }

private:
  const std::uint8_t* Data;
  std::size_t Size;
};

/// A file that no disk sees.
class MemoryFile
{
public:
  MemoryFile(const void* bytes, std::size_t size)
    : Descriptor(memfd_create("lacuna-fuzz", MFD_CLOEXEC))
    , Path("/proc/self/fd/" + std::to_string(this->Descriptor))
  {
    Require(
      this->Descriptor >= 0 && write(this->Descriptor, bytes, size) == static_cast<ssize_t>(size),
      "a file in memory");
  }
  ~MemoryFile() { close(this->Descriptor); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& GetPath() const { return this->Path; }

private:
  int Descriptor;
  std::string Path;
};

/// Names in one folder for files in memory, for readers that look beside a file.
class MemoryFolder
{
public:
  MemoryFolder()
  {
    char path[] = "/tmp/lacuna-fuzz-XXXXXX";
    Require(mkdtemp(path) != nullptr, "a folder");
    this->Path = path;
  }
  ~MemoryFolder()
  {
    std::error_code code;
    std::filesystem::remove_all(this->Path, code);
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;
  std::string GetPath(const std::string& name) const { return this->Path + "/" + name; }
  void Name(const std::string& name, const MemoryFile& file) const
  {
    unlink(this->GetPath(name).c_str());
    Require(symlink(file.GetPath().c_str(), this->GetPath(name).c_str()) == 0, "a name");
  }

private:
  std::string Path;
};
}
#endif
