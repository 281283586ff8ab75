// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A full disk for tests.
#ifndef FileSizeLimit_h
#define FileSizeLimit_h

#include <csignal>

#include <sys/resource.h>

/// Writing beyond size fails, as on a full disk.
class FileSizeLimit
{
public:
  explicit FileSizeLimit(rlim_t size)
    : Handler(std::signal(SIGXFSZ, SIG_IGN))
  {
    getrlimit(RLIMIT_FSIZE, &this->Before);
    rlimit small = this->Before;
    small.rlim_cur = size;
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FileSizeLimit()
  {
    setrlimit(RLIMIT_FSIZE, &this->Before);
    std::signal(SIGXFSZ, this->Handler);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
  rlimit Before{};
  void (*Handler)(int);
};
#endif
