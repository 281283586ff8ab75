// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceFollower.h"

#include "lacunaExecution.h"
#include "lacunaMemory.h"
#include "lacunaProperties.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace lacuna
{
namespace
{
// A node of the lattice: all three numbers even (corners of cubes) or all odd (their centres), in
// half edges of a cube.
using Site = std::array<int, 3>;
constexpr int LargestIndex = 1 << 20;

std::uint64_t GetKey(const Site& site)
{
  std::uint64_t key = 0;
  for (const int i : site)
  {
    key = key << 21 | static_cast<std::uint64_t>(i + LargestIndex);
  }
  return key;
}

// The largest of the function and the distance from a box: closed where the box ends.
class Capped : public ImplicitFunction
{
public:
  Capped(const ImplicitFunction& inner, const std::array<double, 6>& bounds)
    : Inner(inner)
    , Bounds(bounds)
  {
  }

  // Distance along an axis from the nearest face, negative inside; the axis and its direction.
  double GetBox(const Vec3& x, int& axis, double& side) const
  {
    double largest = -std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c)
    {
      for (const double s : { -1.0, 1.0 })
      {
        const double d = s * (x[c] - this->Bounds[2 * c + (s > 0)]);
        if (d > largest)
        {
          largest = d;
          axis = c;
          side = s;
        }
      }
    }
    return largest;
  }

  void Evaluate(Execution& execution, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override
  {
    this->Inner.Evaluate(execution, points, values, gradients);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      int axis = 0;
      double side = 1;
      const double box = this->GetBox(points[i], axis, side);
      if (box > values[i])
      {
        values[i] = box;
        if (gradients)
        {
          (*gradients)[i] = {};
          (*gradients)[i][axis] = side;
        }
      }
    }
  }

private:
  const ImplicitFunction& Inner;
  std::array<double, 6> Bounds;
};

class Follower
{
public:
  Follower(Execution& execution, const ImplicitFunction& function,
    const SurfaceFollowerOptions& options, FollowedSurface& result)
    : Runner(execution)
    , Function(function)
    , Options(options)
    , Result(result)
  {
    for (int c = 0; c < 3; ++c)
    {
      const double size = options.Bounds[2 * c + 1] - options.Bounds[2 * c];
      // A node at the middle of the bounds would lie on planes of symmetry, where many shapes are 0.
      this->Origin[c] = options.Bounds[2 * c] + 0.5 * size + 0.137 * options.EdgeLength;
      if (size / options.EdgeLength > LargestIndex / 2)
      {
        throw std::invalid_argument("triangles of " + std::to_string(options.EdgeLength) +
          " mm are too small for bounds of " + std::to_string(size) + " mm");
      }
    }
  }

  void Follow(const std::vector<Vec3>& seeds)
  {
    std::vector<Site> frontier = this->FindFirstCubes(seeds);
    while (!frontier.empty())
    {
      this->EvaluateSites(frontier);
      std::vector<Site> next;
      for (const Site& cube : frontier)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          for (const int side : { -2, 2 })
          {
            Site neighbor = cube;
            neighbor[axis] += side;
            if (this->IsCrossed(cube, neighbor, axis) && !this->Cubes.count(GetKey(neighbor)))
            {
              if (this->IsWithinBounds(neighbor))
              {
                this->Add(neighbor, next);
              }
              else
              {
                this->Result.ReachesBounds = true;
              }
            }
          }
        }
      }
      frontier = std::move(next);
    }
  }

  // Marching tetrahedra. All tetrahedra have one long edge between the centres of neighbouring cubes
  // and one of the edges of the face between these.
  void MakeTriangles()
  {
    for (const Site& cube : this->Order)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        for (const int side : { -2, 2 })
        {
          Site neighbor = cube;
          neighbor[axis] += side;
          // a face of two cubes of the surface is handled by the lower one
          if ((side > 0 || !this->Cubes.count(GetKey(neighbor))) &&
            this->IsCrossed(cube, neighbor, axis))
          {
            this->MakeTriangles(side > 0 ? cube : neighbor, side > 0 ? neighbor : cube, axis);
          }
        }
      }
    }
    if (this->Result.Surface.Triangles.empty())
    {
      throw std::runtime_error("no seed leads to the surface: it lies outside of the bounds, or is "
                               "smaller than the triangles, or the normals contradict each other");
    }
    this->Cubes.clear();
    this->Index.clear();
    this->Crossings.clear();
  }

  // Moves points onto the surface, at most so far in each step; normals follow.
  void Project(std::vector<Vec3>& points, std::vector<Vec3>& normals, int steps)
  {
    normals.resize(points.size());
    std::vector<std::size_t> active(points.size());
    for (std::size_t i = 0; i < active.size(); ++i)
    {
      active[i] = i;
    }
    this->Result.LargestDistance = 0;
    std::vector<Vec3> at;
    std::vector<double> values;
    std::vector<Vec3> gradients;
    for (int step = 0; step <= steps && !active.empty(); ++step)
    {
      at.resize(active.size());
      for (std::size_t i = 0; i < active.size(); ++i)
      {
        at[i] = points[active[i]];
      }
      this->EvaluateAt(at, values, &gradients);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < active.size(); ++i)
      {
        const double slope = Norm(gradients[i]);
        const double distance = slope > 0 ? values[i] / slope : 0;
        normals[active[i]] = Normalized(gradients[i]);
        if (std::abs(distance) <= this->Options.Tolerance)
        {
          this->Result.LargestDistance = std::max(this->Result.LargestDistance, std::abs(distance));
          continue;
        }
        if (step == steps)
        {
          this->Result.LargestDistance = std::max(this->Result.LargestDistance, std::abs(distance));
          continue;
        }
        const double longest = 0.5 * this->Options.EdgeLength;
        points[active[i]] =
          points[active[i]] - std::clamp(distance, -longest, longest) * normals[active[i]];
        active[kept++] = active[i];
      }
      active.resize(kept);
    }
  }

