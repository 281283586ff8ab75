// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFileBytes.h"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::int64_t WindowSize = 8192;                  // most headers fit
constexpr std::size_t MostInflated = std::size_t(1) << 30; // two bytes can stand for 2 KiB
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
FileBytes::FileBytes(const std::string& path)
  : Path(path)
{
  this->File.rdbuf()->pubsetbuf(nullptr, 0); // the window is the buffer
  this->File.open(path, std::ios::binary);
  this->File.seekg(0, std::ios::end);
  const std::streamoff size = this->File.tellg();
  if (!this->File || size < 0)
  {
    throw std::runtime_error(path + ": cannot be read");
  }
  this->Size = size;
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
  if (fromFile == 0)
  {
    return true;
  }
  this->File.clear();
  this->File.seekg(offset);
  this->File.read(reinterpret_cast<char*>(bytes), fromFile);
  return this->File.gcount() == fromFile;
}

//------------------------------------------------------------------------------
void FileBytes::Inflate(std::int64_t first)
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
      if (done >= MostInflated)
      {
        throw std::runtime_error(this->Path + ": is deflated and holds more than 1 GiB");
      }
      bytes.resize(done + std::min(std::max(InflateStep, done / 2), MostInflated - done));
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
