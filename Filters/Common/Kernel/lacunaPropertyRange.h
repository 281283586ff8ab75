// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses whole numbers below those that a property has a meaning for. Clamping them would take
/// MemoryLimit -1 for 0, which is no limit.
#ifndef lacunaPropertyRange_h
#define lacunaPropertyRange_h

#include <stdexcept>
#include <string>

namespace lacuna
{
/// Throws std::runtime_error that names the property.
inline void RequireAtLeast(int lowest, const char* property, int value)
{
  if (value < lowest)
  {
    throw std::runtime_error(std::string(property) + " is " + std::to_string(value) + "; give " +
      std::to_string(lowest) + " or more");
  }
}
}
#endif
