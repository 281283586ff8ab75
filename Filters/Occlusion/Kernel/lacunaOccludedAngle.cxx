// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOccludedAngle.h"

#include "lacunaDirections.h"
#include "lacunaOcclusionTile.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
const double Pi = 3.14159265358979323846;

// Up to this size a line is too little work to be divided among threads: lines are, in a fixed
// number of parts whose sums are added in a fixed order.
constexpr std::int64_t SmallGrid = 1 << 18;
constexpr std::int64_t LineParts = 16;

constexpr std::int64_t FlatTileLength = 512;
constexpr std::int64_t TileRows = 16;
constexpr std::int64_t StoreSize = 1 << 19; // floats: the paths of a tile stay in the cache

/// The hidden sums and how to march over them along each axis.
class Accumulator
{
public:
  Accumulator(AttenuationField& field, const OccludedAngleOptions& options, bool space,
    float* hidden, Execution& execution)
    : Field(field)
    , Options(options)
    , Space(space)
    , Hidden(hidden)
    , Runner(execution)
  {
    const std::int64_t voxels = field.GetNumberOfVoxels();
    if (voxels <= SmallGrid)
    {
      this->Parts.assign(LineParts * voxels, 0.0F);
    }
    std::fill_n(hidden, voxels, 0.0F);
    this->SortLines();
  }

  void Run()
  {
    this->March(2);
    this->March(1);
    this->SwapXY();
    this->March(1); // the former x axis
    this->AddParts();
    this->SwapXY();
  }

private:
  void SortLines()
  {
    const int count = this->Options.Directions / 2;
    const Vec3& spacing = this->Field.GetSpacing();
    for (const Vec3& line : this->Field.IsFlat() ? EqualAngleLines(count) : EqualAreaLines(count))
    {
      const Vec3 voxels{ line[0] / spacing[0], line[1] / spacing[1], line[2] / spacing[2] };
      int axis = 2;
      for (int candidate : { 1, 0 })
      {
        axis = std::abs(voxels[candidate]) > std::abs(voxels[axis]) ? candidate : axis;
      }
      this->Lines[axis].push_back(voxels);
    }
    this->LineCount = count;
  }

  void SwapXY()
  {
    const auto n = this->Field.GetDimensions();
    if (this->Parts.empty())
    {
      lacuna::SwapXY(this->Hidden, n[0], n[1], n[2], this->Runner);
    }
    else if (!this->Added)
    {
      lacuna::SwapXY(this->Parts.data(), n[0], n[1], n[2] * LineParts, this->Runner);
    }
    else
    {
      lacuna::SwapXY(this->Hidden, n[0], n[1], n[2], this->Runner);
    }
    this->Field.SwapXY(this->Runner);
    this->Swapped = !this->Swapped;
  }

  MarchFrame GetFrame(int axis, float* hidden) const
  {
    const auto n = this->Field.GetDimensions();
    const int row = axis == 2 ? 1 : 2;
    const std::int64_t strides[3] = { 1, n[0], n[0] * n[1] };
    return { n[0], n[row], n[axis], this->Field.Row(0, 0), this->Field.GetStride(row),
      this->Field.GetStride(axis), hidden, strides[row], strides[axis] };
  }

  static LinePath GetPath(const Vec3& line, int axis, bool swapped, std::int64_t layers)
  {
    const Vec3 v = swapped ? Vec3{ line[1], line[0], line[2] } : line;
    const int row = axis == 2 ? 1 : 2;
    return { v[0] / v[axis], v[row] / v[axis], 1 / std::abs(v[axis]), layers };
  }

  std::vector<RayTile> GetTiles(const MarchFrame& frame, const LinePath& path) const
  {
    RayTile all{};
    path.GetRays(frame.Length, path.GetSlopeX(), all.FirstX, all.LastX);
    path.GetRays(frame.Rows, path.GetSlopeY(), all.FirstY, all.LastY);
    const bool flat = frame.Rows == 1;
    if (flat)
    {
      all.FirstY = 0;
      all.LastY = 1;
    }
    const std::int64_t plane = (all.LastX - all.FirstX) * (frame.Layers + 1);
    const bool stored = this->Space || this->Options.Radius > 0;
    const std::int64_t rows =
      stored ? std::min(TileRows, std::max<std::int64_t>(2, StoreSize / plane)) : TileRows;
    const std::int64_t length = flat ? FlatTileLength : all.LastX - all.FirstX;
    std::vector<RayTile> tiles;
    for (std::int64_t q = all.FirstY; q < all.LastY; q += rows)
    {
      for (std::int64_t r = all.FirstX; r < all.LastX; r += length)
      {
        tiles.push_back(
          { r, std::min(all.LastX, r + length), q, std::min(all.LastY, q + rows) });
      }
    }
    return tiles;
  }

