// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Samples as unsigned integers of the same size and the same order, so that ranking is written
/// once for all types. -0 comes just before +0; NaN becomes the greatest key.
#ifndef lacunaOrderedKey_h
#define lacunaOrderedKey_h

#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace lacuna
{
template <class T>
struct OrderedKey
{
  using Key = std::conditional_t<sizeof(T) == 1, std::uint8_t,
    std::conditional_t<sizeof(T) == 2, std::uint16_t,
      std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
  static constexpr Key SignBit = static_cast<Key>(Key(1) << (8 * sizeof(T) - 1));
  /// The key of NaN; for integer types it is that of the greatest value.
  static constexpr Key NaN = std::numeric_limits<Key>::max();

  static Key From(T value)
  {
    Key key;
    std::memcpy(&key, &value, sizeof(T));
    if constexpr (std::is_floating_point_v<T>)
    {
      // Magnitudes of negative numbers run downwards: turn them round.
      const Key ordered =
        (key & SignBit) ? static_cast<Key>(~key) : static_cast<Key>(key | SignBit);
      return value == value ? ordered : NaN;
    }
    else
    {
      return std::is_signed_v<T> ? static_cast<Key>(key ^ SignBit) : key;
    }
  }

  static T To(Key key)
  {
    if constexpr (std::is_floating_point_v<T>)
    {
      if (key == NaN)
      {
        return std::numeric_limits<T>::quiet_NaN();
      }
      key = (key & SignBit) ? static_cast<Key>(key ^ SignBit) : static_cast<Key>(~key);
    }
    else if (std::is_signed_v<T>)
    {
      key = static_cast<Key>(key ^ SignBit);
    }
    T value;
    std::memcpy(&value, &key, sizeof(T));
    return value;
  }
};

template <class T>
using KeyOf = typename OrderedKey<T>::Key;
}
#endif
