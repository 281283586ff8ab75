// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFileBytes.h"

#include <algorithm>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::int64_t WindowSize = 32768; // most headers fit
}

//------------------------------------------------------------------------------
FileBytes::FileBytes(const std::string& path)
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
  this->File.clear();
  this->File.seekg(offset);
  this->File.read(reinterpret_cast<char*>(bytes), count);
  return this->File.gcount() == count;
}
}