private:
  void EvaluateAt(
    const std::vector<Vec3>& points, std::vector<double>& values, std::vector<Vec3>* gradients)
  {
    values.resize(points.size());
    if (gradients)
    {
      gradients->resize(points.size());
    }
    this->Function.Evaluate(this->Runner, points, values, gradients);
    this->Result.Evaluations += static_cast<std::int64_t>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      if (!std::isfinite(values[i]) || (gradients && !IsFinite((*gradients)[i])))
      {
        throw std::runtime_error("the function is not a finite number at (" +
          std::to_string(points[i][0]) + ", " + std::to_string(points[i][1]) + ", " +
          std::to_string(points[i][2]) + ") mm");
      }
    }
  }

  Vec3 GetPoint(const Site& site) const
  {
    Vec3 point = this->Origin;
    for (int c = 0; c < 3; ++c)
    {
      point[c] += 0.5 * this->Options.EdgeLength * site[c];
    }
    return point;
  }

  // The centre of the cube with a point.
  Site GetCube(const Vec3& point) const
  {
    Site site;
    for (int c = 0; c < 3; ++c)
    {
      site[c] =
        2 * static_cast<int>(std::floor((point[c] - this->Origin[c]) / this->Options.EdgeLength)) +
        1;
    }
    return site;
  }

  bool IsWithinBounds(const Site& cube) const
  {
    if (this->Options.Cap)
    {
      return true; // a cap keeps the surface there
    }
    const Vec3 center = this->GetPoint(cube);
    for (int c = 0; c < 3; ++c)
    {
      if (center[c] < this->Options.Bounds[2 * c] - 0.5 * this->Options.EdgeLength ||
        center[c] > this->Options.Bounds[2 * c + 1] + 0.5 * this->Options.EdgeLength)
      {
        return false;
      }
    }
    return true;
  }

  void Add(const Site& cube, std::vector<Site>& to)
  {
    if (this->Cubes.insert(GetKey(cube)).second)
    {
      this->Order.push_back(cube);
      to.push_back(cube);
    }
  }

  std::vector<Site> FindFirstCubes(const std::vector<Vec3>& seeds)
  {
    // one seed in each few cubes will do, since the surface is followed from there
    std::vector<Vec3> chosen;
    std::unordered_set<std::uint64_t> seen;
    for (const Vec3& seed : seeds)
    {
      bool inside = IsFinite(seed);
      for (int c = 0; c < 3 && inside; ++c)
      {
        inside = seed[c] >= this->Options.Bounds[2 * c] - this->Options.EdgeLength &&
          seed[c] <= this->Options.Bounds[2 * c + 1] + this->Options.EdgeLength;
      }
      if (inside)
      {
        Site coarse = this->GetCube(seed);
        for (int& i : coarse)
        {
          i = static_cast<int>(std::floor(i / 4.0));
        }
        if (seen.insert(GetKey(coarse)).second)
        {
          chosen.push_back(seed);
        }
      }
    }
    std::vector<Vec3> normals;
    constexpr int steps = 10;
    this->Project(chosen, normals, steps);
    std::vector<Site> first;
    for (const Vec3& point : chosen)
    {
      const Site cube = this->GetCube(point);
      const auto isFar = [](int i) { return std::abs(i) >= LargestIndex - 4; };
      if (std::none_of(cube.begin(), cube.end(), isFar) && this->IsWithinBounds(cube))
      {
        this->Add(cube, first);
      }
    }
    return first;
  }

  std::int32_t Find(const Site& site)
  {
    const auto found =
      this->Index.emplace(GetKey(site), static_cast<std::int32_t>(this->Sites.size()));
    if (found.second)
    {
      this->Sites.push_back(site);
    }
    return found.first->second;
  }

  // All nodes of tetrahedra that have the centre of one of the cubes.
  void EvaluateSites(const std::vector<Site>& cubes)
  {
    constexpr double bytesPerCube = 500; // with its nodes and triangles
    RequireMemory("a surface of so many triangles (choose larger ones)",
      bytesPerCube * static_cast<double>(cubes.size()));
    const std::size_t known = this->Sites.size();
    for (const Site& cube : cubes)
    {
      this->Find(cube);
      for (int corner = 0; corner < 8; ++corner)
      {
        this->Find({ cube[0] + (corner & 1 ? 1 : -1), cube[1] + (corner & 2 ? 1 : -1),
          cube[2] + (corner & 4 ? 1 : -1) });
      }
      for (int axis = 0; axis < 3; ++axis)
      {
        for (const int side : { -2, 2 })
        {
          Site neighbor = cube;
          neighbor[axis] += side;
          this->Find(neighbor);
        }
      }
    }
    if (this->Sites.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() / 4))
    {
      throw MemoryExceeded("the surface has too many triangles; choose larger ones");
    }
    std::vector<Vec3> points;
    for (std::size_t i = known; i < this->Sites.size(); ++i)
    {
      points.push_back(this->GetPoint(this->Sites[i]));
    }
    std::vector<double> values;
    this->EvaluateAt(points, values, nullptr);
    this->Values.insert(this->Values.end(), values.begin(), values.end());
  }

  // Corners of the face between cubes that differ along an axis, in turn.
  static std::array<Site, 4> GetFace(const Site& low, const Site& high, int axis)
  {
    std::array<Site, 4> corners;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k)
    {
      corners[k] = low;
      corners[k][axis] = (low[axis] + high[axis]) / 2;
      corners[k][b] += k == 0 || k == 3 ? 1 : -1;
      corners[k][c] += k < 2 ? 1 : -1;
    }
    return corners;
  }

  bool IsCrossed(const Site& cube, const Site& neighbor, int axis)
  {
    const bool inside = this->Values[this->Find(cube)] < 0;
    if ((this->Values[this->Find(neighbor)] < 0) != inside)
    {
      return true;
    }
    for (const Site& corner : GetFace(cube, neighbor, axis))
    {
      if ((this->Values[this->Find(corner)] < 0) != inside)
      {
        return true;
      }
    }
    return false;
  }

  void MakeTriangles(const Site& low, const Site& high, int axis)
  {
    const std::array<Site, 4> face = GetFace(low, high, axis);
    for (int k = 0; k < 4; ++k)
    {
      // ordered so that the determinant of its edges is positive
      this->March(
        { this->Find(low), this->Find(face[k]), this->Find(face[(k + 1) % 4]), this->Find(high) });
    }
  }

  void March(const std::array<std::int32_t, 4>& nodes)
  {
    // Even permutations, so that the orientation of the nodes stays.
    static constexpr int ones[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 },
      { 3, 2, 1, 0 } };
    static constexpr int pairs[6][4] = { { 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 },
      { 1, 2, 0, 3 }, { 1, 3, 2, 0 }, { 2, 3, 0, 1 } };
    bool inside[4];
    int count = 0;
    for (int i = 0; i < 4; ++i)
    {
      inside[i] = this->Values[nodes[i]] < 0;
      count += inside[i];
    }
    const auto cross = [&](int i, int j) { return this->GetCrossing(nodes[i], nodes[j]); };
    std::vector<TriangleSurface::Triangle>& triangles = this->Result.Surface.Triangles;
    if (count == 1 || count == 3)
    {
      for (const auto& p : ones)
      {
        if (inside[p[0]] == (count == 1))
        {
          const std::int32_t a = cross(p[0], p[1]);
          const std::int32_t b = cross(p[0], p[2]);
          const std::int32_t c = cross(p[0], p[3]);
          triangles.push_back(count == 1 ? TriangleSurface::Triangle{ a, b, c }
                                         : TriangleSurface::Triangle{ a, c, b });
        }
      }
    }
    else if (count == 2)
    {
      for (const auto& p : pairs)
      {
        if (inside[p[0]] && inside[p[1]])
        {
          const std::int32_t a = cross(p[0], p[2]);
          const std::int32_t b = cross(p[0], p[3]);
          const std::int32_t c = cross(p[1], p[3]);
          const std::int32_t d = cross(p[1], p[2]);
          const std::vector<Vec3>& points = this->Result.Surface.Points;
          // Both diagonals lie inside of the tetrahedron, so that no other triangle has them.
          if (Norm(points[a] - points[c]) <= Norm(points[b] - points[d]))
          {
            triangles.push_back({ a, b, c });
            triangles.push_back({ a, c, d });
          }
          else
          {
            triangles.push_back({ a, b, d });
            triangles.push_back({ b, c, d });
          }
        }
      }
    }
  }

  std::int32_t GetCrossing(std::int32_t i, std::int32_t j)
  {
    const auto [low, high] = std::minmax(i, j);
    const auto found = this->Crossings.emplace(
      static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high),
      static_cast<std::int32_t>(this->Result.Surface.Points.size()));
    if (found.second)
    {
      const Vec3 from = this->GetPoint(this->Sites[low]);
      const Vec3 to = this->GetPoint(this->Sites[high]);
      const double t = this->Values[low] / (this->Values[low] - this->Values[high]);
      this->Result.Surface.Points.push_back(from + t * (to - from));
    }
    return found.first->second;
  }

  Execution& Runner;
  const ImplicitFunction& Function;
  const SurfaceFollowerOptions& Options;
  FollowedSurface& Result;
  Vec3 Origin{};
  std::unordered_map<std::uint64_t, std::int32_t> Index;
  std::vector<Site> Sites;
  std::vector<double> Values;
  std::unordered_set<std::uint64_t> Cubes; // that hold some of the surface
  std::vector<Site> Order;                 // of the same, as they were found
  std::unordered_map<std::uint64_t, std::int32_t> Crossings;
};

