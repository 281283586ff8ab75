// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Walks the voxels of a convex region row by row.
#ifndef lacunaVoxelRegion_h
#define lacunaVoxelRegion_h

#include "lacunaAffineFunction.h"

#include <array>
#include <cstdint>

namespace lacuna
{
/// A closed interval of indices, empty when First > Last.
struct IndexInterval
{
  std::int64_t First = 0;
  std::int64_t Last = -1;

  bool IsEmpty() const { return this->First > this->Last; }
};

/// The voxels (i, j, k) at which a few affine functions are all >= 0. Which voxels belong to it
/// does not depend on the intervals it is asked for.
class VoxelRegion
{
public:
  static constexpr int MaximumNumberOfFunctions = 12;

  /// The voxels of one layer k.
  class Layer
  {
  public:
    /// Rows j that may have voxels; rows outside of it have none.
    IndexInterval GetRows() const { return this->Rows; }
    /// The voxels i of row j, cut to columns (First >= 0).
    IndexInterval GetRow(std::int64_t j, IndexInterval columns) const
    {
      const auto row = static_cast<double>(j);
      for (int n = 0; n < this->NumberOfFixed; ++n)
      {
        if (this->Fixed[n].At(row) < 0)
        {
          return {};
        }
      }
      auto low = static_cast<double>(columns.First);
      auto high = static_cast<double>(columns.Last);
      for (int n = 0; n < this->NumberOfLower; ++n)
      {
        const double bound = this->Lower[n].At(row);
        low = bound > low ? bound : low;
      }
      for (int n = 0; n < this->NumberOfUpper; ++n)
      {
        const double bound = this->Upper[n].At(row);
        high = bound < high ? bound : high;
      }
      if (low > high)
      {
        return {};
      }
      const auto first = static_cast<std::int64_t>(low);
      return { first + (static_cast<double>(first) < low ? 1 : 0),
        static_cast<std::int64_t>(high) };
    }

  private:
    friend class VoxelRegion;

    /// A bound of i that moves evenly from row to row.
    struct Bound
    {
      double Start, Step;
      double At(double j) const { return this->Start + this->Step * j; }
    };
    void NarrowRows(double constant, double step);

    IndexInterval Rows;
    int NumberOfLower = 0;
    int NumberOfUpper = 0;
    int NumberOfFixed = 0;
    std::array<Bound, MaximumNumberOfFunctions> Lower;
    std::array<Bound, MaximumNumberOfFunctions> Upper;
    /// Functions that do not change along a row.
    std::array<Bound, MaximumNumberOfFunctions> Fixed;
  };

  /// Cuts the region to where f >= 0.
  void Add(const AffineFunction& f);
  /// Layer k, its rows cut to rows (First >= 0).
  Layer GetLayer(std::int64_t k, IndexInterval rows) const;

private:
  int NumberOfFunctions = 0;
  std::array<AffineFunction, MaximumNumberOfFunctions> Functions;
};
}
#endif
