// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRankFilter.h"

#include "lacunaBoxSlide.h"
#include "lacunaMedianNetwork.h"
#include "lacunaOrderedKey.h"
#include "lacunaRankBlocks.h"
#include "lacunaRankTile.h"
#include "lacunaScalarType.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
// What a rank filter asks the counts of a window (BoxCounts or EllipsoidCounts) for.

// The 0-based rank that parameters mean among n samples.
inline std::int64_t RankAmong(std::int64_t n, const RankParameters& parameters)
{
  return std::min<std::int64_t>(
    n - 1, static_cast<std::int64_t>(static_cast<double>(n) * parameters.Percentile / 100));
}

// Where results go: the place of the result of each window, x fastest.
struct RankResults
{
  int Size[2]; // windows along x and y
  std::uint32_t* Places;

  std::uint32_t& At(int x, int y, int z) const
  {
    return this->Places[(std::size_t(z) * this->Size[1] + y) * this->Size[0] + x];
  }
};

// The place of the k-th sample (0-based) in the window.
template <class Counts>
LACUNA_INLINE std::uint32_t SelectInLevel(
  const Counts& counts, const RankTile& tile, int level, std::int64_t k)
{
  return tile.Exact ? static_cast<std::uint32_t>(level)
                    : counts.Find(level, k - counts.Below(level));
}

// One rank, the same in all windows.
struct FixedRankQuery
{
  const RankTile& Tile;
  RankResults Results;
  std::int64_t Rank;

  template <class Counts>
  LACUNA_INLINE void Visit(const Counts& counts, int x, int y, int z, int level)
  {
    this->Results.At(x, y, z) = SelectInLevel(counts, this->Tile, level, this->Rank);
  }
};

// Which samples a truncated median keeps: [first, second) of the places.
class Truncation
{
public:
  virtual ~Truncation() = default;
  virtual std::pair<std::uint32_t, std::uint32_t> Keep(
    std::uint32_t least, std::uint32_t median, std::uint32_t greatest) const = 0;
};

// Any rank query, also where NaN is about and for the mode.
struct GeneralRankQuery
{
  const RankTile& Tile;
  RankResults Results;
  const RankParameters& Parameters;
  std::int64_t Samples; // in a window
  const Truncation& Mode;

  template <class Counts>
  LACUNA_INLINE void Visit(const Counts& counts, int x, int y, int z, int)
  {
    const std::int64_t n = this->CountBefore(counts, this->Tile.Numbers);
    std::uint32_t& place = this->Results.At(x, y, z);
    if (n == 0)
    {
      place = this->Tile.Numbers; // all NaN
      return;
    }
    if (!this->Parameters.Mode)
    {
      place = this->Select(counts, RankAmong(n, this->Parameters));
      return;
    }
    const auto kept = this->Mode.Keep(
      this->Select(counts, 0), this->Select(counts, n / 2), this->Select(counts, n - 1));
    const std::int64_t first = this->CountBefore(counts, kept.first);
    const std::int64_t last = this->CountBefore(counts, kept.second);
    place = this->Select(counts, first + (last - first) / 2);
  }

private:
  template <class Counts>
  LACUNA_INLINE std::uint32_t Select(const Counts& counts, std::int64_t k) const
  {
    return SelectInLevel(counts, this->Tile, counts.FindLevel(k), k);
  }

  // Samples of the window whose place is before the given one.
  template <class Counts>
  LACUNA_INLINE std::int64_t CountBefore(const Counts& counts, std::uint32_t place) const
  {
    if (place >= this->Tile.Places)
    {
      return this->Samples;
    }
    const int level = static_cast<int>(this->Tile.LevelOf(place));
    return counts.Below(level) + (this->Tile.Exact ? 0 : counts.CountUntil(level, place));
  }
};

