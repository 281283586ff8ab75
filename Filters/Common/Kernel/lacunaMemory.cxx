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

// What the system lets this process have, of all addresses or of those that hold data.
struct ProcessLimit
{
  const char* Option; // of ulimit
  double Bytes;
  double Free;
};

ProcessLimit Measure(const char* option, int resource, double pages)
{
  rlimit limit{};
  const bool limited = getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  const double bytes = limited ? static_cast<double>(limit.rlim_cur) : Unlimited;
  return { option, bytes,
    std::max(0.0, bytes - pages * static_cast<double>(sysconf(_SC_PAGESIZE))) };
}

// The one that leaves less.
ProcessLimit MeasureProcess()
{
  double size = 0;
  double data = 0;
  std::string others;
  std::ifstream("/proc/self/statm") >> size >> others >> others >> others >> others >> data;
  const ProcessLimit addresses = Measure("-v", RLIMIT_AS, size);
  const ProcessLimit stored = Measure("-d", RLIMIT_DATA, data);
  return stored.Free < addresses.Free ? stored : addresses;
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
  return std::min({ GetMachine(), ReadControlGroupMemory().Limit, MeasureProcess().Bytes });
}

double GetAvailableMemory()
{
  return std::min(
    { GetMachine(), GetFreeMachine(), ReadControlGroupMemory().Free, MeasureProcess().Free });
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

void RequireMemory(const std::string& what, double bytes, double held)
{
  const double available = GetAvailableMemory();
  if (bytes <= available + held)
  {
    return;
  }
  const ProcessLimit process = MeasureProcess();
  throw MemoryExceeded(what + " would need " + DescribeBytes(bytes) +
    (process.Free <= available
        ? ", this process may have (ulimit " + std::string(process.Option) + ") " +
          DescribeBytes(available) + " more"
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
