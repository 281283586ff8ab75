// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Follows one ray through a field: blocks, then cells, then polynomials.
#ifndef lacunaFieldWalker_h
#define lacunaFieldWalker_h

#include "lacunaFieldBounds.h"
#include "lacunaTensorCell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace lacuna
{
/// What a walker walks through.
template <class T>
struct WalkedField
{
  const T* Voxels;
  std::array<int, 3> Size;
  const FieldBounds<T>* Bounds;
  bool SolidAbove;
  bool HasEmpty; ///< some voxels are not finite
  double Empty;  ///< and count as this
};

/// The line A + t B in index coordinates, and how far it is known.
template <class T, int Support>
class FieldWalker
{
public:
  FieldWalker(const WalkedField<T>& field, const Vec3& a, const Vec3& b, double isoValue)
    : Field(field)
    , A(a)
    , B(b)
    , InverseB{ 1 / b[0], 1 / b[1], 1 / b[2] }
    , IsoValue(isoValue)
    , Sign(field.SolidAbove ? 1 : -1)
  {
  }

  /// Finds the first entry into the solid. gradient is that of the field towards the solid, per
  /// voxel step.
  bool FindEntry(double& t, Vec3& gradient)
  {
    double t0;
    double t1;
    if (!this->Clip(t0, t1))
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

  /// t where the line meets the far side of a block of 2^shift cells.
  double LeaveAt(int axis, int block, int shift) const
  {
    if (this->B[axis] == 0)
    {
      return std::numeric_limits<double>::infinity();
    }
    const int plane = (block + (this->B[axis] > 0)) * (1 << shift);
    return (plane - this->A[axis]) * this->InverseB[axis];
  }

  /// Visits the blocks first..last of one level between t0 and t1, in order. Every t is computed
  /// from the integer coordinates of a plane, so that levels agree and errors do not add up.
  template <int Shift>
  bool Walk(const Index& first, const Index& last, double t0, double t1)
  {
    Index block;
    std::array<double, 3> leave;
    for (int a = 0; a < 3; ++a)
    {
      const int cell = static_cast<int>(std::floor(this->A[a] + t0 * this->B[a]));
      block[a] = std::min(std::max(cell >> Shift, first[a]), last[a]);
      leave[a] = this->LeaveAt(a, block[a], Shift);
    }
    for (double t = t0;;)
    {
      const int yz = leave[1] < leave[2] ? 1 : 2;
      const int axis = leave[0] < leave[yz] ? 0 : yz;
      const double end = std::min(leave[axis], t1);
      if (end > t)
      {
        if (this->template Visit<Shift>(block, t, end))
        {
          return true;
        }
        t = end;
      }
      if (leave[axis] >= t1)
      {
        return false;
      }
      block[axis] += this->B[axis] > 0 ? 1 : -1;
      if (block[axis] < first[axis] || block[axis] > last[axis])
      {
        return false;
      }
      leave[axis] = this->LeaveAt(axis, block[axis], Shift);
    }
  }

  template <int Shift>
  bool Visit(const Index& block, double t0, double t1)
  {
    if constexpr (Shift == 0)
    {
      return this->VisitCell(block, t0, t1);
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
      const int c = static_cast<int>(std::floor(this->A[a] + t * this->B[a]));
      cell[a] = std::min(std::max(c, 0), this->Field.Size[a] - 2);
    }
    this->Gather(cell);
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

  bool VisitCell(const Index& cell, double t0, double t1)
  {
    this->Gather(cell);
    // the sign bits of all control points: do they agree?
    std::uint64_t any = 0;
    std::uint64_t all = ~std::uint64_t(0);
    for (const double p : this->Cell.Points)
    {
      std::uint64_t bits;
      std::memcpy(&bits, &p, sizeof(bits));
      any |= bits;
      all &= bits;
    }
    if (all >> 63)
    {
      this->Known = State::Outside;
      return false;
    }
    if (!(any >> 63))
    {
      if (this->Known != State::Outside)
      {
        this->Known = State::Inside;
        return false;
      }
      this->SetHit(cell, t0);
      return true;
    }
    return this->SearchCell(cell, t0, t1);
  }

  bool SearchCell(const Index& cell, double t0, double t1)
  {
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

  /// Loads the control points of a cell, less the iso-value; positive is solid.
  void Gather(const Index& cell)
  {
    constexpr int before = TensorCell<Support>::Before;
    constexpr int after = TensorCell<Support>::After;
    const auto& size = this->Field.Size;
    const bool interior = cell[0] >= before && cell[1] >= before && cell[2] >= before &&
      cell[0] + after < size[0] && cell[1] + after < size[1] && cell[2] + after < size[2];
    if (!interior || this->Field.HasEmpty)
    {
      this->GatherGuarded(cell);
      return;
    }
    const double sign = this->Sign;
    const double offset = -sign * this->IsoValue;
    const std::int64_t row = size[0];
    const std::int64_t slice = row * size[1];
    const T* corner = this->Field.Voxels + (cell[2] - before) * slice + (cell[1] - before) * row +
      (cell[0] - before);
    double* out = this->Cell.Points;
    for (int k = 0; k < Support; ++k)
    {
      for (int j = 0; j < Support; ++j)
      {
        const T* in = corner + k * slice + j * row;
        for (int i = 0; i < Support; ++i)
        {
          out[i] = sign * static_cast<double>(in[i]) + offset;
        }
        out += Support;
      }
    }
  }

  /// The same at the border, where points are missing, and for voxels that are not finite.
  void GatherGuarded(const Index& cell)
  {
    constexpr int before = TensorCell<Support>::Before;
    const auto& size = this->Field.Size;
    double* out = this->Cell.Points;
    for (int k = 0; k < Support; ++k)
    {
      const int z = std::min(std::max(cell[2] - before + k, 0), size[2] - 1);
      for (int j = 0; j < Support; ++j)
      {
        const int y = std::min(std::max(cell[1] - before + j, 0), size[1] - 1);
        const T* row = this->Field.Voxels + (static_cast<std::int64_t>(z) * size[1] + y) * size[0];
        for (int i = 0; i < Support; ++i)
        {
          const int x = std::min(std::max(cell[0] - before + i, 0), size[0] - 1);
          const double v = static_cast<double>(row[x]);
          *out++ =
            this->Sign * (std::isfinite(v) ? v : this->Field.Empty) - this->Sign * this->IsoValue;
        }
      }
    }
    if constexpr (Support == 4)
    {
      constexpr std::ptrdiff_t strides[3] = { 1, 4, 16 };
      for (int a = 0; a < 3; ++a)
      {
        if (cell[a] == 0)
        {
          this->Extrapolate(a, strides[a], 0, 1);
        }
        if (cell[a] == size[a] - 2)
        {
          this->Extrapolate(a, strides[a], 3, -1);
        }
      }
    }
  }

  /// Continues the points linearly along an axis at position end; inward leads to its neighbours.
  void Extrapolate(int axis, std::ptrdiff_t stride, int end, std::ptrdiff_t inward)
  {
    const std::ptrdiff_t u = axis == 0 ? 4 : 1;
    const std::ptrdiff_t v = axis == 2 ? 4 : 16;
    for (int b = 0; b < 4; ++b)
    {
      for (int a = 0; a < 4; ++a)
      {
        double* p = &this->Cell.Points[a * u + b * v + end * stride];
        p[0] = 2 * p[inward * stride] - p[2 * inward * stride];
      }
    }
  }

  const WalkedField<T>& Field;
  Vec3 A;
  Vec3 B;
  Vec3 InverseB;
  double IsoValue;
  double Sign;
  State Known = State::Unknown;
  TensorCell<Support> Cell;
  double HitT = 0;
  Vec3 HitGradient{ 0, 0, 0 };
};
}
#endif
