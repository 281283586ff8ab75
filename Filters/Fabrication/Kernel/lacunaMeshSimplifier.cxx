// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMeshSimplifier.h"

#include "lacunaTriangleTree.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <queue>

namespace lacuna
{
namespace
{
constexpr double LargestTurn = 0.3;   // least cosine between a triangle's normals before and after
constexpr double LeastHeight = 1e-3;  // mm, of a triangle that is made; thinner ones may stay
constexpr double SameDistance = 1e-5; // mm; a place that is better by less is not taken
constexpr double LargestCorrection = 0.3; // of the tolerance, for the volume
constexpr int MostSamples = 32;           // along an edge

// The sum of squared distances to planes, each times its area.
class Quadric
{
public:
  void Add(const Vec3& normal, double offset, double area)
  {
    int i = 0;
    const double plane[4] = { normal[0], normal[1], normal[2], offset };
    for (int row = 0; row < 4; ++row)
    {
      for (int column = row; column < 4; ++column)
      {
        this->Terms[i++] += area * plane[row] * plane[column];
      }
    }
  }
  void Add(const Quadric& other)
  {
    for (int i = 0; i < 10; ++i)
    {
      this->Terms[i] += other.Terms[i];
    }
  }
  double Get(const Vec3& x) const
  {
    const double v[4] = { x[0], x[1], x[2], 1 };
    double sum = 0;
    int i = 0;
    for (int row = 0; row < 4; ++row)
    {
      for (int column = row; column < 4; ++column)
      {
        sum += (row == column ? 1 : 2) * this->Terms[i++] * v[row] * v[column];
      }
    }
    return std::max(0.0, sum);
  }

  double GetArea() const { return this->Terms[0] + this->Terms[4] + this->Terms[7]; }
  // Where Get is least of the plane Dot(normal, x) = offset, drawn a little to middle, since along planes and
  // edges many points are as good.
  Vec3 GetLowest(const Vec3& middle, const Vec3& normal, double offset) const
  {
    const std::array<double, 10>& q = this->Terms;
    const double weight = 1e-3 * this->GetArea();
    const Vec3 rows[3] = { { q[0] + weight, q[1], q[2] }, { q[1], q[4] + weight, q[5] },
      { q[2], q[5], q[7] + weight } };
    const Vec3 minors[3] = { Cross(rows[1], rows[2]), Cross(rows[2], rows[0]),
      Cross(rows[0], rows[1]) };
    const double determinant = Dot(rows[0], minors[0]);
    const auto solve = [&](const Vec3& right) {
      return 1 / determinant * (right[0] * minors[0] + right[1] * minors[1] + right[2] * minors[2]);
    };
    if (!(determinant > 0))
    {
      return middle;
    }
    const Vec3 free = solve(weight * middle - Vec3{ q[3], q[6], q[8] });
    const Vec3 way = solve(normal);
    const double length = Dot(normal, way);
    return length > 0 ? free + (offset - Dot(normal, free)) / length * way : free;
  }

private:
  std::array<double, 10> Terms{};
};

// A point takes the place of an edge.
struct Step
{
  double Cost;
  std::int32_t From; // the point that goes
  std::int32_t To;
  std::int32_t Stamp; // of From and To together when this was thought of
  bool operator<(const Step& other) const
  {
    if (this->Cost != other.Cost)
    {
      return this->Cost > other.Cost; // the least is the first of the queue
    }
    return this->From != other.From ? this->From > other.From : this->To > other.To;
  }
};

class Simplifier
{
public:
  Simplifier(const ClosedMesh& mesh, double tolerance, const std::vector<char>& fixed)
    : Mesh(mesh)
    , Tree(mesh)
    , Tolerance(tolerance)
    , SquaredTolerance(tolerance * tolerance)
    , Around(mesh.Points.size())
    , Quadrics(mesh.Points.size())
    , Stamps(mesh.Points.size(), 0)
    , Samples(mesh.Triangles.size())
    , Alive(mesh.Triangles.size(), 1)
    , Placed(mesh.Points.size(), 0)
    , Fixed(fixed)
  {
    for (const Vec3& p : mesh.Points) // near zero quadrics lose no digits
    {
      this->Middle = this->Middle + 1.0 / static_cast<double>(mesh.Points.size()) * p;
    }
    for (std::size_t t = 0; t < mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = mesh.Triangles[t];
      const Vec3 normal = this->GetNormal(ids);
      const double area = Norm(normal) / 2;
      const Vec3 unit = Normalized(normal);
      for (const std::int32_t id : ids)
      {
        this->Around[id].push_back(static_cast<std::int32_t>(t));
        this->Quadrics[id].Add(unit, -Dot(unit, mesh.Points[ids[0]] - this->Middle), area);
      }
    }
    for (std::size_t p = 0; p < mesh.Points.size(); ++p)
    {
      if (!this->Around[p].empty())
      {
        this->Samples[this->Around[p].front()].push_back(mesh.Points[p]);
      }
    }
    this->PlaceSamples(tolerance);
  }

