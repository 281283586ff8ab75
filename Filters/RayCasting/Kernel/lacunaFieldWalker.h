// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Follows one ray through a field: blocks, then cells, then polynomials.
#ifndef lacunaFieldWalker_h
#define lacunaFieldWalker_h

#include "lacunaSurfaceBlocks.h"
#include "lacunaTileSpans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace lacuna
{
/// The line A + t B in index coordinates, and how far it is known.
template <class T, int Support>
class FieldWalker
{
public:
  /// blocks: of the same field; lent for the time of the walk.
  FieldWalker(const WalkedField<T>& field, double isoValue, SurfaceBlocks<T, Support>& blocks,
    const Vec3& a, const Vec3& b)
    : Field(field)
    , Blocks(blocks)
    , A(a)
    , B(b)
    , InverseB{ 1 / b[0], 1 / b[1], 1 / b[2] }
    , IsoValue(isoValue)
  {
  }

  /// Finds the first entry into the solid. gradient is that of the field towards the solid, per
  /// voxel step.
  bool FindEntry(const RaySpan& span, double& t, Vec3& gradient)
  {
    double t0;
    double t1;
    if (!this->Clip(t0, t1))
    {
      return false;
    }
    if (span.First > t0)
    {
      t0 = span.First;
      this->Known = State::Outside;
    }
    t1 = std::min(t1, span.Last);
    if (!(t0 < t1))
    {
      return false;
    }
    const auto& blocks = this->Field.Bounds->GetCoarse().Blocks;
    if (!this->template Walk<CoarseShift>(
          { 0, 0, 0 }, { blocks[0] - 1, blocks[1] - 1, blocks[2] - 1 }, t0, t1))
    {
      return false;
    }
    t = this->HitT;
    gradient = this->HitGradient;
    return true;
  }

private:
  using Index = std::array<int, 3>;
  static constexpr int CoarseShift = 4;
  static constexpr int FineShift = 2;
  static constexpr double FaceTolerance = 1e-10; ///< voxels
  static constexpr double StandsStill = 1e-6;    ///< voxels
  static constexpr double NoLength = 1e-9;       ///< of a ray's way through a cell

  enum class State
  {
    Unknown,
    Outside,
    Inside
  };

  /// The part of the line within the volume. A line in a face of the volume may miss it by rounding
  /// only: the faces' tolerance counts for the axes along which the line stands still.
  bool Clip(double& t0, double& t1) const
  {
    t0 = -std::numeric_limits<double>::infinity();
    t1 = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a)
    {
      if (!this->ClipAxis(a, FaceTolerance, t0, t1))
      {
        return false;
      }
    }
    const double length = t1 - t0;
    for (int a = 0; a < 3; ++a)
    {
      if (std::abs(this->B[a]) * length > StandsStill && !this->ClipAxis(a, 0, t0, t1))
      {
        return false;
      }
    }
    return true;
  }

  bool ClipAxis(int axis, double tolerance, double& t0, double& t1) const
  {
    const double low = -tolerance - this->A[axis];
    const double high = this->Field.Size[axis] - 1 + tolerance - this->A[axis];
    if (this->B[axis] == 0)
    {
      return low <= 0 && high >= 0;
    }
    const double u = low * this->InverseB[axis];
    const double v = high * this->InverseB[axis];
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
    return t0 < t1;
  }

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
      const bool forwards = this->B[a] > 0;
      // cuts to the whole number towards 0: rounding may lead out of the volume, but not far
      const int cell = static_cast<int>(this->A[a] + t0 * this->B[a]);
      block[a] = std::min(std::max(cell >> Shift, first[a]), last[a]);
      step[a] = forwards ? 1 : -1;
      stepsLeft[a] = forwards ? last[a] - block[a] : block[a] - first[a];
      plane[a] = (block[a] + forwards) * (1 << Shift);
      leave[a] = this->B[a] == 0 ? std::numeric_limits<double>::infinity()
                                 : (plane[a] - this->A[a]) * this->InverseB[a];
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
      leave[axis] = (plane[axis] - this->A[axis]) * this->InverseB[axis];
    }
  }

  template <int Shift>
  bool Visit(const Index& block, double t0, double t1)
  {
    if constexpr (Shift == 0)
    {
      const int bit = CellHulls::BitOf(block[0], block[1], block[2]);
      if (this->Hulls.Outside >> bit & 1)
      {
        this->Known = State::Outside;
        return false;
      }
      return this->Hulls.Inside >> bit & 1 ? this->MeetSolid(t0) : this->SearchCell(block, t0, t1);
    }
    else
    {
      const auto& level =
        Shift == CoarseShift ? this->Field.Bounds->GetCoarse() : this->Field.Bounds->GetFine();
      const T* bounds = level.Bounds.data() + level.IndexOf(block[0], block[1], block[2]);
      const double low = static_cast<double>(bounds[0]);
      const double high = static_cast<double>(bounds[1]);
      if (this->Field.SolidAbove ? high < this->IsoValue : low > this->IsoValue)
      {
        this->Known = State::Outside;
        return false;
      }
      if (this->Field.SolidAbove ? low >= this->IsoValue : high <= this->IsoValue)
      {
        return this->MeetSolid(t0);
      }
      if constexpr (Shift == FineShift)
      {
        this->Hulls = this->Blocks.Get(block);
        if (this->Hulls.AreOutside())
        {
          this->Known = State::Outside;
          return false;
        }
        if (this->Hulls.AreInside())
        {
          return this->MeetSolid(t0);
        }
      }
      constexpr int finer = Shift == CoarseShift ? FineShift : 0;
      Index first;
      Index last;
      for (int a = 0; a < 3; ++a)
      {
        const int end =
          finer == 0 ? this->Field.Size[a] - 1 : this->Field.Bounds->GetFine().Blocks[a];
        first[a] = block[a] << (Shift - finer);
        last[a] = std::min((block[a] + 1) << (Shift - finer), end) - 1;
      }
      return this->template Walk<finer>(first, last, t0, t1);
    }
  }

  /// The field is solid from t on. A hit, unless it was so before or is so from the start.
  bool MeetSolid(double t)
  {
    if (this->Known != State::Outside)
    {
      this->Known = State::Inside;
      return false;
    }
    Index cell;
    for (int a = 0; a < 3; ++a)
    {
      const int c = static_cast<int>(this->A[a] + t * this->B[a]);
      cell[a] = std::min(std::max(c, 0), this->Field.Size[a] - 2);
    }
    this->Blocks.GetControlPoints().GetCell(cell, this->Cell);
    this->SetHit(cell, t);
    return true;
  }

  void SetHit(const Index& cell, double t)
  {
    this->HitT = t;
    this->HitGradient = this->Cell.Gradient(this->Local(cell, t));
  }

  Vec3 Local(const Index& cell, double t) const
  {
    Vec3 local;
    for (int a = 0; a < 3; ++a)
    {
      local[a] = std::min(std::max(this->A[a] + t * this->B[a] - cell[a], 0.0), 1.0);
    }
    return local;
  }

  bool SearchCell(const Index& cell, double t0, double t1)
  {
    this->Blocks.GetControlPoints().GetCell(cell, this->Cell);
    const Vec3 to = this->Local(cell, t1);
    ScaledBernstein p = this->Cell.Along(this->Local(cell, t0), to);
    double s;
    if (p.A[0] >= 0 && this->Known != State::Outside)
    {
      this->Known = State::Inside;
      if (!FindFirstSignChange(p, s))
      {
        return false;
      }
      this->Known = State::Outside;
      if (1 - s < NoLength)
      {
        return false;
      }
      t0 += s * (t1 - t0);
      p = this->Cell.Along(this->Local(cell, t0), to);
      p.A[0] = -std::numeric_limits<double>::min(); // zero but for rounding, and falling
    }
    else if (p.A[0] >= 0)
    {
      // The last cell ended outside, so this is zero but for rounding: an entry if the field rises
      // from here, and if it falls the exit that the last cell has seen already.
      p.A[0] = -std::numeric_limits<double>::min();
    }
    this->Known = State::Outside;
    if (!FindFirstSignChange(p, s))
    {
      return false;
    }
    this->SetHit(cell, t0 + s * (t1 - t0));
    return true;
  }

  const WalkedField<T>& Field;
  SurfaceBlocks<T, Support>& Blocks;
  CellHulls Hulls; ///< of the block on the way
  Vec3 A;
  Vec3 B;
  Vec3 InverseB;
  double IsoValue;
  State Known = State::Unknown;
  TensorCell<Support> Cell;
  double HitT = 0;
  Vec3 HitGradient{ 0, 0, 0 };
};
}
#endif
