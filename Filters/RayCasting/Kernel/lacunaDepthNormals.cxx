// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthNormals.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr int RowGrain = 16;
constexpr std::int64_t VectorGrain = 1 << 14;

/// The points of one row of a grid; rows outside of it have none.
struct PointRow
{
  std::vector<Vec3> Points;
  std::vector<char> Defined;

  void Load(const DepthGrid& grid, std::int64_t row)
  {
    const auto& e = grid.Extent;
    const std::size_t columns =
      static_cast<std::size_t>(static_cast<std::int64_t>(e[1]) - e[0] + 1);
    this->Points.resize(columns);
    this->Defined.assign(columns, 0);
    if (row < e[2] || row > e[3])
    {
      return;
    }
    for (std::size_t i = 0; i < columns; ++i)
    {
      const int column = static_cast<int>(e[0] + static_cast<std::int64_t>(i));
      if (grid.IsDefined(column, static_cast<int>(row)))
      {
        this->Points[i] = grid.PointOf(column, static_cast<int>(row));
        this->Defined[i] = 1;
      }
    }
  }
};

DepthEdge EdgeOf(
  const DepthGrid& grid, const PointRow& from, std::size_t i, const PointRow& to, std::size_t j)
{
  if (j < to.Points.size() && from.Defined[i] && to.Defined[j])
  {
    return grid.EdgeBetween(from.Points[i], to.Points[j]);
  }
  return DepthEdge::Missing();
}

/// An edge's step, scaled to 1 mm across the ray.
Vec3 UnitAcross(const DepthEdge& edge)
{
  return (1 / std::max({ edge.Across, 1e-12 * std::abs(edge.Along), DBL_MIN })) * edge.Step;
}

double SlopeOf(const DepthEdge& edge)
{
  return edge.Along / std::max(edge.Across, DBL_MIN);
}

/// The tangent that follows from the edges before and after a pixel; level is that of slope 0.
class TangentRule
{
public:
  /// Only the predicate method knows of discontinuities. The others ask whether there are neighbours:
  /// for them no edge is too steep.
  TangentRule(DepthNormalMethod method, const DiscontinuityLimits& limits)
    : Method(method)
    , Cases(method == DepthNormalMethod::Predicate ? limits : DiscontinuityLimits{ 90, 180 })
  {
  }

  Vec3 Tangent(const DepthEdge& backward, const DepthEdge& forward, const Vec3& level) const
  {
    const SlopeCase c = this->Cases.Classify(backward, forward);
    const bool usesBackward = UsesBackward(c);
    const bool usesForward = UsesForward(c);
    if (!usesBackward && !usesForward)
    {
      return level;
    }
    if (!usesBackward || !usesForward)
    {
      return usesForward ? forward.Step : backward.Step;
    }
    if (this->Method == DepthNormalMethod::Gordon)
    {
      return GordonWeight(SlopeOf(backward)) * UnitAcross(backward) +
        GordonWeight(SlopeOf(forward)) * UnitAcross(forward);
    }
    return backward.Step + forward.Step;
  }

private:
  DepthNormalMethod Method;
  SlopeRule Cases;
};

/// Unit normal towards the viewer of a surface with these tangents, which ray meets.
Vec3 NormalOf(const Vec3& right, const Vec3& down, const Vec3& ray)
{
  const Vec3 normal = Normalized(Cross(Normalized(down), Normalized(right)));
  if (!IsFinite(normal) || normal == Vec3{ 0, 0, 0 })
  {
    return -1 * ray;
  }
  return Dot(normal, ray) > 0 ? -1 * normal : normal;
}

void Store(const Vec3& normal, float* out)
{
  for (int a = 0; a < 3; ++a)
  {
    out[a] = static_cast<float>(normal[a]);
  }
}
}

double GordonWeight(double slope)
{
  constexpr double a = 2;
  constexpr double b = 5;
  constexpr double epsilon = 1e-5;
  const double steepness = std::abs(slope);
  if (steepness <= a)
  {
    return 1;
  }
  if (!(steepness < b))
  {
    return epsilon;
  }
  return (1 + epsilon) / 2 + (1 - epsilon) / 2 * std::cos(Pi * (steepness - a) / (b - a));
}

