// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAllocations.h"
#include "lacunaTests.h"
#include "lacunaTrial.h"

#include <algorithm>

#include <sys/wait.h>
#include <unistd.h>

namespace lacunaProperties
{
namespace
{
std::string CompareOutputs(
  const std::vector<Fingerprint>& first, const std::vector<Fingerprint>& second)
{
  if (first.size() != second.size())
  {
    return "their number";
  }
  for (std::size_t port = 0; port < first.size(); ++port)
  {
    const std::string difference = Compare(first[port], second[port]);
    if (!difference.empty())
    {
      return difference + " of output " + std::to_string(port);
    }
  }
  return {};
}

// In a process of its own.
std::string RunOut(const Trial& trial, const Run& whole, long granted)
{
  const vtkSmartPointer<vtkAlgorithm> algorithm = trial.Make();
  GrantAllocations(granted);
  const Run starved = trial.Execute(algorithm, 0);
  if (starved.Stray.find("an exception escaped") != std::string::npos)
  {
    return starved.Stray;
  }
  if (!starved.Errors.empty() && !starved.IsEmpty)
  {
    return "an error and an output: " + starved.Errors;
  }
  if (starved.Errors.empty())
  {
    const std::string difference = CompareOutputs(whole.Outputs, starved.Outputs);
    if (!difference.empty())
    {
      return "no error, and another output, by " + difference + "; " + starved.Warnings +
        starved.Stray;
    }
  }
  algorithm->Modified();
  const Run again = trial.Execute(algorithm, 0);
  const std::string difference = CompareOutputs(whole.Outputs, again.Outputs);
  return difference.empty() ? "" : "afterwards the output differs by " + difference + again.Errors;
}
}

//------------------------------------------------------------------------------
std::string TestExhaustion(const Subject& subject, std::uint64_t seed, Account& account)
{
  constexpr int stretch = 4;        // until arrays are large
  constexpr unsigned longest = 120; // s
  const Trial trial(subject, seed, Trial::Varied, stretch);
  trial.Execute(trial.Make(), 0); // what is made once
  const Run whole = trial.Execute(trial.Make(), 0);
  account.Story = trial.GetStory() + "  " + std::to_string(whole.Allocations) +
    " large allocations\n" + whole.Errors;
  if (!whole.Errors.empty() || whole.IsEmpty || whole.Allocations == 0)
  {
    account.Succeeded = whole.Errors.empty() && subject.IsFrugal;
    return {};
  }
  const long granted =
    Dice(seed + 1).Whole(0, static_cast<int>(std::min(whole.Allocations, 1000000L)) - 1);
  account.Story += "  " + std::to_string(granted) + " granted\n";
  // What ends the program shall not end the test.
  int channel[2];
  if (pipe(channel) != 0)
  {
    return "no pipe";
  }
  const pid_t child = fork();
  if (child < 0)
  {
    return "no process";
  }
  if (child == 0)
  {
    alarm(longest);
    const std::string fault = RunOut(trial, whole, granted);
    const std::string told = (WereAllocationsRefused() ? "r" : "-") + fault.substr(0, 4000);
    (void)!write(channel[1], told.data(), told.size());
    _exit(0);
  }
  close(channel[1]);
  std::string told(5000, '\0');
  told.resize(
    static_cast<std::size_t>(std::max<ssize_t>(0, read(channel[0], told.data(), told.size()))));
  close(channel[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
  {
    return "without memory it ends by signal " + std::to_string(WTERMSIG(status));
  }
  if (WEXITSTATUS(status) != 0 || told.empty())
  {
    return "without memory it exits with " + std::to_string(WEXITSTATUS(status));
  }
  account.Succeeded = told[0] == 'r';
  return told.substr(1);
}
}
