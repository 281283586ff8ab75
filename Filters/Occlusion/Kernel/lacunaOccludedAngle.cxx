// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOccludedAngle.h"

#include "lacunaOcclusionTile.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
const double Pi = 3.14159265358979323846;
}

std::vector<Vec3> EqualAngleLines(int count)
{
  std::vector<Vec3> lines;
  lines.reserve(count);
  for (int i = 0; i < count; ++i)
  {
    const double angle = (i + 0.5) * Pi / count;
    lines.push_back({ std::cos(angle), std::sin(angle), 0 });
  }
  return lines;
}

std::vector<Vec3> EqualAreaLines(int count)
{
  const double turn = 2 * Pi * (std::sqrt(5.0) - 1) / 2;
  std::vector<Vec3> lines;
  lines.reserve(count);
  for (int i = 0; i < count; ++i)
  {
    const double z = (i + 0.5) / count; // slices of equal height have equal area
    const double r = std::sqrt(1 - z * z);
    lines.push_back({ r * std::cos(i * turn), r * std::sin(i * turn), z });
  }
  return lines;
}

//------------------------------------------------------------------------------
namespace
{
// Up to this size a line is too little work to be divided among threads: lines are, in a fixed
// number of parts.
constexpr std::int64_t SmallGrid = 1 << 18;
constexpr std::int64_t LineParts = 16;

constexpr std::int64_t FlatTileLength = 512;
constexpr std::int64_t TileRows = 16;
constexpr std::int64_t StoreSize = 1 << 19; // floats: the paths of a tile stay in the cache

/// The sums over lines, and how to march along each axis.
class Accumulator
{
public:
  Accumulator(AttenuationField& field, const OccludedAngleOptions& options, bool space,
    std::uint32_t* hidden, Execution& execution, const Ranks& ranks)
    : Field(field)
    , Options(options)
    , Space(space)
    , Hidden(hidden)
    , Runner(execution)
    , Sharing(ranks)
  {
  }

  void Run()
  {
    this->Sharing.Together([this] { this->MarchAll(); });
    const std::int64_t voxels = this->Field.GetNumberOfVoxels();
    if (this->Totals.empty())
    {
      this->Sharing.Sum(this->Hidden, voxels);
    }
    else
    {
      this->Sharing.Sum(this->Totals.data(), voxels);
    }
  }

  /// In units; after Run.
  double GetSum(std::int64_t voxel) const
  {
    return this->Totals.empty() ? this->Hidden[voxel] : static_cast<double>(this->Totals[voxel]);
  }

private:
  struct Line
  {
    Vec3 Voxels; ///< per mm
    double OffsetX;
    double OffsetY;
  };

  void MarchAll()
  {
    const std::int64_t voxels = this->Field.GetNumberOfVoxels();
    if (voxels <= SmallGrid)
    {
      this->Parts.assign(LineParts * voxels, 0);
    }
    if (GetOccludedAngleMemory(this->Options.Directions) > 0)
    {
      this->Totals.assign(voxels, 0);
    }
    this->SortLines();
    const std::int64_t nz = this->Field.GetDimensions()[2];
    this->MarchBlocks(2, this->Lines[2], false);
    this->MarchBlocks(1, this->Lines[1], false);
    // Rows shall be contiguous in memory: lines along x march along y of the swapped grid.
    this->SwapXY(nz);
    this->MarchBlocks(1, this->Lines[0], true);
    this->SwapXY(nz);
  }

  /// Those of this rank, dealt like cards: neighbours cost the same.
  void SortLines()
  {
    const int count = this->Options.Directions / 2;
    const Vec3& spacing = this->Field.GetSpacing();
    double number = 0;
    std::int64_t dealt[3] = { 0, 0, 0 };
    for (const Vec3& line : this->Field.IsFlat() ? EqualAngleLines(count) : EqualAreaLines(count))
    {
      const Vec3 voxels{ line[0] / spacing[0], line[1] / spacing[1], line[2] / spacing[2] };
      int axis = 2;
      for (int candidate : { 1, 0 })
      {
        axis = std::abs(voxels[candidate]) > std::abs(voxels[axis]) ? candidate : axis;
      }
      // Offsets of low discrepancy: no place of the grid lies on rays of many directions.
      ++number;
      const double offsetX = std::fmod(number * 0.7548776662466927, 1.0);
      const double offsetY = std::fmod(number * 0.5698402909980532, 1.0);
      if (dealt[axis]++ % this->Sharing.GetNumber() == this->Sharing.GetRank())
      {
        this->Lines[axis].push_back({ voxels, offsetX, this->Field.IsFlat() ? 0 : offsetY });
        this->LineCount += 1;
      }
    }
  }

