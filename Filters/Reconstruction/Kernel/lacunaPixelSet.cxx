// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPixelSet.h"

namespace lacuna
{
void PixelSet::Put(const PixelPart& part)
{
  for (const auto& [column, row] : part.Pixels)
  {
    this->Put(column, row);
  }
}

std::int64_t PixelSet::GetSize() const
{
  return std::count(this->Members.begin(), this->Members.end(), char(1));
}

PixelSet PixelSet::Flipped() const
{
  PixelSet flipped(this->Width, this->Height);
  for (int row = 0; row < this->Height; ++row)
  {
    for (int column = 0; column < this->Width; ++column)
    {
      if (this->Has(column, row))
      {
        flipped.Put(column, this->Height - 1 - row);
      }
    }
  }
  return flipped;
}

PixelRectangle PixelSet::GetBounds() const
{
  PixelRectangle box;
  this->ForEach([&](int column, int row) { box.Put(column, row); });
  return box;
}

PixelSet PixelSet::Gathered(int radiusX, int radiusY, int needed) const
{
  const auto stride = static_cast<std::size_t>(this->Width) + 1;
  std::vector<int> sums(stride * (static_cast<std::size_t>(this->Height) + 1), 0);
  const auto sum = [&](int column, int row) -> int&
  { return sums[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)]; };
  for (int row = 0; row < this->Height; ++row)
  {
    int line = 0;
    for (int column = 0; column < this->Width; ++column)
    {
      line += this->Has(column, row) ? 1 : 0;
      sum(column + 1, row + 1) = sum(column + 1, row) + line;
    }
  }
  return Select(this->Width, this->Height,
    [&](int column, int row)
    {
      const int left = std::max(0, column - radiusX);
      const int right = std::min(this->Width, column + radiusX + 1);
      const int top = std::max(0, row - radiusY);
      const int bottom = std::min(this->Height, row + radiusY + 1);
      const int count = sum(right, bottom) - sum(left, bottom) - sum(right, top) + sum(left, top);
      return count >= (needed > 0 ? needed : (right - left) * (bottom - top) + needed);
    });
}

std::vector<PixelPart> PixelSet::GetParts() const
{
  std::vector<PixelPart> parts;
  PixelSet seen(this->Width, this->Height);
  this->ForEach(
    [&](int column, int row)
    {
      if (seen.Has(column, row))
      {
        return;
      }
      PixelPart part;
      part.Pixels.emplace_back(column, row);
      seen.Put(column, row);
      for (std::size_t n = 0; n < part.Pixels.size(); ++n)
      {
        const auto [x, y] = part.Pixels[n];
        part.Bounds.Put(x, y);
        for (int ny = std::max(0, y - 1); ny <= std::min(this->Height - 1, y + 1); ++ny)
        {
          for (int nx = std::max(0, x - 1); nx <= std::min(this->Width - 1, x + 1); ++nx)
          {
            if (this->Has(nx, ny) && !seen.Has(nx, ny))
            {
              seen.Put(nx, ny);
              part.Pixels.emplace_back(nx, ny);
            }
          }
        }
      }
      parts.push_back(std::move(part));
    });
  return parts;
}

std::array<std::vector<PixelRectangle>, 2> PixelSet::GetLines() const
{
  std::vector<PixelRectangle> rows(static_cast<std::size_t>(this->Height));
  std::vector<PixelRectangle> columns(static_cast<std::size_t>(this->Width));
  this->ForEach(
    [&](int column, int row)
    {
      rows[static_cast<std::size_t>(row)].Put(column, row);
      columns[static_cast<std::size_t>(column)].Put(column, row);
    });
  return { std::move(rows), std::move(columns) };
}
}
