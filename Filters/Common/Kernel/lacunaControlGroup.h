// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a container allows.
#ifndef lacunaControlGroup_h
#define lacunaControlGroup_h

#include <limits>
#include <string>

namespace lacuna
{
/// Memory that Linux's control groups allow this process, bytes; infinite without a limit.
struct ControlGroupMemory
{
  double Limit = std::numeric_limits<double>::infinity();
  /// Of Limit, what nobody uses but for files that Linux keeps in memory as long as it is free.
  double Free = std::numeric_limits<double>::infinity();
};

/// The least of this process' group and all above it, of version 1 or 2. root stands before the
/// names of the system's files.
ControlGroupMemory ReadControlGroupMemory(const std::string& root = {});
}
#endif
