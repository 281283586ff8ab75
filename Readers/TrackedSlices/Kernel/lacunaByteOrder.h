// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How a file's bytes become this machine's.
#ifndef lacunaByteOrder_h
#define lacunaByteOrder_h

#include <cstddef>

namespace lacuna
{
/// Reverses the bytes of each of count numbers of 1, 2, 4 or 8 bytes.
void SwapElementBytes(void* elements, std::size_t count, std::size_t elementSize);

/// Whether this machine stores the most significant byte first.
bool IsBigEndianMachine();
}
#endif
