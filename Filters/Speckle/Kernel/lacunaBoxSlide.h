// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Counts of levels in a box that slides over a RankTile, in constant time per sample.
///
/// For each window the table of all cumulative counts, #{samples <= level}, is kept. It is the sum
/// of the tables of the window's x positions ("planes"), so a step along x adds one plane and
/// takes one away; each plane is likewise a sum of columns along z; and a column changes by one
/// sample when z does. All of it is adding tables, which vectors do well, without a branch: the
/// cost depends neither on the window nor on the data. (The scheme of Perreault & Hebert 2007,
/// one dimension up, with cumulative instead of plain histograms so that a rank is found by
/// counting the levels not above it.)
#ifndef lacunaBoxSlide_h
#define lacunaBoxSlide_h

#include "lacunaBoxCounts.h"
#include "lacunaLevelTables.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lacuna
{
/// Slides a box over a tile. Plane is the unsigned type of the planes' counts (ky * kz samples at
/// most), Count the signed type that holds the window's.
template <class Plane, class Count, class Query>
struct BoxSlide
{
  const RankTile& Tile;
  const int* Size;   ///< of the window
  std::int64_t Rank; ///< looked up on the way; the queries that need others look for themselves
  Query& Visitor;    ///< Visit(counts, x, y, z, level of Rank) for each place of the window

  template <int Bytes>
  static LACUNA_INLINE void Run(BoxSlide& slide)
  {
    slide.template Slide<Bytes>();
  }

private:
  template <int Bytes>
  LACUNA_INLINE void Slide()
  {
    const int levels = this->Tile.Levels;
    const int nx = this->Tile.Size[0];
    const int ny = this->Tile.Size[1];
    const int outX = nx - this->Size[0] + 1;
    const int outY = ny - this->Size[1] + 1;
    const int outZ = this->Tile.Size[2] - this->Size[2] + 1;
    const bool deep = this->Size[2] > 1;
    AlignedTable<std::uint8_t> columns(deep ? std::size_t(nx) * ny * levels : 0);
    AlignedTable<Plane> planes(std::size_t(nx) * levels);
    AlignedTable<Plane> zeros(levels);
    AlignedTable<Count> table(levels);
    BoxCounts<Count, Bytes> counts(this->Tile, this->Size, table.data());

    for (int z = 0; z < outZ; ++z)
    {
      if (deep)
      {
        this->template MoveColumns<Bytes>(z, columns.data());
      }
      for (int y = 0; y < outY; ++y)
      {
        if (deep)
        {
          this->template MovePlanes<Bytes>(y, columns.data(), planes.data());
        }
        else
        {
          this->template MoveFlatPlanes<Bytes>(y, z, planes.data());
        }
        counts.Corner[1] = static_cast<std::uint8_t>(y);
        counts.Corner[2] = static_cast<std::uint8_t>(z);
        std::fill_n(table.data(), levels, std::numeric_limits<Count>::min());
        for (int x = 0; x < this->Size[0] - 1; ++x)
        {
          AddTable<Bytes>(table.data(), planes.data() + std::size_t(x) * levels, levels);
        }
        const Plane* out = zeros.data();
        const Plane* in = planes.data() + std::size_t(this->Size[0] - 1) * levels;
        for (int x = 0; x < outX; ++x, in += levels)
        {
          const int level = this->template Step<Bytes>(table.data(), in, out);
          counts.Corner[0] = static_cast<std::uint8_t>(x);
          this->Visitor.Visit(counts, x, y, z, level);
          out = planes.data() + std::size_t(x) * levels;
        }
      }
    }
  }

  /// Adds in, takes away out, returns the level of Rank.
  template <int Bytes>
  LACUNA_INLINE int Step(Count* table, const Plane* in, const Plane* out) const
  {
    using Counts = typename Vector<Count, Bytes>::Type;
    constexpr int Lanes = Vector<Count, Bytes>::Lanes;
    using Planes = typename Vector<Plane, Lanes * sizeof(Plane)>::Type;
    Counts above{};
    const Counts limit =
      Counts{} + static_cast<Count>(this->Rank + std::numeric_limits<Count>::min());
    for (int i = 0; i < this->Tile.Levels; i += Lanes)
    {
      Planes a, b;
      Counts c;
      LoadVector(a, in + i);
      LoadVector(b, out + i);
      LoadVector(c, table + i);
      c += __builtin_convertvector(a, Counts) - __builtin_convertvector(b, Counts);
      StoreVector(table + i, c);
      above -= (Counts)(c > limit);
    }
    return this->Tile.Levels - SumLanes<Count, Bytes>(above);
  }

  template <int Bytes>
  LACUNA_INLINE void MoveColumns(int z, std::uint8_t* columns) const
  {
    const int levels = this->Tile.Levels;
    const std::size_t slice = std::size_t(this->Tile.Size[0]) * this->Tile.Size[1];
    const std::uint8_t* first = this->Tile.Level.data();
    const int depth = this->Size[2];
    for (std::size_t i = 0; i < slice; ++i, columns += levels)
    {
      if (z == 0)
      {
        for (int k = 0; k < depth; ++k)
        {
          AddSample<Bytes>(columns, levels, first[i + k * slice]);
        }
      }
      else
      {
        ExchangeSample<Bytes>(
          columns, levels, first[i + (z + depth - 1) * slice], first[i + (z - 1) * slice]);
      }
    }
  }

  template <int Bytes>
  LACUNA_INLINE void MovePlanes(int y, const std::uint8_t* columns, Plane* planes) const
  {
    using Planes = typename Vector<Plane, Bytes>::Type;
    constexpr int Lanes = Vector<Plane, Bytes>::Lanes;
    using Columns = typename Vector<std::uint8_t, Lanes>::Type;
    const std::size_t row = std::size_t(this->Tile.Size[0]) * this->Tile.Levels;
    const int height = this->Size[1];
    if (y == 0)
    {
      std::fill(planes, planes + row, Plane(0));
    }
    const int from = y == 0 ? 0 : height - 1;
    for (int j = from; j < height; ++j)
    {
      const std::uint8_t* in = columns + (y + j) * row;
      const std::uint8_t* out = columns + (y - 1) * row;
      for (std::size_t i = 0; i < row; i += Lanes)
      {
        Planes p;
        Columns c;
        LoadVector(p, planes + i);
        LoadVector(c, in + i);
        p += __builtin_convertvector(c, Planes);
        if (y > 0)
        {
          LoadVector(c, out + i);
          p -= __builtin_convertvector(c, Planes);
        }
        StoreVector(planes + i, p);
      }
    }
  }

  /// As MovePlanes for a window of one slice: the columns are single samples.
  template <int Bytes>
  LACUNA_INLINE void MoveFlatPlanes(int y, int z, Plane* planes) const
  {
    const int levels = this->Tile.Levels;
    const int nx = this->Tile.Size[0];
    const std::uint8_t* row =
      this->Tile.Level.data() + (std::size_t(z) * this->Tile.Size[1] + y) * nx;
    if (y == 0)
    {
      std::fill(planes, planes + std::size_t(nx) * levels, Plane(0));
    }
    for (int x = 0; x < nx; ++x, planes += levels)
    {
      if (y == 0)
      {
        for (int j = 0; j < this->Size[1]; ++j)
        {
          AddSample<Bytes>(planes, levels, row[x + std::ptrdiff_t(j) * nx]);
        }
      }
      else
      {
        ExchangeSample<Bytes>(
          planes, levels, row[x + std::ptrdiff_t(this->Size[1] - 1) * nx], row[x - nx]);
      }
    }
  }
};
}
#endif
