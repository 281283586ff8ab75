// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include "lacunaControlGroup.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr double Unlimited = std::numeric_limits<double>::infinity();

// What ulimit -v allows this process in all.
double GetAddressSpace()
{
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY
    ? Unlimited
    : static_cast<double>(limit.rlim_cur);
}

// What is left of that.
double GetFreeAddressSpace()
{
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(0.0, GetAddressSpace() - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

double GetMachine()
{
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// What Linux says can be had without swapping.
double GetFreeMachine()
{
  std::ifstream file("/proc/meminfo");
  std::string name;
  for (double kibibytes = 0; file >> name >> kibibytes; file.ignore(1000, '\n'))
  {
    if (name == "MemAvailable:")
    {
      return 1024 * kibibytes;
    }
  }
  return Unlimited;
}
}

double GetPhysicalMemory()
{
  return std::min({ GetMachine(), ReadControlGroupMemory().Limit, GetAddressSpace() });
}

double GetAvailableMemory()
{
  return std::min(
    { GetMachine(), GetFreeMachine(), ReadControlGroupMemory().Free, GetFreeAddressSpace() });
}

std::string DescribeBytes(double bytes)
{
  constexpr double Gibibyte = 1024.0 * 1024.0 * 1024.0;
  std::ostringstream text;
  if (bytes < 1e15)
  {
    text << static_cast<std::int64_t>(bytes) << " bytes";
  }
  else
  {
    text.precision(3);
    text << bytes << " bytes";
  }
  text.precision(3);
  text << " (" << bytes / Gibibyte << " GiB)";
  return text.str();
}

void RequireMemory(const std::string& what, double bytes)
{
  const double available = GetAvailableMemory();
  if (bytes <= available)
  {
    return;
  }
  throw std::runtime_error(what + " would need " + DescribeBytes(bytes) +
    (GetFreeAddressSpace() <= available
        ? ", this process may have (ulimit -v) " + DescribeBytes(available) + " more"
        : ", this machine has " + DescribeBytes(available) + " of memory free"));
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
