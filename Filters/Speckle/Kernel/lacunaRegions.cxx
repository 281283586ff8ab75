// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRegions.h"

#include <algorithm>

namespace lacuna
{
namespace
{
/// The rows of a box of bounds, row after row.
class BoundsTest
{
public:
  BoundsTest(const std::array<double, 6>& bounds, const Matrix4& indexToWorld)
    : Bounds(bounds)
    , IndexToWorld(indexToWorld)
  {
    // Coordinates such as 0.1 + 2 * 0.1 miss 0.3 by their rounding.
    const double spacing = std::min(
      { Norm(indexToWorld.Column(0)), Norm(indexToWorld.Column(1)), Norm(indexToWorld.Column(2)) });
    for (std::size_t i = 0; i < 6; ++i)
    {
      this->Bounds[i] += (i % 2 == 0 ? -1e-6 : 1e-6) * spacing;
    }
  }

  bool Holds(int x, int y, int z) const
  {
    const Vec3 p = this->IndexToWorld.Point(
      { static_cast<double>(x), static_cast<double>(y), static_cast<double>(z) });
    return this->Bounds[0] <= p[0] && p[0] <= this->Bounds[1] && this->Bounds[2] <= p[1] &&
      p[1] <= this->Bounds[3] && this->Bounds[4] <= p[2] && p[2] <= this->Bounds[5];
  }

private:
  std::array<double, 6> Bounds;
  Matrix4 IndexToWorld;
};

/// Clears the flags of the samples first, first + 1, ... whose value is 0 or NaN.
void KeepMarked(const RegionMask& mask, std::int64_t first, std::vector<std::uint8_t>& flags)
{
  DispatchScalars(mask.Type, mask.Values,
    [&](const auto* values)
    {
      for (std::size_t i = 0; i < flags.size(); ++i)
      {
        const auto value = values[first + static_cast<std::int64_t>(i)];
        flags[i] &= static_cast<std::uint8_t>(value != 0 && value == value);
      }
    });
}
}

bool RegionRule::HasBounds() const
{
  return this->Bounds[0] <= this->Bounds[1] && this->Bounds[2] <= this->Bounds[3] &&
    this->Bounds[4] <= this->Bounds[5];
}

void MarkRegion(const Extent& box, const Matrix4& indexToWorld, const RegionRule& rule,
  Region region, std::uint8_t* regions, Execution& execution)
{
  const int nx = SizeOf(box, 0);
  const int ny = SizeOf(box, 1);
  const bool bounded = rule.HasBounds();
  const BoundsTest bounds(rule.Bounds, indexToWorld);
  const std::int64_t rows = std::int64_t(ny) * SizeOf(box, 2);
  execution.For(rows, 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<std::uint8_t> flags;
      for (std::int64_t row = begin; row < end; ++row)
      {
        std::uint8_t* to = regions + row * nx;
        flags.assign(nx, 1);
        for (const RegionMask& mask : rule.Masks)
        {
          KeepMarked(mask, row * nx, flags);
        }
        const int y = box[2] + static_cast<int>(row % ny);
        const int z = box[4] + static_cast<int>(row / ny);
        for (int i = 0; i < nx; ++i)
        {
          if (flags[i] && to[i] == NoRegion && (!bounded || bounds.Holds(box[0] + i, y, z)))
          {
            to[i] = region;
          }
        }
      }
    });
}
}
