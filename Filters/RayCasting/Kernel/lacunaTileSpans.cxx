// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTileSpans.h"

#include <cmath>

namespace lacuna
{
TileSpans::TileSpans(const Matrix4& indexToPixel, const std::array<int, 4>& extent)
  : IndexToPixel(indexToPixel)
  , Extent(extent)
{
  constexpr double more = 1 + 1e-6;
  for (int a = 0; a < 3; ++a)
  {
    this->CellSize[a] = 0.5 * more *
      (std::abs(indexToPixel(a, 0)) + std::abs(indexToPixel(a, 1)) + std::abs(indexToPixel(a, 2)));
  }
  const auto tiles = [](int first, int last)
  { return static_cast<std::size_t>((static_cast<std::int64_t>(last) - first) / TileWidth + 1); };
  this->Across = tiles(extent[0], extent[1]);
  this->Spans.resize(this->Across * tiles(extent[2], extent[3]));
}

void TileSpans::Add(const std::array<int, 3>& block, int shift, std::vector<RaySpan>& spans) const
{
  // The last blocks may reach beyond the volume: their spans are longer than need be.
  const double width = 1 << shift;
  const Vec3 centre = this->IndexToPixel.Point(
    { (block[0] + 0.5) * width, (block[1] + 0.5) * width, (block[2] + 0.5) * width });
  const Vec3 half = width * this->CellSize;
  int first[2];
  int last[2];
  for (int a = 0; a < 2; ++a)
  {
    const double low = std::max(centre[a] - half[a] - this->Extent[2 * a], 0.0);
    const double high = std::min(centre[a] + half[a], 1.0 * this->Extent[2 * a + 1]);
    if (low > high - this->Extent[2 * a])
    {
      return;
    }
    first[a] = static_cast<int>(low) / TileWidth;
    last[a] = static_cast<int>(high - this->Extent[2 * a]) / TileWidth;
  }
  const double nearest = centre[2] - half[2];
  const double farthest = centre[2] + half[2];
  for (int y = first[1]; y <= last[1]; ++y)
  {
    for (int x = first[0]; x <= last[0]; ++x)
    {
      RaySpan& span = spans[y * this->Across + x];
      span.First = std::min(span.First, nearest);
      span.Last = std::max(span.Last, farthest);
    }
  }
}

void TileSpans::Merge(const std::vector<RaySpan>& spans)
{
  for (std::size_t i = 0; i < spans.size(); ++i)
  {
    this->Spans[i].First = std::min(this->Spans[i].First, spans[i].First);
    this->Spans[i].Last = std::max(this->Spans[i].Last, spans[i].Last);
  }
}
}
