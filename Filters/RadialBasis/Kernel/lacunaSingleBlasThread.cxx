// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSingleBlasThread.h"

#include "lacunaMemory.h"

#include <cblas.h>

#include <cstddef>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <sys/mman.h>

// How OpenBLAS takes a buffer from its store and puts it back. It exports these for its parts, so they
// may be missing.
extern "C"
{
  __attribute__((weak)) void* blas_memory_alloc(int);
  __attribute__((weak)) void blas_memory_free(void*);
}

namespace lacuna
{
namespace
{
struct Users
{
  std::mutex Mutex;
  int Count = 0;
  int Threads = 1;
  int Buffers = 0; ///< there was room for
};

Users& GetUsers()
{
  static Users users;
  return users;
}

// Asks the system for what OpenBLAS will ask for, and gives it back.
void RequireRoom(int count)
{
  constexpr std::size_t BufferSize = 134217728 + 1048576; // and what it keeps besides
  std::vector<void*> buffers;
  for (bool room = true; room && buffers.size() < static_cast<std::size_t>(count);)
  {
    void* buffer =
      mmap(nullptr, BufferSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    room = buffer != MAP_FAILED;
    if (room)
    {
      buffers.push_back(buffer);
    }
  }
  const std::size_t found = buffers.size();
  for (void* buffer : buffers)
  {
    munmap(buffer, BufferSize);
  }
  if (found < static_cast<std::size_t>(count))
  {
    throw std::runtime_error("the buffers of OpenBLAS would need " +
      DescribeBytes(static_cast<double>(BufferSize) * count) +
      " of address space, this process may have " +
      DescribeBytes(static_cast<double>(BufferSize) * static_cast<double>(found)) +
      " (ulimit -v, -d); fewer threads (OPENBLAS_NUM_THREADS, VTK_SMP_MAX_THREADS) need less");
  }
}

// Has OpenBLAS make as many buffers, while there is room for them.
void MakeBuffers(std::vector<void*>& buffers)
{
  if (!blas_memory_alloc || !blas_memory_free)
  {
    return;
  }
  for (void*& buffer : buffers)
  {
    buffer = blas_memory_alloc(0);
  }
  for (void* buffer : buffers)
  {
    blas_memory_free(buffer);
  }
}
}

SingleBlasThread::SingleBlasThread(int callers)
{
  Users& users = GetUsers();
  const std::lock_guard<std::mutex> lock(users.Mutex);
  std::vector<void*> buffers;
  if (users.Buffers < callers)
  {
    // Its own threads, which it starts below, take one each.
    const int others = users.Buffers == 0 ? openblas_get_num_threads() - 1 : 0;
    RequireRoom(callers - users.Buffers + others);
    buffers.resize(callers);
  }
  if (users.Count++ == 0)
  {
    users.Threads = openblas_get_num_threads();
    openblas_set_num_threads(1);
  }
  if (!buffers.empty())
  {
    MakeBuffers(buffers);
    users.Buffers = callers;
  }
}

SingleBlasThread::~SingleBlasThread()
{
  Users& users = GetUsers();
  const std::lock_guard<std::mutex> lock(users.Mutex);
  if (--users.Count == 0)
  {
    openblas_set_num_threads(users.Threads);
  }
}
}
