// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPointNormals.h"

#include "lacunaExecution.h"

#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <stdexcept>
#include <string>

extern "C" void dsyev_(const char* jobs, const char* uplo, const int* n, double* a, const int* lda,
  double* values, double* work, const int* workLength, int* info, std::size_t, std::size_t);

namespace lacuna
{
namespace
{
constexpr std::int64_t Grain = 512;
constexpr std::size_t FewestPoints = 10;
// Of the variances within a neighbourhood: below, it is a line.
constexpr double Flatness = 1e-4;

// What nanoflann wants to know.
struct Cloud
{
  const std::vector<Vec3>& Points;
  std::size_t kdtree_get_point_count() const { return this->Points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t c) const
  {
    return this->Points[i][static_cast<int>(c)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const
  {
    return false;
  }
};

struct Neighborhood
{
  Vec3 Normal;
  bool IsLine;
};

Neighborhood FitPlane(const std::vector<Vec3>& points, const std::vector<std::size_t>& indices)
{
  Vec3 center{};
  for (const std::size_t i : indices)
  {
    center = center + (1.0 / static_cast<double>(indices.size())) * points[i];
  }
  double covariance[9] = {};
  for (const std::size_t i : indices)
  {
    const Vec3 d = points[i] - center;
    for (int r = 0; r < 3; ++r)
    {
      for (int c = 0; c < 3; ++c)
      {
        covariance[3 * r + c] += d[r] * d[c];
      }
    }
  }
  double values[3];
  double work[64];
  const int n = 3;
  const int length = 64;
  int info = 0;
  dsyev_("V", "L", &n, covariance, &n, values, work, &length, &info, 1, 1);
  return { Normalized({ covariance[0], covariance[1], covariance[2] }),
    !(values[1] > Flatness * values[2]) };
}
}

//------------------------------------------------------------------------------
class PointNeighbors::Tree
{
public:
  using Index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

  explicit Tree(const std::vector<Vec3>& points)
    : Source{ points }
    , Search(3, this->Source, nanoflann::KDTreeSingleIndexAdaptorParams(16))
  {
  }

  Cloud Source;
  Index Search;
};

PointNeighbors::PointNeighbors(const std::vector<Vec3>& points)
{
  if (points.empty())
  {
    throw std::invalid_argument("there are no points");
  }
  this->Search = std::make_unique<Tree>(points);
}

PointNeighbors::~PointNeighbors() = default;

void PointNeighbors::Find(const Vec3& x, std::size_t count, std::vector<std::size_t>& indices,
  std::vector<double>* distances) const
{
  count = std::min(count, this->Search->Source.Points.size());
  indices.resize(count);
  std::vector<double> squares(count);
  nanoflann::KNNResultSet<double, std::size_t> found(count);
  found.init(indices.data(), squares.data());
  this->Search->Search.findNeighbors(found, x.data(), {});
  if (distances)
  {
    distances->resize(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      (*distances)[i] = std::sqrt(squares[i]);
    }
  }
}

double PointNeighbors::GetDistance(const Vec3& x) const
{
  std::size_t index = 0;
  double square = 0;
  nanoflann::KNNResultSet<double, std::size_t> found(1);
  found.init(&index, &square);
  this->Search->Search.findNeighbors(found, x.data(), {});
  return std::sqrt(square);
}

//------------------------------------------------------------------------------
double FindPointSpacing(Execution& execution, const std::vector<Vec3>& points)
{
  constexpr std::size_t neighbors = 8;
  constexpr std::size_t samples = 4096;
  const PointNeighbors tree(points);
  const std::size_t stride = std::max<std::size_t>(1, points.size() / samples);
  std::vector<double> spacings((points.size() + stride - 1) / stride);
  execution.For(static_cast<std::int64_t>(spacings.size()), Grain,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<std::size_t> indices;
      std::vector<double> distances;
      for (std::int64_t i = begin; i < end; ++i)
      {
        tree.Find(points[static_cast<std::size_t>(i) * stride], neighbors + 1, indices, &distances);
        // a disc of so many points
        const double pi = std::acos(-1.0);
        spacings[i] = distances.back() *
          std::sqrt(pi / static_cast<double>(std::max<std::size_t>(1, distances.size() - 1)));
      }
    });
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

//------------------------------------------------------------------------------
namespace
{
// Neighbours of all points, so many each, itself left out.
class Graph
{
public:
  Graph(Execution& execution, const std::vector<Vec3>& points, std::size_t count)
    : Points(points)
    , Count(std::min(count, points.size() - 1))
    , Neighbors(points.size() * this->Count)
    , Normals(points.size())
    , Lines(points.size(), 0)
  {
    const PointNeighbors tree(points);
    execution.For(static_cast<std::int64_t>(points.size()), Grain,
      [&](std::int64_t begin, std::int64_t end)
      {
        std::vector<std::size_t> indices;
        for (std::int64_t i = begin; i < end; ++i)
        {
          const auto self = static_cast<std::size_t>(i);
          tree.Find(points[self], this->Count + 1, indices);
          const Neighborhood plane = FitPlane(points, indices);
          this->Normals[self] = plane.Normal;
          this->Lines[self] = plane.IsLine;
          // itself is one of them, unless many lie in the same place
          const auto own = std::find(indices.begin(), indices.end(), self);
          indices.erase(own == indices.end() ? indices.end() - 1 : own);
          for (std::size_t k = 0; k < this->Count; ++k)
          {
            this->Neighbors[self * this->Count + k] = static_cast<std::uint32_t>(indices[k]);
          }
        }
      });
    this->AddReverse();
  }

