// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <sstream>
#include <stdexcept>

#include <unistd.h>

namespace lacuna
{
double GetPhysicalMemory()
{
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long pageSize = sysconf(_SC_PAGESIZE);
  return pages > 0 && pageSize > 0 ? static_cast<double>(pages) * static_cast<double>(pageSize) : 0;
}

void RequireMemory(const std::string& what, double bytes)
{
  const double available = GetPhysicalMemory();
  if (available <= 0 || bytes <= available)
  {
    return;
  }
  constexpr double Gibibyte = 1024.0 * 1024.0 * 1024.0;
  std::ostringstream message;
  message.precision(3);
  message << what << " would need " << bytes / Gibibyte << " GiB, this machine has "
          << available / Gibibyte << " GiB of memory";
  throw std::runtime_error(message.str());
}
}
