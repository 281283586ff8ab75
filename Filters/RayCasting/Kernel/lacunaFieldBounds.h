// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bounds of a field over blocks of cells, for skipping what holds no surface.
#ifndef lacunaFieldBounds_h
#define lacunaFieldBounds_h

#include "lacunaExecution.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Least and greatest voxel in the support of each block of 4^3 and of 16^3 cells. Since B-splines
/// and trilinear fields stay in the convex hull of their control points, and linear extrapolation
/// at the border adds nothing to that hull inside the volume, these bound the field. Memory: some
/// 3 % of the voxels'.
///
/// Voxels that are not finite count as unbounded here; a block that has one is never skipped.
template <class T>
class FieldBounds
{
public:
  struct Level
  {
    int Shift; ///< a block is 2^Shift cells wide
    std::array<int, 3> Blocks;
    std::vector<T> Bounds; ///< minimum, maximum; x fastest

    std::size_t IndexOf(int i, int j, int k) const
    {
      return 2 *
        (i +
          static_cast<std::size_t>(this->Blocks[0]) *
            (j + static_cast<std::size_t>(this->Blocks[1]) * k));
    }
  };

  /// The support of a cell reaches from before voxels below its first voxel to after above it.
  FieldBounds(
    const T* voxels, const std::array<int, 3>& size, int before, int after, Execution& execution);

  const Level& GetFine() const { return this->Fine; }
  const Level& GetCoarse() const { return this->Coarse; }
  /// Over the finite voxels; Minimum > Maximum when there is none.
  double GetMinimum() const { return this->Minimum; }
  double GetMaximum() const { return this->Maximum; }
  std::int64_t GetNumberOfNonFinite() const { return this->NumberOfNonFinite; }

private:
  void FindRange(const T* voxels, const std::array<int, 3>& size, Execution& execution);
  void Build(
    const T* voxels, const std::array<int, 3>& size, int before, int after, Execution& execution);
  /// layer: of the coarse blocks; its fine ones must be there.
  void BuildCoarse(int layer);

  Level Fine;
  Level Coarse;
  double Minimum;
  double Maximum;
  std::int64_t NumberOfNonFinite = 0;
};
}
#endif
