// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRankFilter.h"

#include "lacunaBoxSlide.h"
#include "lacunaEllipsoidCounts.h"
#include "lacunaMedianNetwork.h"
#include "lacunaOrderedKey.h"
#include "lacunaRankBlocks.h"
#include "lacunaRankQuery.h"
#include "lacunaScalarType.h"

#include <memory>
#include <vector>

namespace lacuna
{
namespace
{
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