// Points move along the surface towards the middle of their neighbours.
void Relax(TriangleSurface& surface, const std::vector<Vec3>& normals)
{
  constexpr double part = 0.5;
  const std::vector<Vec3> ways = GetUmbrellas(surface);
  for (std::size_t i = 0; i < ways.size(); ++i)
  {
    surface.Points[i] =
      surface.Points[i] + part * (ways[i] - Dot(ways[i], normals[i]) * normals[i]);
  }
}
}

//------------------------------------------------------------------------------
FollowedSurface FollowSurface(Execution& execution, const ImplicitFunction& function,
  const std::vector<Vec3>& seeds, const SurfaceFollowerOptions& options)
{
  if (!(options.EdgeLength > 0) || !std::isfinite(options.EdgeLength))
  {
    throw std::invalid_argument("the length of edges must be a finite number above 0");
  }
  ValueRange::Above(0, "mm").Check("Tolerance", options.Tolerance);
  for (int c = 0; c < 3; ++c)
  {
    if (!(options.Bounds[2 * c] < options.Bounds[2 * c + 1]) ||
      !std::isfinite(options.Bounds[2 * c + 1] - options.Bounds[2 * c]))
    {
      throw std::invalid_argument("bounds must be finite, the lower one first, and not flat");
    }
  }
  // Of the length of edges: what makes triangles even, found by trial on spheres and tori.
  constexpr double shortest = 0.62;
  constexpr double longest = 1.5;
  constexpr int rounds = 3;
  constexpr int newtonSteps = 12;
  const Capped capped(function, options.Bounds);
  const Execution::NestedStages stages(execution);
  FollowedSurface result;
  Follower follower(execution,
    options.Cap ? static_cast<const ImplicitFunction&>(capped) : function, options, result);
  follower.Follow(seeds);
  follower.MakeTriangles();
  TriangleSurface& surface = result.Surface;
  for (int round = 0; round < rounds; ++round)
  {
    follower.Project(surface.Points, result.Normals, 1);
    CollapseShortEdges(surface, shortest * options.EdgeLength, longest * options.EdgeLength);
    FlipEdges(surface);
    follower.Project(surface.Points, result.Normals, 0);
    Relax(surface, result.Normals);
  }
  follower.Project(surface.Points, result.Normals, newtonSteps);
  result.IsCap.assign(surface.Points.size(), 0);
  for (std::size_t i = 0; options.Cap && i < surface.Points.size(); ++i)
  {
    int axis = 0;
    double side = 0;
    result.IsCap[i] =
      std::abs(capped.GetBox(surface.Points[i], axis, side)) <= 2 * options.Tolerance;
    result.ReachesBounds = result.ReachesBounds || result.IsCap[i];
  }
  return result;
}