  void SwapXY(std::int64_t planes)
  {
    const auto& n = this->Field.GetDimensions();
    if (this->Totals.empty())
    {
      lacuna::SwapXY(this->Hidden, n[0], n[1], planes, this->Runner);
    }
    else
    {
      lacuna::SwapXY(this->Totals.data(), n[0], n[1], planes, this->Runner);
    }
    this->Field.SwapXY(this->Runner);
  }

  /// As many lines at a time as one sum holds, if there are more.
  void MarchBlocks(int axis, const std::vector<Line>& lines, bool swapped)
  {
    const std::size_t block = this->Totals.empty() ? lines.size() : LinesPerSum;
    for (std::size_t first = 0; first < lines.size(); first += block)
    {
      const std::size_t last = std::min(lines.size(), first + block);
      this->March(axis, { lines.begin() + first, lines.begin() + last }, swapped);
      this->AddParts();
    }
  }

  MarchFrame GetFrame(int axis, std::uint32_t* hidden) const
  {
    const auto& n = this->Field.GetDimensions();
    const int row = axis == 2 ? 1 : 2;
    const std::int64_t strides[3] = { 1, n[0], n[0] * n[1] };
    return { n[0], n[row], n[axis], this->Field.Row(0, 0), this->Field.GetStride(row),
      this->Field.GetStride(axis), hidden, strides[row], strides[axis] };
  }

  static LinePath GetPath(const Line& line, int axis, bool swapped, std::int64_t layers)
  {
    const Vec3 v = swapped ? Vec3{ line.Voxels[1], line.Voxels[0], line.Voxels[2] } : line.Voxels;
    const int row = axis == 2 ? 1 : 2;
    return { v[0] / v[axis], v[row] / v[axis], line.OffsetX, line.OffsetY, 1 / std::abs(v[axis]),
      layers };
  }

  std::vector<RayTile> GetTiles(const MarchFrame& frame, const LinePath& path) const
  {
    RayTile all{};
    path.GetRays(0, frame.Length, all.FirstX, all.LastX);
    path.GetRays(1, frame.Rows, all.FirstY, all.LastY);
    const bool flat = frame.Rows == 1;
    const std::int64_t width = all.LastX - all.FirstX;
    const std::int64_t length = flat ? std::min(width, FlatTileLength) : width;
    const bool stored = this->Space || this->Options.Radius > 0;
    const std::int64_t rows =
      stored ? std::clamp<std::int64_t>(StoreSize / (width * frame.Layers), 2, TileRows) : TileRows;
    std::vector<RayTile> tiles;
    for (std::int64_t q = all.FirstY; q < all.LastY; q += rows)
    {
      for (std::int64_t r = all.FirstX; r < all.LastX; r += length)
      {
        tiles.push_back({ r, std::min(all.LastX, r + length), q, std::min(all.LastY, q + rows) });
      }
    }
    return tiles;
  }

  MarchOptions GetMarchOptions() const
  {
    return { this->Options.Binary, this->Options.Radius, this->Space,
      static_cast<float>(this->Options.Dilation) };
  }

  void SetStage(std::int64_t lines)
  {
    const double all = std::max(1.0, this->LineCount);
    const double length = this->Options.LastProgress - this->Options.FirstProgress;
    const double first = this->Options.FirstProgress + length * this->LinesDone / all;
    this->LinesDone += static_cast<double>(lines);
    this->Runner.SetStage(first, this->Options.FirstProgress + length * this->LinesDone / all);
  }

