// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice at a coarser resolution, for showing it.
#ifndef lacunaSliceLattice_h
#define lacunaSliceLattice_h

#include "lacunaScalarType.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// Every step-th pixel of a picture along both axes, the last ones of each axis included, so that
/// the lattice covers the picture from the first to the last pixel centre.
class SliceLattice
{
public:
  /// At least 1 pixel and a step of at least 1; step 1 is the picture itself.
  SliceLattice(int width, int height, int step);

  /// The smallest step with which slices pictures have at most most points together (at least the
  /// corners of each are kept).
  static int ChooseStep(int width, int height, std::int64_t slices, std::int64_t most);

  int GetStep() const { return this->Step; }
  /// Positions of the lattice's points in pixels, ascending.
  const std::vector<int>& GetColumns() const { return this->Columns; }
  const std::vector<int>& GetRows() const { return this->Rows; }
  std::int64_t GetNumberOfPoints() const
  {
    return static_cast<std::int64_t>(this->Columns.size()) *
      static_cast<std::int64_t>(this->Rows.size());
  }

  /// The picture at the lattice's points, row by row: means over step x step pixels, so that
  /// speckle averages out instead of aliasing. Nearer to an edge than half a step the box shrinks
  /// towards its centre: grey levels that are linear in the picture are reproduced exactly
  /// everywhere. pixels are width * height numbers of the type.
  void Reduce(ScalarType type, const void* pixels, float* levels) const;

private:
  int Width, Height, Step;
  std::vector<int> Columns, Rows;
};
}
#endif