  void March(int axis)
  {
    const std::vector<Vec3>& lines = this->Lines[this->Swapped ? 0 : axis];
    const auto marchTiles = [&](TileMarch& march, const Vec3& line, float* hidden,
                              const std::vector<RayTile>& tiles, std::int64_t b, std::int64_t e)
    {
      const MarchFrame frame = this->GetFrame(axis, hidden);
      const LinePath path = GetPath(line, axis, this->Swapped, frame.Layers);
      for (std::int64_t t = b; t < e; ++t)
      {
        march.March(frame, path, tiles[t]);
      }
    };
    const auto tilesOf = [&](const Vec3& line)
    {
      const MarchFrame frame = this->GetFrame(axis, nullptr);
      return this->GetTiles(frame, GetPath(line, axis, this->Swapped, frame.Layers));
    };
    const double first = this->LinesDone / this->LineCount;
    const std::int64_t count = static_cast<std::int64_t>(lines.size());
    if (!this->Parts.empty())
    {
      this->Runner.SetStage(first, (this->LinesDone + count) / this->LineCount);
      this->Runner.For(LineParts, 1,
        [&](std::int64_t begin, std::int64_t end)
        {
          TileMarch march(this->Options.Binary, this->Options.Radius, this->Space);
          for (std::int64_t part = begin; part < end; ++part)
          {
            float* hidden = this->Parts.data() + part * this->Field.GetNumberOfVoxels();
            for (std::int64_t i = part; i < count; i += LineParts)
            {
              const std::vector<RayTile> tiles = tilesOf(lines[i]);
              marchTiles(march, lines[i], hidden, tiles, 0, static_cast<std::int64_t>(tiles.size()));
            }
          }
        });
      this->LinesDone += count;
      return;
    }
    for (const Vec3& line : lines)
    {
      const std::vector<RayTile> tiles = tilesOf(line);
      this->Runner.SetStage(
        this->LinesDone / this->LineCount, (this->LinesDone + 1) / this->LineCount);
      this->Runner.For(static_cast<std::int64_t>(tiles.size()), 1,
        [&](std::int64_t begin, std::int64_t end)
        {
          TileMarch march(this->Options.Binary, this->Options.Radius, this->Space);
          marchTiles(march, line, this->Hidden, tiles, begin, end);
        });
      this->LinesDone += 1;
    }
  }

  void AddParts()
  {
    const std::int64_t voxels = this->Field.GetNumberOfVoxels();
    for (std::int64_t part = 0; part * voxels < static_cast<std::int64_t>(this->Parts.size());
         ++part)
    {
      const float* sums = this->Parts.data() + part * voxels;
      for (std::int64_t i = 0; i < voxels; ++i)
      {
        this->Hidden[i] += sums[i];
      }
    }
    this->Added = true;
  }

  AttenuationField& Field;
  const OccludedAngleOptions& Options;
  bool Space;
  float* Hidden;
  Execution& Runner;
  std::vector<float> Parts;
  bool Added = false;
  bool Swapped = false;
  std::vector<Vec3> Lines[3];
  double LineCount = 1;
  double LinesDone = 0;
};
}

double GetFullAngle(const AttenuationField& field)
{
  return field.IsFlat() ? 2 * Pi : 4 * Pi;
}

void ComputeOccludedAngle(AttenuationField& field, const OccludedAngleOptions& options,
  float* angle, Execution& execution)
{
  const auto& n = field.GetDimensions();
  bool space = false;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      const float* row = field.Row(j, k);
      space = space || std::any_of(row, row + n[0], AttenuationField::IsOutsideSpace);
    }
  Accumulator(field, options, space, angle, execution).Run();
  const float scale = static_cast<float>(GetFullAngle(field) / options.Directions);
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      const float* row = field.Row(j, k);
      float* out = angle + (k * n[1] + j) * n[0];
      for (std::int64_t i = 0; i < n[0]; ++i)
        out[i] = AttenuationField::IsOutsideSpace(row[i]) ? 0.0F : scale * out[i];
    }
}
}
