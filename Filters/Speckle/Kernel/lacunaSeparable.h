// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Filters that work along x, then y, then z.
///
/// The work along an axis is done on a flat array in which neighbours along that axis are `shift`
/// elements apart: whole rows and slices are one long vector loop, whatever the axis. The type of
/// the image's samples is hidden behind functions of whole rows, so that the steps are compiled for
/// each type of sums only.
#ifndef lacunaSeparable_h
#define lacunaSeparable_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaWindow.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace lacuna
{
/// How far a separable filter looks along each axis.
struct Reach
{
  std::array<int, 3> Lower;
  std::array<int, 3> Upper;

  explicit Reach(const Window& window)
    : Lower{ window.Lower(0), window.Lower(1), window.Lower(2) }
    , Upper{ window.Upper(0), window.Upper(1), window.Upper(2) }
  {
  }
  explicit Reach(const std::array<int, 3>& radii)
    : Lower(radii)
    , Upper(radii)
  {
  }

  bool Along(int axis) const { return this->Lower[axis] + this->Upper[axis] > 0; }
  /// The box that results in box depend on, along some axes; it ends where the integers do.
  Extent Grow(const Extent& box, bool xy, bool z) const
  {
    Extent grown = box;
    for (int a = 0; a < 3; ++a)
    {
      if (a < 2 ? xy : z)
      {
        lacuna::Grow(grown, a, this->Lower[a], this->Upper[a]);
      }
    }
    return grown;
  }
};

/// What a separable filter of sums S is made of.
template <class S>
struct SeparableSteps
{
  /// The samples of a box, which may reach outside of the image, as CopyReplicated gives them.
  std::function<void(const Extent& box, S* to)> Load;
  /// Replaces data[i], i < count, by what it computes from data[i], data[i + shift], ...
  /// data[i + n * shift], n being the reach along axis; spare is memory to use.
  std::function<void(
    int axis, S* data, std::int64_t count, std::int64_t shift, std::vector<S>& spare)>
    Along;
  /// Takes the results x0 ... x1 of a row.
  std::function<void(const S* row, int x0, int x1, int y, int z)> Store;
};

/// Filters box of an image whose samples lie in inputBox. The steps run in several threads at once.
/// S: 1, 2, 4 or 8 byte unsigned integers, unsigned __int128, float or double.
template <class S>
void FilterSeparably(const Extent& inputBox, const Extent& box, const Reach& reach,
  const SeparableSteps<S>& steps, Execution& execution);
}
#endif
