// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTriangleSurface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

namespace lacuna
{
namespace
{
using Triangle = TriangleSurface::Triangle;

// An edge as one triangle has it: from its lower point to its higher one, or the other way round.
struct Side
{
  std::int32_t Low;
  std::int32_t High;
  std::int32_t Triangle;
  bool Forward; // the triangle goes from Low to High
};

std::vector<Side> GetSortedSides(const std::vector<Triangle>& triangles)
{
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    for (int c = 0; c < 3; ++c)
    {
      const std::int32_t a = triangles[t][c];
      const std::int32_t b = triangles[t][(c + 1) % 3];
      sides.push_back({ std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b });
    }
  }
  std::sort(sides.begin(), sides.end(),
    [](const Side& a, const Side& b)
    {
      return a.Low != b.Low ? a.Low < b.Low
        : a.High != b.High  ? a.High < b.High
                            : a.Triangle < b.Triangle;
    });
  return sides;
}

// Calls body(first, last) for the sides of each edge.
template <class Body>
void ForEdges(const std::vector<Side>& sides, const Body& body)
{
  for (std::size_t first = 0; first < sides.size();)
  {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].Low == sides[first].Low &&
      sides[last].High == sides[first].High)
    {
      ++last;
    }
    body(first, last);
    first = last;
  }
}

Vec3 GetNormal(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return Cross(b - a, c - a);
}

// The triangles around each point, kept while edges collapse and flip.
class Stars
{
public:
  explicit Stars(TriangleSurface& surface)
    : Surface(surface)
    , Around(surface.Points.size())
    , OnBoundary(surface.Points.size(), 0)
  {
    for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
    {
      for (const std::int32_t p : surface.Triangles[t])
      {
        this->Around[p].push_back(static_cast<std::int32_t>(t));
      }
    }
    const std::vector<Side> sides = GetSortedSides(surface.Triangles);
    ForEdges(sides,
      [&](std::size_t first, std::size_t last)
      {
        if (last != first + 2)
        {
          this->OnBoundary[sides[first].Low] = this->OnBoundary[sides[first].High] = 1;
        }
      });
  }

  std::size_t GetValence(std::int32_t p) const { return this->Around[p].size(); }

  bool AreNeighbors(std::int32_t p, std::int32_t q) const
  {
    return std::any_of(this->Around[p].begin(), this->Around[p].end(),
      [&](std::int32_t t) { return Has(this->Surface.Triangles[t], q); });
  }

  bool Collapse(std::int32_t keep, std::int32_t drop, double longest)
  {
    if (this->OnBoundary[keep] || this->OnBoundary[drop])
    {
      return false;
    }
    // Only the two points opposite of the edge may be neighbours of both its ends.
    this->Collect(keep, this->First);
    this->Collect(drop, this->Second);
    this->Common.clear();
    std::set_intersection(this->First.begin(), this->First.end(), this->Second.begin(),
      this->Second.end(), std::back_inserter(this->Common));
    if (!std::binary_search(this->First.begin(), this->First.end(), drop) ||
      this->Common.size() != 2 || this->GetValence(this->Common[0]) <= 3 ||
      this->GetValence(this->Common[1]) <= 3)
    {
      return false;
    }
    const std::vector<Vec3>& points = this->Surface.Points;
    const Vec3 middle = 0.5 * (points[keep] + points[drop]);
    for (const std::int32_t end : { keep, drop })
    {
      for (const std::int32_t t : this->Around[end])
      {
        const Triangle& triangle = this->Surface.Triangles[t];
        if (Has(triangle, keep) && Has(triangle, drop))
        {
          continue;
        }
        Vec3 moved[3];
        for (int c = 0; c < 3; ++c)
        {
          moved[c] = triangle[c] == end ? middle : points[triangle[c]];
          if (Norm(moved[c] - middle) > longest)
          {
            return false;
          }
        }
        const Vec3 before =
          GetNormal(points[triangle[0]], points[triangle[1]], points[triangle[2]]);
        const Vec3 after = GetNormal(moved[0], moved[1], moved[2]);
        if (Dot(before, after) < 0.5 * Norm(before) * Norm(after))
        {
          return false;
        }
      }
    }
    this->Surface.Points[keep] = middle;
    for (const std::int32_t t : this->Around[drop])
    {
      Triangle& triangle = this->Surface.Triangles[t];
      if (Has(triangle, keep))
      {
        for (const std::int32_t p : triangle)
        {
          if (p != drop)
          {
            this->Remove(p, t);
          }
        }
        triangle = { -1, -1, -1 };
      }
      else
      {
        std::replace(triangle.begin(), triangle.end(), drop, keep);
        this->Around[keep].push_back(t);
      }
    }
    this->Around[drop].clear();
    return true;
  }

