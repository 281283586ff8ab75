// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaClosedMesh.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace lacuna
{
namespace
{
constexpr double FullTurn = 12.566370614359172; // 4 pi, sr

std::string DescribePlace(const Vec3& p)
{
  const auto text = [](double value) { return FormatNumber(std::round(1000 * value) / 1000); };
  return text(p[0]) + " " + text(p[1]) + " " + text(p[2]) + " mm";
}

std::uint64_t MakeKey(std::int32_t from, std::int32_t to)
{
  return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
}

// The directed edges of all triangles, sorted by their ends, each with its triangle.
struct DirectedEdge
{
  std::uint64_t Key;
  std::int32_t Triangle;
};
std::vector<DirectedEdge> SortEdges(const ClosedMesh& mesh)
{
  std::vector<DirectedEdge> edges;
  edges.reserve(3 * mesh.Triangles.size());
  for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
  {
    const ClosedMesh::Triangle& ids = mesh.Triangles[t];
    for (int k = 0; k < 3; ++k)
    {
      edges.push_back({ MakeKey(ids[k], ids[(k + 1) % 3]), static_cast<std::int32_t>(t) });
    }
  }
  std::sort(edges.begin(), edges.end(),
    [](const DirectedEdge& a, const DirectedEdge& b) { return a.Key < b.Key; });
  return edges;
}

// The triangle on the other side of the edge that leads from one point to the other; -1: none.
std::int32_t FindTriangle(const std::vector<DirectedEdge>& edges, std::uint64_t key)
{
  const auto found = std::lower_bound(edges.begin(), edges.end(), key,
    [](const DirectedEdge& edge, std::uint64_t value) { return edge.Key < value; });
  return found != edges.end() && found->Key == key ? found->Triangle : -1;
}

// Sets that grow together.
class Unions
{
public:
  explicit Unions(std::size_t count)
    : Parents(count)
  {
    std::iota(this->Parents.begin(), this->Parents.end(), 0);
  }
  std::int32_t Find(std::int32_t i)
  {
    while (this->Parents[i] != i)
    {
      this->Parents[i] = this->Parents[this->Parents[i]];
      i = this->Parents[i];
    }
    return i;
  }
  void Join(std::int32_t a, std::int32_t b)
  {
    a = this->Find(a);
    b = this->Find(b);
    this->Parents[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::int32_t> Parents;
};

double GetVolumeOf(const ClosedMesh& mesh, const ClosedMesh::Triangle& ids)
{
  const Vec3& origin = mesh.Points.front();
  return Dot(mesh.Points[ids[0]] - origin,
           Cross(mesh.Points[ids[1]] - origin, mesh.Points[ids[2]] - origin)) /
    6;
}

// The solid angle that a triangle covers seen from x (Van Oosterom and Strackee 1983).
double GetSolidAngle(const Vec3& x, const Vec3& p, const Vec3& q, const Vec3& r)
{
  const Vec3 a = p - x;
  const Vec3 b = q - x;
  const Vec3 c = r - x;
  const double la = Norm(a);
  const double lb = Norm(b);
  const double lc = Norm(c);
  return 2 *
    std::atan2(
      Dot(a, Cross(b, c)), la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb);
}
}

//------------------------------------------------------------------------------
double ClosedMesh::GetVolume() const
{
  double volume = 0;
  for (const Triangle& ids : this->Triangles)
  {
    volume += GetVolumeOf(*this, ids);
  }
  return volume;
}

//------------------------------------------------------------------------------
void CheckClosed(const ClosedMesh& mesh)
{
  if (mesh.Triangles.empty())
  {
    throw std::runtime_error("there are no triangles to write");
  }
  for (std::size_t k = 0; k < mesh.Points.size(); ++k)
  {
    if (!IsFinite(mesh.Points[k]))
    {
      throw std::runtime_error("point " + std::to_string(k) + " of the surface is not finite");
    }
  }
  for (std::size_t k = 0; k < mesh.Triangles.size(); ++k)
  {
    const ClosedMesh::Triangle& ids = mesh.Triangles[k];
    if (ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0])
    {
      throw std::runtime_error(
        "triangle " + std::to_string(k) + " has a corner twice; apply Clean first");
    }
  }
  const std::vector<DirectedEdge> edges = SortEdges(mesh);
  std::int64_t twice = 0;
  std::int64_t alone = 0;
  std::int32_t branch = 0;
  std::int32_t open = 0;
  for (std::size_t k = 0; k < edges.size(); ++k)
  {
    const auto from = static_cast<std::int32_t>(edges[k].Key >> 32);
    const auto to = static_cast<std::int32_t>(edges[k].Key & 0xffffffffu);
    if (k > 0 && edges[k].Key == edges[k - 1].Key)
    {
      branch = twice++ == 0 ? from : branch;
    }
    else if (FindTriangle(edges, MakeKey(to, from)) < 0)
    {
      open = alone++ == 0 ? from : open;
    }
  }
  if (twice > 0)
  {
    throw std::runtime_error("the surface branches or is turned over: " + std::to_string(twice) +
      " edges have more than one triangle on the same side, such as one at " +
      DescribePlace(mesh.Points[branch]));
  }
  if (alone > 0)
  {
    throw std::runtime_error("a solid has a closed surface, and this one is open: " +
      std::to_string(alone) + " edges have a triangle on one side only, such as one at " +
      DescribePlace(mesh.Points[open]) +
      ". Write another format, or if points are there twice (Generate Surface Normals splits them) "
      "apply Clean first");
  }
  if (!(mesh.GetVolume() > 0))
  {
    throw std::runtime_error(
      "the surface is inside out; turn its triangles (Generate Surface Normals, Flip Normals)");
  }
}

//------------------------------------------------------------------------------
void SeparateFans(ClosedMesh& mesh)
{
  // Corners are one point when the triangles of a fan connect them over an edge.
  const std::vector<DirectedEdge> edges = SortEdges(mesh);
  Unions corners(3 * mesh.Triangles.size());
  for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
  {
    const ClosedMesh::Triangle& ids = mesh.Triangles[t];
    for (int k = 0; k < 3; ++k)
    {
      const std::int32_t other = FindTriangle(edges, MakeKey(ids[(k + 1) % 3], ids[k]));
      for (int corner = 0; corner < 3; ++corner)
      {
        for (int end : { k, (k + 1) % 3 })
        {
          if (mesh.Triangles[other][corner] == ids[end])
          {
            corners.Join(static_cast<std::int32_t>(3 * t) + end, 3 * other + corner);
          }
        }
      }
    }
  }
  std::vector<std::int32_t> numbers(3 * mesh.Triangles.size(), -1);
  std::vector<Vec3> points;
  for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      std::int32_t& number = numbers[corners.Find(static_cast<std::int32_t>(3 * t) + k)];
      if (number < 0)
      {
        number = static_cast<std::int32_t>(points.size());
        points.push_back(mesh.Points[mesh.Triangles[t][k]]);
      }
      mesh.Triangles[t][k] = number;
    }
  }
  mesh.Points.swap(points);
}