  // A step that was refused may be possible when its surroundings have changed.
  void Run(Execution& execution)
  {
    const auto whole = static_cast<double>(this->Mesh.Points.size());
    std::int64_t before = 0;
    do
    {
      before = this->Done;
      for (std::size_t p = 0; p < this->Mesh.Points.size(); ++p)
      {
        this->Think(static_cast<std::int32_t>(p));
      }
      for (std::int64_t tried = 0; !this->Queue.empty(); ++tried)
      {
        if (tried % 4096 == 0)
        {
          execution.Report(static_cast<double>(this->Done) / whole);
        }
        const Step step = this->Queue.top();
        this->Queue.pop();
        if (!this->Around[step.From].empty() && !this->Around[step.To].empty() &&
          step.Stamp == this->Stamps[step.From] + this->Stamps[step.To] && this->Take(step))
        {
          ++this->Done;
        }
      }
    } while (
      static_cast<double>(this->Done - before) > 0.01 * (whole - static_cast<double>(this->Done)));
  }

  // Moves points that are not where points of the mesh were, all as far and along their normals, so that the
  // volume is that of the mesh.
  void CorrectVolume(double volume)
  {
    std::vector<Vec3> ways(this->Mesh.Points.size(), Vec3{ 0, 0, 0 });
    double now = 0;
    for (std::size_t t = 0; t < this->Mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
      if (this->Alive[t])
      {
        const Vec3 normal = this->GetNormal(ids);
        now += Dot(normal, this->Mesh.Points[ids[0]] - this->Middle) / 6;
        for (const std::int32_t id : ids)
        {
          ways[id] = ways[id] + 1.0 / 6 * normal;
        }
      }
    }
    double sum = 0;
    for (std::size_t p = 0; p < ways.size(); ++p)
    {
      sum += this->Placed[p] ? Norm(ways[p]) : 0;
    }
    const double way = sum > 0 ? (volume - now) / sum : 0;
    if (std::abs(way) <= LargestCorrection * this->Tolerance)
    {
      for (std::size_t p = 0; p < ways.size(); ++p)
      {
        this->Mesh.Points[p] =
          this->Mesh.Points[p] + (this->Placed[p] ? way : 0) * Normalized(ways[p]);
      }
    }
  }

  ClosedMesh Get() const
  {
    ClosedMesh result;
    std::vector<std::int32_t> numbers(this->Mesh.Points.size(), -1);
    for (std::size_t t = 0; t < this->Mesh.Triangles.size(); ++t)
    {
      if (!this->Alive[t])
      {
        continue;
      }
      ClosedMesh::Triangle ids = this->Mesh.Triangles[t];
      for (std::int32_t& id : ids)
      {
        if (numbers[id] < 0)
        {
          numbers[id] = static_cast<std::int32_t>(result.Points.size());
          result.Points.push_back(this->Mesh.Points[id]);
        }
        id = numbers[id];
      }
      result.Triangles.push_back(ids);
    }
    return result;
  }

private:
  Vec3 GetNormal(const ClosedMesh::Triangle& ids) const
  {
    const std::vector<Vec3>& p = this->Mesh.Points;
    return Cross(p[ids[1]] - p[ids[0]], p[ids[2]] - p[ids[0]]);
  }

