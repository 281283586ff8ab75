// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGreyRange.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace lacuna
{
namespace
{
template <class T>
std::pair<double, double> GetRange(const SliceImage& slice)
{
  using Limits = std::numeric_limits<T>;
  T low = Limits::has_infinity ? Limits::infinity() : Limits::max();
  T high = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  for (int j = 0; j < slice.Height; ++j)
  {
    const T* const row = static_cast<const T*>(slice.Pixels) + j * slice.RowStride;
    for (int i = 0; i < slice.Width; ++i)
    {
      if constexpr (std::is_floating_point_v<T>)
      {
        if (!std::isfinite(row[i]))
        {
          continue;
        }
      }
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
    }
  }
  return { static_cast<double>(low), static_cast<double>(high) };
}
}

void GreyRange::Update(const std::vector<SliceImage>& slices)
{
  for (; this->Seen < slices.size(); ++this->Seen)
  {
    const SliceImage& slice = slices[this->Seen];
    const auto [low, high] =
      DispatchScalarType(slice.Type, [&](auto zero) { return GetRange<decltype(zero)>(slice); });
    this->Low = std::min(this->Low, low);
    this->High = std::max(this->High, high);
  }
}
}
