// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullBridge.h"

#include "lacunaSkullEllipsoid.h"
#include "lacunaSkullRays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>

namespace lacuna
{
namespace
{
constexpr double TypicalRadius = 90; // mm, of the rays' spacing
constexpr int SoundSteps = 4;        // beyond the rounded edge, in which bone has to be sound
constexpr double LeastSound =
  0.75; // of the rays there: it is 0.8 and more in the vault, 0.65 and less in the base

enum Role : std::uint8_t
{
  Beside,
  Known,   // bone near a hole
  Rounded, // bone whose tables are not those of the rim
  Hole
};

// A hole and the bone around it.
struct Surroundings
{
  std::vector<int> Border; // bone beside the hole
  std::vector<int> Edge;   // bone that voxels round off, the border included
  std::vector<int> Bone;   // beyond it
  bool IsAtEnd = false;    // of the scan
};

Surroundings LookAround(const SkullRays& rays, const std::vector<std::vector<int>>& around,
  const std::vector<int>& hole, int edge, std::vector<int>& seen, int stamp)
{
  Surroundings found;
  for (const int i : hole)
  {
    seen[i] = stamp;
  }
  std::vector<int> last = hole;
  for (int step = 1; step <= edge + SoundSteps; ++step)
  {
    std::vector<int> next;
    for (const int i : last)
    {
      for (const int j : around[i])
      {
        if (seen[j] == stamp)
        {
          continue;
        }
        seen[j] = stamp;
        found.IsAtEnd |= step == 1 && rays.Kinds[j] == SkullRayKind::Unknown;
        if (!std::isnan(rays.Outer[j])) // other holes end the way
        {
          next.push_back(j);
        }
      }
    }
    if (step == 1)
    {
      found.Border = next;
    }
    std::vector<int>& to = step <= edge ? found.Edge : found.Bone;
    to.insert(to.end(), next.begin(), next.end());
    last.swap(next);
  }
  return found;
}

// Whether a circle of the diameter fits into a hole.
bool IsWide(const SkullRays& rays, const std::vector<double>& sizes, const std::vector<int>& hole,
  const std::vector<int>& border, double diameter)
{
  return std::any_of(hole.begin(), hole.end(),
    [&](int i)
    {
      // half a spacing to the border's rays is bone
      const double cosine = std::cos(0.5 * diameter / sizes[i] + 0.5 * rays.Spacing);
      return std::none_of(border.begin(), border.end(),
        [&](int j) { return Dot(rays.Directions[i], rays.Directions[j]) > cosine; });
    });
}

// Gives each ray that is not known the mean of its neighbours, until nothing changes.
void Stretch(std::vector<double>& values, const std::vector<int>& open,
  const std::vector<std::vector<int>>& around, const std::vector<std::uint8_t>& roles)
{
  constexpr int most = 3000;
  constexpr double small = 1e-8; // of the ellipsoid's radius
  double change = 1;
  for (int sweep = 0; sweep < most && change > small; ++sweep)
  {
    change = 0;
    for (const int i : open)
    {
      double sum = 0;
      int count = 0;
      for (const int j : around[i])
      {
        if (roles[j] != Beside)
        {
          sum += values[j];
          ++count;
        }
      }
      change = std::max(change, std::abs(sum / count - values[i]));
      values[i] = sum / count;
    }
  }
}

// The tables of bone along rays, in parts of the ellipsoid's radius.
struct Tables
{
  std::vector<double> Sizes; // of the ellipsoid, mm; NaN where it is open
  std::vector<std::uint8_t> Roles;
  std::vector<double> Outer;
  std::vector<double> Inner;

