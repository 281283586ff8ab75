// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// OpenBLAS on one thread, for results that do not depend on how many there are.
#ifndef lacunaSingleBlasThread_h
#define lacunaSingleBlasThread_h

namespace lacuna
{
/// While one of these lives, OpenBLAS's number of threads is 1 for the whole program (it divides its
/// work by that number, and sums accordingly); when the last is gone, what it was before. BLAS may
/// then be called from many threads.
///
/// OpenBLAS has a buffer of 128 MiB for each thread that calls it, made when that is first needed and
/// kept; where there is no room for one it tries again for ever. So the room is looked for here.
class SingleBlasThread
{
public:
  /// callers is the number of threads that call BLAS at the same time. Throws std::runtime_error
  /// when this process may not have their buffers.
  explicit SingleBlasThread(int callers = 1);
  ~SingleBlasThread();
  SingleBlasThread(const SingleBlasThread&) = delete;
  SingleBlasThread& operator=(const SingleBlasThread&) = delete;
};
}
#endif
