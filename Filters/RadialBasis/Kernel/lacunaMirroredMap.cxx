// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirroredMap.h"

#include "lacunaSymmetrySearch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr int LevelCells[] = { 40, 100, 250 }; // at most, along the longer edge
constexpr std::size_t LeastPoints = 100;
constexpr double LeastOverlap = 0.5;
constexpr double Tolerance = 0.03;  // of half the diagonal of the box around the surface
constexpr double LeastFacing = 0.2; // cosine between a mirrored normal and the view
constexpr int NumberOfDirections = 500;
constexpr double MostAlongView = 0.70710678; // cosine of 45 degrees
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

// mm along the map's right, down and view direction, from its first pixel.
struct OwnFrame
{
  explicit OwnFrame(const DepthGrid& map)
  {
    const Matrix4& m = map.ImageToWorld;
    const Vec3 corner{ static_cast<double>(map.Extent[0]), static_cast<double>(map.Extent[2]), 0 };
    this->Origin = m.Point(corner);
    for (int a = 0; a < 3; ++a)
    {
      this->Axes[a] = Normalized(m.Column(a));
    }
    this->Spacing = { Norm(m.Column(0)), Norm(m.Column(1)) };
  }
  MirrorPlane ToWorld(const MirrorPlane& own) const
  {
    const Vec3& n = own.Normal;
    const Vec3 normal = n[0] * this->Axes[0] + n[1] * this->Axes[1] + n[2] * this->Axes[2];
    return { normal, own.Offset + Dot(normal, this->Origin) };
  }

  Vec3 Origin{ 0, 0, 0 };
  std::array<Vec3, 3> Axes{};
  Vec2 Spacing{};
};

// Means of blocks of pixels as a height field, bilinear in between.
class MapLevel : public SymmetryLevel
{
public:
  MapLevel(const DepthGrid& map, const OwnFrame& frame, double wantedCell)
  {
    const int pixels[2] = { map.Extent[1] - map.Extent[0] + 1, map.Extent[3] - map.Extent[2] + 1 };
    int block[2];
    for (int a = 0; a < 2; ++a)
    {
      block[a] = static_cast<int>(std::clamp(
        wantedCell / frame.Spacing[a] + 0.5, 1.0, std::max(1.0, std::floor(pixels[a] / 4.0))));
      this->Size[a] = pixels[a] / block[a];
      this->Cell[a] = block[a] * frame.Spacing[a];
      this->First[a] = (block[a] - 1) / 2.0 * frame.Spacing[a];
    }
    this->CellSize = std::min(this->Cell[0], this->Cell[1]);
    Vec3 low{ 1e300, 1e300, 1e300 };
    Vec3 high{ -1e300, -1e300, -1e300 };
    for (int j = 0; j < this->Size[1]; ++j)
    {
      for (int i = 0; i < this->Size[0]; ++i)
      {
        const double depth = AverageOf(map, block, i, j);
        this->Depths.push_back(depth);
        if (!std::isnan(depth))
        {
          const Vec3 p{ this->First[0] + i * this->Cell[0], this->First[1] + j * this->Cell[1],
            depth };
          this->Points.push_back(p);
          for (int a = 0; a < 3; ++a)
          {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
          }
        }
      }
    }
    if (!this->Points.empty())
    {
      this->Center = 0.5 * (low + high);
      this->HalfSize = 0.5 * (high - low);
    }
    this->FindNormals();
    this->Reach = Tolerance * Norm(this->HalfSize);
    this->CellResidual = 0.5 * this->CellSize; // on a slope of 30 degrees
  }

  std::size_t GetNumberOfPoints() const { return this->Points.size(); }