//------------------------------------------------------------------------------
// Counts of levels in a window of any shape that slides over a RankTile: each step along x takes
// away one sample of each run of the window and adds one (Huang 1979), so the cost grows with the
// number of runs. Same interface for queries as BoxCounts.

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

  // Counts the window whose lowest corner is at (x, y, z), from the one at x - 1 unless x is 0.
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

  // True when the sample at place lies in the window.
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
  std::vector<const Window::Run*> RunAt; // by (z, y); null where the window has none
  std::array<int, 3> Corner{};
  std::array<int, 256> Levels{};
  std::array<int, 16> Groups{};
};

//------------------------------------------------------------------------------
template <class T>
class ValueTruncation : public Truncation
{
public:
  using Key = KeyOf<T>;

  explicit ValueTruncation(const SortedTile<Key>& tile)
    : Tile(tile)
  {
  }

  std::pair<std::uint32_t, std::uint32_t> Keep(
    std::uint32_t least, std::uint32_t median, std::uint32_t greatest) const override
  {
    const Key a = this->Tile.GetKey(least);
    const Key m = this->Tile.GetKey(median);
    const Key b = this->Tile.GetKey(greatest);
    std::pair<std::uint32_t, std::uint32_t> kept(0, this->Tile.Numbers);
    if constexpr (std::is_integral_v<T>)
    {
      // Keys of integers are as far apart as the integers.
      if (m - a < b - m)
      {
        kept.second = this->Tile.UpperBound(static_cast<Key>(m + (m - a)));
      }
      else if (m - a > b - m)
      {
        kept.first = this->Tile.LowerBound(static_cast<Key>(m - (b - m)));
      }
    }
    else
    {
      const T low = OrderedKey<T>::To(a);
      const T middle = OrderedKey<T>::To(m);
      const T high = OrderedKey<T>::To(b);
      // Halves, so that no difference of finite numbers overflows.
      const T below = middle / 2 - low / 2;
      const T above = high / 2 - middle / 2;
      if (below < above)
      {
        const T limit = middle + 2 * below;
        kept.second = this->Tile.UpperBound(OrderedKey<T>::From(limit == 0 ? T(0) : limit));
      }
      else if (below > above)
      {
        const T limit = middle - 2 * above;
        kept.first = this->Tile.LowerBound(OrderedKey<T>::From(limit == 0 ? -T(0) : limit));
      }
    }
    return kept;
  }

private:
  const SortedTile<Key>& Tile;
};

template <class Plane, class Count, class Query>
void SlideBox(
  const RankTile& tile, const Window& window, std::int64_t rank, Query& query, VectorUnit set)
{
  const std::array<int, 3> size = window.GetSize();
  using Slide = BoxSlide<Plane, Count, Query>;
  Slide slide{ tile, size.data(), rank, query };
  RunWith<Slide>(set, slide);
}

template <class Query>
void SlideWindow(
  const RankTile& tile, const Window& window, std::int64_t rank, Query& query, VectorUnit set)
{
  const std::int64_t samples = window.GetNumberOfSamples();
  const int plane = window.GetSize(1) * window.GetSize(2);
  if (!window.IsBox())
  {
    EllipsoidCounts counts(tile, window);
    for (int z = 0; z <= tile.Size[2] - window.GetSize(2); ++z)
    {
      for (int y = 0; y <= tile.Size[1] - window.GetSize(1); ++y)
      {
        for (int x = 0; x <= tile.Size[0] - window.GetSize(0); ++x)
        {
          counts.MoveTo(x, y, z);
          query.Visit(counts, x, y, z, counts.FindLevel(rank));
        }
      }
    }
  }
  else if (samples < 256)
  {
    SlideBox<std::uint8_t, std::int8_t>(tile, window, rank, query, set);
  }
  else if (samples < 65536 && plane < 256)
  {
    SlideBox<std::uint8_t, std::int16_t>(tile, window, rank, query, set);
  }
  else if (samples < 65536)
  {
    SlideBox<std::uint16_t, std::int16_t>(tile, window, rank, query, set);
  }
  else
  {
    SlideBox<std::uint16_t, std::int32_t>(tile, window, rank, query, set);
  }
}