  // The edge of two triangles becomes the other diagonal of their four points.
  bool Flip(std::int32_t s, std::int32_t t)
  {
    Triangle& first = this->Surface.Triangles[s];
    Triangle& second = this->Surface.Triangles[t];
    int at = 0; // so that first = (a, u, v), second = (b, v, u)
    while (at < 3 && (Has(second, first[at])))
    {
      ++at;
    }
    int to = 0;
    while (to < 3 && Has(first, second[to]))
    {
      ++to;
    }
    if (at == 3 || to == 3)
    {
      return false;
    }
    const std::int32_t a = first[at];
    const std::int32_t u = first[(at + 1) % 3];
    const std::int32_t v = first[(at + 2) % 3];
    const std::int32_t b = second[to];
    if (second[(to + 1) % 3] != v || this->GetValence(u) <= 3 || this->GetValence(v) <= 3 ||
      this->AreNeighbors(a, b))
    {
      return false;
    }
    const std::vector<Vec3>& p = this->Surface.Points;
    const double before =
      std::min(SmallestAngle(p[a], p[u], p[v]), SmallestAngle(p[b], p[v], p[u]));
    const double after = std::min(SmallestAngle(p[a], p[u], p[b]), SmallestAngle(p[a], p[b], p[v]));
    const Vec3 old = Normalized(GetNormal(p[a], p[u], p[v]) + GetNormal(p[b], p[v], p[u]));
    constexpr double flat = 0.85; // cosine: a crease stays an edge
    const auto lies = [&](const Vec3& x, const Vec3& y, const Vec3& z)
    { return Dot(Normalized(GetNormal(x, y, z)), old) > flat; };
    if (after <= before + 1e-3 || !lies(p[a], p[u], p[v]) || !lies(p[b], p[v], p[u]) ||
      !lies(p[a], p[u], p[b]) || !lies(p[a], p[b], p[v]))
    {
      return false;
    }
    first = { a, u, b };
    second = { a, b, v };
    this->Remove(v, s);
    this->Remove(u, t);
    this->Around[b].push_back(s);
    this->Around[a].push_back(t);
    return true;
  }

private:
  static bool Has(const Triangle& triangle, std::int32_t p)
  {
    return triangle[0] == p || triangle[1] == p || triangle[2] == p;
  }

  static double SmallestAngle(const Vec3& a, const Vec3& b, const Vec3& c)
  {
    const double area = Norm(GetNormal(a, b, c));
    return std::min({ std::atan2(area, Dot(b - a, c - a)), std::atan2(area, Dot(c - b, a - b)),
      std::atan2(area, Dot(a - c, b - c)) });
  }

  void Collect(std::int32_t p, std::vector<std::int32_t>& neighbors) const
  {
    neighbors.clear();
    for (const std::int32_t t : this->Around[p])
    {
      for (const std::int32_t q : this->Surface.Triangles[t])
      {
        if (q != p)
        {
          neighbors.push_back(q);
        }
      }
    }
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  }

  void Remove(std::int32_t p, std::int32_t t)
  {
    std::vector<std::int32_t>& around = this->Around[p];
    around.erase(std::find(around.begin(), around.end(), t));
  }

  TriangleSurface& Surface;
  std::vector<std::vector<std::int32_t>> Around;
  std::vector<char> OnBoundary;
  std::vector<std::int32_t> First;
  std::vector<std::int32_t> Second;
  std::vector<std::int32_t> Common;
};

void RemoveUnused(TriangleSurface& surface)
{
  std::vector<Triangle>& triangles = surface.Triangles;
  triangles.erase(
    std::remove_if(triangles.begin(), triangles.end(), [](const Triangle& t) { return t[0] < 0; }),
    triangles.end());
  std::vector<std::int32_t> numbers(surface.Points.size(), -1);
  std::vector<Vec3> points;
  points.reserve(surface.Points.size());
  for (Triangle& triangle : triangles)
  {
    for (std::int32_t& p : triangle)
    {
      if (numbers[p] < 0)
      {
        numbers[p] = static_cast<std::int32_t>(points.size());
        points.push_back(surface.Points[p]);
      }
      p = numbers[p];
    }
  }
  surface.Points = std::move(points);
}
}

//------------------------------------------------------------------------------
double TriangleSurface::GetVolume() const
{
  double volume = 0;
  const Vec3 origin = this->Points.empty() ? Vec3{} : this->Points[0];
  for (const Triangle& t : this->Triangles)
  {
    volume += Dot(this->Points[t[0]] - origin,
                Cross(this->Points[t[1]] - origin, this->Points[t[2]] - origin)) /
      6;
  }
  return volume;
}