  double Rate(const MirrorPlane& plane) const override
  {
    double sum = 0;
    double seen = 0;
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      Vec3 mirrored{ 0, 0, 0 };
      Vec3 normal{ 0, 0, 0 };
      const double r = this->DistanceOfImage(i, plane, mirrored, normal);
      if (!std::isnan(r))
      {
        const double t = r / this->Reach;
        const double parallel = 2 * Dot(mirrored, normal) - 1; // 0 from 60 degrees
        sum += std::max(0.0, 1 - t * t) * std::max(0.0, parallel);
        seen += 1;
      }
    }
    const double all = static_cast<double>(this->Points.size());
    return seen > 0 && sum > 0 ? sum / std::max(seen, LeastOverlap * all) : -1;
  }

  std::vector<double> GetResiduals(const MirrorPlane& plane, Execution&) const override
  {
    std::vector<double> residuals;
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      Vec3 mirrored{ 0, 0, 0 };
      Vec3 normal{ 0, 0, 0 };
      const double r = std::abs(this->DistanceOfImage(i, plane, mirrored, normal));
      if (!std::isnan(r))
      {
        residuals.push_back(r);
      }
    }
    return residuals;
  }

  SymmetryEquations Linearize(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
    double limit, Execution& execution) const override
  {
    return SumOverBlocks<SymmetryEquations>(execution,
      static_cast<std::int64_t>(this->Points.size()), 4096,
      [&](std::int64_t begin, std::int64_t end)
      {
        SymmetryEquations equations;
        const Vec3& n = plane.Normal;
        for (std::int64_t i = begin; i < end; ++i)
        {
          const Vec3& x = this->Points[i];
          Vec3 mirrored{ 0, 0, 0 };
          Vec3 normal{ 0, 0, 0 };
          const double residual = this->DistanceOfImage(i, plane, mirrored, normal);
          if (std::isnan(residual))
          {
            continue;
          }
          // as in volumes, with the image's distance along the surface's normal as the residual
          const double along = Dot(normal, n);
          const double distance = plane.Distance(x);
          const Vec3 arm = x - this->Center;
          std::array<double, 3> slopes;
          for (std::size_t k = 0; k < 2; ++k)
          {
            slopes[k] = -2 * (Dot(turns[k], arm) * along + distance * Dot(normal, turns[k]));
          }
          slopes[2] = 2 * along;
          equations.Add(residual, slopes, limit);
        }
        return equations;
      });
  }

private:
  // NaN unless more than half of the block's pixels have a depth.
  static double AverageOf(const DepthGrid& map, const int* block, int i, int j)
  {
    double sum = 0;
    int count = 0;
    for (int r = j * block[1]; r < (j + 1) * block[1]; ++r)
    {
      for (int c = i * block[0]; c < (i + 1) * block[0]; ++c)
      {
        const double d = map.Depth[map.PixelOf(map.Extent[0] + c, map.Extent[2] + r)];
        if (std::isfinite(d))
        {
          sum += d;
          ++count;
        }
      }
    }
    return 2 * count > block[0] * block[1] ? sum / count : NaN;
  }

  // Normals of the surface at the points, away from the viewer.
  void FindNormals()
  {
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      const Vec3& p = this->Points[i];
      Vec3 normal{ 0, 0, 1 };
      Vec3 sum{ 0, 0, 0 };
      for (const double right : { -0.5, 0.5 })
      {
        for (const double down : { -0.5, 0.5 })
        {
          const Vec3 aside{ p[0] + right * this->Cell[0], p[1] + down * this->Cell[1], p[2] };
          if (!std::isnan(this->Distance(aside, normal)))
          {
            sum = sum + normal;
          }
        }
      }
      this->Normals.push_back(Normalized(sum));
    }
  }

  // Distance of a point's mirror image from the surface, its normal mirrored, and that of the surface
  // there. NaN where there is no surface, or the image would show its back and so not be seen.
  double DistanceOfImage(
    std::size_t point, const MirrorPlane& plane, Vec3& mirrored, Vec3& normal) const
  {
    mirrored = plane.ReflectDirection(this->Normals[point]);
    return mirrored[2] > LeastFacing ? this->Distance(plane.Reflect(this->Points[point]), normal)
                                     : NaN;
  }

  // Of a point from the surface, along the surface's normal there (away from the viewer); positive
  // behind it. NaN where there is no surface.
  double Distance(const Vec3& x, Vec3& normal) const
  {
    int base[2];
    double t[2];
    for (int a = 0; a < 2; ++a)
    {
      const double u = (x[a] - this->First[a]) / this->Cell[a];
      if (!(u >= 0) || !(u <= this->Size[a] - 1) || this->Size[a] < 2)
      {
        return NaN;
      }
      base[a] = std::min(static_cast<int>(u), this->Size[a] - 2);
      t[a] = u - base[a];
    }
    const double* p = &this->Depths[base[0] + static_cast<std::size_t>(this->Size[0]) * base[1]];
    const double upper = p[0] + t[0] * (p[1] - p[0]);
    const double lower = p[this->Size[0]] + t[0] * (p[this->Size[0] + 1] - p[this->Size[0]]);
    const double zx =
      ((1 - t[1]) * (p[1] - p[0]) + t[1] * (p[this->Size[0] + 1] - p[this->Size[0]])) /
      this->Cell[0];
    const double zy = (lower - upper) / this->Cell[1];
    const double cosine = 1 / std::sqrt(1 + zx * zx + zy * zy);
    normal = { -zx * cosine, -zy * cosine, cosine };
    return (x[2] - upper - t[1] * (lower - upper)) * cosine;
  }

  std::array<int, 2> Size{};
  Vec2 Cell{};
  Vec2 First{};
  std::vector<double> Depths;
  std::vector<Vec3> Points;
  std::vector<Vec3> Normals;
  double Reach = 0;
};
}