void EstimateNormals(const DepthGrid& grid, DepthNormalMethod method,
  const DiscontinuityLimits& limits, const std::array<int, 4>& extent, float* normals,
  Execution& execution)
{
  limits.Check();
  const TangentRule rule(method, limits);
  const Vec3 axes[2] = { Normalized(grid.ImageToWorld.Column(0)),
    Normalized(grid.ImageToWorld.Column(1)) };
  const std::int64_t columns = static_cast<std::int64_t>(extent[1]) - extent[0] + 1;
  const std::int64_t rows = static_cast<std::int64_t>(extent[3]) - extent[2] + 1;
  const auto first = static_cast<std::size_t>(extent[0] - grid.Extent[0]);
  if (columns <= 0 || rows <= 0)
  {
    return;
  }
  execution.For(rows, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      PointRow above;
      PointRow here;
      PointRow below;
      above.Load(grid, extent[2] + begin - 1);
      here.Load(grid, extent[2] + begin);
      for (std::int64_t r = begin; r < end; ++r)
      {
        below.Load(grid, extent[2] + r + 1);
        float* out = normals + 3 * r * columns;
        DepthEdge backward =
          first > 0 ? EdgeOf(grid, here, first - 1, here, first) : DepthEdge::Missing();
        for (std::int64_t c = 0; c < columns; ++c, out += 3)
        {
          const std::size_t i = first + static_cast<std::size_t>(c);
          const DepthEdge forward = EdgeOf(grid, here, i, here, i + 1);
          if (here.Defined[i])
          {
            const Vec3 ray =
              grid.RayOf(static_cast<int>(extent[0] + c), static_cast<int>(extent[2] + r));
            const auto level = [&](int axis) { return axes[axis] - Dot(axes[axis], ray) * ray; };
            Store(NormalOf(rule.Tangent(backward, forward, level(0)),
                    rule.Tangent(
                      EdgeOf(grid, above, i, here, i), EdgeOf(grid, here, i, below, i), level(1)),
                    ray),
              out);
          }
          else
          {
            std::fill_n(out, 3, 0.0F);
          }
          backward = forward;
        }
        std::swap(above, here);
        std::swap(here, below);
      }
    });
}

std::int64_t MendNormals(
  const DepthGrid& grid, const std::array<int, 4>& extent, float* normals, Execution& execution)
{
  const std::int64_t columns = static_cast<std::int64_t>(extent[1]) - extent[0] + 1;
  const std::int64_t rows = static_cast<std::int64_t>(extent[3]) - extent[2] + 1;
  std::atomic<std::int64_t> missing(0);
  execution.For(std::max<std::int64_t>(0, columns > 0 ? rows : 0), RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::int64_t found = 0;
      for (std::int64_t i = begin * columns; i < end * columns; ++i)
      {
        const int column = static_cast<int>(extent[0] + i % columns);
        const int row = static_cast<int>(extent[2] + i / columns);
        float* out = normals + 3 * i;
        const Vec3 normal{ out[0], out[1], out[2] };
        if (!grid.IsDefined(column, row))
        {
          std::fill_n(out, 3, 0.0F);
        }
        else if (IsFinite(normal) && Norm(normal) > 0)
        {
          Store(Normalized(normal), out);
        }
        else
        {
          Store(-1 * grid.RayOf(column, row), out);
          ++found;
        }
      }
      missing += found;
    });
  return missing;
}

void AnglesBetween(
  const float* a, const float* b, std::int64_t count, float* degrees, Execution& execution)
{
  execution.For(count, VectorGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const Vec3 u{ a[3 * i], a[3 * i + 1], a[3 * i + 2] };
        const Vec3 v{ b[3 * i], b[3 * i + 1], b[3 * i + 2] };
        const double sine = Norm(Cross(u, v));
        const double cosine = Dot(u, v);
        degrees[i] = sine > 0 || cosine != 0 // of two vectors that are not zero, one of both is not
          ? static_cast<float>(std::atan2(sine, cosine) * 180 / Pi)
          : std::numeric_limits<float>::quiet_NaN();
      }
    });
}
}
