// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A block of samples sorted for ranking.
#ifndef lacunaRankTile_h
#define lacunaRankTile_h

#include "lacunaImageView.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// What ranking needs to know of the samples of a block, whatever their type.
///
/// Each sample falls in one of Levels levels, a byte. Where the values of the block span at most
/// 256 steps (8-bit data always) a level is a value and the *place* of a sample is its level.
/// Otherwise the samples are sorted (equal ones in the order of their positions), the place is the
/// index in that order and a level is a run of consecutive places, all runs equally long: the rank
/// of a window is found by counting levels, then by going through one short run.
struct RankTile
{
  /// A power of two at least as long as any vector, so that levels and runs are read in vectors.
  static constexpr int Padding = 64;

  int Size[3];
  int Levels;                      ///< a multiple of Padding, at most 256
  std::vector<std::uint8_t> Level; ///< of each sample, x fastest
  bool Exact;                      ///< a level is a value
  std::uint32_t Places;            ///< number of places
  std::uint32_t Numbers;           ///< the places before this one are numbers, the others NaN

  // Unless Exact:
  std::vector<std::uint32_t> First;      ///< place where each level begins, and the end
  std::vector<std::uint8_t> Position[3]; ///< of the sample at each place, padded
  std::uint32_t LevelOf(std::uint32_t place) const
  {
    return this->Exact
      ? place
      : static_cast<std::uint32_t>(std::uint64_t(place) * this->Levels / this->Places);
  }
  bool HasNaN() const { return this->Numbers < this->Places; }
};

/// A tile together with the values, Key being one of OrderedKey's types.
template <class Key>
class SortedTile : public RankTile
{
public:
  /// Sorts keys, size samples with x fastest. Unless all values lie within 256 steps no size may
  /// exceed 256. floating says that the greatest key means NaN.
  void Assign(const Key* keys, const int size[3], bool floating);

  Key GetKey(std::uint32_t place) const
  {
    return this->Exact ? static_cast<Key>(this->Lowest + place) : this->Sorted[place].Value;
  }
  /// The first place whose key is not below (strictly: above) key.
  std::uint32_t LowerBound(Key key) const;
  std::uint32_t UpperBound(Key key) const;

private:
  struct Entry
  {
    Key Value;
    std::uint32_t Position; ///< x + 256 y + 65536 z
  };
  void Sort(Key differing);

  Key Lowest = 0;
  std::vector<Entry> Sorted;
  std::vector<Entry> Spare;
};
}
#endif