//------------------------------------------------------------------------------
SymmetryResult FindSymmetryPlane(const DepthGrid& map, Execution& execution)
{
  const OwnFrame frame(map);
  const double longest = std::max((map.Extent[1] - map.Extent[0] + 1) * frame.Spacing[0],
    (map.Extent[3] - map.Extent[2] + 1) * frame.Spacing[1]);
  std::vector<std::unique_ptr<SymmetryLevel>> levels;
  for (const int cells : LevelCells)
  {
    const double cell = longest / cells;
    auto level = std::make_unique<MapLevel>(map, frame, cell);
    if (level->GetNumberOfPoints() >= LeastPoints)
    {
      levels.push_back(std::move(level));
    }
    if (cell < 1.5 * std::min(frame.Spacing[0], frame.Spacing[1]))
    {
      break;
    }
  }
  if (levels.empty())
  {
    throw std::runtime_error("the depth map has too few pixels with a depth (100 at least) to find "
                             "a plane of symmetry; give a plane instead");
  }
  std::vector<Vec3> directions;
  for (const Vec3& n : HemisphereDirections(NumberOfDirections))
  {
    if (std::abs(n[2]) < MostAlongView)
    {
      directions.push_back(n);
    }
  }
  SymmetryResult result = FindSymmetryPlane(levels, directions, execution);
  result.Plane = frame.ToWorld(result.Plane);
  return result;
}

//------------------------------------------------------------------------------
namespace
{

// Triangles of the mirrored surface, in columns, rows and depths, cast to the pixels.
class Raster
{
public:
  Raster(const DepthGrid& map, const float* normals, const MirrorPlane& plane,
    const DepthMapMesher& mesher, Execution& execution)
    : Plane(plane)
    , Given(normals)
    , Width(map.Extent[1] - map.Extent[0] + 1)
    , Height(map.Extent[3] - map.Extent[2] + 1)
    , Points(static_cast<std::size_t>(mesher.GetNumberOfPoints()) * 3)
    , Pixels(static_cast<std::size_t>(mesher.GetNumberOfPoints()))
    , Corners(static_cast<std::size_t>(mesher.GetNumberOfTriangles()) * 3)
  {
    mesher.FillPoints(this->Points.data(), this->Pixels.data(), execution);
    mesher.FillTriangles(this->Corners.data(), execution);
    const Matrix4 toMap = map.ImageToWorld.Inverse();
    execution.For(static_cast<std::int64_t>(this->Pixels.size()), 4096,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          double* p = &this->Points[3 * i];
          const Vec3 q = toMap.Point(plane.Reflect({ p[0], p[1], p[2] }));
          p[0] = q[0] - map.Extent[0];
          p[1] = q[1] - map.Extent[2];
          p[2] = q[2];
        }
      });
    if (!this->Corners.empty())
    {
      // All triangles of the map show their fronts, and go round the same way; mirrored ones that
      // show their fronts go round the other way.
      long long x[3];
      long long y[3];
      for (int c = 0; c < 3; ++c)
      {
        x[c] = this->Pixels[this->Corners[c]] % this->Width;
        y[c] = this->Pixels[this->Corners[c]] / this->Width;
      }
      this->FrontIsPositive = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]) < 0;
    }
    this->Sort();
  }

  void Cast(MirroredMap& result, Execution& execution) const
  {
    execution.For(static_cast<std::int64_t>(this->Bands.size()), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t b = begin; b < end; ++b)
        {
          this->CastBand(static_cast<int>(b), result);
        }
      });
  }

