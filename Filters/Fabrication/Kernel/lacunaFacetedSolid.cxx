// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFacetedSolid.h"

#include "lacunaMeshSimplifier.h"
#include "lacunaTriangleTree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double VolumeTolerance = 5e-4;
constexpr std::array<double, 4> Attempts = { 0.85, 0.6, 0.3, 0.1 }; // parts of the tolerance
constexpr int Rounds = 3; // of each, in which more and more of the surface is left as it is
constexpr double FixedReach = 0.5;      // mm around what passes through itself
constexpr double SameDirection = 0.999; // least cosine between normals of triangles in one plane
constexpr double SampleSpacing = 0.25;  // mm

//------------------------------------------------------------------------------
double FindLargestDistance(
  const std::vector<Vec3>& samples, const TriangleTree& tree, Execution& execution)
{
  std::vector<double> distances(samples.size());
  execution.For(static_cast<std::int64_t>(samples.size()), 1024,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        distances[i] = tree.GetDistance(samples[i]);
      }
    });
  return *std::max_element(distances.begin(), distances.end());
}

// Triangles that pass through others, and these.
std::vector<std::int32_t> FindCrossings(
  const ClosedMesh& mesh, const TriangleTree& tree, Execution& execution)
{
  std::vector<std::int32_t> others(mesh.Triangles.size());
  execution.For(static_cast<std::int64_t>(mesh.Triangles.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t t = begin; t < end; ++t)
      {
        others[t] = tree.FindCrossing(static_cast<std::int32_t>(t));
      }
    });
  std::vector<std::int32_t> found;
  for (std::size_t t = 0; t < others.size(); ++t)
  {
    if (others[t] >= 0)
    {
      found.push_back(static_cast<std::int32_t>(t));
      found.push_back(others[t]);
    }
  }
  return found;
}

// Marks points of mesh in the boxes of these triangles of another one, and up to reach (mm) around. Whether there are new ones.
bool FixAround(const ClosedMesh& other, const std::vector<std::int32_t>& triangles, double reach,
  const ClosedMesh& mesh, std::vector<char>& fixed, Execution& execution)
{
  std::vector<std::array<Vec3, 2>> boxes;
  for (const std::int32_t t : triangles)
  {
    const ClosedMesh::Triangle& ids = other.Triangles[t];
    std::array<Vec3, 2> box;
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto [low, high] = std::minmax(
        { other.Points[ids[0]][axis], other.Points[ids[1]][axis], other.Points[ids[2]][axis] });
      box[0][axis] = low - reach;
      box[1][axis] = high + reach;
    }
    boxes.push_back(box);
  }
  const auto before = std::count(fixed.begin(), fixed.end(), 1);
  execution.For(static_cast<std::int64_t>(fixed.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const Vec3& p = mesh.Points[i];
        const auto holds = [&p](const std::array<Vec3, 2>& box)
        {
          return p[0] >= box[0][0] && p[0] <= box[1][0] && p[1] >= box[0][1] && p[1] <= box[1][1] &&
            p[2] >= box[0][2] && p[2] <= box[1][2];
        };
        fixed[i] = fixed[i] || std::any_of(boxes.begin(), boxes.end(), holds) ? 1 : 0;
      }
    });
  return std::count(fixed.begin(), fixed.end(), 1) > before;
}

//------------------------------------------------------------------------------
// Puts triangles that lie in one plane together.
class FaceMaker
{
public:
  FaceMaker(const ClosedMesh& mesh, double flatness)
    : Mesh(mesh)
    , Flatness(flatness)
    , Neighbors(mesh.Triangles.size())
    , Groups(mesh.Triangles.size(), -1)
  {
    std::unordered_map<std::uint64_t, std::int32_t> edges;
    edges.reserve(3 * mesh.Triangles.size());
    const auto key = [](std::int32_t from, std::int32_t to)
    { return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to); };
    for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = mesh.Triangles[t];
      for (int k = 0; k < 3; ++k)
      {
        edges[key(ids[k], ids[(k + 1) % 3])] = static_cast<std::int32_t>(t);
      }
    }
    for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = mesh.Triangles[t];
      for (int k = 0; k < 3; ++k)
      {
        this->Neighbors[t][k] = edges.at(key(ids[(k + 1) % 3], ids[k]));
      }
    }
  }

  // Calls take(face, triangle) for each face, with one of its triangles.
  template <class Take>
  void Make(Take take)
  {
    std::vector<double> areas(this->Mesh.Triangles.size());
    std::vector<std::int32_t> order(this->Mesh.Triangles.size());
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t t = 0; t < areas.size(); ++t)
    {
      areas[t] = Norm(this->GetNormal(static_cast<std::int32_t>(t)));
    }
    std::stable_sort(order.begin(), order.end(),
      [&](std::int32_t a, std::int32_t b) { return areas[a] > areas[b]; });
    for (const std::int32_t seed : order)
    {
      if (this->Groups[seed] >= 0)
      {
        continue;
      }
      const std::vector<std::int32_t> group = this->Grow(seed);
      FacetedSolid::Face face;
      if (group.size() > 1 && this->MakePolygon(group, face))
      {
        take(face, seed);
        continue;
      }
      for (const std::int32_t t : group)
      {
        const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
        const Vec3 normal = this->GetNormal(t);
        if (!HasDirection(normal))
        {
          throw std::runtime_error("triangle " + std::to_string(t) +
            " of the surface has no area; apply Clean first, or write another format");
        }
        take(FacetedSolid::Face{ this->Mesh.Points[ids[0]], Normalized(normal),
               { { ids[0], ids[1], ids[2] } } },
          t);
      }
    }
  }

