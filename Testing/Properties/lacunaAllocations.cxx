// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAllocations.h"

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>

namespace
{
std::atomic<long> Requests{ 0 };
std::atomic<long> Granted{ LONG_MAX };
std::atomic<bool> Refused{ false };
}

namespace lacunaProperties
{
//------------------------------------------------------------------------------
long CountAllocations()
{
  return Requests.exchange(0);
}

//------------------------------------------------------------------------------
void GrantAllocations(long first)
{
  Granted = first < 0 ? LONG_MAX : first;
}

//------------------------------------------------------------------------------
bool WereAllocationsRefused()
{
  return Refused;
}
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// The program's own functions come before those of the C library, for all shared libraries, too.
// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): names of the C library
extern "C"
{
  void* __libc_malloc(std::size_t size);
  void* __libc_calloc(std::size_t count, std::size_t size);
  void* __libc_realloc(void* memory, std::size_t size);
  void* __libc_memalign(std::size_t alignment, std::size_t size);

  static bool IsGranted(std::size_t size)
  {
    if (size < lacunaProperties::LargeAllocation)
    {
      return true;
    }
    ++Requests;
    if (Granted == LONG_MAX || Granted-- > 0)
    {
      return true;
    }
    Granted = 0;
    Refused = true;
    errno = ENOMEM;
    return false;
  }

  void* malloc(std::size_t size)
  {
    return IsGranted(size) ? __libc_malloc(size) : nullptr;
  }

  void* calloc(std::size_t count, std::size_t size)
  {
    return IsGranted(count * size) ? __libc_calloc(count, size) : nullptr;
  }

  void* realloc(void* memory, std::size_t size)
  {
    return IsGranted(size) ? __libc_realloc(memory, size) : nullptr;
  }

  void* memalign(std::size_t alignment, std::size_t size)
  {
    return IsGranted(size) ? __libc_memalign(alignment, size) : nullptr;
  }

  void* aligned_alloc(std::size_t alignment, std::size_t size)
  {
    return memalign(alignment, size);
  }

  int posix_memalign(void** memory, std::size_t alignment, std::size_t size)
  {
    *memory = memalign(alignment, size);
    return *memory ? 0 : ENOMEM;
  }
}
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
#endif