  // Samples of what is between the points: on edges that are long or turn, and in large triangles.
  void PlaceSamples(double tolerance)
  {
    const double spacing = std::max(0.5, 10 * tolerance);
    for (std::size_t t = 0; t < this->Mesh.Triangles.size(); ++t)
    {
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
      const Vec3& a = this->Mesh.Points[ids[0]];
      const Vec3 ab = this->Mesh.Points[ids[1]] - a;
      const Vec3 ac = this->Mesh.Points[ids[2]] - a;
      const double longest = std::max(
        { Norm(ab), Norm(ac), Norm(this->Mesh.Points[ids[2]] - this->Mesh.Points[ids[1]]) });
      const int parts = static_cast<int>(
        std::clamp(std::ceil(longest / spacing), 2.0, static_cast<double>(MostSamples)));
      for (int i = 0; i <= parts; ++i)
      {
        for (int j = 0; i + j <= parts; ++j)
        {
          const bool corner = (i == 0 && j == 0) || i == parts || j == parts;
          // of an edge that two triangles have, the one with the lower corner first has the samples
          const bool others = (j == 0 && ids[0] > ids[1]) || (i + j == parts && ids[1] > ids[2]) ||
            (i == 0 && ids[2] > ids[0]);
          if (!corner && !others)
          {
            this->Samples[t].push_back(
              a + static_cast<double>(i) / parts * ab + static_cast<double>(j) / parts * ac);
          }
        }
      }
    }
  }

  void FindNeighbors(std::int32_t p, std::vector<std::int32_t>& neighbors) const
  {
    neighbors.clear();
    for (const std::int32_t t : this->Around[p])
    {
      for (const std::int32_t id : this->Mesh.Triangles[t])
      {
        if (id != p)
        {
          neighbors.push_back(id);
        }
      }
    }
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  }

  bool IsFixed(std::int32_t p) const { return !this->Fixed.empty() && this->Fixed[p]; }

  // Puts the edges of p into the queue.
  void Think(std::int32_t p)
  {
    if (this->IsFixed(p))
    {
      return;
    }
    this->FindNeighbors(p, this->One);
    for (const std::int32_t other : this->One)
    {
      if (this->IsFixed(other))
      {
        continue;
      }
      const Plan plan = this->MakePlan(p, other);
      const Vec3 way = this->Mesh.Points[other] - this->Mesh.Points[p];
      // the length decides between steps in a plane
      this->Queue.push({ plan.Cost + 1e-9 * Dot(way, way), plan.FromSecond ? other : p,
        plan.FromSecond ? p : other, this->Stamps[p] + this->Stamps[other] });
    }
  }

  // Where the point of an edge would best be.
  struct Plan
  {
    double Cost;
    bool FromSecond; // the first end is the better one
    bool AtEnd;      // and is as good as any place
    Vec3 Place;
  };
  Plan MakePlan(std::int32_t first, std::int32_t second) const
  {
    Quadric both = this->Quadrics[first];
    both.Add(this->Quadrics[second]);
    const Vec3 a = this->Mesh.Points[first] - this->Middle;
    const Vec3 b = this->Mesh.Points[second] - this->Middle;
    const double one = both.Get(a);
    const double two = both.Get(b);
    // the volume stays (Lindstrom and Turk 1998)
    Vec3 normal{ 0, 0, 0 };
    double offset = 0;
    for (const std::int32_t end : { first, second })
    {
      for (const std::int32_t t : this->Around[end])
      {
        if (end == first || !this->Has(t, first))
        {
          const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
          const Vec3 own = this->GetNormal(ids);
          normal = normal + own;
          offset += Dot(own, this->Mesh.Points[ids[0]] - this->Middle);
        }
      }
    }
    const Vec3 place = both.GetLowest(0.5 * (a + b), normal, offset);
    const double least = both.Get(place);
    const double end = std::min(one, two);
    const bool far = Norm(place - 0.5 * (a + b)) > Norm(b - a);
    const bool atEnd = far || end <= least + SameDistance * SameDistance * both.GetArea();
    return { atEnd ? end : least, one < two, atEnd, place + this->Middle };
  }

  bool Take(const Step& step)
  {
    if (!this->KeepsTopology(step.From, step.To))
    {
      return false;
    }
    const Plan plan = this->MakePlan(step.From, step.To);
    if (plan.AtEnd)
    {
      return this->Collapse(step.From, step.To, nullptr);
    }
    // Where the volume stays may be too far outside; nearer to the edge it is as far outside as triangles are
    // inside.
    const Vec3 middle = 0.5 * (this->Mesh.Points[step.From] + this->Mesh.Points[step.To]);
    for (const double part : { 1.0, 0.7, 0.5 })
    {
      const Vec3 place = middle + part * (plan.Place - middle);
      if (this->Tree.GetDistance(place) <= this->Tolerance &&
        this->Collapse(step.From, step.To, &place))
      {
        return true;
      }
    }
    return false;
  }

