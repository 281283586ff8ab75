// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGreyImage.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr float Largest = 1e30f; // sums and differences of a few stay numbers
}

std::vector<float> GetLevels(const GreyImage& image)
{
  std::vector<float> levels;
  levels.reserve(static_cast<std::size_t>(image.Width) * static_cast<std::size_t>(image.Height));
  DispatchScalarType(image.Type,
    [&](auto zero)
    {
      using Scalar = decltype(zero);
      for (int row = 0; row < image.Height; ++row)
      {
        const Scalar* first = static_cast<const Scalar*>(image.Pixels) + row * image.RowStride;
        for (int column = 0; column < image.Width; ++column)
        {
          const float level = static_cast<float>(first[column]);
          levels.push_back(std::isfinite(level) ? std::clamp(level, -Largest, Largest) : 0.0f);
        }
      }
    });
  return levels;
}
}