  // Small along one sheet: normals are parallel, and the way between the points is across them.
  double GetCost(std::size_t i, std::size_t j) const
  {
    const Vec3 way = Normalized(this->Points[j] - this->Points[i]);
    const double parallel = std::abs(Dot(this->Normals[i], this->Normals[j]));
    const double leaves =
      std::max(std::abs(Dot(way, this->Normals[i])), std::abs(Dot(way, this->Normals[j])));
    return 1 - parallel + leaves;
  }

  template <class Body>
  void ForNeighbors(std::size_t i, const Body& body) const
  {
    for (std::size_t k = 0; k < this->Count; ++k)
    {
      body(static_cast<std::size_t>(this->Neighbors[i * this->Count + k]));
    }
    for (std::size_t k = this->Starts[i]; k < this->Starts[i + 1]; ++k)
    {
      body(static_cast<std::size_t>(this->Reverse[k]));
    }
  }

  const std::vector<Vec3>& Points;
  std::size_t Count;
  std::vector<std::uint32_t> Neighbors;
  std::vector<Vec3> Normals;
  std::vector<char> Lines;

private:
  // Who has a point for a neighbour.
  void AddReverse()
  {
    this->Starts.assign(this->Points.size() + 1, 0);
    for (const std::uint32_t j : this->Neighbors)
    {
      ++this->Starts[j + 1];
    }
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      this->Starts[i + 1] += this->Starts[i];
    }
    std::vector<std::size_t> at(this->Starts.begin(), this->Starts.end() - 1);
    this->Reverse.resize(this->Neighbors.size());
    for (std::size_t k = 0; k < this->Neighbors.size(); ++k)
    {
      this->Reverse[at[this->Neighbors[k]]++] = static_cast<std::uint32_t>(k / this->Count);
    }
  }

