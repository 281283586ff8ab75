// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRankTile.h"

#include "lacunaOrderedKey.h"

#include <algorithm>
#include <array>

namespace lacuna
{
namespace
{
// How many levels make the search cheapest: counting costs a step for each level, going through a
// run one for each of half its places, 32 of them at a time.
int ChooseLevels(std::size_t samples)
{
  return samples < 4000 ? 64 : samples < 20000 ? 128 : 256;
}
}

template <class Key>
void SortedTile<Key>::Assign(const Key* keys, const int size[3], bool floating)
{
  const std::size_t n = std::size_t(size[0]) * size[1] * size[2];
  std::copy(size, size + 3, this->Size);
  const auto [least, greatest] = std::minmax_element(keys, keys + n);
  this->Lowest = *least;
  const Key span = static_cast<Key>(*greatest - *least);
  this->Exact = span < 256 && !(floating && *greatest == std::numeric_limits<Key>::max());
  this->Level.resize(n);
  if (this->Exact)
  {
    this->Places = this->Numbers = static_cast<std::uint32_t>(span) + 1;
    this->Levels = (static_cast<int>(span) / Padding + 1) * Padding;
    std::transform(keys, keys + n, this->Level.begin(),
      [this](Key key) { return static_cast<std::uint8_t>(key - this->Lowest); });
    return;
  }

  this->Places = static_cast<std::uint32_t>(n);
  this->Levels = ChooseLevels(n);
  this->Sorted.resize(n);
  std::size_t i = 0;
  Key differing = 0; // bits
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x, ++i)
      {
        this->Sorted[i] = { keys[i], static_cast<std::uint32_t>(x | y << 8 | z << 16) };
        differing = static_cast<Key>(differing | (keys[i] ^ keys[0]));
      }
    }
  }
  this->Sort(differing);

  for (auto& position : this->Position)
  {
    position.resize(n + Padding);
  }
  this->First.resize(this->Levels + 1);
  for (int level = 0; level <= this->Levels; ++level)
  {
    // The least place p with p * Levels / Places >= level.
    this->First[level] =
      static_cast<std::uint32_t>((std::uint64_t(level) * n + this->Levels - 1) / this->Levels);
  }
  for (int level = 0; level < this->Levels; ++level)
  {
    for (std::uint32_t p = this->First[level]; p < this->First[level + 1]; ++p)
    {
      const std::uint32_t where = this->Sorted[p].Position;
      const std::uint32_t x = where & 255;
      const std::uint32_t y = where >> 8 & 255;
      const std::uint32_t z = where >> 16;
      this->Position[0][p] = static_cast<std::uint8_t>(x);
      this->Position[1][p] = static_cast<std::uint8_t>(y);
      this->Position[2][p] = static_cast<std::uint8_t>(z);
      this->Level[(std::size_t(z) * size[1] + y) * size[0] + x] = static_cast<std::uint8_t>(level);
    }
  }
  this->Numbers = floating ? this->LowerBound(std::numeric_limits<Key>::max()) : this->Places;
}

// Radix sort from the lowest digit, which keeps the order of equal keys; digits that all keys
// share are passed over.
template <class Key>
void SortedTile<Key>::Sort(Key differing)
{
  constexpr int DigitBits = sizeof(Key) == 4 ? 11 : 8;
  constexpr int Buckets = 1 << DigitBits;
  this->Spare.resize(this->Sorted.size());
  for (int shift = 0; shift < static_cast<int>(8 * sizeof(Key)); shift += DigitBits)
  {
    const auto digit = [shift](Key key) { return (key >> shift) & (Buckets - 1); };
    if (digit(differing) == 0)
    {
      continue;
    }
    std::array<std::uint32_t, Buckets> next{};
    for (const Entry& entry : this->Sorted)
    {
      ++next[digit(entry.Value)];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& count : next)
    {
      const std::uint32_t begin = sum;
      sum += count;
      count = begin;
    }
    for (const Entry& entry : this->Sorted)
    {
      this->Spare[next[digit(entry.Value)]++] = entry;
    }
    this->Sorted.swap(this->Spare);
  }
}

template <class Key>
std::uint32_t SortedTile<Key>::LowerBound(Key key) const
{
  if (this->Exact)
  {
    const Key greatest = static_cast<Key>(this->Lowest + (this->Places - 1));
    return key <= this->Lowest ? 0
      : key > greatest         ? this->Places
                               : static_cast<std::uint32_t>(key - this->Lowest);
  }
  return static_cast<std::uint32_t>(
    std::lower_bound(this->Sorted.begin(), this->Sorted.end(), key,
      [](const Entry& entry, Key value) { return entry.Value < value; }) -
    this->Sorted.begin());
}

template <class Key>
std::uint32_t SortedTile<Key>::UpperBound(Key key) const
{
  return key == std::numeric_limits<Key>::max() ? this->Places
                                                : this->LowerBound(static_cast<Key>(key + 1));
}

template class SortedTile<std::uint8_t>;
template class SortedTile<std::uint16_t>;
template class SortedTile<std::uint32_t>;
template class SortedTile<std::uint64_t>;
}