double TriangleSurface::GetArea() const
{
  double area = 0;
  for (const Triangle& t : this->Triangles)
  {
    area += 0.5 * Norm(GetNormal(this->Points[t[0]], this->Points[t[1]], this->Points[t[2]]));
  }
  return area;
}

//------------------------------------------------------------------------------
namespace
{
// How often a surface winds around a place: the sum of the solid angles of its triangles (van Oosterom
// and Strackee 1983).
double GetWindingNumber(
  const TriangleSurface& surface, const std::vector<std::int32_t>& triangles, const Vec3& x)
{
  double sum = 0;
  for (const std::int32_t t : triangles)
  {
    const Triangle& corners = surface.Triangles[t];
    const Vec3 a = surface.Points[corners[0]] - x;
    const Vec3 b = surface.Points[corners[1]] - x;
    const Vec3 c = surface.Points[corners[2]] - x;
    const double la = Norm(a);
    const double lb = Norm(b);
    const double lc = Norm(c);
    sum += std::atan2(
      Dot(a, Cross(b, c)), la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb);
  }
  return sum / (2 * std::acos(-1.0));
}
}

std::vector<SurfacePart> FindParts(const TriangleSurface& surface)
{
  std::vector<std::int32_t> parents(surface.Points.size());
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](std::int32_t p)
  {
    while (parents[p] != p)
    {
      p = parents[p] = parents[parents[p]];
    }
    return p;
  };
  for (const Triangle& t : surface.Triangles)
  {
    parents[root(t[1])] = root(t[0]);
    parents[root(t[2])] = root(t[0]);
  }
  std::map<std::int32_t, std::vector<std::int32_t>> byRoot;
  for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
  {
    byRoot[root(surface.Triangles[t][0])].push_back(static_cast<std::int32_t>(t));
  }
  std::vector<std::pair<SurfacePart, const std::vector<std::int32_t>*>> found;
  for (const auto& group : byRoot)
  {
    SurfacePart part;
    part.At = surface.Points[surface.Triangles[group.second.front()][0]];
    for (const std::int32_t t : group.second)
    {
      const Triangle& corners = surface.Triangles[t];
      part.Volume +=
        Dot(surface.Points[corners[0]] - part.At,
          Cross(surface.Points[corners[1]] - part.At, surface.Points[corners[2]] - part.At)) /
        6;
    }
    found.emplace_back(part, &group.second);
  }
  std::stable_sort(found.begin(), found.end(),
    [](const auto& a, const auto& b)
    { return std::abs(a.first.Volume) > std::abs(b.first.Volume); });
  constexpr std::size_t most = 64; // of many small ones the depth is not worth its time
  std::vector<SurfacePart> parts;
  for (std::size_t inner = 0; inner < std::min(most, found.size()); ++inner)
  {
    parts.push_back(found[inner].first);
    for (std::size_t outer = 0; outer < inner; ++outer)
    {
      parts.back().Depth +=
        std::abs(GetWindingNumber(surface, *found[outer].second, parts.back().At)) > 0.5;
    }
  }
  return parts;
}

//------------------------------------------------------------------------------
SurfaceTopology FindTopology(const TriangleSurface& surface)
{
  SurfaceTopology result;
  const std::vector<Side> sides = GetSortedSides(surface.Triangles);
  std::vector<std::int32_t> parents(surface.Triangles.size());
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](std::int32_t t)
  {
    while (parents[t] != t)
    {
      t = parents[t] = parents[parents[t]];
    }
    return t;
  };
  std::int64_t edges = 0;
  ForEdges(sides,
    [&](std::size_t first, std::size_t last)
    {
      ++edges;
      result.BoundaryEdges += last == first + 1;
      result.BadEdges +=
        last > first + 2 || (last == first + 2 && sides[first].Forward == sides[first + 1].Forward);
      for (std::size_t i = first + 1; i < last; ++i)
      {
        parents[root(sides[i].Triangle)] = root(sides[first].Triangle);
      }
    });
  for (std::size_t t = 0; t < parents.size(); ++t)
  {
    result.Components += parents[t] == static_cast<std::int32_t>(t);
  }
  std::vector<std::vector<std::int32_t>> around(surface.Points.size());
  for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
  {
    for (const std::int32_t p : surface.Triangles[t])
    {
      around[p].push_back(static_cast<std::int32_t>(t));
    }
  }
  for (std::size_t p = 0; p < around.size(); ++p)
  {
    // Going on from triangle to triangle over edges at the point reaches all of one fan.
    std::vector<std::int32_t> rest = around[p];
    std::vector<std::int32_t> reached;
    if (!rest.empty())
    {
      reached.push_back(rest.back());
      rest.pop_back();
    }
    for (std::size_t i = 0; i < reached.size(); ++i)
    {
      const auto shared = [&](std::int32_t t)
      {
        int count = 0;
        for (const std::int32_t q : surface.Triangles[t])
        {
          const Triangle& other = surface.Triangles[reached[i]];
          count += std::find(other.begin(), other.end(), q) != other.end();
        }
        return count >= 2;
      };
      const auto from =
        std::stable_partition(rest.begin(), rest.end(), [&](std::int32_t t) { return !shared(t); });
      reached.insert(reached.end(), from, rest.end());
      rest.erase(from, rest.end());
    }
    result.BadPoints += around[p].empty() || !rest.empty();
  }
  result.EulerNumber = static_cast<std::int64_t>(surface.Points.size()) - edges +
    static_cast<std::int64_t>(surface.Triangles.size());
  return result;
}