  bool KeepsTopology(std::int32_t from, std::int32_t to)
  {
    this->FindNeighbors(from, this->One);
    this->FindNeighbors(to, this->Two);
    this->Common.clear();
    std::set_intersection(this->One.begin(), this->One.end(), this->Two.begin(), this->Two.end(),
      std::back_inserter(this->Common));
    return this->Common.size() == 2 && (this->One.size() > 3 || this->Two.size() > 3);
  }

  // Takes from away. place: where to goes; null: it stays. False when a triangle would be bad, or a sample
  // too far from all.
  bool Collapse(std::int32_t from, std::int32_t to, const Vec3* place)
  {
    const std::size_t own = this->CollectChanges(from, to, place != nullptr);
    const Vec3 before = this->Mesh.Points[to];
    this->Mesh.Points[to] = place ? *place : before;
    if (!this->IsAllowed())
    {
      this->Mesh.Points[to] = before;
      return false;
    }
    this->RemoveTriangles(from, to);
    this->ChangeTriangles(to, own);
    this->Placed[to] = place ? 1 : this->Placed[to];
    this->Quadrics[to].Add(this->Quadrics[from]);
    ++this->Stamps[to];
    this->Think(to);
    return true;
  }

  // Kept gets the triangles that change and stay, first those of from, Moved their new corners, Loose all samples of
  // changed triangles. Returns how many are of from. isMoved: to does not stay where it is.
  std::size_t CollectChanges(std::int32_t from, std::int32_t to, bool isMoved)
  {
    this->Kept.clear();
    this->Moved.clear();
    this->Loose.clear();
    this->Normals.clear();
    const auto collect = [&](std::int32_t t)
    {
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[t];
      this->Loose.insert(this->Loose.end(), this->Samples[t].begin(), this->Samples[t].end());
      this->Kept.push_back(t);
      this->Normals.push_back(this->GetNormal(ids));
      this->Moved.push_back(ids);
      std::replace(this->Moved.back().begin(), this->Moved.back().end(), from, to);
    };
    for (const std::int32_t t : this->Around[from])
    {
      if (this->Has(t, to))
      {
        this->Loose.insert(this->Loose.end(), this->Samples[t].begin(), this->Samples[t].end());
      }
      else
      {
        collect(t);
      }
    }
    const std::size_t own = this->Kept.size();
    if (isMoved)
    {
      for (const std::int32_t t : this->Around[to])
      {
        if (!this->Has(t, from))
        {
          collect(t);
        }
      }
    }
    return own;
  }

  // Whether the triangles of Moved are good and near the mesh as it was.
  bool IsAllowed()
  {
    for (std::size_t k = 0; k < this->Kept.size(); ++k)
    {
      if (!this->IsGood(this->Moved[k], this->Normals[k]))
      {
        return false;
      }
    }
    return this->AssignSamples() && this->AreNear();
  }

  // Takes the triangles at the edge away, and all of from's samples.
  void RemoveTriangles(std::int32_t from, std::int32_t to)
  {
    for (const std::int32_t t : this->Around[from])
    {
      this->Samples[t].clear();
      if (this->Has(t, to))
      {
        this->Alive[t] = 0;
        for (const std::int32_t id : this->Mesh.Triangles[t])
        {
          if (id != from)
          {
            std::vector<std::int32_t>& around = this->Around[id];
            around.erase(std::find(around.begin(), around.end(), t));
          }
        }
      }
    }
    this->Around[from].clear();
  }

  // Makes Moved of Kept. The first ones, own, become triangles of to; it has the others already.
  void ChangeTriangles(std::int32_t to, std::size_t own)
  {
    for (std::size_t k = 0; k < this->Kept.size(); ++k)
    {
      this->Samples[this->Kept[k]].clear();
      this->Mesh.Triangles[this->Kept[k]] = this->Moved[k];
      if (k < own)
      {
        this->Around[to].push_back(this->Kept[k]);
      }
    }
    for (std::size_t k = 0; k < this->Loose.size(); ++k)
    {
      this->Samples[this->Kept[this->Owners[k]]].push_back(this->Loose[k]);
    }
  }

  bool Has(std::int32_t triangle, std::int32_t point) const
  {
    const ClosedMesh::Triangle& ids = this->Mesh.Triangles[triangle];
    return ids[0] == point || ids[1] == point || ids[2] == point;
  }

