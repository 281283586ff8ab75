// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Surfaces to mill, and a judge of paths that shares nothing with their maker: it measures
/// distances of triangles from places of the tool.
#ifndef lacunaMillScene_h
#define lacunaMillScene_h

#include "lacunaDropCutter.h"
#include "lacunaToolPath.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace lacunaMill
{
using lacuna::Vec3;

/// Points over a rectangle with a corner at x, y.
inline lacuna::MillSurface Surface(std::int64_t columns, std::int64_t rows, double spacing,
  const std::function<double(double, double)>& height, double x = 0, double y = 0)
{
  std::vector<Vec3> points;
  for (std::int64_t j = 0; j < rows; ++j)
  {
    for (std::int64_t i = 0; i < columns; ++i)
    {
      const double px = x + spacing * static_cast<double>(i);
      const double py = y + spacing * static_cast<double>(j);
      points.push_back({ px, py, height(px, py) });
    }
  }
  return lacuna::MillSurface({ columns, rows }, std::move(points));
}

/// A skull's cap of 120 x 120 mm, 0..120, with a bump and ripples; nothing about it is symmetric.
inline double Mould(double x, double y)
{
  x -= 60;
  y -= 60;
  return std::sqrt(95 * 95 - x * x - 1.1 * y * y) - 95 +
    5 * std::exp(-((x - 20) * (x - 20) + (y + 10) * (y + 10)) / 300) +
    0.2 * std::sin(x / 3 + y / 5);
}

/// Distance of a point from a triangle: by regions, after Ericson (Real-Time Collision Detection).
inline double TriangleDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c)
{
  using lacuna::Dot;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = Dot(ab, ap);
  const double d2 = Dot(ac, ap);
  if (d1 <= 0 && d2 <= 0)
  {
    return Norm(ap);
  }
  const Vec3 bp = p - b;
  const double d3 = Dot(ab, bp);
  const double d4 = Dot(ac, bp);
  if (d3 >= 0 && d4 <= d3)
  {
    return Norm(bp);
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0)
  {
    return Norm(p - (a + (d1 / (d1 - d3)) * ab));
  }
  const Vec3 cp = p - c;
  const double d5 = Dot(ab, cp);
  const double d6 = Dot(ac, cp);
  if (d6 >= 0 && d5 <= d6)
  {
    return Norm(cp);
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0)
  {
    return Norm(p - (a + (d2 / (d2 - d6)) * ac));
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
  {
    return Norm(p - (b + ((d4 - d3) / (d4 - d3 + d5 - d6)) * (c - b)));
  }
  const Vec3 n = Normalized(Cross(ab, ac));
  return std::abs(Dot(ap, n));
}

/// Judges places of a tool on a surface.
class Judge
{
public:
  Judge(const lacuna::MillSurface& surface, const lacuna::MillTool& tool)
    : Surface(surface)
    , Tool(tool)
  {
  }

  std::int64_t GetChecks() const { return this->Checks; }

  /// Depth in mm to which some triangle is within the tool with its tip at p.
  double Depth(const Vec3& p)
  {
    double depth = -1;
    const lacuna::GridSize size = this->Surface.GetSize();
    for (std::int64_t j = 0; j + 1 < size.Rows; ++j)
    {
      // rows and cells out of reach
      if (std::max(this->Surface.At(0, j)[1], this->Surface.At(0, j + 1)[1]) + this->Margin <
          p[1] - this->Tool.Radius ||
        std::min(this->Surface.At(0, j)[1], this->Surface.At(0, j + 1)[1]) - this->Margin >
          p[1] + this->Tool.Radius)
      {
        continue;
      }
      for (std::int64_t i = 0; i + 1 < size.Columns; ++i)
      {
        const Vec3& a = this->Surface.At(i, j);
        const Vec3& b = this->Surface.At(i + 1, j);
        const Vec3& c = this->Surface.At(i + 1, j + 1);
        const Vec3& d = this->Surface.At(i, j + 1);
        if (std::abs(a[0] - p[0]) < this->Tool.Radius + this->Margin &&
          std::abs(a[1] - p[1]) < this->Tool.Radius + this->Margin)
        {
          depth =
            std::max({ depth, this->TriangleDepth(p, a, b, c), this->TriangleDepth(p, a, c, d) });
        }
      }
    }
    return depth;
  }

  /// The largest depth at places spread over all motions but rapid ones.
  double LargestDepth(const lacuna::ToolPath& path, std::int64_t checks, unsigned seed = 1)
  {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<std::int64_t> motions;
    for (const lacuna::ToolPath::Run& run : path.Runs)
    {
      for (std::int64_t k = 1; run.Kind != lacuna::Motion::Rapid && k < run.Count; ++k)
      {
        motions.push_back(run.First + k);
      }
    }
    double depth = -1;
    while (this->Checks < checks)
    {
      const std::int64_t k = motions[random() % motions.size()];
      const Vec3& a = path.Points[k - 1];
      const Vec3& b = path.Points[k];
      depth = std::max(depth, this->Depth(a + uniform(random) * (b - a)));
    }
    return depth;
  }

  double Margin = 3; ///< mm, at least the longest side of a cell

private:
  double TriangleDepth(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c)
  {
    const double r = this->Tool.Radius;
    if (this->Tool.Shape == lacuna::ToolShape::Ball)
    {
      ++this->Checks;
      const Vec3 centre = p + Vec3{ 0, 0, r };
      double depth = r - TriangleDistance(centre, a, b, c);
      for (const Vec3& v : { a, b, c })
      {
        if (v[2] > centre[2]) // beside the shank
        {
          depth = std::max(depth, r - std::hypot(v[0] - p[0], v[1] - p[1]));
        }
      }
      return depth;
    }
    double depth = -1;
    constexpr int n = 8;
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; i + j <= n; ++j)
      {
        ++this->Checks;
        const Vec3 v = a + (double(i) / n) * (b - a) + (double(j) / n) * (c - a);
        depth = std::max(depth, std::min(r - std::hypot(v[0] - p[0], v[1] - p[1]), v[2] - p[2]));
      }
    }
    return depth;
  }

  const lacuna::MillSurface& Surface;
  lacuna::MillTool Tool;
  std::int64_t Checks = 0;
};
}
#endif