//------------------------------------------------------------------------------
MeshPieces FindPieces(const ClosedMesh& mesh)
{
  Unions points(mesh.Points.size());
  for (const ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    points.Join(ids[0], ids[1]);
    points.Join(ids[0], ids[2]);
  }
  MeshPieces pieces;
  std::unordered_map<std::int32_t, std::int32_t> numbers;
  for (const ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    const auto number = numbers.emplace(points.Find(ids[0]), numbers.size()).first->second;
    pieces.Of.push_back(number);
    pieces.Volumes.resize(numbers.size());
    pieces.Volumes[number] += GetVolumeOf(mesh, ids);
  }
  return pieces;
}

//------------------------------------------------------------------------------
std::vector<std::int32_t> FindHosts(const ClosedMesh& mesh, const MeshPieces& pieces)
{
  const std::size_t count = pieces.Volumes.size();
  std::vector<std::int32_t> hosts(count, -1);
  std::vector<std::int32_t> firsts(count, -1);
  for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
  {
    std::int32_t& first = firsts[pieces.Of[t]];
    first = first < 0 ? mesh.Triangles[t][0] : first;
  }
  std::vector<double> turns(count);
  for (std::size_t piece = 0; piece < count; ++piece)
  {
    if (pieces.Volumes[piece] > 0)
    {
      continue;
    }
    const Vec3 x = mesh.Points[firsts[piece]];
    std::fill(turns.begin(), turns.end(), 0);
    for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = mesh.Triangles[t];
      if (pieces.Volumes[pieces.Of[t]] > 0)
      {
        turns[pieces.Of[t]] +=
          GetSolidAngle(x, mesh.Points[ids[0]], mesh.Points[ids[1]], mesh.Points[ids[2]]);
      }
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t host = 0; host < count; ++host)
    {
      if (turns[host] > FullTurn / 2 && pieces.Volumes[host] < least)
      {
        least = pieces.Volumes[host];
        hosts[piece] = static_cast<std::int32_t>(host);
      }
    }
    if (hosts[piece] < 0)
    {
      throw std::runtime_error("a closed piece of the surface, at " + DescribePlace(x) +
        ", is inside out and no other piece encloses it; turn its triangles");
    }
  }
  return hosts;
}
}