private:
  Vec3 GetNormal(std::int32_t t) const
  {
    const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
    return Cross(this->Mesh.Points[ids[1]] - this->Mesh.Points[ids[0]],
      this->Mesh.Points[ids[2]] - this->Mesh.Points[ids[0]]);
  }

  // The triangles around seed that lie in its plane.
  std::vector<std::int32_t> Grow(std::int32_t seed)
  {
    const Vec3 origin = this->Mesh.Points[this->Mesh.Triangles[seed][0]];
    const Vec3 normal = Normalized(this->GetNormal(seed));
    std::vector<std::int32_t> group{ seed };
    this->Groups[seed] = seed;
    for (std::size_t next = 0; next < group.size(); ++next)
    {
      for (const std::int32_t other : this->Neighbors[group[next]])
      {
        if (this->Groups[other] >= 0)
        {
          continue;
        }
        const ClosedMesh::Triangle& ids = this->Mesh.Triangles[other];
        bool flat = true;
        double longest = 0;
        for (int k = 0; k < 3; ++k)
        {
          const Vec3& p = this->Mesh.Points[ids[k]];
          flat = flat && std::abs(Dot(normal, p - origin)) <= this->Flatness / 2;
          longest = std::max(longest, Norm(this->Mesh.Points[ids[(k + 1) % 3]] - p));
        }
        const Vec3 own = this->GetNormal(other);
        const bool thin = Norm(own) <= this->Flatness * longest; // it may have any normal
        if (flat && (thin || Dot(normal, own) >= SameDirection * Norm(own)))
        {
          this->Groups[other] = seed;
          group.push_back(other);
        }
      }
    }
    return group;
  }

  // False when the border of the group meets itself.
  bool MakePolygon(const std::vector<std::int32_t>& group, FacetedSolid::Face& face) const
  {
    std::unordered_map<std::int32_t, std::int32_t> next;
    std::vector<std::int32_t> starts;
    for (const std::int32_t t : group)
    {
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
      for (int k = 0; k < 3; ++k)
      {
        if (this->Groups[this->Neighbors[t][k]] != this->Groups[t])
        {
          if (!next.emplace(ids[k], ids[(k + 1) % 3]).second)
          {
            return false;
          }
          starts.push_back(ids[k]);
        }
      }
    }
    const Vec3 origin = this->Mesh.Points[this->Mesh.Triangles[group.front()][0]];
    const Vec3 rough = Normalized(this->GetNormal(group.front()));
    Vec3 normal{ 0, 0, 0 };
    int outer = 0;
    for (const std::int32_t start : starts)
    {
      std::vector<std::int32_t> loop;
      Vec3 area{ 0, 0, 0 };
      for (auto found = next.find(start); found != next.end(); found = next.find(loop.back()))
      {
        area = area +
          Cross(
            this->Mesh.Points[found->first] - origin, this->Mesh.Points[found->second] - origin);
        loop.push_back(found->second);
        next.erase(found);
      }
      if (loop.empty())
      {
        continue;
      }
      normal = normal + area;
      face.Loops.push_back(std::move(loop));
      if (Dot(area, rough) > 0)
      {
        ++outer;
        std::swap(face.Loops.front(), face.Loops.back());
      }
    }
    if (outer != 1)
    {
      return false;
    }
    Vec3 middle{ 0, 0, 0 };
    for (const std::int32_t id : face.Loops.front())
    {
      middle =
        middle + 1.0 / static_cast<double>(face.Loops.front().size()) * this->Mesh.Points[id];
    }
    face.Normal = Normalized(normal);
    face.Origin = middle;
    return true;
  }

  const ClosedMesh& Mesh;
  double Flatness;
  std::vector<std::array<std::int32_t, 3>> Neighbors; // over each edge
  std::vector<std::int32_t> Groups;
};

// A point where the surface passes through itself.
std::optional<Vec3> GetPlace(const ClosedMesh& mesh, const std::vector<std::int32_t>& crossings)
{
  if (crossings.empty())
  {
    return {};
  }
  return mesh.Points[mesh.Triangles[crossings.front()][0]];
}

//------------------------------------------------------------------------------
struct Simplified
{
  ClosedMesh Mesh;
  double Deviation = 0;
  std::optional<Vec3> Crossing;
};

