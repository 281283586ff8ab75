// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirroredMap.h"

#include "lacunaSymmetrySearch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace lacuna
{
namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

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
