// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Counts of levels in a window of any shape that slides over a RankTile: each step along x takes
/// away one sample of each run of the window and adds one (Huang 1979), so the cost grows with the
/// number of runs. Same interface for queries as BoxCounts.
#ifndef lacunaEllipsoidCounts_h
#define lacunaEllipsoidCounts_h

#include "lacunaRankTile.h"
#include "lacunaWindow.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
class EllipsoidCounts
{
public:
  EllipsoidCounts(const RankTile& tile, const Window& window)
    : Tile(tile)
    , Size(window.GetSize())
    , Runs(window.GetRuns())
    , RunAt(std::size_t(Size[1]) * Size[2], nullptr)
  {
    for (const Window::Run& run : this->Runs)
    {
      this->RunAt[std::size_t(run.Z) * this->Size[1] + run.Y] = &run;
    }
  }

  /// Counts the window whose lowest corner is at (x, y, z), from the one at x - 1 unless x is 0.
  void MoveTo(int x, int y, int z)
  {
    this->Corner = { x, y, z };
    if (x == 0)
    {
      this->Levels.fill(0);
      this->Groups.fill(0);
    }
    for (const Window::Run& run : this->Runs)
    {
      const std::uint8_t* row = this->Tile.Level.data() +
        (std::size_t(z + run.Z) * this->Tile.Size[1] + y + run.Y) * this->Tile.Size[0] + x;
      if (x == 0)
      {
        for (int i = run.Begin; i < run.End; ++i)
        {
          this->Add(row[i], 1);
        }
      }
      else
      {
        this->Add(row[run.Begin - 1], -1);
        this->Add(row[run.End - 1], 1);
      }
    }
  }

  int FindLevel(std::int64_t k) const
  {
    int group = 0;
    while (k >= this->Groups[group])
    {
      k -= this->Groups[group++];
    }
    int level = 16 * group;
    while (k >= this->Levels[level])
    {
      k -= this->Levels[level++];
    }
    return level;
  }

  std::int64_t Below(int level) const
  {
    std::int64_t n = 0;
    for (int group = 0; group < level / 16; ++group)
    {
      n += this->Groups[group];
    }
    for (int l = level / 16 * 16; l < level; ++l)
    {
      n += this->Levels[l];
    }
    return n;
  }

  std::uint32_t Find(int level, std::int64_t k) const
  {
    std::uint32_t place = this->Tile.First[level];
    while (!this->Holds(place) || k-- > 0)
    {
      ++place;
    }
    return place;
  }

  std::int64_t CountUntil(int level, std::uint32_t end) const
  {
    std::int64_t n = 0;
    for (std::uint32_t place = this->Tile.First[level]; place < end; ++place)
    {
      n += this->Holds(place);
    }
    return n;
  }

private:
  void Add(std::uint8_t level, int n)
  {
    this->Levels[level] += n;
    this->Groups[level / 16] += n;
  }

  /// True when the sample at place lies in the window.
  bool Holds(std::uint32_t place) const
  {
    const int x = this->Tile.Position[0][place] - this->Corner[0];
    const int y = this->Tile.Position[1][place] - this->Corner[1];
    const int z = this->Tile.Position[2][place] - this->Corner[2];
    if (y < 0 || y >= this->Size[1] || z < 0 || z >= this->Size[2])
    {
      return false;
    }
    const Window::Run* run = this->RunAt[std::size_t(z) * this->Size[1] + y];
    return run && x >= run->Begin && x < run->End;
  }

  const RankTile& Tile;
  const std::array<int, 3> Size;
  const std::vector<Window::Run>& Runs;
  std::vector<const Window::Run*> RunAt; ///< by (z, y); null where the window has none
  std::array<int, 3> Corner{};
  std::array<int, 256> Levels{};
  std::array<int, 16> Groups{};
};
}
#endif
