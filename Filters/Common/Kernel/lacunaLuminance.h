// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grey levels of colour pictures: one rule for all that read them.
#ifndef lacunaLuminance_h
#define lacunaLuminance_h

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace lacuna
{
/// Luminance 0.299 R + 0.587 G + 0.114 B (Rec. 601) of count pixels of channels numbers each, of
/// which the first three are red, green and blue; rounded (half up) for integer types. grey may be
/// the beginning of pixels: the luminances then take the place of the colours.
template <class T>
void MakeLuminance(const T* pixels, std::int64_t count, std::int64_t channels, T* grey)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    const T* colour = pixels + i * channels;
    if constexpr (std::is_integral_v<T> && sizeof(T) <= 4)
    {
      // exact: the sum of doubles falls short of some ties
      const std::int64_t sum = 299 * static_cast<std::int64_t>(colour[0]) +
        587 * static_cast<std::int64_t>(colour[1]) + 114 * static_cast<std::int64_t>(colour[2]) +
        500;
      grey[i] = static_cast<T>(sum / 1000 - (sum % 1000 < 0 ? 1 : 0));
      continue;
    }
    const double level = 0.299 * static_cast<double>(colour[0]) +
      0.587 * static_cast<double>(colour[1]) + 0.114 * static_cast<double>(colour[2]);
    if constexpr (std::is_integral_v<T>)
    {
      // 2^63 - 1 and 2^64 - 1 are not doubles: the rounded sum can be one too much for T
      constexpr auto most = static_cast<double>(std::numeric_limits<T>::max());
      grey[i] =
        level < most ? static_cast<T>(std::floor(level + 0.5)) : std::numeric_limits<T>::max();
    }
    else
    {
      grey[i] = static_cast<T>(level);
    }
  }
}
}
#endif
