// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <sys/mman.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
double GetPhysicalMemory()
{
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long pageSize = sysconf(_SC_PAGESIZE);
  return pages > 0 && pageSize > 0 ? static_cast<double>(pages) * static_cast<double>(pageSize) : 0;
}
}

double GetAvailableMemory()
{
  // Linux says how much can be had without swapping; elsewhere all there is must do.
  std::ifstream file("/proc/meminfo");
  std::string name;
  for (double kibibytes = 0; file >> name >> kibibytes; file.ignore(1000, '\n'))
  {
    if (name == "MemAvailable:")
    {
      return 1024 * kibibytes;
    }
  }
  return GetPhysicalMemory();
}

void RequireMemory(const std::string& what, double bytes)
{
  const double available = GetAvailableMemory();
  if (available <= 0 || bytes <= available)
  {
    return;
  }
  constexpr double Gibibyte = 1024.0 * 1024.0 * 1024.0;
  std::ostringstream message;
  message.precision(3);
  message << what << " would need " << bytes / Gibibyte << " GiB, this machine has "
          << available / Gibibyte << " GiB of memory free";
  throw std::runtime_error(message.str());
}

void PreferLargePages(void* memory, std::size_t bytes)
{
#ifdef MADV_HUGEPAGE
  // whole large pages inside of the block: what lies next to it is not ours
  constexpr std::uintptr_t page = 2097152;
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t end = (address + bytes) / page * page;
  if (first < end)
  {
    void* pages = static_cast<char*>(memory) + (first - address);
    madvise(pages, end - first, MADV_HUGEPAGE); // a wish, may fail
  }
#else
  static_cast<void>(memory);
  static_cast<void>(bytes);
#endif
}
}
