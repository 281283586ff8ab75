// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMillSurface.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::int64_t LargestSide = 1 << 30;

[[noreturn]] void ThrowAt(
  std::int64_t i, std::int64_t j, const std::string& what, const Vec3* place = nullptr)
{
  std::string message =
    what + " at column " + std::to_string(i) + ", row " + std::to_string(j) + " of the surface";
  if (place)
  {
    message += " (x " + FormatNumber((*place)[0]) + ", y " + FormatNumber((*place)[1]) + ")";
  }
  throw std::invalid_argument(message);
}

// Twice the signed area of a triangle as the mill sees it.
double Area(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double Angle(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return std::atan2(Norm(Cross(b - a, c - a)), Dot(b - a, c - a));
}
}

//------------------------------------------------------------------------------
MillSurface::MillSurface(GridSize size, std::vector<Vec3> points)
  : Size(size)
  , Points(std::move(points))
{
  if (size.Columns < 2 || size.Rows < 2 || size.Columns > LargestSide || size.Rows > LargestSide ||
    this->Points.size() != static_cast<std::size_t>(size.Columns * size.Rows))
  {
    throw std::invalid_argument("the surface has " + std::to_string(size.Columns) + " x " +
      std::to_string(size.Rows) + " points; a surface to mill has at least 2 x 2");
  }
  this->Lowest = this->Highest = this->Points.front();
  for (std::size_t k = 0; k < this->Points.size(); ++k)
  {
    const Vec3& p = this->Points[k];
    if (!IsFinite(p))
    {
      const auto index = static_cast<std::int64_t>(k);
      ThrowAt(index % size.Columns, index / size.Columns,
        "the surface has a hole: the point is not finite,");
    }
    for (int c = 0; c < 3; ++c)
    {
      this->Lowest[c] = std::min(this->Lowest[c], p[c]);
      this->Highest[c] = std::max(this->Highest[c], p[c]);
    }
  }
  if (!(Norm(this->Lowest) < 1e5 && Norm(this->Highest) < 1e5))
  {
    throw std::invalid_argument("the surface reaches beyond 100 m; coordinates are in mm");
  }
  this->CheckTriangles();
  double sums[2] = { 0, 0 };
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    const Vec3 d = this->At(size.Columns - 1, j) - this->At(0, j);
    sums[0] += std::hypot(d[0], d[1]);
  }
  for (std::int64_t i = 0; i < size.Columns; ++i)
  {
    const Vec3 d = this->At(i, size.Rows - 1) - this->At(i, 0);
    sums[1] += std::hypot(d[0], d[1]);
  }
  this->Spacing = std::min(sums[0] / static_cast<double>(size.Rows * (size.Columns - 1)),
    sums[1] / static_cast<double>(size.Columns * (size.Rows - 1)));
  this->MakeBlocks();
  this->MakeBins();
}

//------------------------------------------------------------------------------
void MillSurface::CheckTriangles() const
{
  const double extent =
    std::max(this->Highest[0] - this->Lowest[0], this->Highest[1] - this->Lowest[1]);
  const double sense = Area(this->At(0, 0), this->At(1, 0), this->At(1, 1)) < 0 ? -1 : 1;
  for (std::int64_t j = 0; j + 1 < this->Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < this->Size.Columns; ++i)
    {
      const Vec3& p = this->At(i, j);
      const Vec3& q = this->At(i + 1, j + 1);
      const double least = sense *
        (std::min(sense * Area(p, this->At(i + 1, j), q), sense * Area(p, q, this->At(i, j + 1))));
      if (!(std::abs(least) > 1e-12 * extent * extent))
      {
        ThrowAt(i, j,
          "the surface is upright or has no area, so that the mill, which looks along -z, cannot "
          "see it,",
          &p);
      }
      if (least * sense < 0)
      {
        ThrowAt(i, j,
          "the surface folds back: the mill, which looks along -z, sees more than one layer of it",
          &p);
      }
    }
  }
}

