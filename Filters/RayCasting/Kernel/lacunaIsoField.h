// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What of an iso ray caster depends on the type of voxels and on the interpolation.
#ifndef lacunaIsoField_h
#define lacunaIsoField_h

#include "lacunaCellHulls.h"
#include "lacunaCellSearch.h"
#include "lacunaFieldBlocks.h"
#include "lacunaFour.h"
#include "lacunaIsoRayCaster.h"
#include "lacunaMatrix4.h"
#include "lacunaRay.h"
#include "lacunaSurfaceBlocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace lacuna
{
/// A rectangle of pixels.
struct PixelBox
{
  int FirstColumn;
  int LastColumn;
  int FirstRow;
  int LastRow;

  bool IsEmpty() const
  {
    return this->FirstColumn > this->LastColumn || this->FirstRow > this->LastRow;
  }
};

/// An order of the indices from first to last in which all rays meet them: those in front of the
/// eye first, going away from it, then those behind.
class FrontToBack
{
public:
  FrontToBack(int first, int last, int turn)
    : First(first)
    , Last(last)
    , Turn(std::min(std::max(turn, first), last + 1))
  {
  }
  int Count() const { return this->Last - this->First + 1; }
  int operator[](int n) const
  {
    const int upwards = this->Last - this->Turn + 1;
    return n < upwards ? this->Turn + n : this->Turn - 1 - (n - upwards);
  }

private:
  int First;
  int Last;
  int Turn;
};

class BlockProjection
{
public:
  /// indexToPixel: (i, j, k, 1) to (column, row, .) in a parallel projection, otherwise to
  /// (column z, row z, z) with z > 0 before the eye.
  BlockProjection(const Matrix4& indexToPixel, const RayGrid& rays)
    : IndexToPixel(indexToPixel)
    , Parallel(rays.Parallel)
  {
    // What rounding may do must not leave out a pixel.
    constexpr double more = 1 + 1e-6;
    for (int a = 0; a < 3; ++a)
    {
      this->HalfCell[a] = 0.5 * more *
        (std::abs(indexToPixel(a, 0)) + std::abs(indexToPixel(a, 1)) +
          std::abs(indexToPixel(a, 2)));
      const double infinity = std::numeric_limits<double>::infinity();
      this->Eye[a] =
        !this->Parallel ? rays.First.A[a] : (rays.First.B[a] < 0 ? infinity : -infinity);
    }
  }

  /// The pixels of extent (first and last column, first and last row) that may see a block which
  /// is 2^shift cells wide; with many pixels before the eye and its plane.
  PixelBox Find(const std::array<int, 3>& block, int shift, const std::array<int, 4>& extent) const
  {
    const double width = 1 << shift;
    const Vec3 centre{ (block[0] + 0.5) * width, (block[1] + 0.5) * width,
      (block[2] + 0.5) * width };
    const Matrix4& m = this->IndexToPixel;
    double low[2];
    double high[2];
    for (int a = 0; a < 2; ++a)
    {
      const double middle =
        m(a, 0) * centre[0] + m(a, 1) * centre[1] + m(a, 2) * centre[2] + m(a, 3);
      low[a] = middle - width * this->HalfCell[a];
      high[a] = middle + width * this->HalfCell[a];
    }
    if (!this->Parallel)
    {
      const double z = m(2, 0) * centre[0] + m(2, 1) * centre[1] + m(2, 2) * centre[2] + m(2, 3);
      const double near = z - width * this->HalfCell[2];
      const double far = z + width * this->HalfCell[2];
      if (!(far > 0))
      {
        return { 0, -1, 0, -1 };
      }
      if (!(near > 0))
      {
        return { extent[0], extent[1], extent[2], extent[3] };
      }
      for (int a = 0; a < 2; ++a)
      {
        low[a] /= low[a] < 0 ? near : far;
        high[a] /= high[a] < 0 ? far : near;
      }
    }
    constexpr double margin = 1e-6; // pixels
    int box[4];
    for (int a = 0; a < 2; ++a)
    {
      // not floor and ceil, which are calls on old processors
      const double size = 1.0 * extent[2 * a + 1] - extent[2 * a];
      const double from = std::max(low[a] - margin - extent[2 * a], 0.0);
      const double to = std::min(high[a] + margin - extent[2 * a], size);
      if (!(from <= to))
      {
        return { 0, -1, 0, -1 };
      }
      const int first = static_cast<int>(from);
      box[2 * a] = extent[2 * a] + first + (first < from);
      box[2 * a + 1] = extent[2 * a] + static_cast<int>(to);
    }
    return { box[0], box[1], box[2], box[3] };
  }

  /// The order along an axis of blocks 2^shift cells wide.
  FrontToBack Order(int axis, int first, int last, int shift) const
  {
    const double eye = this->Eye[axis] / (1 << shift);
    const int turn = eye <= first ? first : (eye >= last + 1 ? last + 1 : static_cast<int>(eye));
    return { first, last, turn };
  }

private:
  Matrix4 IndexToPixel;
  Vec3 HalfCell;
  Vec3 Eye; ///< voxels
  bool Parallel;
};

// Four rays at once in one cell, lane by lane. What comes out of a lane does not depend on the
// others.

struct RayBatch
{
  static constexpr int Lanes = 4;

  int Count = 0; ///< lanes in use
  Four Column{};
  Four Row{};
  Four A[3];
  Four B[3];
  /// First the part of the ray to follow, then that in the cell.
  Four First{};
  Four Last{};
  /// Where the ray enters and leaves the cell, in the coordinates of the cell, 0..1.
  Four From[3];
  Four To[3];

  /// Sets all but columns, rows, First and Last of the lanes in use. low, high: the cell's faces,
  /// from which the local coordinates count from cell on. Returns the lanes that cross the cell, as
  /// bits.
  unsigned Clip(
    const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low, const Vec3& high);

  /// The lanes that planes do not exclude from holding a zero.
  unsigned FindBetween(const CellPlanes& planes) const;

  /// The lanes whose polynomial, of count Bernstein coefficients, may change its sign or is zero at
  /// an end but for doubt.
  static unsigned FindChanges(const Four* coefficients, int count, double doubt);

  Ray GetRay(int lane) const
  {
    return { { this->A[0][lane], this->A[1][lane], this->A[2][lane] },
      { this->B[0][lane], this->B[1][lane], this->B[2][lane] } };
  }
  Vec3 GetFrom(int lane) const
  {
    return { this->From[0][lane], this->From[1][lane], this->From[2][lane] };
  }
  Vec3 GetTo(int lane) const { return { this->To[0][lane], this->To[1][lane], this->To[2][lane] }; }
};

/// What the rays of a tile of pixels have met; row r, column c of the tile is element Width r + c.
struct TileEntries
{
  static constexpr int Width = 64;
  std::array<std::uint64_t, Width> Found; ///< bit c of element r
  std::vector<RayEntry> Entries = std::vector<RayEntry>(Width * Width);
};

/// Offers blocks, and then cells, that may hold surface to the rays that cross them, front to back.
/// What is read from the voxels and found out about a cell serves all its rays, and space without
/// surface costs nothing. A cell is crossed between two of the six points at which a ray meets its
/// planes, each computed from the plane's integer coordinate: the cells of a ray leave no gaps.
///
/// Between the cells a ray is offered, the field has no zero; so what the ray has met before need
/// not be known. Where a ray enters or leaves a cell at a zero of the field but for rounding, that
/// is in doubt: it is then followed alone, by FieldWalker.
template <int Support>
class TileCaster
{
public:
  static constexpr int Width = TileEntries::Width;
  using Index = std::array<int, 3>;

  /// One per thread. field and projection must outlive this object.
  TileCaster(
    const FieldBlocks<Support>& field, const RayGrid& rays, const BlockProjection& projection);

  /// extent: first and last column, first and last row; at most Width of each. spans: of each pixel
  /// of the tile, or null for whole rays.
  void Cast(const std::array<int, 4>& extent, const RaySpan* spans, TileEntries& result);

private:
  /// What is found out about a cell when its first ray asks for it.
  struct CellAtWork
  {
    Index Cell;
    Vec3 Low;
    Vec3 High;
    CellPlanes Planes;
    bool HasPlanes = false;
    TensorCell<Support> Points;
    bool HasPoints = false;
  };

  void CastBlock(const Index& block, const PixelBox& box);
  void CastCell(const Index& cell, const PixelBox& box);
  void CastBatch(CellAtWork& work, RayBatch& batch);
  template <class Body>
  void ForEach(std::uint64_t set, const Index& bigger, int shift, const Body& body) const;

  /// Whether a ray of the box still looks for its entry.
  bool IsOpen(const PixelBox& box) const
  {
    const std::uint64_t columns = this->Columns(box);
    std::uint64_t open = 0;
    for (int row = box.FirstRow; row <= box.LastRow; ++row)
    {
      open |= this->Open[row - this->Extent[2]];
    }
    return (open & columns) != 0;
  }

  std::uint64_t Columns(const PixelBox& box) const
  {
    return ~std::uint64_t(0) >> (Width - 1 - (box.LastColumn - box.FirstColumn))
      << (box.FirstColumn - this->Extent[0]);
  }

  const FieldBlocks<Support>& Field;
  RayGrid Rays;
  const BlockProjection& Projection;
  std::array<bool, 3> StandsStill; ///< along an axis parallel rays move by rounding only
  int Axis = -1;                   ///< parallel rays go along this one alone
  SurfaceBlocks<Support> Blocks;   ///< for rays followed alone
  BlockPoints<Support> Points;     ///< of the block at work
  std::array<std::uint64_t, Width> Open;
  std::array<int, 4> Extent;
  const RaySpan* Spans = nullptr;
  TileEntries* Out = nullptr;
};

extern template class TileCaster<2>;
extern template class TileCaster<4>;

/// Follows single rays at one iso-value; one per thread.
class RayFollower
{
public:
  virtual ~RayFollower() = default;

  /// The first entry of the ray into the solid within span. What lies before is not known: a ray
  /// that starts in the solid leaves it first.
  virtual bool FindEntry(const Ray& ray, const RaySpan& span, RayEntry& entry) = 0;

  /// Where the ray, in the solid behind t0, leaves it; false when the volume or span ends before.
  virtual bool FindExit(const Ray& ray, double t0, const RaySpan& span, double& t) = 0;

  /// The field less the iso-value at an index point in the volume, not negative in the solid.
  virtual double Value(const Vec3& index) = 0;
};

class IsoField
{
public:
  virtual ~IsoField() = default;

  virtual std::unique_ptr<RayFollower> Follow(double isoValue) const = 0;

  /// What is done with the tiles of a map, from any thread.
  struct TileWork
  {
    /// Sets the spans of the tile's rays, see TileCaster. Empty: whole lines.
    std::function<void(const std::array<int, 4>& tile, RayFollower& follower, RaySpan* spans)>
      Prepare;
    std::function<void(const std::array<int, 4>& tile, RayFollower& follower, const TileEntries&)>
      Take;
  };
  virtual void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileWork& work,
    Execution& execution) const = 0;

  double Minimum = 0;
  double Maximum = 0;
  std::int64_t NumberOfNonFinite = 0;
};

/// volume: must outlive the result.
std::unique_ptr<const IsoField> MakeIsoField(const VoxelVolume& volume,
  FieldInterpolation interpolation, SolidSide side, Execution& execution);
}
#endif
