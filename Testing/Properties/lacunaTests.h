// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The tests of this folder: each looks at one subject under one seed, and gives what is wrong; empty
/// when nothing is. story: what was done, to be read.
#ifndef lacunaTests_h
#define lacunaTests_h

#include "lacunaSubject.h"

#include <cstdint>
#include <string>

namespace lacunaProperties
{
/// A valid output, the same twice and for any number of threads and pieces, or an error and nothing;
/// inputs stay as they were; sound inputs after an error give what they always give.
std::string TestOutcome(const Subject& subject, std::uint64_t seed, std::string& story);

/// Stopped at a report of progress: no output and no error; the next run gives what a first one does.
std::string TestAbort(const Subject& subject, std::uint64_t seed, std::string& story);

/// Created, run and deleted `cycles` times: memory in use does not grow.
std::string TestCycles(const Subject& subject, std::uint64_t seed, int cycles, std::string& story);
}
#endif