  std::vector<std::size_t> Starts;
  std::vector<std::uint32_t> Reverse;
};

// Signs over a spanning tree (Prim); returns the parts. Ties are broken by numbers, so that the
// result is always the same.
std::vector<std::vector<std::size_t>> SpreadSigns(Graph& graph)
{
  struct Step
  {
    double Cost;
    std::size_t To;
    std::size_t From;
    bool operator<(const Step& other) const // the cheapest first in a queue
    {
      return this->Cost != other.Cost ? this->Cost > other.Cost
        : this->To != other.To        ? this->To > other.To
                                      : this->From > other.From;
    }
  };
  std::vector<std::vector<std::size_t>> parts;
  std::vector<char> done(graph.Points.size(), 0);
  for (std::size_t start = 0; start < done.size(); ++start)
  {
    if (done[start])
    {
      continue;
    }
    parts.emplace_back();
    std::priority_queue<Step> queue;
    queue.push({ 0, start, start });
    while (!queue.empty())
    {
      const Step step = queue.top();
      queue.pop();
      if (done[step.To])
      {
        continue;
      }
      done[step.To] = 1;
      parts.back().push_back(step.To);
      if (Dot(graph.Normals[step.From], graph.Normals[step.To]) < 0)
      {
        graph.Normals[step.To] = -1.0 * graph.Normals[step.To];
      }
      graph.ForNeighbors(step.To,
        [&](std::size_t j)
        {
          if (!done[j])
          {
            queue.push({ graph.GetCost(step.To, j), j, step.To });
          }
        });
    }
  }
  return parts;
}

// Whether the normals of a part point outwards on the whole: at the points that are extreme in many
// directions they point in these.
bool PointsOutwards(const Graph& graph, const std::vector<std::size_t>& part)
{
  double votes = 0;
  for (int x = -2; x <= 2; ++x)
  {
    for (int y = -2; y <= 2; ++y)
    {
      for (int z = -2; z <= 2; ++z)
      {
        const Vec3 direction =
          Normalized({ static_cast<double>(x), static_cast<double>(y), static_cast<double>(z) });
        const auto extreme = *std::max_element(part.begin(), part.end(),
          [&](std::size_t a, std::size_t b)
          { return Dot(graph.Points[a], direction) < Dot(graph.Points[b], direction); });
        votes += Dot(graph.Normals[extreme], direction);
      }
    }
  }
  return votes >= 0;
}

// Solid angle of a part's oriented points seen from x, of the whole sphere's: 1 inside, 0 outside.
double GetWinding(const Graph& graph, const std::vector<std::size_t>& part, const Vec3& x)
{
  const double pi = std::acos(-1.0);
  double sum = 0;
  for (const std::size_t i : part)
  {
    const Vec3 d = graph.Points[i] - x;
    const double r = Norm(d);
    const std::size_t last = graph.Neighbors[i * graph.Count + graph.Count - 1];
    const double radius = Norm(graph.Points[last] - graph.Points[i]);
    const double area = pi * radius * radius / static_cast<double>(graph.Count + 1);
    sum += r > 0 ? area * Dot(graph.Normals[i], d) / (r * r * r) : 0;
  }
  return sum / (4 * pi);
}
}

//------------------------------------------------------------------------------
PointNormals EstimateNormals(
  Execution& execution, const std::vector<Vec3>& points, std::size_t neighbors)
{
  if (points.size() < FewestPoints)
  {
    throw std::invalid_argument("there are " + std::to_string(points.size()) +
      " points; normals need " + std::to_string(FewestPoints) + " or more");
  }
  if (points.size() > std::numeric_limits<std::uint32_t>::max() / 64)
  {
    throw std::invalid_argument("there are too many points");
  }
  Graph graph(execution, points, neighbors);
  PointNormals result;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (graph.Lines[i])
    {
      result.LinearAt = result.Linear++ == 0 ? points[i] : result.LinearAt;
    }
  }
  const std::vector<std::vector<std::size_t>> parts = SpreadSigns(graph);
  result.Parts = static_cast<std::int64_t>(parts.size());
  const auto turn = [&](const std::vector<std::size_t>& part)
  {
    for (const std::size_t i : part)
    {
      graph.Normals[i] = -1.0 * graph.Normals[i];
    }
  };
  for (const auto& part : parts)
  {
    if (!PointsOutwards(graph, part))
    {
      turn(part);
    }
  }
  // A part within an odd number of others is the wall of a cavity.
  std::vector<char> isCavity(parts.size(), 0);
  for (std::size_t p = 0; p < parts.size() && parts.size() < 100; ++p)
  {
    int around = 0;
    for (std::size_t q = 0; q < parts.size(); ++q)
    {
      around += q != p && parts[q].size() >= FewestPoints &&
        GetWinding(graph, parts[q], points[parts[p][0]]) > 0.5;
    }
    isCavity[p] = around % 2 == 1;
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
  {
    if (isCavity[p])
    {
      turn(parts[p]);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (std::size_t k = 0; k < graph.Count; ++k)
    {
      const std::size_t j = graph.Neighbors[i * graph.Count + k];
      constexpr double along = 0.3; // cost of neighbours that surely are on one sheet
      if (Dot(graph.Normals[i], graph.Normals[j]) < 0 && graph.GetCost(i, j) < along)
      {
        result.ConflictAt = result.Conflicts++ == 0 ? points[i] : result.ConflictAt;
      }
    }
  }
  result.Normals = std::move(graph.Normals);
  return result;
}

//------------------------------------------------------------------------------
std::int64_t FindOpposedNormals(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Vec3>& normals, double spacing, Vec3& at)
{
  constexpr std::size_t neighbors = 6;
  const PointNeighbors tree(points);
  std::vector<char> opposed(points.size(), 0);
  execution.For(static_cast<std::int64_t>(points.size()), Grain,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<std::size_t> indices;
      std::vector<double> distances;
      for (std::int64_t i = begin; i < end; ++i)
      {
        tree.Find(points[i], neighbors, indices, &distances);
        for (std::size_t k = 0; k < indices.size(); ++k)
        {
          constexpr double nearlyOpposite = -0.8;
          if (distances[k] < spacing && Dot(normals[i], normals[indices[k]]) < nearlyOpposite)
          {
            opposed[i] = 1;
          }
        }
      }
    });
  std::int64_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (opposed[i])
    {
      at = count++ == 0 ? points[i] : at;
    }
  }
  return count;
}
}
