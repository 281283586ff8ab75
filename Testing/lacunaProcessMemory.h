// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What Linux tells of the memory of this process, for tests and benchmarks.
#ifndef lacunaProcessMemory_h
#define lacunaProcessMemory_h

#include <fstream>
#include <string>

namespace lacuna
{
/// Bytes: "VmHWM", the most that has been in memory, or "VmRSS", what is there now; 0 where the
/// system does not tell.
inline double GetProcessMemory(const std::string& key)
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
  {
    if (line.rfind(key + ":", 0) == 0)
    {
      return 1024 * std::stod(line.substr(key.size() + 1));
    }
  }
  return 0;
}

/// Lets VmHWM begin anew.
inline void ResetPeakMemory()
{
  std::ofstream("/proc/self/clear_refs") << 5;
}
}
#endif
