// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The tests of this folder: each looks at one subject under one seed, and gives what is wrong; empty
/// when nothing is.
#ifndef lacunaTests_h
#define lacunaTests_h

#include "lacunaSubject.h"

#include <cstdint>
#include <string>

namespace lacunaProperties
{
/// What a test tells besides.
struct Account
{
  std::string Story; ///< what was done, to be read
  /// Whether the algorithm came to the point of which the test is. Where that happens in no case,
  /// nothing was tested.
  bool Succeeded = false;
};

/// What is done from now on may take as long as a case may. A test that does a lot in one case calls it
/// now and then.
void StartClock();

/// A valid output, the same twice and for any number of threads and pieces, or an error and nothing;
/// inputs stay as they were; sound inputs after an error give what they always give.
std::string TestOutcome(const Subject& subject, std::uint64_t seed, Account& account);

/// Stopped at any report of progress: no output and no error; the next run gives what a first one does.
/// Reports come between any two ranges of its loops, of which the calling thread does all; or, where
/// areAtWork, every 20 microseconds while threads are at work on larger inputs, so that a run need not come to
/// the report at which it was to stop (LACUNA_REPORT_INTERVAL).
std::string TestAbort(const Subject& subject, std::uint64_t seed, bool areAtWork, Account& account);

/// Created, run and deleted `cycles` times, with the first inputs from this seed on that give an
/// output: memory in use does not grow.
std::string TestCycles(const Subject& subject, std::uint64_t seed, int cycles, Account& account);

/// Memory runs out at any moment: an error and no output, or the usual one where that memory was no
/// need; the next run gives what a first one does. The program goes on.
std::string TestExhaustion(const Subject& subject, std::uint64_t seed, Account& account);
}
#endif
