// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGrowth.h"
#include "lacunaTests.h"
#include "lacunaTrial.h"

#include <memory>
#include <string>

namespace lacunaProperties
{
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
  const std::string fault = lacuna::FindGrowth(cycles, run, account.Story);
  const std::string difference = CompareRuns(first, last);
  if (!difference.empty())
  {
    return "the last cycle is not the first: " + difference;
  }
  return fault;
}
}
