// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far down a tool can go: exact against facets, edges and vertices of a surface.
#ifndef lacunaDropCutter_h
#define lacunaDropCutter_h

#include "lacunaSurfaceFit.h"
#include "lacunaVector.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// A surface of triangles over a structured grid of points, single valued as the mill sees it along
/// -z. Each cell is cut along its diagonal from point (i, j) to (i + 1, j + 1). The triangles are
/// the part: whatever is said to be exact is exact for them.
class MillSurface
{
public:
  /// Takes points in mm, column fastest. Throws std::invalid_argument, naming the place, when there
  /// are fewer than 2 x 2, one is not finite, or neighbouring triangles face different ways or are
  /// upright, that is, the surface folds back. Whether parts of it that are far apart in the grid
  /// overlap is not seen; the highest counts.
  MillSurface(GridSize size, std::vector<Vec3> points);

  GridSize GetSize() const { return this->Size; }
  const std::vector<Vec3>& GetPoints() const { return this->Points; }
  const Vec3& At(std::int64_t i, std::int64_t j) const
  {
    return this->Points[static_cast<std::size_t>(i + this->Size.Columns * j)];
  }
  /// Corners of the box around the points.
  const Vec3& GetLowest() const { return this->Lowest; }
  const Vec3& GetHighest() const { return this->Highest; }
  /// The smaller one of the mean distances in x and y of neighbours along columns and along rows.
  double GetSpacing() const { return this->Spacing; }

  /// Unit normals at the points, with z > 0: of the triangles around, weighted by their angles.
  std::vector<Vec3> GetNormals() const;

  /// Cells that are looked at together, and the box around their corners.
  struct Block
  {
    std::int32_t Column;
    std::int32_t Row; ///< of the first cell
    float Low[2];     ///< x, y, rounded outwards
    float High[2];
    double Top; ///< largest z
  };
  static constexpr int BlockSize = 4; ///< cells along either side

  /// Calls visit(block) once for each block that may reach into a rectangle.
  template <class Visitor>
  void VisitBlocks(const Vec2& low, const Vec2& high, Visitor&& visit) const
  {
    const BinRange query = this->GetBins(low, high);
    for (std::int32_t v = query.First[1]; v <= query.Last[1]; ++v)
    {
      for (std::int32_t u = query.First[0]; u <= query.Last[0]; ++u)
      {
        const std::int64_t bin = u + std::int64_t{ this->Bins[0] } * v;
        for (std::int64_t k = this->BinStarts[bin]; k < this->BinStarts[bin + 1]; ++k)
        {
          const Entry& entry = this->Entries[k];
          // a block in several bins is seen in the first one of them that is in the query
          if ((u == entry.First[0] || u == query.First[0]) &&
            (v == entry.First[1] || v == query.First[1]))
          {
            visit(this->Blocks[entry.Block]);
          }
        }
      }
    }
  }

private:
  struct BinRange
  {
    std::int32_t First[2];
    std::int32_t Last[2];
  };
  struct Entry
  {
    std::int32_t Block;
    std::int32_t First[2]; ///< first bin of the block
  };

  void CheckTriangles() const;
  void MakeBlocks();
  void MakeBins();
  BinRange GetBins(const Vec2& low, const Vec2& high) const;

  GridSize Size;
  std::vector<Vec3> Points;
  Vec3 Lowest{ 0, 0, 0 };
  Vec3 Highest{ 0, 0, 0 };
  double Spacing = 0;
  std::vector<Block> Blocks;
  std::int32_t Bins[2] = { 1, 1 };
  double BinSize[2] = { 1, 1 };
  std::vector<std::int64_t> BinStarts;
  std::vector<Entry> Entries;
};

enum class ToolShape
{
  Ball = 0, ///< ball end
  Flat = 1  ///< square end
};
inline constexpr std::array<const char*, 2> ToolShapeNames{ "Ball", "Flat" };

/// An upright tool. Its place is its tip, the lowest point of its axis.
struct MillTool
{
  ToolShape Shape = ToolShape::Ball;
  double Radius = 4; ///< mm
};

/// Drops a tool onto a surface. A ball touches where its centre lies on the offset of the surface:
/// of a facet a plane, of an edge a cylinder, of a vertex a ball; a square end touches with its rim
/// or, on level ground, its face. All are solved in closed form; what cannot be higher than what was
/// found already is passed over in blocks. The shank above a ball end is as thick as the ball.
class DropCutter
{
public:
  /// allowance: mm of stock to leave on the surface (along the normal for a ball, at least this
  /// along z and sideways for a square end). surface is not owned.
  DropCutter(const MillSurface& surface, const MillTool& tool, double allowance = 0);

  /// Memory of a thread, so that no call allocates.
  struct Scratch
  {
    struct Candidate
    {
      double Bound;
      const MillSurface::Block* Block;
    };
    std::vector<Candidate> Candidates;
  };

  /// Lowest z of the tip at x, y at which the tool does not cut the surface; -infinity where the
  /// surface is not below it. Within 1e-9 mm.
  double Drop(double x, double y, Scratch& scratch) const;

  /// As Drop, but outside of the rectangle around the surface the tool does not go lower than the
  /// extension of its own way: level where it is level or rises at the nearest point of the
  /// rectangle's border, and where it goes down there, twice as steep, so that a ball reaches the
  /// lowest part of a border that slopes down. Never lower than Drop, and never lower than the tip
  /// has to be to touch an edge as high as the surface's lowest point: at most a radius below it.
  double DropBeyond(double x, double y, Scratch& scratch) const;

  struct Excess
  {
    double Height;   ///< mm, by which the motion is too low where it is lowest; -infinity: nowhere
    double Fraction; ///< 0..1, where from start to end
  };
  /// How much too low the straight motion of the tip from a to b is anywhere strictly between
  /// them, apart from where that is at an end (see Drop). Exact: found as the stationary points of
  /// the height of the tool over each edge and vertex, not by sampling. What is not larger than
  /// tolerance may be passed over.
  Excess FindExcess(const Vec3& a, const Vec3& b, double tolerance) const;

private:
  struct Dropping;
  struct Sweeping;

  const MillSurface& Surface;
  bool Ball;
  double Radius;    ///< with the allowance
  double TipOffset; ///< from the reference point (centre of the ball, middle of the face)
};
}
#endif
