// SPDX-License-Identifier: BSD-3-Clause
// Tests of what every algorithm promises, on random data and properties:
//
//   LacunaProperties outcome|abort|abort-threads|cycles|exhaustion [--seed N] [--count N] [--filter NAME]... [--output FOLDER]
//
// --seed: of the first case, the others follow; `clock` takes one from the time. --count: cases of
// an algorithm of cost 1 (cycles: cycles). A failure prints the options that repeat it alone. It is
// one, too, when an algorithm came to the point in no case: there are more then, up to 60.
#include "lacunaGrowth.h"
#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"
#include "lacunaTests.h"
#include "lacunaTrial.h"
#include "vtkLogger.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

extern "C" void __sanitizer_set_death_callback(void (*)()) __attribute__((weak));
// That of undefined behaviour knows of no callback; what is aborted says where.
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options()
{
  return "abort_on_error=1:print_stacktrace=1";
}

namespace
{
using lacunaProperties::Account;
using lacunaProperties::Subject;

// s of the processor's time for a case; they take milliseconds, under a sanitizer seconds
constexpr int Longest = lacuna::Sanitized ? 1200 : 120;
// bytes; they take little, sanitizers keep what was given back
#if defined(                                                                                       \
  __SANITIZE_THREAD__) // takes several times as much on top, which the system does not count
constexpr rlim_t MostMemory = rlim_t{ 5 } << 29;
#else
constexpr rlim_t MostMemory = rlim_t{ lacuna::Sanitized ? 16 : 5 } << 29;
#endif

constexpr int More = 60; ///< cases, where none has come to the point

char Current[300] = ""; ///< the options that repeat the case at hand

const std::string* Story = nullptr; ///< of that case

void SayWhere()
{
  const char* const parts[] = { "\nin the case of: ", Current, "\n", Story ? Story->c_str() : "" };
  for (const char* part : parts)
  {
    (void)!write(STDERR_FILENO, part, std::strlen(part));
  }
}

void Die(int signal)
{
  SayWhere();
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void TakesTooLong(int)
{
  (void)!write(STDERR_FILENO, "takes too long", 14);
  SayWhere();
  _exit(1);
}

struct Options
{
  std::string Test;
  std::uint64_t Seed = 1996;
  int Count = 60;
  std::vector<std::string> Filters;
};

bool Parse(int argc, char* argv[], Options& options)
{
  if (argc < 2)
  {
    return false;
  }
  options.Test = argv[1];
  for (int i = 2; i + 1 < argc; i += 2)
  {
    const std::string key = argv[i];
    const std::string value = argv[i + 1];
    std::istringstream number(value);
    bool isNumber = true;
    if (key == "--seed" && value == "clock")
    {
      options.Seed =
        static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
    }
    else if (key == "--seed")
    {
      isNumber = static_cast<bool>(number >> options.Seed);
    }
    else if (key == "--count")
    {
      isNumber = number >> options.Count && options.Count > 0;
    }
    else if (key == "--filter")
    {
      options.Filters.push_back(value);
    }
    else if (key == "--output")
    {
      lacunaProperties::SetOutputFolder(value);
    }
    else
    {
      return false;
    }
    if (!isNumber)
    {
      return false;
    }
  }
  return argc % 2 == 0 &&
    (options.Test == "outcome" || options.Test == "abort" || options.Test == "abort-threads" ||
      options.Test == "cycles" || options.Test == "exhaustion");
}

double GetProcessorTime()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// How many cases of the subject failed.
int TestSubject(const Options& options, const Subject& subject, int count,
  const std::function<std::string(std::uint64_t seed, Account& account)>& test)
{
  const double start = GetProcessorTime();
  const bool isRepeated = options.Count == 1; // a failure, to be looked at
  bool succeeded = isRepeated;
  int failures = 0;
  int i = 0;
  for (; i < count || (!succeeded && i < count + More); ++i)
  {
    const std::uint64_t seed = options.Seed + static_cast<std::uint64_t>(i);
    std::snprintf(Current, sizeof(Current), "%s --filter %s --seed %llu --count 1",
      options.Test.c_str(), subject.Name.c_str(), static_cast<unsigned long long>(seed));
    lacunaProperties::StartClock();
    Account account;
    Story = &account.Story;
    const std::string fault = test(seed, account);
    Story = nullptr;
    succeeded = succeeded || account.Succeeded;
    if (!fault.empty())
    {
      ++failures;
      std::cerr << "FAILED: " << Current << "\n" << account.Story << "  " << fault << "\n";
    }
    else if (isRepeated)
    {
      std::cout << account.Story;
    }
  }
  if (!succeeded)
  {
    ++failures;
    std::cerr << "FAILED: " << options.Test << " --filter " << subject.Name << " --seed "
              << options.Seed << ": came to the point in no case\n";
  }
  std::cout << subject.Name << ": " << i << " cases, " << failures << " failed, "
            << GetProcessorTime() - start << " s" << std::endl;
  return failures;
}
}

