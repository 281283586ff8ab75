// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAdaptiveMedian.h"

#include "lacunaOrderedKey.h"
#include "lacunaRankBlocks.h"
#include "lacunaRankTile.h"
#include "lacunaScalarType.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double CentralWeight = 99;

/// The samples of a window: how far from its corner in a block of given size, how far from its
/// centre.
struct Neighbours
{
  std::vector<std::ptrdiff_t> Offset;
  std::vector<double> Distance;
  std::vector<int> IndexAt; ///< by place in the window's box, x fastest; -1 outside of the window
  std::ptrdiff_t Centre;

  Neighbours(const Window& window, const int size[3])
    : IndexAt(std::size_t(window.GetSize(0)) * window.GetSize(1) * window.GetSize(2), -1)
  {
    const auto offset = [size](int x, int y, int z)
    { return (std::ptrdiff_t(z) * size[1] + y) * size[0] + x; };
    this->Centre = offset(window.Lower(0), window.Lower(1), window.Lower(2));
    for (const Window::Run& run : window.GetRuns())
    {
      for (int x = run.Begin; x < run.End; ++x)
      {
        this->IndexAt[(std::size_t(run.Z) * window.GetSize(1) + run.Y) * window.GetSize(0) + x] =
          static_cast<int>(this->Offset.size());
        this->Offset.push_back(offset(x, run.Y, run.Z));
        const double dx = x - window.Lower(0);
        const double dy = run.Y - window.Lower(1);
        const double dz = run.Z - window.Lower(2);
        this->Distance.push_back(std::sqrt(dx * dx + dy * dy + dz * dz));
      }
    }
  }
};

template <class T>
class BlockFilter
{
public:
  using Key = KeyOf<T>;

  BlockFilter(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
    double strength)
    : Input(input)
    , Output(output)
    , Shape(window)
    , Strength(strength)
  {
  }

  void Filter(const Extent& block)
  {
    const Extent grown = this->Shape.Grow(block);
    const int size[3] = { SizeOf(grown, 0), SizeOf(grown, 1), SizeOf(grown, 2) };
    this->Keys.resize(NumberOfSamples(grown));
    CopyReplicated(this->Input, grown, this->Keys.data(), OrderedKey<T>::From);
    this->Values.resize(this->Keys.size());
    std::transform(this->Keys.begin(), this->Keys.end(), this->Values.begin(),
      [](Key key) { return static_cast<double>(OrderedKey<T>::To(key)); });
    this->Tile.Assign(this->Keys.data(), size, std::is_floating_point_v<T>);
    const Neighbours neighbours(this->Shape, size);
    for (int z = block[4]; z <= block[5]; ++z)
    {
      for (int y = block[2]; y <= block[3]; ++y)
      {
        for (int x = block[0]; x <= block[1]; ++x)
        {
          const int corner[3] = { x - block[0], y - block[2], z - block[4] };
          *this->Output.At(x, y, z) = OrderedKey<T>::To(this->Find(neighbours, corner));
        }
      }
    }
  }

private:
  Key Find(const Neighbours& neighbours, const int corner[3])
  {
    const std::size_t first =
      (std::size_t(corner[2]) * this->Tile.Size[1] + corner[1]) * this->Tile.Size[0] + corner[0];
    const Key centre = this->Keys[first + neighbours.Centre];
    const std::size_t n = neighbours.Offset.size();
    const double c = this->Values[first + neighbours.Centre];
    if (c != c)
    {
      return centre;
    }
    // Differences from the centre, so that no digits cancel when values are large and alike.
    double count = 0;
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const double d = this->Values[first + neighbours.Offset[i]] - c;
      if (!std::is_floating_point_v<T> || d == d)
      {
        count += 1;
        sum += d;
        squares += d * d;
      }
    }
    const double mean = c + sum / count;
    const double variance = std::max(0.0, (squares - sum * sum / count) / count);
    const double slope =
      variance > 0 && this->Strength > 0 ? this->Strength * variance / std::abs(mean) : 0;
    if (!std::isfinite(slope))
    {
      return centre;
    }

    this->Weights.resize(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      const double w = CentralWeight - slope * neighbours.Distance[i] + 0.5;
      this->Weights[i] = w > 0 ? static_cast<int>(w) : 0;
    }
    this->Levels.assign(this->Tile.Levels, 0);
    std::int64_t total = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const std::size_t at = first + neighbours.Offset[i];
      if (!std::is_floating_point_v<T> || this->Values[at] == this->Values[at])
      {
        this->Levels[this->Tile.Level[at]] += this->Weights[i];
        total += this->Weights[i];
      }
    }
    std::int64_t half = total / 2;
    int level = 0;
    while (half >= this->Levels[level])
    {
      half -= this->Levels[level++];
    }
    return this->Tile.GetKey(this->Tile.Exact ? static_cast<std::uint32_t>(level)
                                              : this->FindInLevel(neighbours, corner, level, half));
  }

  /// The first place of level at which the weights in the window exceed half.
  std::uint32_t FindInLevel(
    const Neighbours& neighbours, const int corner[3], int level, std::int64_t half) const
  {
    for (std::uint32_t place = this->Tile.First[level];; ++place)
    {
      std::size_t index = 0;
      bool inside = true;
      for (int a = 2; a >= 0; --a)
      {
        const int i = this->Tile.Position[a][place] - corner[a];
        inside = inside && i >= 0 && i < this->Shape.GetSize(a);
        index = index * this->Shape.GetSize(a) + i;
      }
      const int neighbour = inside ? neighbours.IndexAt[index] : -1;
      if (neighbour >= 0)
      {
        half -= this->Weights[neighbour];
        if (half < 0)
        {
          return place;
        }
      }
    }
  }

  const ImageView<const T>& Input;
  const ImageView<T>& Output;
  const Window& Shape;
  double Strength;
  std::vector<Key> Keys;
  std::vector<double> Values;
  std::vector<int> Weights;
  std::vector<std::int64_t> Levels;
  SortedTile<Key> Tile;
};
}

template <class T>
void FilterAdaptiveMedian(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, double strength, Execution& execution)
{
  if (!(strength >= 0) || !std::isfinite(strength))
  {
    throw std::invalid_argument("the adaptive strength is " + std::to_string(strength) +
      "; it must be a finite number, 0 or more");
  }
  RequireRankable(window);
  FilterBlocks(output.Box, ChooseExhaustiveBlock(window, sizeof(T)), execution,
    [&] { return std::make_unique<BlockFilter<T>>(input, output, window, strength); });
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterAdaptiveMedian(                                                              \
    const ImageView<const T>&, const ImageView<T>&, const Window&, double, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
