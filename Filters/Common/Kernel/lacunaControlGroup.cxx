// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaControlGroup.h"

#include <algorithm>
#include <fstream>

namespace lacuna
{
namespace
{
// Names of one version's files, and of lines in one of them.
struct Names
{
  const char* Limit;
  const char* Used;
  const char* InactiveFile;
  const char* ActiveFile;
};

constexpr Names Version1 = { "memory.limit_in_bytes", "memory.usage_in_bytes",
  "total_inactive_file", "total_active_file" };
constexpr Names Version2 = { "memory.max", "memory.current", "inactive_file", "active_file" };

// Bytes of files that are kept in memory, which gives them up when it is wanted.
double ReadFilesInMemory(const std::string& folder, const Names& names)
{
  std::ifstream file(folder + "memory.stat");
  double sum = 0;
  double bytes = 0;
  for (std::string name; file >> name >> bytes;)
  {
    if (name == names.InactiveFile || name == names.ActiveFile)
    {
      sum += bytes;
    }
  }
  return sum;
}

void Restrict(ControlGroupMemory& memory, const std::string& folder, const Names& names)
{
  double limit = 0;
  if (!(std::ifstream(folder + names.Limit) >> limit)) // none, or "max"
  {
    return;
  }
  double used = 0;
  std::ifstream(folder + names.Used) >> used;
  memory.Limit = std::min(memory.Limit, limit);
  memory.Free = std::min(
    memory.Free, std::max(0.0, limit - std::max(0.0, used - ReadFilesInMemory(folder, names))));
}
}

ControlGroupMemory ReadControlGroupMemory(const std::string& root)
{
  ControlGroupMemory memory;
  std::ifstream groups(root + "/proc/self/cgroup");
  // number:controllers:/path; version 2 names no controllers
  for (std::string line; std::getline(groups, line);)
  {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos)
    {
      continue;
    }
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool isVersion1 = controllers.find(",memory,") != std::string::npos;
    if (!isVersion1 && controllers != ",,")
    {
      continue;
    }
    const std::string top = root + (isVersion1 ? "/sys/fs/cgroup/memory" : "/sys/fs/cgroup");
    // A container may see its own group as the top, whatever the path.
    for (std::string path = line.substr(second + 1) + "/"; !path.empty();)
    {
      Restrict(memory, top + path, isVersion1 ? Version1 : Version2);
      path.pop_back();
      path.erase(path.rfind('/') + 1); // all of it where there is none
    }
  }
  return memory;
}
}
