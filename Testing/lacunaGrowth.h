// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether what is made, used and deleted again and again leaves something behind.
#ifndef lacunaGrowth_h
#define lacunaGrowth_h

#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <thread>

#include <malloc.h>
#include <unistd.h>

namespace lacuna
{
/// Starts the program again with an allocator that counts what was given back as given back: by default each
/// thread of glibc keeps small blocks for itself, and more of them as sizes vary. For the beginning of main().
inline void CountExactly(char* const* argv)
{
  const char* name = "GLIBC_TUNABLES";
  if (!std::getenv(name))
  {
    setenv(name, "glibc.malloc.tcache_count=0", 1);
    execv("/proc/self/exe", argv);
  }
}

/// Bytes that the program has and not given back; 0 where the allocator does not tell (sanitizers).
inline double GetBytesInUse()
{
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

inline long CountEntries(const char* folder)
{
  const std::filesystem::directory_iterator entries(folder);
  return std::distance(begin(entries), end(entries));
}

/// The threads of this process. One that was joined stays listed until the kernel has put it away, so more
/// than expected are counted again for some seconds.
inline long CountThreads(long expected)
{
  long count = CountEntries("/proc/self/task");
  for (int i = 0; i < 500 && count > expected; ++i)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    count = CountEntries("/proc/self/task");
  }
  return count;
}

/// run(count) does it so many times, and has been called for what is made once. Gives what grows; empty
/// when nothing does. story: figures, to be read.
inline std::string FindGrowth(int cycles, const std::function<void(int)>& run, std::string& story)
{
  const long files = CountEntries("/proc/self/fd");
  const long threads = CountEntries("/proc/self/task");
  malloc_trim(0); // what was given back goes to the system
  const double resident = GetProcessMemory("VmRSS");
  // Tables of libraries grow a little now and then; what is lost in each cycle is lost in all rounds, and
  // is 32 bytes at the least.
  double grown = 0;
  int rounds = 0;
  do
  {
    const double bytes = GetBytesInUse();
    run(cycles);
    grown = GetBytesInUse() - bytes;
    ++rounds;
  } while (grown >= 32.0 * cycles && rounds < 10);
  malloc_trim(0);
  const double residentGrown = GetProcessMemory("VmRSS") - resident;
  story += "  in " + std::to_string(cycles) + " cycles, after " + std::to_string(rounds - 1) +
    " times as many, " + std::to_string(grown) + " bytes in use more; " +
    std::to_string(residentGrown) + " in memory\n";
  if (CountEntries("/proc/self/fd") > files)
  {
    return "files stay open";
  }
  if (CountThreads(threads) > threads)
  {
    return "threads stay";
  }
  if (grown >= 32.0 * cycles)
  {
    return "memory in use grows";
  }
  // sanitizers keep what was given back
  return !Sanitized && residentGrown > 16e6 ? "memory grows" : "";
}
}
#endif