  /// Marches lines along an axis of the field as it lies now.
  void March(int axis, const std::vector<Line>& lines, bool swapped)
  {
    const std::int64_t count = static_cast<std::int64_t>(lines.size());
    const std::int64_t layers = this->Field.GetDimensions()[axis];
    if (this->Parts.empty())
    {
      for (const Line& line : lines)
      {
        const MarchFrame frame = this->GetFrame(axis, this->Hidden);
        const LinePath path = GetPath(line, axis, swapped, layers);
        const std::vector<RayTile> tiles = this->GetTiles(frame, path);
        this->SetStage(1);
        this->Runner.For(static_cast<std::int64_t>(tiles.size()), 1,
          [&](std::int64_t begin, std::int64_t end)
          {
            TileMarch march(this->GetMarchOptions());
            for (std::int64_t t = begin; t < end; ++t)
            {
              march.March(frame, path, tiles[t]);
            }
          });
      }
      return;
    }
    this->SetStage(count);
    this->Runner.For(LineParts, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        TileMarch march(this->GetMarchOptions());
        for (std::int64_t part = begin; part < end; ++part)
        {
          const MarchFrame frame =
            this->GetFrame(axis, this->Parts.data() + part * this->Field.GetNumberOfVoxels());
          for (std::int64_t i = part; i < count; i += LineParts)
          {
            const LinePath path = GetPath(lines[i], axis, swapped, layers);
            for (const RayTile& tile : this->GetTiles(frame, path))
            {
              march.March(frame, path, tile);
            }
          }
        }
      });
  }

  void AddParts()
  {
    const std::int64_t voxels = this->Field.GetNumberOfVoxels();
    const std::int64_t all = static_cast<std::int64_t>(this->Parts.size());
    for (std::int64_t first = 0; first < all; first += voxels)
    {
      std::transform(this->Parts.begin() + first, this->Parts.begin() + first + voxels,
        this->Hidden, this->Hidden, std::plus<>());
    }
    std::fill(this->Parts.begin(), this->Parts.end(), 0U);
    for (std::size_t i = 0; i < this->Totals.size(); ++i)
    {
      this->Totals[i] += this->Hidden[i];
      this->Hidden[i] = 0;
    }
  }

  AttenuationField& Field;
  const OccludedAngleOptions& Options;
  bool Space;
  std::uint32_t* Hidden;
  Execution& Runner;
  const Ranks& Sharing;
  std::vector<std::uint32_t> Parts;
  std::vector<std::uint64_t> Totals; ///< when there are too many lines for Hidden alone
  std::vector<Line> Lines[3];
  double LineCount = 0;
  double LinesDone = 0;
};

void Check(const AttenuationField& field, const OccludedAngleOptions& options)
{
  if (options.Directions < 2 || options.Directions % 2 != 0)
  {
    throw std::invalid_argument("the number of directions is " +
      std::to_string(options.Directions) + "; it must be even (a line serves two) and at least 2");
  }
  if (options.Radius != 0 && !(options.Radius >= field.GetShortestEdge()))
  {
    throw std::invalid_argument("a local radius of " + std::to_string(options.Radius) +
      " mm is smaller than a voxel; give at least " + std::to_string(field.GetShortestEdge()) +
      " mm, or 0 for the whole reconstruction space");
  }
  DilationRange.Check("Dilation", options.Dilation);
}
}

double GetFullAngle(const AttenuationField& field)
{
  return field.IsFlat() ? 2 * Pi : 4 * Pi;
}

int GetOccludedAngleMemory(int directions)
{
  return directions / 2 > LinesPerSum ? sizeof(std::uint64_t) : 0;
}

void ComputeOccludedAngle(AttenuationField& field, const OccludedAngleOptions& options,
  float* angle, Execution& execution, const Ranks& ranks)
{
  Check(field, options);
  const auto n = field.GetDimensions();
  bool space = false;
  for (std::int64_t row = 0; row < n[1] * n[2]; ++row)
  {
    const float* values = field.Row(row % n[1], row / n[1]);
    space = space || std::any_of(values, values + n[0], AttenuationField::IsOutsideSpace);
  }
  // The sums are where the angle will be: it may be most of the memory.
  static_assert(sizeof(float) == sizeof(std::uint32_t), "they take each other's place");
  auto* hidden = reinterpret_cast<std::uint32_t*>(angle);
  std::uninitialized_fill_n(hidden, field.GetNumberOfVoxels(), 0U);
  Accumulator accumulator(field, options, space, hidden, execution, ranks);
  accumulator.Run();
  const double scale = GetFullAngle(field) / options.Directions / HiddenUnits;
  for (std::int64_t row = 0; row < n[1] * n[2]; ++row)
  {
    const float* values = field.Row(row % n[1], row / n[1]);
    for (std::int64_t i = 0; i < n[0]; ++i)
    {
      const auto seen = static_cast<float>(scale * accumulator.GetSum(row * n[0] + i));
      new (angle + row * n[0] + i) float(AttenuationField::IsOutsideSpace(values[i]) ? 0.0F : seen);
    }
  }
}
}
