// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelRegion.h"

#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
// A function that grows by less than this per voxel is constant for any volume that fits in memory.
constexpr double NegligibleStep = 1e-12;
// GetRow decides which voxels belong to the region; the rows are only narrowed to save time, and
// must not lose one to rounding.
constexpr double RowMargin = 0.01;
}

void VoxelRegion::Add(const AffineFunction& f)
{
  if (this->NumberOfFunctions == MaximumNumberOfFunctions)
  {
    throw std::logic_error("VoxelRegion: too many functions");
  }
  this->Functions[this->NumberOfFunctions++] = f;
}

// Keeps the rows with constant + step * j >= 0.
void VoxelRegion::Layer::NarrowRows(double constant, double step)
{
  if (std::abs(step) < NegligibleStep)
  {
    if (constant < 0)
    {
      this->Rows.Last = this->Rows.First - 1;
    }
    return;
  }
  const double zero = -constant / step;
  if (step > 0 && zero - RowMargin > static_cast<double>(this->Rows.First))
  {
    this->Rows.First = zero < static_cast<double>(this->Rows.Last) + 1
      ? static_cast<std::int64_t>(std::ceil(zero - RowMargin))
      : this->Rows.Last + 1;
  }
  else if (step < 0 && zero + RowMargin < static_cast<double>(this->Rows.Last))
  {
    this->Rows.Last = zero > static_cast<double>(this->Rows.First) - 1
      ? static_cast<std::int64_t>(std::floor(zero + RowMargin))
      : this->Rows.First - 1;
  }
}

VoxelRegion::Layer VoxelRegion::GetLayer(std::int64_t k, IndexInterval rows) const
{
  Layer layer;
  layer.Rows = rows;
  for (int n = 0; n < this->NumberOfFunctions; ++n)
  {
    const AffineFunction& f = this->Functions[n];
    const double constant = f.C + f.K * static_cast<double>(k);
    if (std::abs(f.I) < NegligibleStep)
    {
      layer.Fixed[layer.NumberOfFixed++] = { constant, f.J };
      layer.NarrowRows(constant, f.J);
    }
    else
    {
      const Layer::Bound bound = { -constant / f.I, -f.J / f.I };
      (f.I > 0 ? layer.Lower[layer.NumberOfLower++] : layer.Upper[layer.NumberOfUpper++]) = bound;
    }
  }
  // A row has voxels only where each lower bound lies below each upper one.
  for (int l = 0; l < layer.NumberOfLower; ++l)
  {
    for (int u = 0; u < layer.NumberOfUpper; ++u)
    {
      layer.NarrowRows(
        layer.Upper[u].Start - layer.Lower[l].Start, layer.Upper[u].Step - layer.Lower[l].Step);
    }
  }
  return layer;
}
}
