// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A system that gives no threads.
#ifndef lacunaTestNoThreads_h
#define lacunaTestNoThreads_h

#include <cstddef>

#include <pthread.h>

namespace lacunaTest
{
/// The system refuses all new threads: none has room for such a stack.
class NoThreads
{
public:
  NoThreads()
  {
    pthread_getattr_default_np(&this->Before);
    pthread_attr_t huge = this->Before;
    pthread_attr_setstacksize(&huge, std::size_t{ 1 } << 47);
    pthread_setattr_default_np(&huge);
  }
  ~NoThreads()
  {
    pthread_setattr_default_np(&this->Before);
    pthread_attr_destroy(&this->Before);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

private:
  pthread_attr_t Before{};
};
}
#endif