  bool AreClosed(const std::vector<int>& rays) const
  {
    return std::none_of(
      rays.begin(), rays.end(), [&](int i) { return std::isnan(this->Sizes[i]); });
  }
  void SetRole(const std::vector<int>& rays, Role role)
  {
    for (const int i : rays)
    {
      this->Roles[i] = std::max<std::uint8_t>(this->Roles[i], role);
    }
  }
};

// Of the ellipsoid that fits sound bone; no ray has a role yet.
Tables MakeTables(const SkullRays& rays)
{
  const std::size_t n = rays.Directions.size();
  std::vector<Vec3> sound;
  for (std::size_t i = 0; i < n; ++i)
  {
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      sound.push_back(rays.Center + rays.Outer[i] * rays.Directions[i]);
    }
  }
  const SkullEllipsoid ellipsoid(rays.Center, sound);
  Tables tables;
  tables.Sizes.reserve(n);
  for (const Vec3& direction : rays.Directions)
  {
    tables.Sizes.push_back(ellipsoid.GetRadius(direction));
  }
  tables.Roles.assign(n, Beside);
  tables.Outer.assign(n, 0);
  tables.Inner.assign(n, 0);
  return tables;
}

// Whether a hole is in the vault, and no circle of the diameter fits into it.
bool IsSmallInVault(const SkullRays& rays, const Tables& tables, const std::vector<int>& hole,
  const Surroundings& near, double diameter)
{
  const auto sound = std::count_if(near.Bone.begin(), near.Bone.end(),
    [&](int i) { return rays.Kinds[i] == SkullRayKind::Sound; });
  return !near.IsAtEnd && !near.Bone.empty() &&
    static_cast<double>(sound) >= LeastSound * static_cast<double>(near.Bone.size()) &&
    !IsWide(rays, tables.Sizes, hole, near.Border, diameter) && tables.AreClosed(hole) &&
    tables.AreClosed(near.Edge) && tables.AreClosed(near.Bone);
}

// Gives each small hole and the bone around it their roles, and the hole the mean of its border's tables.
void MarkHoles(const SkullRays& rays, const std::vector<std::vector<int>>& around, double diameter,
  Tables& tables)
{
  std::vector<int> seen(rays.Directions.size(), -1);
  int stamp = 0;
  const int edge = static_cast<int>(std::ceil(rays.RoundedEdge / (rays.Spacing * TypicalRadius)));
  for (const std::vector<int>& hole :
    FindParts(around, [&](int i) { return rays.Kinds[i] == SkullRayKind::Open; }))
  {
    const Surroundings near = LookAround(rays, around, hole, edge, seen, stamp++);
    if (!IsSmallInVault(rays, tables, hole, near, diameter))
    {
      continue;
    }
    tables.SetRole(hole, Hole);
    tables.SetRole(near.Edge, Rounded);
    tables.SetRole(near.Bone, Known);
    std::array<double, 2> mean{ 0, 0 };
    for (const int i : near.Border)
    {
      const double size = tables.Sizes[i] * static_cast<double>(near.Border.size());
      mean[0] += rays.Outer[i] / size;
      mean[1] += rays.Inner[i] / size;
    }
    for (const int i : hole)
    {
      tables.Outer[i] = mean[0];
      tables.Inner[i] = mean[1];
    }
  }
}

// Both tables as membranes across the holes and their rounded edges.
void StretchAcross(
  const SkullRays& rays, const std::vector<std::vector<int>>& around, Tables& tables)
{
  std::vector<int> open;
  for (std::size_t i = 0; i < tables.Roles.size(); ++i)
  {
    const std::uint8_t role = tables.Roles[i];
    if (role >= Rounded)
    {
      open.push_back(static_cast<int>(i));
    }
    if (role == Known || role == Rounded)
    {
      tables.Outer[i] = rays.Outer[i] / tables.Sizes[i];
      tables.Inner[i] = rays.Inner[i] / tables.Sizes[i];
    }
  }
  Stretch(tables.Outer, open, around, tables.Roles);
  Stretch(tables.Inner, open, around, tables.Roles);
}

// Voxels to which rays give their tables, the nearer the more.
class WeightedVoxels
{
public:
  WeightedVoxels(const VoxelVolume& volume, const SkullRays& rays);
  void Add(std::size_t ray, const Tables& tables);
  // Those to which holes gave more than bone did, in the order of their indices.
  std::vector<BridgedVoxel> FindBridged() const;

private:
  struct Weighted
  {
    double Sum = 0;
    double Missing = 0; // of it, of rays without known bone
    double Outer = 0;
    double Inner = 0;
  };