//------------------------------------------------------------------------------
namespace
{
// Nearest place of a triangle.
Vec3 FindFoot(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal)
{
  const double area = Dot(normal, normal);
  if (area > 0 && Dot(Cross(b - a, p - a), normal) >= 0 && Dot(Cross(c - b, p - b), normal) >= 0 &&
    Dot(Cross(a - c, p - c), normal) >= 0)
  {
    return p - (Dot(p - a, normal) / area) * normal;
  }
  Vec3 best = a;
  for (const auto& edge : { std::array<Vec3, 2>{ a, b }, { b, c }, { c, a } })
  {
    const Vec3 along = edge[1] - edge[0];
    const double length = Dot(along, along);
    const double t = length > 0 ? std::clamp(Dot(p - edge[0], along) / length, 0.0, 1.0) : 0;
    const Vec3 foot = edge[0] + t * along;
    best = Norm(p - foot) < Norm(p - best) ? foot : best;
  }
  return best;
}
}

//------------------------------------------------------------------------------
SurfaceDistance::SurfaceDistance(const TriangleSurface& surface)
  : Surface(surface)
  , Neighbors(surface.Points)
  , Firsts(surface.Points.size() + 1, 0)
{
  for (const auto& triangle : surface.Triangles)
  {
    for (const std::int32_t p : triangle)
    {
      ++this->Firsts[p + 1];
    }
  }
  for (std::size_t i = 1; i < this->Firsts.size(); ++i)
  {
    this->Firsts[i] += this->Firsts[i - 1];
  }
  this->Around.resize(this->Firsts.back());
  std::vector<std::size_t> at(this->Firsts.begin(), this->Firsts.end() - 1);
  for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
  {
    for (const std::int32_t p : surface.Triangles[t])
    {
      this->Around[at[p]++] = t;
    }
  }
}

