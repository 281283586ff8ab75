// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"
#include "lacunaTests.h"
#include "lacunaTrial.h"

#include <filesystem>
#include <iterator>
#include <memory>
#include <string>

#include <malloc.h>

namespace lacunaProperties
{
namespace
{
// Bytes that the program has and not given back; 0 where the allocator does not tell (sanitizers).
double GetBytesInUse()
{
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

// Files, sockets and pipes.
long CountOpenFiles()
{
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return std::distance(begin(open), end(open));
}
}

//------------------------------------------------------------------------------
std::string TestCycles(const Subject& subject, std::uint64_t seed, int cycles, Account& account)
{
  constexpr int tries = 100;
  std::unique_ptr<Trial> found;
  Run first;
  for (int i = 0; i < tries && !account.Succeeded; ++i)
  {
    found = std::make_unique<Trial>(subject, seed + static_cast<std::uint64_t>(i), Trial::Plain);
    first = found->Execute(found->Make(), 0);
    account.Succeeded = first.Errors.empty() && !first.IsEmpty;
  }
  const Trial& trial = *found;
  Run last;
  const auto run = [&](int count)
  {
    for (int i = 0; i < count; ++i)
    {
      StartClock();
      last = trial.Execute(trial.Make(), 0);
    }
  };
  run(cycles / 5 + 1); // what is made once
  const long files = CountOpenFiles();
  const double resident = lacuna::GetProcessMemory("VmRSS");
  // Tables of VTK grow a little now and then; what is lost in each cycle is lost in all rounds, and is 32
  // bytes at the least.
  double grown = 0;
  int rounds = 0;
  do
  {
    const double bytes = GetBytesInUse();
    run(cycles);
    grown = GetBytesInUse() - bytes;
    ++rounds;
  } while (grown >= 32.0 * cycles && rounds < 4);
  const double residentGrown = lacuna::GetProcessMemory("VmRSS") - resident;
  account.Story = "  in " + std::to_string(cycles) + " cycles, after " +
    std::to_string(rounds - 1) + " times as many, " + std::to_string(grown) +
    " bytes in use more; " + std::to_string(residentGrown) + " in memory\n";
  const std::string difference = CompareRuns(first, last);
  if (!difference.empty())
  {
    return "the last cycle is not the first: " + difference;
  }
  if (CountOpenFiles() > files)
  {
    return "files stay open";
  }
  if (grown >= 32.0 * cycles)
  {
    return "memory in use grows";
  }
  // sanitizers keep what was given back
  return !lacuna::Sanitized && residentGrown > 16e6 ? "memory grows" : "";
}
}