//------------------------------------------------------------------------------
std::int64_t CollapseShortEdges(TriangleSurface& surface, double shortest, double longest)
{
  struct Edge
  {
    double Length;
    std::int32_t Low;
    std::int32_t High;
  };
  std::vector<Edge> edges;
  for (const Triangle& t : surface.Triangles)
  {
    for (int c = 0; c < 3; ++c)
    {
      const std::int32_t a = t[c];
      const std::int32_t b = t[(c + 1) % 3];
      const double length = Norm(surface.Points[a] - surface.Points[b]);
      if (a < b && length < shortest) // the other triangle of the edge has b < a
      {
        edges.push_back({ length, a, b });
      }
    }
  }
  std::sort(edges.begin(), edges.end(),
    [](const Edge& a, const Edge& b)
    {
      return a.Length != b.Length ? a.Length < b.Length
        : a.Low != b.Low          ? a.Low < b.Low
                                  : a.High < b.High;
    });
  Stars stars(surface);
  std::int64_t collapsed = 0;
  for (const Edge& edge : edges)
  {
    // what happened before may have moved or removed the ends
    if (stars.GetValence(edge.Low) > 0 && stars.GetValence(edge.High) > 0 &&
      Norm(surface.Points[edge.Low] - surface.Points[edge.High]) < shortest)
    {
      collapsed += stars.Collapse(edge.Low, edge.High, longest);
    }
  }
  RemoveUnused(surface);
  return collapsed;
}

std::int64_t FlipEdges(TriangleSurface& surface)
{
  const std::vector<Side> sides = GetSortedSides(surface.Triangles);
  Stars stars(surface);
  std::int64_t flipped = 0;
  ForEdges(sides,
    [&](std::size_t first, std::size_t last)
    {
      if (last == first + 2)
      {
        const auto has = [&](std::int32_t t, std::int32_t p)
        {
          const Triangle& triangle = surface.Triangles[t];
          return std::find(triangle.begin(), triangle.end(), p) != triangle.end();
        };
        const std::int32_t s = sides[first].Triangle;
        const std::int32_t t = sides[first + 1].Triangle;
        // flips before may have taken the edge from them
        if (has(s, sides[first].Low) && has(s, sides[first].High) && has(t, sides[first].Low) &&
          has(t, sides[first].High))
        {
          flipped += stars.Flip(s, t);
        }
      }
    });
  return flipped;
}

std::vector<Vec3> GetUmbrellas(const TriangleSurface& surface)
{
  std::vector<Vec3> sums(surface.Points.size(), Vec3{});
  std::vector<int> counts(surface.Points.size(), 0);
  std::vector<char> fixed(surface.Points.size(), 0);
  const std::vector<Side> sides = GetSortedSides(surface.Triangles);
  ForEdges(sides,
    [&](std::size_t first, std::size_t last)
    {
      const std::int32_t a = sides[first].Low;
      const std::int32_t b = sides[first].High;
      const Vec3 way = surface.Points[b] - surface.Points[a];
      sums[a] = sums[a] + way;
      sums[b] = sums[b] - way;
      ++counts[a];
      ++counts[b];
      if (last != first + 2)
      {
        fixed[a] = fixed[b] = 1;
      }
    });
  for (std::size_t p = 0; p < sums.size(); ++p)
  {
    sums[p] = fixed[p] || counts[p] == 0 ? Vec3{} : (1.0 / counts[p]) * sums[p];
  }
  return sums;
}
}