//------------------------------------------------------------------------------
double SurfaceDistance::Get(const Vec3& x) const
{
  constexpr std::size_t count = 6;
  std::vector<std::size_t> nearest;
  this->Neighbors.Find(x, count, nearest);
  double least = std::numeric_limits<double>::infinity();
  double facing =
    0; // of the triangles with the least distance the one that is seen most from the front
  double side = 1;
  for (const std::size_t p : nearest)
  {
    for (std::size_t k = this->Firsts[p]; k < this->Firsts[p + 1]; ++k)
    {
      const auto& t = this->Surface.Triangles[this->Around[k]];
      const Vec3& a = this->Surface.Points[t[0]];
      const Vec3& b = this->Surface.Points[t[1]];
      const Vec3& c = this->Surface.Points[t[2]];
      const Vec3 normal = Cross(b - a, c - a);
      const Vec3 way = x - FindFoot(x, a, b, c, normal);
      const double distance = Norm(way);
      const double height = Dot(way, normal) / Norm(normal);
      constexpr double same = 1e-9;
      const bool nearer = distance < least * (1 - same);
      if (nearer || (distance <= least * (1 + same) && std::abs(height) > facing))
      {
        least = nearer ? distance : least;
        facing = std::abs(height);
        side = height < 0 ? -1 : 1;
      }
    }
  }
  return side * least;
}
}
