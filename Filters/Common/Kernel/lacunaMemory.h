// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses allocations that cannot succeed before they are tried.
#ifndef lacunaMemory_h
#define lacunaMemory_h

#include <string>

namespace lacuna
{
/// Bytes of memory that can be had now without swapping; 0 when the system does not tell.
double GetAvailableMemory();

/// Throws std::runtime_error when bytes exceed the available memory; the text names what is
/// to be stored, its size and the memory there is. bytes is a double so that no product of sizes
/// can overflow on its way here.
void RequireMemory(const std::string& what, double bytes);
}
#endif
