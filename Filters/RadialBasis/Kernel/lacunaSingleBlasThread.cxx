// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSingleBlasThread.h"

#include <cblas.h>

#include <mutex>

namespace lacuna
{
namespace
{
struct Users
{
  std::mutex Mutex;
  int Count = 0;
  int Threads = 1;
};

Users& GetUsers()
{
  static Users users;
  return users;
}
}

SingleBlasThread::SingleBlasThread()
{
  Users& users = GetUsers();
  const std::lock_guard<std::mutex> lock(users.Mutex);
  if (users.Count++ == 0)
  {
    users.Threads = openblas_get_num_threads();
    openblas_set_num_threads(1);
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