//------------------------------------------------------------------------------
void MillSurface::MakeBlocks()
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto cellColumns = static_cast<std::int32_t>(this->Size.Columns - 1);
  const auto cellRows = static_cast<std::int32_t>(this->Size.Rows - 1);
  for (std::int32_t row = 0; row < cellRows; row += BlockSize)
  {
    for (std::int32_t column = 0; column < cellColumns; column += BlockSize)
    {
      Vec3 low = this->At(column, row);
      Vec3 high = low;
      for (std::int32_t j = row; j <= std::min(row + BlockSize, cellRows); ++j)
      {
        for (std::int32_t i = column; i <= std::min(column + BlockSize, cellColumns); ++i)
        {
          for (int c = 0; c < 3; ++c)
          {
            low[c] = std::min(low[c], this->At(i, j)[c]);
            high[c] = std::max(high[c], this->At(i, j)[c]);
          }
        }
      }
      Block block{ column, row, { 0, 0 }, { 0, 0 }, high[2] };
      for (int c = 0; c < 2; ++c)
      {
        block.Low[c] = std::nextafter(static_cast<float>(low[c]), -infinity);
        block.High[c] = std::nextafter(static_cast<float>(high[c]), infinity);
      }
      this->Blocks.push_back(block);
    }
  }
}

//------------------------------------------------------------------------------
MillSurface::BinRange MillSurface::GetBins(const Vec2& low, const Vec2& high) const
{
  BinRange range{};
  for (int c = 0; c < 2; ++c)
  {
    const auto bin = [&](double x)
    {
      const double index = std::floor((x - this->Lowest[c]) / this->BinSize[c]);
      return static_cast<std::int32_t>(std::clamp(index, 0.0, double(this->Bins[c] - 1)));
    };
    range.First[c] = bin(low[c]);
    range.Last[c] = bin(high[c]);
  }
  return range;
}

//------------------------------------------------------------------------------
void MillSurface::MakeBins()
{
  // about one block a bin
  const double extent[2] = { this->Highest[0] - this->Lowest[0],
    this->Highest[1] - this->Lowest[1] };
  const auto blocks = static_cast<double>(this->Blocks.size());
  const double side = std::sqrt(extent[0] * extent[1] / blocks);
  for (int c = 0; c < 2; ++c)
  {
    const double wanted = std::clamp(std::ceil(extent[c] / side), 1.0, 4 * blocks);
    this->Bins[c] = static_cast<std::int32_t>(std::min(wanted, 32768.0));
    this->BinSize[c] = extent[c] / this->Bins[c];
  }
  std::vector<BinRange> ranges;
  ranges.reserve(this->Blocks.size());
  this->BinStarts.assign(std::size_t(this->Bins[0]) * this->Bins[1] + 1, 0);
  const auto forEachBin = [this](const BinRange& range, const auto& body)
  {
    for (std::int32_t v = range.First[1]; v <= range.Last[1]; ++v)
    {
      for (std::int32_t u = range.First[0]; u <= range.Last[0]; ++u)
      {
        body(u + std::int64_t{ this->Bins[0] } * v);
      }
    }
  };
  for (const Block& block : this->Blocks)
  {
    ranges.push_back(
      this->GetBins({ block.Low[0], block.Low[1] }, { block.High[0], block.High[1] }));
    forEachBin(ranges.back(), [this](std::int64_t bin) { ++this->BinStarts[bin + 1]; });
  }
  for (std::size_t k = 1; k < this->BinStarts.size(); ++k)
  {
    this->BinStarts[k] += this->BinStarts[k - 1];
  }
  std::vector<std::int64_t> next = this->BinStarts;
  this->Entries.resize(this->BinStarts.back());
  for (std::size_t b = 0; b < this->Blocks.size(); ++b)
  {
    const BinRange& range = ranges[b];
    forEachBin(range,
      [&](std::int64_t bin)
      {
        this->Entries[next[bin]++] = { static_cast<std::int32_t>(b),
          { range.First[0], range.First[1] } };
      });
  }
}

//------------------------------------------------------------------------------
std::vector<Vec3> MillSurface::GetNormals() const
{
  std::vector<Vec3> normals(this->Points.size(), Vec3{ 0, 0, 0 });
  const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c)
  {
    const std::int64_t corners[3] = { a, b, c };
    const Vec3 n =
      Normalized(Cross(this->Points[b] - this->Points[a], this->Points[c] - this->Points[a]));
    for (int k = 0; k < 3; ++k)
    {
      const std::int64_t p = corners[k];
      normals[p] = normals[p] +
        Angle(
          this->Points[p], this->Points[corners[(k + 1) % 3]], this->Points[corners[(k + 2) % 3]]) *
          (n[2] < 0 ? -1.0 : 1.0) * n;
    }
  };
  const std::int64_t columns = this->Size.Columns;
  for (std::int64_t j = 0; j + 1 < this->Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < columns; ++i)
    {
      const std::int64_t p = i + columns * j;
      add(p, p + 1, p + columns + 1);
      add(p, p + columns + 1, p + columns);
    }
  }
  for (Vec3& n : normals)
  {
    n = Normalized(n);
  }
  return normals;
}
}
