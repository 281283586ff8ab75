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
class SingleBlasThread
{
public:
  SingleBlasThread();
  ~SingleBlasThread();
  SingleBlasThread(const SingleBlasThread&) = delete;
  SingleBlasThread& operator=(const SingleBlasThread&) = delete;
};
}
#endif
