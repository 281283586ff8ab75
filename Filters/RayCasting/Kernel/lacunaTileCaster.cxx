// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTileCaster.h"

#include "lacunaFieldWalker.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
template <int Support>
TileCaster<Support>::TileCaster(
  const FieldBlocks<Support>& field, const RayGrid& rays, const BlockProjection& projection)
  : Field(field)
  , Rays(rays)
  , Projection(projection)
  , Blocks(field)
{
  const Vec3& b = rays.First.B;
  const double fastest = std::max(std::max(std::abs(b[0]), std::abs(b[1])), std::abs(b[2]));
  const Index& size = field.GetSize();
  const double length = 1.0 * size[0] + size[1] + size[2]; // no ray crosses more voxels
  int still = 0;
  for (int a = 0; a < 3; ++a)
  {
    this->StandsStill[a] = rays.Parallel && std::abs(b[a]) * length < NoMove * fastest;
    still += b[a] == 0;
    this->Axis = b[a] == 0 ? this->Axis : a;
  }
  if (!rays.Parallel || still != 2)
  {
    this->Axis = -1;
  }
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
    const int line = row - extent[2];
    this->Open[line] = this->Columns(tile);
    for (int x = 0; spans && x <= extent[1] - extent[0]; ++x)
    {
      const RaySpan& span = spans[Width * line + x];
      this->Open[line] &= ~(static_cast<std::uint64_t>(!(span.First < span.Last)) << x);
    }
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
        this->ForEach(mixed, big, blockShift,
          [&](const Index& block)
          {
            const PixelBox box = this->Projection.Find(block, blockShift, extent);
            if (!box.IsEmpty() && this->IsOpen(box))
            {
              this->CastBlock(block, box);
            }
          });
      }
    }
  }
}

/// Calls body with the blocks of a bigger one that are in set, front to back.
template <int Support>
template <class Body>
void TileCaster<Support>::ForEach(
  std::uint64_t set, const Index& bigger, int shift, const Body& body) const
{
  int order[3][4];
  for (int a = 0; a < 3; ++a)
  {
    const FrontToBack indices = this->Projection.Order(a, 4 * bigger[a], 4 * bigger[a] + 3, shift);
    for (int n = 0; n < 4; ++n)
    {
      order[a][n] = indices[n];
    }
  }
  for (const int z : order[2])
  {
    for (const int y : order[1])
    {
      const std::uint64_t row = set >> CellHulls::BitOf(0, y, z) & 15;
      if (!row)
      {
        continue;
      }
      for (const int x : order[0])
      {
        if (row >> (x & 3) & 1)
        {
          body({ x, y, z });
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
  const std::array<int, 4> part{ box.FirstColumn, box.LastColumn, box.FirstRow, box.LastRow };
  this->ForEach(mixed, block, 0,
    [&](const Index& cell)
    {
      const PixelBox cellBox = this->Projection.Find(cell, 0, part);
      if (cellBox.IsEmpty() || !this->IsOpen(cellBox))
      {
        return;
      }
      this->CastCell(cell, cellBox);
    });
}

template <int Support>
void TileCaster<Support>::CastCell(const Index& cell, const PixelBox& box)
{
  CellAtWork work;
  work.Cell = cell;
  for (int a = 0; a < 3; ++a)
  {
    // A line in a face of the volume may miss it by rounding only: the faces' tolerance counts for
    // the axes along which the line stands still.
    const bool still = this->StandsStill[a];
    work.Low[a] = cell[a] - (still && cell[a] == 0 ? FaceTolerance : 0);
    work.High[a] =
      cell[a] + 1 + (still && cell[a] == this->Field.GetSize()[a] - 2 ? FaceTolerance : 0);
  }
  const std::uint64_t columns = this->Columns(box);
  RayBatch batch;
  for (int row = box.FirstRow; row <= box.LastRow; ++row)
  {
    const int line = row - this->Extent[2];
    for (std::uint64_t open = this->Open[line] & columns; open; open &= open - 1)
    {
      const int column = __builtin_ctzll(open);
      const RaySpan span = this->Spans ? this->Spans[Width * line + column] : RaySpan{};
      batch.Column[batch.Count] = this->Extent[0] + column;
      batch.Row[batch.Count] = row;
      batch.First[batch.Count] = span.First;
      batch.Last[batch.Count] = span.Last;
      if (++batch.Count == RayBatch::Lanes)
      {
        this->CastBatch(work, batch);
        batch.Count = 0;
      }
    }
  }
  if (batch.Count > 0)
  {
    this->CastBatch(work, batch);
  }
}

template <int Support>
void TileCaster<Support>::CastBatch(CellAtWork& work, RayBatch& batch)
{
  const Index& cell = work.Cell;
  unsigned lanes = batch.Clip(this->Rays, cell, work.Low, work.High);
  if (!lanes)
  {
    return;
  }
  if (this->Axis < 0)
  {
    if (!work.HasPlanes)
    {
      work.Planes = this->Points.FindPlanes(cell[0] & 3, cell[1] & 3, cell[2] & 3);
      work.HasPlanes = true;
    }
    lanes &= batch.FindBetween(work.Planes);
    if (!lanes)
    {
      return;
    }
  }
  if (!work.HasPoints)
  {
    this->Field.GetCell(cell, work.Points);
    work.HasPoints = true;
  }
  // The tolerance of the block's points is for floats, of 24 bits; here it is doubles, of 53.
  const double doubt = this->Points.Tolerance * 1e-6;
  Four along[Support];
  if (this->Axis >= 0)
  {
    work.Points.FourAlong(this->Axis, batch.From, batch.To, along);
    lanes &= RayBatch::FindChanges(along, Support, doubt);
  }
  for (; lanes; lanes &= lanes - 1)
  {
    const int lane = __builtin_ctz(lanes);
    const Vec3 from = batch.GetFrom(lane);
    const Vec3 to = batch.GetTo(lane);
    ScaledBernstein p;
    if (this->Axis < 0)
    {
      p = work.Points.Along(from, to);
    }
    else
    {
      p.Degree = Support - 1;
      for (int m = 0; m < Support; ++m)
      {
        p.A[m] = along[m][lane];
      }
    }
    const int line = static_cast<int>(batch.Row[lane]) - this->Extent[2];
    const int column = static_cast<int>(batch.Column[lane]) - this->Extent[0];
    RayEntry& entry = this->Out->Entries[Width * line + column];
    bool found = false;
    double s;
    switch (SearchCellAlone(work.Points, p, from, to, doubt, s))
    {
      case CellFinding::Nothing:
        continue;
      case CellFinding::Entry:
        entry.T = batch.First[lane] + s * (batch.Last[lane] - batch.First[lane]);
        entry.Gradient = work.Points.Gradient(LocalPoint(batch.GetRay(lane), cell, entry.T));
        found = true;
        break;
      case CellFinding::Doubt:
        found = FieldWalker<Support>(this->Blocks, batch.GetRay(lane))
                  .FindEntry(this->Spans ? this->Spans[Width * line + column] : RaySpan{}, entry);
        break;
    }
    const std::uint64_t bit = std::uint64_t(1) << column;
    this->Open[line] &= ~bit;
    this->Out->Found[line] |= found ? bit : 0;
  }
}

template class TileCaster<2>;
template class TileCaster<4>;
}
