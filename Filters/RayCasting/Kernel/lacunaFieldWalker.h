// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Follows one ray through a field: blocks, then cells, then polynomials.
#ifndef lacunaFieldWalker_h
#define lacunaFieldWalker_h

#include "lacunaCellSearch.h"
#include "lacunaRay.h"
#include "lacunaSurfaceBlocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lacuna
{
/// Follows one ray.
template <int Support>
class FieldWalker
{
public:
  /// blocks: lent for the time of the walk.
  FieldWalker(SurfaceBlocks<Support>& blocks, const Ray& ray)
    : Field(blocks.GetField())
    , Blocks(blocks)
    , Line(ray)
    , InverseB{ 1 / ray.B[0], 1 / ray.B[1], 1 / ray.B[2] }
  {
  }

  /// Finds the first entry into the solid. What lies before the span is not known.
  bool FindEntry(const RaySpan& span, RayEntry& entry)
  {
    RaySpan within;
    if (!ClipToVolume(this->Line, this->Field.GetSize(), within))
    {
      return false;
    }
    const double t0 = std::max(within.First, span.First);
    const double t1 = std::min(within.Last, span.Last);
    if (!(t0 < t1))
    {
      return false;
    }
    const Index blocks = this->Field.CountCoarse();
    if (!this->template Walk<CoarseShift>(
          { 0, 0, 0 }, { blocks[0] - 1, blocks[1] - 1, blocks[2] - 1 }, t0, t1))
    {
      return false;
    }
    entry = this->Entry;
    return true;
  }

  /// Finds where the ray, in the solid behind t0, leaves it. False when the volume or the span ends
  /// before.
  bool FindExit(double t0, const RaySpan& span, double& t)
  {
    this->Leaving = true;
    RayEntry entry;
    if (!this->FindEntry({ std::max(t0, span.First), span.Last }, entry))
    {
      return false;
    }
    t = entry.T;
    return true;
  }

private:
  using Index = std::array<int, 3>;
  static constexpr int CoarseShift = FieldBlocks<Support>::CoarseShift;
  static constexpr int BlockShift = FieldBlocks<Support>::BlockShift;

  /// Visits the blocks of 2^Shift cells between first and last and between t0 and t1, in order.
  /// Every t is computed from the integer coordinates of a plane, so that levels agree and errors
  /// do not add up. No branch depends on which way the line goes next: nobody can guess it.
  template <int Shift>
  bool Walk(const Index& first, const Index& last, double t0, double t1)
  {
    Index block;
    Index step;
    Index stepsLeft;
    Index plane; // where the line leaves the block, voxels
    std::array<double, 3> leave;
    for (int a = 0; a < 3; ++a)
    {
      const bool forwards = this->Line.B[a] > 0;
      // cuts to the whole number towards 0: rounding may lead out of the volume, but not far
      const int cell = static_cast<int>(this->Line.A[a] + t0 * this->Line.B[a]);
      block[a] = std::min(std::max(cell >> Shift, first[a]), last[a]);
      step[a] = forwards ? 1 : -1;
      stepsLeft[a] = forwards ? last[a] - block[a] : block[a] - first[a];
      plane[a] = (block[a] + forwards) * (1 << Shift);
      leave[a] = this->Line.B[a] == 0 ? std::numeric_limits<double>::infinity()
                                      : (plane[a] - this->Line.A[a]) * this->InverseB[a];
    }
    for (double t = t0;;)
    {
      const int yz = 2 - (leave[1] < leave[2]);
      const int axis = yz * !(leave[0] < leave[yz]);
      const double end = std::min(leave[axis], t1);
      if (end > t)
      {
        if (this->template Visit<Shift>(block, t, end))
        {
          return true;
        }
        t = end;
      }
      if (leave[axis] >= t1 || stepsLeft[axis] == 0)
      {
        return false;
      }
      --stepsLeft[axis];
      block[axis] += step[axis];
      plane[axis] += step[axis] * (1 << Shift);
      leave[axis] = (plane[axis] - this->Line.A[axis]) * this->InverseB[axis];
    }
  }

  template <int Shift>
  bool Visit(const Index& block, double t0, double t1)
  {
    if constexpr (Shift == CoarseShift)
    {
      const auto type = this->Field.GetCoarseClass(block);
      if (type.Outside)
      {
        return this->MeetEmpty(t0);
      }
      if (type.Inside)
      {
        return this->MeetSolid(t0);
      }
      this->Classes = this->Field.GetBlockClasses(block);
      return this->template Refine<BlockShift>(block, t0, t1);
    }
    else
    {
      const CellHulls& hulls = Shift == 0 ? this->Hulls : this->Classes;
      const int bit = CellHulls::BitOf(block[0], block[1], block[2]);
      if (hulls.Outside >> bit & 1)
      {
        return this->MeetEmpty(t0);
      }
      if (hulls.Inside >> bit & 1)
      {
        return this->MeetSolid(t0);
      }
      if constexpr (Shift == 0)
      {
        return this->SearchCell(block, t0, t1);
      }
      else
      {
        this->Hulls = this->Blocks.Get(block);
        return this->template Refine<0>(block, t0, t1);
      }
    }
  }

  /// Walks through the parts of a block that are in the volume.
  template <int Finer>
  bool Refine(const Index& block, double t0, double t1)
  {
    Index first;
    Index last;
    for (int a = 0; a < 3; ++a)
    {
      const int count = ((this->Field.GetSize()[a] - 2) >> Finer) + 1;
      first[a] = block[a] << 2;
      last[a] = std::min(first[a] + 4, count) - 1;
    }
    return this->template Walk<Finer>(first, last, t0, t1);
  }

  /// The field is not solid from t on.
  bool MeetEmpty(double t)
  {
    this->State = RayState::Outside;
    this->Entry.T = t;
    return this->Leaving;
  }

  /// The field is solid from t on. A hit, unless it was so before or is so from the start.
  bool MeetSolid(double t)
  {
    if (this->State != RayState::Outside)
    {
      this->State = RayState::Inside;
      return false;
    }
    Index cell;
    for (int a = 0; a < 3; ++a)
    {
      const int c = static_cast<int>(this->Line.A[a] + t * this->Line.B[a]);
      cell[a] = std::min(std::max(c, 0), this->Field.GetSize()[a] - 2);
    }
    this->Field.GetCell(cell, this->Cell);
    this->SetEntry(cell, t);
    return true;
  }

  void SetEntry(const Index& cell, double t)
  {
    this->Entry = { t, this->Cell.Gradient(LocalPoint(this->Line, cell, t)) };
  }

  bool SearchCell(const Index& cell, double t0, double t1)
  {
    this->Field.GetCell(cell, this->Cell);
    const Vec3 from = LocalPoint(this->Line, cell, t0);
    const Vec3 to = LocalPoint(this->Line, cell, t1);
    ScaledBernstein p = this->Cell.Along(from, to);
    double s;
    if (this->Leaving)
    {
      s = 0;
      if (p.A[0] >= 0 && !FindFirstSignChange(p, s))
      {
        return false;
      }
      this->Entry.T = t0 + s * (t1 - t0);
      return true;
    }
    if (!FindEntryInCell(this->Cell, p, from, to, this->State, s))
    {
      return false;
    }
    this->SetEntry(cell, t0 + s * (t1 - t0));
    return true;
  }

  const FieldBlocks<Support>& Field;
  SurfaceBlocks<Support>& Blocks;
  CellHulls Classes; ///< of the blocks in the coarse block on the way
  CellHulls Hulls;   ///< of the cells in the block on the way
  Ray Line;
  Vec3 InverseB;
  RayState State = RayState::Unknown;
  TensorCell<Support> Cell;
  RayEntry Entry{};
  bool Leaving = false; ///< looks for an exit
};
}
#endif
