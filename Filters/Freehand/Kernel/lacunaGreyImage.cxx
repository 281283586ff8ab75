// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGreyImage.h"

#include <cmath>

namespace lacuna
{
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
          levels.push_back(std::isfinite(level) ? level : 0.0f);
        }
      }
    });
  return levels;
}
}
