// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTileCaster.h"

#include "lacunaFieldWalker.h"

#include <algorithm>
#include <limits>

namespace lacuna
{
namespace
{
constexpr double FaceTolerance = 1e-10; ///< voxels
constexpr double StandsStill = 1e-6;    ///< voxels

/// A line in a face of the volume may miss it by rounding only: the faces' tolerance counts for the
/// axes along which the line stands still. length: in voxels.
bool StandsStillAlong(int axis, const Vec3& b, double length)
{
  const double fastest = std::max(std::max(std::abs(b[0]), std::abs(b[1])), std::abs(b[2]));
  return std::abs(b[axis]) * length < StandsStill * fastest;
}
}

template <int Support>
TileCaster<Support>::TileCaster(
  const FieldBlocks<Support>& field, const RayGrid& rays, const BlockProjection& projection)
  : Field(field)
  , Rays(rays)
  , Projection(projection)
  , InverseB{ 1 / rays.First.B[0], 1 / rays.First.B[1], 1 / rays.First.B[2] }
  , Length(1.0 * field.GetSize()[0] + field.GetSize()[1] + field.GetSize()[2])
  , Blocks(field)
{
}

template <int Support>
void TileCaster<Support>::Cast(
  const std::array<int, 4>& extent, const RaySpan* spans, TileEntries& result)
{
  this->Extent = extent;
  this->Spans = spans;
  this->Out = &result;
  result.Found.fill(0);
  this->Open.fill(0);
  const PixelBox tile{ extent[0], extent[1], extent[2], extent[3] };
  for (int row = extent[2]; row <= extent[3]; ++row)
  {
    this->Open[row - extent[2]] = this->Columns(tile);
  }
  const Index coarse = this->Field.CountCoarse();
  constexpr int coarseShift = FieldBlocks<Support>::CoarseShift;
  constexpr int blockShift = FieldBlocks<Support>::BlockShift;
  const FrontToBack z = this->Projection.Order(2, 0, coarse[2] - 1, coarseShift);
  const FrontToBack y = this->Projection.Order(1, 0, coarse[1] - 1, coarseShift);
  const FrontToBack x = this->Projection.Order(0, 0, coarse[0] - 1, coarseShift);
  for (int k = 0; k < z.Count(); ++k)
  {
    for (int j = 0; j < y.Count(); ++j)
    {
      for (int i = 0; i < x.Count(); ++i)
      {
        const Index big{ x[i], y[j], z[k] };
        const PixelBox bigBox = this->Projection.Find(big, coarseShift, extent);
        if (bigBox.IsEmpty() || !this->IsOpen(bigBox))
        {
          continue;
        }
        const auto type = this->Field.GetCoarseClass(big);
        if (type.Outside || type.Inside)
        {
          continue;
        }
        const CellHulls classes = this->Field.GetBlockClasses(big);
        const std::uint64_t mixed = ~(classes.Outside | classes.Inside);
        const auto order = [&](int a)
        { return this->Projection.Order(a, 4 * big[a], 4 * big[a] + 3, blockShift); };
        const FrontToBack bz = order(2);
        const FrontToBack by = order(1);
        const FrontToBack bx = order(0);
        for (int n = 0; n < 64; ++n)
        {
          const Index block{ bx[n & 3], by[n >> 2 & 3], bz[n >> 4] };
          if (!(mixed >> CellHulls::BitOf(block[0], block[1], block[2]) & 1))
          {
            continue;
          }
          const PixelBox box = this->Projection.Find(block, blockShift, extent);
          if (!box.IsEmpty() && this->IsOpen(box))
          {
            this->CastBlock(block, box);
          }
        }
      }
    }
  }
}

template <int Support>
void TileCaster<Support>::CastBlock(const Index& block, const PixelBox& box)
{
  const CellHulls classes = this->Field.Classify(block, this->Points);
  const std::uint64_t mixed = ~(classes.Outside | classes.Inside);
  if (!mixed)
  {
    return;
  }
  const auto order = [&](int a)
  { return this->Projection.Order(a, 4 * block[a], 4 * block[a] + 3, 0); };
  const FrontToBack z = order(2);
  const FrontToBack y = order(1);
  const FrontToBack x = order(0);
  const std::array<int, 4> part{ box.FirstColumn, box.LastColumn, box.FirstRow, box.LastRow };
  for (int n = 0; n < 64; ++n)
  {
    const Index cell{ x[n & 3], y[n >> 2 & 3], z[n >> 4] };
    if (!(mixed >> CellHulls::BitOf(cell[0], cell[1], cell[2]) & 1))
    {
      continue;
    }
    const PixelBox cellBox = this->Projection.Find(cell, 0, part);
    if (!cellBox.IsEmpty() && this->IsOpen(cellBox))
    {
      const Index inBlock{ cell[0] & 3, cell[1] & 3, cell[2] & 3 };
      if (this->Rays.Parallel)
      {
        this->template CastCell<true>(cell, inBlock, cellBox);
      }
      else
      {
        this->template CastCell<false>(cell, inBlock, cellBox);
      }
    }
  }
}

template <int Support>
template <bool Parallel>
void TileCaster<Support>::CastCell(const Index& cell, const Index& inBlock, const PixelBox& box)
{
  CellPlanes planes;
  bool hasPlanes = false;
  TensorCell<Support> points;
  bool hasPoints = false;
  const Index& size = this->Field.GetSize();
  bool atBorder = false;
  for (int a = 0; a < 3; ++a)
  {
    atBorder = atBorder || cell[a] == 0 || cell[a] == size[a] - 2;
  }
  const std::uint64_t columns = this->Columns(box);
  for (int row = box.FirstRow; row <= box.LastRow; ++row)
  {
    const int line = row - this->Extent[2];
    for (std::uint64_t open = this->Open[line] & columns; open; open &= open - 1)
    {
      const int column = __builtin_ctzll(open);
      const Ray ray = this->Rays.Get(this->Extent[0] + column, row);
      double t0 = -std::numeric_limits<double>::infinity();
      double t1 = std::numeric_limits<double>::infinity();
      if (this->Spans)
      {
        t0 = this->Spans[Width * line + column].First;
        t1 = this->Spans[Width * line + column].Last;
      }
      bool within = true;
      for (int a = 0; a < 3; ++a)
      {
        double low = cell[a];
        double high = cell[a] + 1;
        if (atBorder && StandsStillAlong(a, ray.B, this->Length))
        {
          low -= cell[a] == 0 ? FaceTolerance : 0;
          high += cell[a] == size[a] - 2 ? FaceTolerance : 0;
        }
        if (ray.B[a] == 0)
        {
          within = within && ray.A[a] >= low && ray.A[a] < high;
          continue;
        }
        const double inverse = Parallel ? this->InverseB[a] : 1 / ray.B[a];
        const double u = (low - ray.A[a]) * inverse;
        const double v = (high - ray.A[a]) * inverse;
        t0 = std::max(t0, std::min(u, v));
        t1 = std::min(t1, std::max(u, v));
      }
      if (!within || !(t0 < t1))
      {
        continue;
      }
      if (!hasPlanes)
      {
        planes = this->Points.FindPlanes(inBlock[0], inBlock[1], inBlock[2]);
        hasPlanes = true;
      }
      const Vec3 from = LocalPoint(ray, cell, t0);
      const Vec3 to = LocalPoint(ray, cell, t1);
      const double u =
        planes.Slope[0] * from[0] + planes.Slope[1] * from[1] + planes.Slope[2] * from[2];
      const double v = planes.Slope[0] * to[0] + planes.Slope[1] * to[1] + planes.Slope[2] * to[2];
      if (std::max(u, v) + planes.High < 0 || std::min(u, v) + planes.Low > 0)
      {
        continue;
      }
      if (!hasPoints)
      {
        this->Field.GetCell(cell, points);
        hasPoints = true;
      }
      double s;
      RayEntry& entry = this->Out->Entries[Width * line + column];
      bool found = false;
      switch (SearchCellAlone(points, from, to, s))
      {
        case CellFinding::Nothing:
          continue;
        case CellFinding::Entry:
          entry.T = t0 + s * (t1 - t0);
          entry.Gradient = points.Gradient(LocalPoint(ray, cell, entry.T));
          found = true;
          break;
        case CellFinding::Doubt:
          found = FieldWalker<Support>(this->Blocks, ray)
                    .FindEntry(this->Spans ? this->Spans[Width * line + column] : RaySpan{}, entry);
          break;
      }
      const std::uint64_t bit = std::uint64_t(1) << column;
      this->Open[line] &= ~bit;
      this->Out->Found[line] |= found ? bit : 0;
    }
  }
}

template class TileCaster<2>;
template class TileCaster<4>;
}
