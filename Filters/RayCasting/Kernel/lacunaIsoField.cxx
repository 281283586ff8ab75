// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoField.h"

#include "lacunaFieldWalker.h"
#include "lacunaSplineFilter.h"
#include "lacunaVoxelBlocks.h"
#include "lacunaWide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
LACUNA_INLINE Four Clamp(const Four& a)
{
  return Lesser(Greater(a, All(0)), All(1));
}

template <bool Parallel>
LACUNA_INLINE unsigned Clip(const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low,
  const Vec3& high, RayBatch& batch)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Four column = batch.Column;
  const Four row = batch.Row;
  Four first = batch.First;
  Four last = batch.Last;
  for (int a = 0; a < 3; ++a)
  {
    // as RayGrid::Get
    const Four start =
      (All(rays.First.A[a]) + row * All(rays.PerRow.A[a])) + column * All(rays.PerColumn.A[a]);
    const Four step =
      (All(rays.First.B[a]) + row * All(rays.PerRow.B[a])) + column * All(rays.PerColumn.B[a]);
    batch.A[a] = start;
    batch.B[a] = step;
    const Four inverse = Parallel ? All(1 / rays.First.B[a]) : All(1) / step;
    const Four u = (All(low[a]) - start) * inverse;
    const Four v = (All(high[a]) - start) * inverse;
    Four enters = Lesser(u, v);
    Four leaves = Greater(u, v);
    if (!Parallel || rays.First.B[a] == 0)
    {
      // a ray that does not move along the axis is between the faces throughout, or never
      const Four beyond =
        ((start >= All(low[a])) & (start < All(high[a]))) ? All(infinity) : All(-infinity);
      enters = step == All(0) ? -beyond : enters;
      leaves = step == All(0) ? beyond : leaves;
    }
    first = Greater(first, enters);
    last = Lesser(last, leaves);
  }
  for (int a = 0; a < 3; ++a)
  {
    const Four corner = All(cell[a]);
    batch.From[a] = Clamp(batch.A[a] + first * batch.B[a] - corner);
    batch.To[a] = Clamp(batch.A[a] + last * batch.B[a] - corner);
  }
  batch.First = first;
  batch.Last = last;
  return ToBits(first < last);
}

LACUNA_WIDE unsigned ClipParallel(const RayGrid& rays, const std::array<int, 3>& cell,
  const Vec3& low, const Vec3& high, RayBatch& batch)
{
  return Clip<true>(rays, cell, low, high, batch);
}

LACUNA_WIDE unsigned ClipPerspective(const RayGrid& rays, const std::array<int, 3>& cell,
  const Vec3& low, const Vec3& high, RayBatch& batch)
{
  return Clip<false>(rays, cell, low, high, batch);
}

LACUNA_WIDE unsigned LanesBetween(const CellPlanes& planes, const RayBatch& batch)
{
  const Four x = All(planes.Slope[0]);
  const Four y = All(planes.Slope[1]);
  const Four z = All(planes.Slope[2]);
  const Four u = x * batch.From[0] + y * batch.From[1] + z * batch.From[2];
  const Four v = x * batch.To[0] + y * batch.To[1] + z * batch.To[2];
  return ToBits(
    (Greater(u, v) + All(planes.High) >= All(0)) & (Lesser(u, v) + All(planes.Low) <= All(0)));
}

LACUNA_WIDE unsigned LanesThatChange(const Four* coefficients, int count, double doubt)
{
  Four low = coefficients[0];
  Four high = coefficients[0];
  for (int m = 1; m < count; ++m)
  {
    low = Lesser(low, coefficients[m]);
    high = Greater(high, coefficients[m]);
  }
  const Four first = coefficients[0];
  const Four last = coefficients[count - 1];
  const FourMask signs = (low < All(0)) & (high >= All(0));
  const FourMask doubtful = (Lesser(Greater(first, -first), Greater(last, -last)) <= All(doubt));
  return ToBits(signs | doubtful);
}
}

unsigned RayBatch::Clip(
  const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low, const Vec3& high)
{
  const unsigned lanes = rays.Parallel ? ClipParallel(rays, cell, low, high, *this)
                                       : ClipPerspective(rays, cell, low, high, *this);
  return lanes & ((1U << this->Count) - 1);
}

unsigned RayBatch::FindChanges(const Four* coefficients, int count, double doubt)
{
  return LanesThatChange(coefficients, count, doubt);
}

unsigned RayBatch::FindBetween(const CellPlanes& planes) const
{
  return LanesBetween(planes, *this);
}

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
namespace
{
template <class T, int Support>
class TypedFollower final : public RayFollower
{
public:
  TypedFollower(const SolidVoxels<T>& solid, double isoValue)
    : Field(solid, isoValue)
    , Blocks(this->Field)
  {
  }

  bool FindEntry(const Ray& ray, const RaySpan& span, RayEntry& entry) override
  {
    return FieldWalker<Support>(this->Blocks, ray).FindEntry(span, entry);
  }

  bool FindExit(const Ray& ray, double t0, const RaySpan& span, double& t) override
  {
    return FieldWalker<Support>(this->Blocks, ray).FindExit(t0, span, t);
  }

