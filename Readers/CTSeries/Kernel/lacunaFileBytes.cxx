// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFileBytes.h"

#include "lacunaMemory.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <new>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr std::int64_t WindowSize = 8192; // most headers fit
constexpr std::size_t InflateStep = std::size_t(1) << 20;

// Frees zlib's state whatever happens.
struct Inflater
{
  Inflater()
  {
    if (inflateInit2(&this->Zlib, -MAX_WBITS) != Z_OK) // without zlib's wrapping: PS3.5, A.5
    {
      throw std::bad_alloc();
    }
  }
  ~Inflater() { inflateEnd(&this->Zlib); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream Zlib{};
};
}

//------------------------------------------------------------------------------
// No stream of the library: of hundreds of files, each is opened twice.
FileBytes::FileBytes(const std::string& path)
  : Path(path)
  , File(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) // nor waits for a pipe
{
  struct stat state = {};
  if (this->File < 0 || ::fstat(this->File, &state) != 0 || !S_ISREG(state.st_mode))
  {
    if (this->File >= 0)
    {
      ::close(this->File);
    }
    throw std::runtime_error(path + ": cannot be read");
  }
  this->Size = state.st_size;
  this->State = { this->Size,
    std::int64_t{ state.st_mtim.tv_sec } * 1000000000 + state.st_mtim.tv_nsec };
}

//------------------------------------------------------------------------------
FileBytes::~FileBytes()
{
  ::close(this->File);
}

//------------------------------------------------------------------------------
const unsigned char* FileBytes::Get(std::int64_t offset, std::int64_t count)
{
  if (offset < 0 || count < 0 || offset > this->Size || count > this->Size - offset)
  {
    return nullptr;
  }
  if (this->Inflated && offset >= this->Inflated->First)
  {
    return this->Inflated->Bytes.data() + (offset - this->Inflated->First);
  }
  const auto known = static_cast<std::int64_t>(this->Window.size());
  if (offset < this->First || offset + count > this->First + known)
  {
    const std::int64_t wanted = std::min(std::max(count, WindowSize), this->Size - offset);
    this->Window.resize(static_cast<std::size_t>(wanted));
    this->First = offset;
    if (!this->Read(offset, wanted, this->Window.data()))
    {
      this->Window.clear();
      return nullptr;
    }
  }
  return this->Window.data() + (offset - this->First);
}

//------------------------------------------------------------------------------
bool FileBytes::Read(std::int64_t offset, std::int64_t count, unsigned char* bytes)
{
  if (offset < 0 || count < 0 || offset > this->Size || count > this->Size - offset)
  {
    return false;
  }
  std::int64_t fromFile = count;
  if (this->Inflated)
  {
    const InflatedBytes& inflated = *this->Inflated;
    fromFile = std::clamp<std::int64_t>(inflated.First - offset, 0, count);
    std::copy_n(inflated.Bytes.data() + (offset + fromFile - inflated.First), count - fromFile,
      bytes + fromFile);
  }
  while (fromFile > 0)
  {
    const ssize_t got = ::pread(this->File, bytes, static_cast<std::size_t>(fromFile), offset);
    if (got == 0 || (got < 0 && errno != EINTR))
    {
      return false;
    }
    const std::int64_t step = std::max<std::int64_t>(0, got);
    bytes += step;
    offset += step;
    fromFile -= step;
  }
  return true;
}

//------------------------------------------------------------------------------
void FileBytes::Inflate(std::int64_t first, std::size_t most)
{
  const auto inflated = std::make_shared<InflatedBytes>();
  inflated->First = first;
  std::vector<unsigned char>& bytes = inflated->Bytes;
  Inflater inflater;
  z_stream& zlib = inflater.Zlib;
  std::size_t done = 0;
  int result = Z_OK;
  for (std::int64_t offset = first; result == Z_OK;)
  {
    if (zlib.avail_in == 0)
    {
      const std::int64_t count = std::min(WindowSize, this->Size - offset);
      zlib.next_in = const_cast<unsigned char*>(count > 0 ? this->Get(offset, count) : nullptr);
      if (!zlib.next_in)
      {
        break;
      }
      zlib.avail_in = static_cast<uInt>(count);
      offset += count;
    }
    if (done == bytes.size())
    {
      if (done >= most)
      {
        throw std::runtime_error(
          this->Path + ": is deflated and holds more than " + std::to_string(most >> 20) + " MiB");
      }
      const std::size_t size = done + std::min(std::max(InflateStep, done / 2), most - done);
      RequireMemory(this->Path + ": its data set, which is deflated,", static_cast<double>(size));
      bytes.resize(size);
    }
    zlib.next_out = bytes.data() + done;
    zlib.avail_out = static_cast<uInt>(bytes.size() - done);
    result = inflate(&zlib, Z_NO_FLUSH);
    done = bytes.size() - zlib.avail_out;
  }
  if (result == Z_MEM_ERROR)
  {
    throw std::bad_alloc();
  }
  if (result != Z_STREAM_END)
  {
    throw std::runtime_error(this->Path + ": its deflated data set is " +
      (result == Z_OK ? "cut off" : "damaged") + " after " + std::to_string(done) +
      " inflated bytes");
  }
  bytes.resize(done);
  this->SetInflated(inflated);
}

//------------------------------------------------------------------------------
void FileBytes::SetInflated(std::shared_ptr<const InflatedBytes> inflated)
{
  this->Window.clear();
  this->First = 0;
  this->Size = inflated->First + static_cast<std::int64_t>(inflated->Bytes.size());
  this->Inflated = std::move(inflated);
}
}