  // Whether a triangle that turned from a normal is neither turned over nor thinner than it may be.
  bool IsGood(const ClosedMesh::Triangle& ids, const Vec3& before) const
  {
    const std::vector<Vec3>& p = this->Mesh.Points;
    const Vec3 after = this->GetNormal(ids);
    const double longest = std::max(
      { Norm(p[ids[1]] - p[ids[0]]), Norm(p[ids[2]] - p[ids[1]]), Norm(p[ids[0]] - p[ids[2]]) });
    return Norm(after) >= LeastHeight * longest &&
      Dot(before, after) >= LargestTurn * Norm(before) * Norm(after);
  }

  // Gives each of Loose to the nearest of Moved. False when one is too far from all.
  bool AssignSamples()
  {
    this->Owners.clear();
    for (const Vec3& x : this->Loose)
    {
      double least = std::numeric_limits<double>::infinity();
      std::int32_t owner = 0;
      for (std::size_t k = 0; k < this->Moved.size(); ++k)
      {
        const ClosedMesh::Triangle& ids = this->Moved[k];
        const double squared = GetSquaredDistance(
          x, this->Mesh.Points[ids[0]], this->Mesh.Points[ids[1]], this->Mesh.Points[ids[2]]);
        if (squared < least)
        {
          least = squared;
          owner = static_cast<std::int32_t>(k);
        }
      }
      if (!(least <= this->SquaredTolerance))
      {
        return false;
      }
      this->Owners.push_back(owner);
    }
    return true;
  }

  // Whether the triangles of Moved are near the mesh as it was between their corners, too, as across a crease.
  bool AreNear() const
  {
    for (const ClosedMesh::Triangle& ids : this->Moved)
    {
      const Vec3& a = this->Mesh.Points[ids[0]];
      const Vec3& b = this->Mesh.Points[ids[1]];
      const Vec3& c = this->Mesh.Points[ids[2]];
      for (const Vec3& x : { 1.0 / 3 * (a + b + c), 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a) })
      {
        if (this->Tree.GetDistance(x) > this->Tolerance)
        {
          return false;
        }
      }
    }
    return true;
  }

  ClosedMesh Mesh;
  TriangleTree Tree; // of the mesh as it was
  double Tolerance;
  double SquaredTolerance;
  Vec3 Middle{ 0, 0, 0 };
  std::vector<std::vector<std::int32_t>> Around; // triangles of each point; none: it is gone
  std::vector<Quadric> Quadrics;
  std::vector<std::int32_t> Stamps;
  std::vector<std::vector<Vec3>>
    Samples; // of the mesh as it was, of each triangle those nearest to it
  std::vector<char> Alive;
  std::vector<char> Placed; // points that are not where one of the mesh was
  const std::vector<char>& Fixed;
  std::priority_queue<Step> Queue;
  std::int64_t Done = 0;
  // of the step that is tried, kept for the next
  std::vector<std::int32_t> One;
  std::vector<std::int32_t> Two;
  std::vector<std::int32_t> Common;
  std::vector<std::int32_t> Kept;
  std::vector<ClosedMesh::Triangle> Moved;
  std::vector<Vec3> Normals;
  std::vector<Vec3> Loose;
  std::vector<std::int32_t> Owners;
};
}

//------------------------------------------------------------------------------
ClosedMesh SimplifyMesh(
  const ClosedMesh& mesh, double tolerance, Execution& execution, const std::vector<char>& fixed)
{
  Simplifier simplifier(mesh, tolerance, fixed);
  simplifier.Run(execution);
  simplifier.CorrectVolume(mesh.GetVolume());
  return simplifier.Get();
}

//------------------------------------------------------------------------------
std::vector<Vec3> SampleMesh(const ClosedMesh& mesh, double spacing)
{
  std::vector<Vec3> samples = mesh.Points;
  for (const ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    const Vec3& a = mesh.Points[ids[0]];
    const Vec3 ab = mesh.Points[ids[1]] - a;
    const Vec3 ac = mesh.Points[ids[2]] - a;
    const double longest =
      std::max({ Norm(ab), Norm(ac), Norm(mesh.Points[ids[2]] - mesh.Points[ids[1]]) });
    const int parts = static_cast<int>(
      std::clamp(std::ceil(longest / spacing), 2.0, static_cast<double>(MostSamples)));
    for (int i = 0; i <= parts; ++i)
    {
      for (int j = i == 0 ? 1 : 0; i + j <= parts && (i > 0 || j < parts) && i < parts; ++j)
      {
        samples.push_back(
          a + static_cast<double>(i) / parts * ab + static_cast<double>(j) / parts * ac);
      }
    }
  }
  return samples;
}
}