  const VoxelVolume& Volume;
  const SkullRays& Rays;
  Matrix4 ToIndex;
  Vec3 First; // the rays' middle, in voxels
  double Edges[3];
  double Beyond; // mm along a ray
  std::unordered_map<std::int64_t, Weighted> Voxels;
};

//------------------------------------------------------------------------------
WeightedVoxels::WeightedVoxels(const VoxelVolume& volume, const SkullRays& rays)
  : Volume(volume)
  , Rays(rays)
  , ToIndex(volume.IndexToWorld.Inverse())
  , First(this->ToIndex.Point(rays.Center))
{
  for (int a = 0; a < 3; ++a)
  {
    this->Edges[a] = Norm(volume.IndexToWorld.Column(a));
  }
  this->Beyond = 2 * std::hypot(this->Edges[0], this->Edges[1], this->Edges[2]);
}

//------------------------------------------------------------------------------
void WeightedVoxels::Add(std::size_t ray, const Tables& tables)
{
  const std::uint8_t role = tables.Roles[ray];
  const std::array<int, 3>& size = this->Volume.Size;
  const Vec3& direction = this->Rays.Directions[ray];
  const Vec3 along = this->ToIndex.Vector(direction); // voxels a mm
  double least = 0;                                   // mm
  for (int a = 0; a < 3; ++a)
  {
    least += std::abs(along[a]) * this->Edges[a] * this->Edges[a];
  }
  const double out = tables.Sizes[ray] * tables.Outer[ray];
  const double in =
    std::min(tables.Sizes[ray] * tables.Inner[ray], role == Hole ? out - least : out);
  const double width = out * this->Rays.Spacing;
  int low[3];
  int high[3];
  for (int a = 0; a < 3; ++a)
  {
    const auto [from, to] = std::minmax({ this->First[a] + (in - this->Beyond) * along[a],
      this->First[a] + (out + this->Beyond) * along[a] });
    low[a] = std::max(0, static_cast<int>(std::ceil(from - 2 * width / this->Edges[a])));
    high[a] = std::min(size[a] - 1, static_cast<int>(std::floor(to + 2 * width / this->Edges[a])));
  }
  for (int k = low[2]; k <= high[2]; ++k)
  {
    for (int j = low[1]; j <= high[1]; ++j)
    {
      for (int i = low[0]; i <= high[0]; ++i)
      {
        const Vec3 from =
          this->Volume.IndexToWorld.Point({ 1.0 * i, 1.0 * j, 1.0 * k }) - this->Rays.Center;
        const double r = Norm(from);
        const double aside = Norm(from - Dot(from, direction) * direction) / width;
        if (aside < 2 && r > in - this->Beyond && r < out + this->Beyond)
        {
          const double weight = std::exp(-2 * aside * aside);
          Weighted& voxel =
            this->Voxels[i + size[0] * (j + static_cast<std::int64_t>(size[1]) * k)];
          voxel.Sum += weight;
          voxel.Missing += role >= Rounded ? weight : 0;
          voxel.Outer += weight * out;
          voxel.Inner += weight * in;
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
std::vector<BridgedVoxel> WeightedVoxels::FindBridged() const
{
  const std::array<int, 3>& size = this->Volume.Size;
  std::vector<BridgedVoxel> bridged;
  for (const auto& [index, voxel] : this->Voxels)
  {
    if (voxel.Missing > 0.5 * voxel.Sum)
    {
      const std::int64_t row = index / size[0];
      const Vec3 at{ static_cast<double>(index % size[0]), static_cast<double>(row % size[1]),
        static_cast<double>(row / size[1]) };
      const double r = Norm(this->Volume.IndexToWorld.Point(at) - this->Rays.Center);
      bridged.push_back(
        { index, std::min(voxel.Outer / voxel.Sum - r, r - voxel.Inner / voxel.Sum) });
    }
  }
  std::sort(bridged.begin(), bridged.end(),
    [](const BridgedVoxel& a, const BridgedVoxel& b) { return a.Index < b.Index; });
  return bridged;
}
}

//------------------------------------------------------------------------------
std::vector<BridgedVoxel> BridgeHoles(
  const VoxelVolume& volume, double level, double diameter, Execution& execution)
{
  const MirrorPlane none{ { 0, 0, 0 }, 0 }; // all points are on it, and their own images
  const Vec3 center = FindSkullCenter(volume, level, none, execution);
  const double fine = std::clamp(0.75 * SmallestEdgeOf(volume.IndexToWorld), 0.6, 2.0);
  const SkullRays rays = TraceSkull(volume, level, center, fine, execution);
  const std::vector<std::vector<int>> around = FindNeighbors(rays.Directions, 1.6 * rays.Spacing);
  Tables tables = MakeTables(rays);
  MarkHoles(rays, around, diameter, tables);
  StretchAcross(rays, around, tables);
  WeightedVoxels voxels(volume, rays);
  for (std::size_t ray = 0; ray < tables.Roles.size(); ++ray)
  {
    if (tables.Roles[ray] != Beside)
    {
      voxels.Add(ray, tables);
    }
  }
  return voxels.FindBridged();
}
}
