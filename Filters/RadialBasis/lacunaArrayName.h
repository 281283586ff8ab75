// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Properties that name an array, which may be left out.
#ifndef lacunaArrayName_h
#define lacunaArrayName_h

#include "vtkObject.h"

#include <cstring>
#include <string>

namespace lacuna
{
/// Sets member to name; null and ParaView's "None" are no array.
inline void SetArrayName(vtkObject* filter, std::string& member, const char* name)
{
  const std::string value = !name || !std::strcmp(name, "None") ? "" : name;
  if (member != value)
  {
    member = value;
    filter->Modified();
  }
}
}
#endif