private:
  static constexpr int BandRows = 16;
  // of a pixel: those on an edge between triangles are on both in spite of rounding
  static constexpr double Slack = 1e-9;

  const double* PointOf(std::int64_t triangle, int corner) const
  {
    return &this->Points[3 * this->Corners[3 * triangle + corner]];
  }

  // Which triangles reach which bands of rows.
  void Sort()
  {
    this->Bands.resize((this->Height + BandRows - 1) / BandRows);
    for (std::int64_t t = 0; t < static_cast<std::int64_t>(this->Corners.size() / 3); ++t)
    {
      double low = this->PointOf(t, 0)[1];
      double high = low;
      bool isFinite = true; // it is not when the plane lies 1e308 mm away
      for (int c = 0; c < 3; ++c)
      {
        const double* p = this->PointOf(t, c);
        low = std::min(low, p[1]);
        high = std::max(high, p[1]);
        isFinite = isFinite && std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
      }
      if (!isFinite || high < -1 || low > this->Height)
      {
        continue;
      }
      const int first = static_cast<int>(std::max(0.0, std::floor(low))) / BandRows;
      const int last = static_cast<int>(std::min(this->Height - 1.0, std::ceil(high))) / BandRows;
      for (int b = first; b <= last; ++b)
      {
        this->Bands[b].push_back(t);
      }
    }
  }

  void CastBand(int band, MirroredMap& result) const
  {
    const int firstRow = band * BandRows;
    const int endRow = std::min(this->Height, firstRow + BandRows);
    const auto pixels = static_cast<std::size_t>(this->Width) * (endRow - firstRow);
    const std::size_t start = static_cast<std::size_t>(this->Width) * firstRow;
    std::vector<unsigned char> front(pixels, 0);
    for (const std::int64_t t : this->Bands[band])
    {
      const double* a = this->PointOf(t, 0);
      const double* b = this->PointOf(t, 1);
      const double* c = this->PointOf(t, 2);
      const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (area == 0 || !std::isfinite(area))
      {
        continue; // seen edge on, or beyond all numbers
      }
      const bool isFront = (area > 0) == this->FrontIsPositive;
      const double lowX = std::min({ a[0], b[0], c[0] });
      const double highX = std::max({ a[0], b[0], c[0] });
      const double lowY = std::min({ a[1], b[1], c[1] });
      const double highY = std::max({ a[1], b[1], c[1] });
      const int column0 = static_cast<int>(std::clamp(std::ceil(lowX - Slack), 0.0, 1e9));
      const int column1 =
        static_cast<int>(std::clamp(std::floor(highX + Slack), -1.0, this->Width - 1.0));
      const int row0 =
        static_cast<int>(std::clamp(std::ceil(lowY - Slack), static_cast<double>(firstRow), 1e9));
      const int row1 = static_cast<int>(std::clamp(std::floor(highY + Slack), -1.0, endRow - 1.0));
      const double sign = area > 0 ? 1 : -1;
      const double slack = Slack * (std::abs(highX - lowX) + std::abs(highY - lowY));
      for (int row = row0; row <= row1; ++row)
      {
        for (int column = column0; column <= column1; ++column)
        {
          // barycentric, times the area
          const double u = (b[0] - column) * (c[1] - row) - (b[1] - row) * (c[0] - column);
          const double v = (c[0] - column) * (a[1] - row) - (c[1] - row) * (a[0] - column);
          const double w = area - u - v;
          if (sign * u < -slack || sign * v < -slack || sign * w < -slack)
          {
            continue;
          }
          const double depth = (u * a[2] + v * b[2] + w * c[2]) / area;
          const std::size_t own = static_cast<std::size_t>(this->Width) * (row - firstRow) + column;
          double& nearest = result.Depth[start + own];
          const bool nearer =
            std::isnan(nearest) || depth < nearest || (depth == nearest && isFront && !front[own]);
          if (nearer)
          {
            nearest = depth;
            front[own] = isFront;
            this->SetNormal(result, start + own, t, { u / area, v / area, w / area });
          }
        }
      }
    }
    for (std::size_t p = 0; p < pixels; ++p)
    {
      if (!front[p])
      {
        result.Depth[start + p] = NaN;
        for (std::size_t k = 0; k < 3 && !result.Normals.empty(); ++k)
        {
          result.Normals[3 * (start + p) + k] = 0;
        }
      }
    }
  }

  void SetNormal(
    MirroredMap& result, std::size_t pixel, std::int64_t triangle, const Vec3& weights) const
  {
    if (!this->Given)
    {
      return;
    }
    Vec3 sum{ 0, 0, 0 };
    for (int c = 0; c < 3; ++c)
    {
      const float* n = this->Given + 3 * this->Pixels[this->Corners[3 * triangle + c]];
      sum = sum + weights[c] * Vec3{ n[0], n[1], n[2] };
    }
    const Vec3 mirrored = this->Plane.ReflectDirection(Normalized(sum));
    for (int k = 0; k < 3; ++k)
    {
      result.Normals[3 * pixel + k] = static_cast<float>(mirrored[k]);
    }
  }

  const MirrorPlane& Plane;
  const float* Given;
  int Width;
  int Height;
  std::vector<double> Points; ///< x 3: column, row (from the first of the map), depth
  std::vector<long long> Pixels;
  std::vector<long long> Corners;
  std::vector<std::vector<std::int64_t>> Bands;
  bool FrontIsPositive = true; ///< what sign mirrored triangles that show their front have
};
}

