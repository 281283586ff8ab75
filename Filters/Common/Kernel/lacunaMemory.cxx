// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr double Unlimited = 9e18; // of 64-bit sizes

// A number that stands alone in a file; Unlimited when there is none ("max").
double ReadNumber(const std::string& fileName)
{
  std::ifstream file(fileName);
  double number = 0;
  return file >> number ? number : Unlimited;
}

// Folder of this process' control group (version 2), by which containers are limited.
std::string GetControlGroup()
{
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);)
  {
    if (line.rfind("0::", 0) == 0)
    {
      return "/sys/fs/cgroup" + line.substr(3) + "/";
    }
  }
  return {};
}

// What is left of the address space that ulimit -v allows.
double GetAddressSpace()
{
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
  {
    return Unlimited;
  }
  const double used = ReadNumber("/proc/self/statm") * static_cast<double>(sysconf(_SC_PAGESIZE));
  // not 0, which means that nobody tells
  return std::max(1.0, static_cast<double>(limit.rlim_cur) - (used < Unlimited ? used : 0));
}
}

double GetPhysicalMemory()
{
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long pageSize = sysconf(_SC_PAGESIZE);
  const double machine =
    pages > 0 && pageSize > 0 ? static_cast<double>(pages) * static_cast<double>(pageSize) : 0;
  return std::min(machine, ReadNumber(GetControlGroup() + "memory.max"));
}

double GetAvailableMemory()
{
  // Linux says how much can be had without swapping; elsewhere all there is must do.
  double machine = GetPhysicalMemory();
  std::ifstream file("/proc/meminfo");
  std::string name;
  for (double kibibytes = 0; file >> name >> kibibytes; file.ignore(1000, '\n'))
  {
    if (name == "MemAvailable:")
    {
      machine = 1024 * kibibytes;
      break;
    }
  }
  const std::string group = GetControlGroup();
  const double limit = ReadNumber(group + "memory.max");
  const double left =
    limit < Unlimited ? std::max(0.0, limit - ReadNumber(group + "memory.current")) : Unlimited;
  return std::min({ machine, left, GetAddressSpace() });
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
  if (available <= 0 || bytes <= available)
  {
    return;
  }
  throw std::runtime_error(what + " would need " + DescribeBytes(bytes) +
    (GetAddressSpace() <= available
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
