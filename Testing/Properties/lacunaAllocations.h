// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Lets memory run out: counts what this program asks of the C library, and refuses it on demand.
#ifndef lacunaAllocations_h
#define lacunaAllocations_h

#include <cstddef>

namespace lacunaProperties
{
/// Requests of fewer bytes are granted always: nearly always there is room for them, and VTK does not
/// survive without some of them, such as the tables of a data object's arrays.
constexpr std::size_t LargeAllocation = 9000; // more than the buffers of files

/// Requests of LargeAllocation and more since the last call, on any thread. 0 where the sanitizers'
/// allocator is used instead.
long CountAllocations();

/// The `first` next large requests are granted, and none after them; below 0: all are.
void GrantAllocations(long first);

/// Whether one was not, so far.
bool WereAllocationsRefused();
}
#endif