/// Filters blocks of an image; keeps its memory from one to the next.
template <class T>
class BlockFilter
{
public:
  using Key = KeyOf<T>;

  BlockFilter(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
    const RankParameters& parameters)
    : Input(input)
    , Output(output)
    , Box(window)
    , Parameters(parameters)
  {
  }

  void Filter(const Extent& block)
  {
    const Extent grown = this->Box.Grow(block);
    for (int a = 0; a < 3; ++a)
    {
      this->Size[a] = SizeOf(grown, a);
    }
    const std::size_t n = NumberOfSamples(grown);
    this->Keys.resize(n + RankTile::Padding);
    CopyReplicated(this->Input, grown, this->Keys.data(), OrderedKey<T>::From);
    this->Results.resize(NumberOfSamples(block) + RankTile::Padding);

    const bool nan = std::is_floating_point_v<T> &&
      std::find(this->Keys.begin(), this->Keys.begin() + n, OrderedKey<T>::NaN) !=
        this->Keys.begin() + n;
    if (!nan && !this->Parameters.Mode && this->Parameters.Percentile == 50 &&
      HasMedianNetwork(this->Box))
    {
      FilterByNetwork(
        this->Keys.data(), this->Size, this->Box, this->Parameters.Set, this->Results.data());
    }
    else
    {
      this->Slide(block);
    }
    if (nan)
    {
      this->KeepNaN(block);
    }
    CopyInto(this->Results.data(), block, this->Output, OrderedKey<T>::To);
  }

private:
  void Slide(const Extent& block)
  {
    this->Tile.Assign(this->Keys.data(), this->Size, std::is_floating_point_v<T>);
    this->Places.resize(NumberOfSamples(block));
    const RankResults results{ { SizeOf(block, 0), SizeOf(block, 1) }, this->Places.data() };
    const std::int64_t samples = this->Box.GetNumberOfSamples();
    const std::int64_t rank = RankAmong(samples, this->Parameters);
    if (this->Parameters.Mode || this->Tile.HasNaN())
    {
      const ValueTruncation<T> truncation(this->Tile);
      GeneralRankQuery query{ this->Tile, results, this->Parameters, samples, truncation };
      SlideWindow(this->Tile, this->Box, rank, query, this->Parameters.Set);
    }
    else
    {
      FixedRankQuery query{ this->Tile, results, rank };
      SlideWindow(this->Tile, this->Box, rank, query, this->Parameters.Set);
    }
    std::transform(this->Places.begin(), this->Places.end(), this->Results.begin(),
      [this](std::uint32_t place) { return this->Tile.GetKey(place); });
  }

  void KeepNaN(const Extent& block)
  {
    Key* result = this->Results.data();
    for (int z = block[4]; z <= block[5]; ++z)
    {
      for (int y = block[2]; y <= block[3]; ++y)
      {
        for (int x = block[0]; x <= block[1]; ++x, ++result)
        {
          const T centre = *this->Input.At(x, y, z);
          *result = centre == centre ? *result : OrderedKey<T>::NaN;
        }
      }
    }
  }

  const ImageView<const T>& Input;
  const ImageView<T>& Output;
  const Window& Box;
  const RankParameters& Parameters;
  int Size[3]{};
  std::vector<Key> Keys;
  std::vector<Key> Results;
  std::vector<std::uint32_t> Places;
  SortedTile<Key> Tile;
};
}

template <class T>
void FilterRank(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
  const RankParameters& parameters, Execution& execution)
{
  RequireRankable(window);
  FilterBlocks(output.Box, ChooseRankBlock(window, sizeof(T)), execution,
    [&] { return std::make_unique<BlockFilter<T>>(input, output, window, parameters); });
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterRank(const ImageView<const T>&, const ImageView<T>&, const Window&,          \
    const RankParameters&, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
