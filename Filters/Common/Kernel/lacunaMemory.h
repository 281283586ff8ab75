// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses allocations that cannot succeed before they are tried, and makes large ones cheaper.
#ifndef lacunaMemory_h
#define lacunaMemory_h

#include <cstddef>
#include <stdexcept>
#include <string>

namespace lacuna
{
/// Bytes of memory of the machine, or what the container this process runs in (cgroup) or the limits of
/// its address space and data (ulimit -v, -d) allow, if that is less.
double GetPhysicalMemory();

/// Bytes of memory that this process can have now without swapping: what is free, as far as the same
/// limits allow. Files that the system keeps in memory count as free.
double GetAvailableMemory();

/// In full, and in a unit that can be read: "20000000000 bytes (18.6 GiB)".
std::string DescribeBytes(double bytes);

/// What RequireMemory throws.
class MemoryExceeded : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Throws MemoryExceeded when bytes exceed the available memory; the text names what is
/// to be stored, its size and the memory there is. bytes is a double so that no product of sizes
/// can overflow on its way here. held: of those, what there is already and will be used or freed first.
void RequireMemory(const std::string& what, double bytes, double held = 0);

/// Asks the system to back memory by large pages when it is first touched: ordinary ones of 4 KiB
/// take a fault each, which is a sixth of the time of making a volume. For memory that has just been
/// allocated and will be filled densely. Does nothing for less than some MiB, nor where the system
/// knows no such thing.
void PreferLargePages(void* memory, std::size_t bytes);
}
#endif
