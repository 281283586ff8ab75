// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which side of an iso-value is solid.
#ifndef lacunaSolidSide_h
#define lacunaSolidSide_h

#include <array>

namespace lacuna
{
/// Where the solid is. A field equal to the iso-value is solid.
enum class SolidSide
{
  Above,
  Below
};
inline constexpr std::array<const char*, 2> SolidSideNames{ "Above", "Below" };
}
#endif