Simplified Simplify(const ClosedMesh& mesh, double tolerance, Execution& execution)
{
  const Execution::NestedStages stages(execution);
  const TriangleTree tree(mesh);
  const double volume = mesh.GetVolume();
  const std::vector<Vec3> samples = SampleMesh(mesh, SampleSpacing);
  std::optional<std::vector<std::int32_t>> crossings; // of mesh, when they are known
  for (std::size_t attempt = 0; attempt < Attempts.size() && tolerance > 0; ++attempt)
  {
    std::vector<char> fixed(mesh.Points.size(), 0);
    for (int round = 0; round < Rounds; ++round)
    {
      const double begin = static_cast<double>(attempt) + static_cast<double>(round) / Rounds;
      const auto at = [&](double fraction)
      { return (begin + fraction / Rounds) / Attempts.size(); };
      execution.SetStage(at(0), at(0.5));
      Simplified result{ SimplifyMesh(mesh, Attempts[attempt] * tolerance, execution, fixed), 0,
        {} };
      if (!(std::abs(result.Mesh.GetVolume() - volume) <= VolumeTolerance * volume))
      {
        break;
      }
      const TriangleTree simple(result.Mesh);
      execution.SetStage(at(0.5), at(0.7));
      result.Deviation = FindLargestDistance(samples, simple, execution);
      execution.SetStage(at(0.7), at(0.8));
      result.Deviation = std::max(result.Deviation,
        FindLargestDistance(SampleMesh(result.Mesh, SampleSpacing), tree, execution));
      if (!(result.Deviation <= tolerance))
      {
        break;
      }
      execution.SetStage(at(0.8), at(0.9));
      const std::vector<std::int32_t> found = FindCrossings(result.Mesh, simple, execution);
      if (!found.empty() && !crossings)
      {
        execution.SetStage(at(0.9), at(1));
        crossings = FindCrossings(mesh, tree, execution);
      }
      if (found.empty() || !crossings->empty())
      {
        result.Crossing = GetPlace(result.Mesh, found);
        return result;
      }
      if (round + 1 == Rounds ||
        !FixAround(result.Mesh, found, FixedReach * (round + 1), mesh, fixed, execution))
      {
        break;
      }
    }
  }
  execution.SetStage(0.9, 1);
  return { mesh, 0, GetPlace(mesh, crossings ? *crossings : FindCrossings(mesh, tree, execution)) };
}
}

//------------------------------------------------------------------------------
std::size_t FacetedSolid::GetNumberOfFaces() const
{
  std::size_t count = 0;
  for (const Body& body : this->Bodies)
  {
    for (const std::vector<Face>& shell : body.Shells)
    {
      count += shell.size();
    }
  }
  return count;
}

//------------------------------------------------------------------------------
FacetedSolid MakeFacetedSolid(ClosedMesh mesh, double tolerance, Execution& execution)
{
  FaceTolerances.Check("Tolerance", tolerance);
  CheckClosed(mesh);
  SeparateFans(mesh);
  Simplified simple = Simplify(mesh, tolerance, execution);

  FacetedSolid solid;
  solid.Deviation = simple.Deviation;
  solid.Crossing = simple.Crossing;
  double largest = 0;
  for (const Vec3& p : simple.Mesh.Points)
  {
    largest = std::max({ largest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) });
  }
  solid.Flatness = std::max(1e-6, 4e-7 * largest); // single precision rounds to 6e-8

  const MeshPieces pieces = FindPieces(simple.Mesh);
  const std::vector<std::int32_t> hosts = FindHosts(simple.Mesh, pieces);
  std::vector<std::pair<std::size_t, std::size_t>> places(
    hosts.size()); // body and shell of each piece
  for (const bool cavities : { false, true })
  {
    for (std::size_t piece = 0; piece < hosts.size(); ++piece)
    {
      if ((hosts[piece] >= 0) != cavities)
      {
        continue;
      }
      if (!cavities)
      {
        places[piece] = { solid.Bodies.size(), 0 };
        solid.Bodies.emplace_back();
      }
      else
      {
        const std::size_t body = places[hosts[piece]].first;
        places[piece] = { body, solid.Bodies[body].Shells.size() };
      }
      FacetedSolid::Body& body = solid.Bodies[places[piece].first];
      body.Shells.emplace_back();
      body.Volume += pieces.Volumes[piece];
      solid.Volume += pieces.Volumes[piece];
    }
  }
  FaceMaker(simple.Mesh, solid.Flatness)
    .Make(
      [&](const FacetedSolid::Face& face, std::int32_t triangle)
      {
        const auto& [body, shell] = places[pieces.Of[triangle]];
        solid.Bodies[body].Shells[shell].push_back(face);
      });
  solid.Points = std::move(simple.Mesh.Points);
  if (solid.GetNumberOfFaces() > MostFaces)
  {
    throw std::runtime_error("the solid would have " + std::to_string(solid.GetNumberOfFaces()) +
      " flat faces, and CAD programs take minutes for more than " + std::to_string(MostFaces) +
      ". Increase Tolerance, or write 3MF or STL");
  }
  return solid;
}
}