//------------------------------------------------------------------------------
MirroredMap MirrorMap(const DepthGrid& map, const float* normals, const MirrorPlane& plane,
  const DiscontinuityRule& rule, Execution& execution)
{
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.4);
  const DepthMapMesher mesher(map, rule, map.Extent[2], map.Extent[3], execution);
  const auto count = static_cast<std::size_t>(map.Extent[1] - map.Extent[0] + 1) *
    static_cast<std::size_t>(map.Extent[3] - map.Extent[2] + 1);
  MirroredMap result;
  result.Depth.assign(count, NaN);
  result.Asymmetry.assign(count, NaN);
  result.Normals.assign(normals ? 3 * count : 0, 0);
  const Raster raster(map, normals, plane, mesher, execution);
  execution.SetStage(0.4, 0.9);
  raster.Cast(result, execution);

  std::vector<double> sizes;
  double given = 0;
  double middle = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (std::isfinite(map.Depth[i]))
    {
      given += 1;
      middle += (map.Depth[i] - middle) / given;
    }
  }
  Concordance pairs(middle);
  for (std::size_t i = 0; i < count; ++i)
  {
    if (std::isfinite(map.Depth[i]) && !std::isnan(result.Depth[i]))
    {
      pairs.Add(map.Depth[i], result.Depth[i]);
      result.Asymmetry[i] = map.Depth[i] - result.Depth[i];
      sizes.push_back(std::abs(result.Asymmetry[i]));
    }
  }
  result.Score = pairs.GetScore();
  result.RMS = pairs.GetRMS();
  result.Overlap = given > 0 ? pairs.GetCount() / given : 0;
  result.Median = NaN;
  if (!sizes.empty())
  {
    const auto half = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), half, sizes.end());
    result.Median = *half;
  }
  return result;
}
}