  double Value(const Vec3& index) override
  {
    std::array<int, 3> cell;
    Vec3 local;
    for (int a = 0; a < 3; ++a)
    {
      const int last = this->Field.GetSize()[a] - 2;
      cell[a] = std::min(std::max(static_cast<int>(index[a]), 0), last);
      local[a] = std::min(std::max(index[a] - cell[a], 0.0), 1.0);
    }
    TensorCell<Support> points;
    this->Field.GetCell(cell, points);
    return points.Value(local);
  }

private:
  VoxelBlocks<T, Support> Field;
  SurfaceBlocks<Support> Blocks;
};

/// What a thread works with.
template <class T, int Support>
struct Worker
{
  Worker(const SolidVoxels<T>& solid, double isoValue, const FieldBlocks<Support>& field,
    const RayGrid& rays, const BlockProjection& projection)
    : Follower(solid, isoValue)
    , Caster(field, rays, projection)
  {
  }
  TypedFollower<T, Support> Follower;
  TileCaster<Support> Caster;
  TileEntries Entries;
  std::vector<RaySpan> Spans;
};

/// Workers are used again by threads that come later: fresh memory costs page faults.
template <class T, int Support>
class Workers
{
public:
  using Pointer = std::unique_ptr<Worker<T, Support>>;

  template <class Make>
  Pointer Take(const Make& make)
  {
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      if (!this->Idle.empty())
      {
        Pointer worker = std::move(this->Idle.back());
        this->Idle.pop_back();
        return worker;
      }
    }
    return make();
  }

  void Return(Pointer worker)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Idle.push_back(std::move(worker));
  }

private:
  std::mutex Mutex;
  std::vector<Pointer> Idle;
};

template <class T, int Support>
class TypedField : public IsoField
{
public:
  TypedField(const T* voxels, const std::array<int, 3>& size, SolidSide side, Execution& execution)
    : Bounds(voxels, size, TensorCell<Support>::Before, TensorCell<Support>::After, execution)
  {
    this->Minimum = this->Bounds.GetMinimum();
    this->Maximum = this->Bounds.GetMaximum();
    this->NumberOfNonFinite = this->Bounds.GetNumberOfNonFinite();
    const bool above = side == SolidSide::Above;
    this->Solid = { voxels, size, &this->Bounds, above, this->NumberOfNonFinite > 0,
      above ? this->Minimum : this->Maximum };
  }

  std::unique_ptr<RayFollower> Follow(double isoValue) const override
  {
    return std::make_unique<TypedFollower<T, Support>>(this->Solid, isoValue);
  }

  void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileWork& work,
    Execution& execution) const override
  {
    const VoxelBlocks<T, Support> field(this->Solid, isoValue);
    constexpr int width = TileEntries::Width;
    const std::int64_t across = (static_cast<std::int64_t>(extent[1]) - extent[0]) / width + 1;
    const std::int64_t down = (static_cast<std::int64_t>(extent[3]) - extent[2]) / width + 1;
    Workers<T, Support> workers;
    execution.For(across * down, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        auto worker = workers.Take(
          [&] {
            return std::make_unique<Worker<T, Support>>(
              this->Solid, isoValue, field, rays, projection);
          });
        for (std::int64_t n = begin; n < end; ++n)
        {
          const int x = extent[0] + static_cast<int>(n % across) * width;
          const int y = extent[2] + static_cast<int>(n / across) * width;
          const std::array<int, 4> tile{ x, std::min(x + width - 1, extent[1]), y,
            std::min(y + width - 1, extent[3]) };
          const RaySpan* spans = nullptr;
          if (work.Prepare)
          {
            worker->Spans.resize(width * width);
            work.Prepare(tile, worker->Follower, worker->Spans.data());
            spans = worker->Spans.data();
          }
          worker->Caster.Cast(tile, spans, worker->Entries);
          work.Take(tile, worker->Follower, worker->Entries);
        }
        workers.Return(std::move(worker));
      });
  }

private:
  FieldBounds<T> Bounds;
  SolidVoxels<T> Solid;
};

/// Owns the control points of the spline that goes through the voxels.
class InterpolatingField : public TypedField<float, 4>
{
public:
  InterpolatingField(SplineCoefficients&& coefficients, const std::array<int, 3>& size,
    SolidSide side, Execution& execution)
    : TypedField<float, 4>(coefficients.Values.data(), size, side, execution)
    , Coefficients(std::move(coefficients))
  {
    this->Minimum = this->Coefficients.Minimum;
    this->Maximum = this->Coefficients.Maximum;
    this->NumberOfNonFinite = this->Coefficients.NumberOfNonFinite;
  }

private:
  SplineCoefficients Coefficients;
};

}

std::unique_ptr<const IsoField> MakeIsoField(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
{
  if (interpolation == FieldInterpolation::InterpolatingBSpline)
  {
    return std::make_unique<InterpolatingField>(
      FilterToCoefficients(volume, side == SolidSide::Above, execution), volume.Size, side,
      execution);
  }
  return DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels) -> std::unique_ptr<const IsoField>
    {
      using T = std::remove_cv_t<std::remove_pointer_t<decltype(voxels)>>;
      if (interpolation == FieldInterpolation::Trilinear)
      {
        return std::make_unique<TypedField<T, 2>>(voxels, volume.Size, side, execution);
      }
      return std::make_unique<TypedField<T, 4>>(voxels, volume.Size, side, execution);
    });
}
}
