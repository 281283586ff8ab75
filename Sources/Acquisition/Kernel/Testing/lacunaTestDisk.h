// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A disk that is slow, or fails: what the program's fsync finds.
#ifndef lacunaTestDisk_h
#define lacunaTestDisk_h

#include <atomic>

namespace lacunaTest
{
/// How long the disk takes for each file, in ms.
extern std::atomic<int> DiskDelay;
/// How many times more it fails with EIO. Then, as with Linux, what pixels were written since it worked is
/// gone (zeros), and the next time it works.
extern std::atomic<int> DiskFailures;
}
#endif