//------------------------------------------------------------------------------
void lacunaProperties::StartClock()
{
  const struct itimerval limit = { { 0, 0 }, { Longest, 0 } };
  setitimer(ITIMER_PROF, &limit, nullptr);
}

//------------------------------------------------------------------------------
int main(int argc, char* argv[])
{
  Options options;
  if (!Parse(argc, argv, options))
  {
    std::cerr
      << "usage: LacunaProperties outcome|abort|abort-threads|cycles|exhaustion [--seed N|clock] "
         "[--count N] [--filter NAME]... [--output FOLDER]\n";
    return 2;
  }
  if (options.Test == "cycles")
  {
    lacuna::CountExactly(argv);
  }
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  const bool areAtWork = options.Test == "abort-threads";
  if (options.Test == "abort" || areAtWork)
  {
    setenv("LACUNA_REPORT_INTERVAL", areAtWork ? "0.02" : "0", 1);
  }
  // It forks, and VTK 9.3 and later would wait for threads that a fork has not.
  if (options.Test == "exhaustion")
  {
    setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  }
  std::signal(SIGPROF, TakesTooLong);
  std::signal(SIGABRT, Die);
  if (__sanitizer_set_death_callback)
  {
    __sanitizer_set_death_callback(SayWhere);
  }
  else
  {
    for (const int signal : { SIGSEGV, SIGFPE, SIGILL, SIGBUS })
    {
      std::signal(signal, Die);
    }
  }
  // of data, since sanitizers take all of the address space
  const auto most = static_cast<rlim_t>(lacuna::GetProcessMemory("VmData")) + MostMemory;
  const struct rlimit limit = { most, most };
  setrlimit(RLIMIT_DATA, &limit);
  int failures = 0;
  int found = 0;
  for (const Subject& subject : lacunaProperties::GetSubjects())
  {
    if (!options.Filters.empty() &&
      std::find(options.Filters.begin(), options.Filters.end(), subject.Name) ==
        options.Filters.end())
    {
      continue;
    }
    ++found;
    const int count = std::max(1, options.Count / subject.Cost);
    // a case executes 1.2 to 10.2 times as often
    const int cycles = options.Count / std::clamp(subject.Cost / 4, 1, 25);
    using namespace lacunaProperties;
    failures += options.Test == "cycles" ? TestSubject(options, subject, 1,
                                             [&](std::uint64_t seed, Account& account)
                                             { return TestCycles(subject, seed, cycles, account); })
                                         : TestSubject(options, subject, count,
                                             [&](std::uint64_t seed, Account& account)
                                             {
                                               return options.Test == "abort" || areAtWork
                                                 ? TestAbort(subject, seed, areAtWork, account)
                                                 : options.Test == "exhaustion"
                                                 ? TestExhaustion(subject, seed, account)
                                                 : TestOutcome(subject, seed, account);
                                             });
  }
  if (found == 0)
  {
    std::cerr << "no such filter\n";
    return 2;
  }
  return failures == 0 ? 0 : 1;
}
