// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Keeps a volume while its sweeps grow.
#ifndef lacunaGrowingVolume_h
#define lacunaGrowingVolume_h

#include "lacunaSliceFingerprint.h"
#include "lacunaSweptVolume.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
/// A swept volume that is asked for again and again. When the slices are those of the last time and
/// some more at the end of the last sweep (or new sweeps), and grid, extent and options are the
/// same, only what is new is added to the volume of the last time. Else it is made anew. The result
/// is the same bit by bit in either case.
///
/// Slices are the same when their poses, windows, types and fans are equal, number by number, and
/// the hashes of their pixels are (lacunaSliceFingerprint.h). Neither addresses nor times of
/// modification are trusted: sources reuse their memory, and copy it.
///
/// A volume is kept, and pixels are hashed, only if growth is expected, or when the slices grew for
/// the first time: so what does not grow costs neither memory nor time.
class GrowingVolume
{
public:
  /// The slices of each sweep, in order.
  using Sweeps = std::vector<const std::vector<SliceImage>*>;

  /// Brings the volume up to date. isGrowing: growth is expected. Pixels are not needed any more
  /// when it returns. Progress covers first..last of the whole. Throws what SweptVolume throws;
  /// nothing is kept then. The result is valid until the next call of any method.
  const SweptVolume& Update(const Sweeps& sweeps, const VolumeGrid& grid,
    const std::array<int, 6>& extent, const SweptVolume::Options& options, bool isGrowing,
    Execution& execution, double first = 0, double last = 1);

  /// Slices that the last update worked on: the new ones, or all.
  std::int64_t GetNumberOfSlicesAdded() const { return this->Added; }

  /// What is kept, which the next update uses or frees before it needs more.
  double GetBytes() const;

  /// Frees the volume, unless it is to be kept. Call it when the volume is written.
  void Finish();

private:
  struct Record
  {
    std::size_t Sweep = 0;
    SliceFingerprint Slice; ///< with its pixels when IsKept
  };
  static std::vector<Record> MakeRecords(const Sweeps& sweeps);
  bool HasPixelsOf(const std::vector<const SliceImage*>& slices, Execution& execution) const;

  std::unique_ptr<SweptVolume> Volume;
  std::vector<Record> Records; ///< of the slices in the volume, or of the last time
  bool IsKept = false;
  VolumeGrid Grid;
  std::array<int, 6> Extent{};
  SweptVolume::Options Options;
  std::int64_t Added = 0;
};
}
#endif
