// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Numbers that look random and are the same on all machines.
#ifndef lacunaScramble_h
#define lacunaScramble_h

#include <cstdint>

namespace lacuna
{
/// One for each x (splitmix64).
inline std::uint64_t Scramble(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}
}
#endif
