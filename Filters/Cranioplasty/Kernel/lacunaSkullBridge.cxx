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

struct Weighted
{
  double Sum = 0;
  double Missing = 0; // of it, of rays without known bone
  double Outer = 0;
  double Inner = 0;
};
}

//------------------------------------------------------------------------------
std::vector<BridgedVoxel> BridgeHoles(
  const VoxelVolume& volume, double level, double diameter, Execution& execution)
{
  const MirrorPlane none{ { 0, 0, 0 }, 0 }; // all points are on it, and their own images
  const Vec3 center = FindSkullCenter(volume, level, none, execution);
  const double fine = std::clamp(0.75 * SmallestEdgeOf(volume.IndexToWorld), 0.6, 2.0);
  const SkullRays rays = TraceSkull(volume, level, center, fine, execution);
  const auto n = static_cast<int>(rays.Directions.size());
  const std::vector<std::vector<int>> around = FindNeighbors(rays.Directions, 1.6 * rays.Spacing);
  std::vector<Vec3> sound;
  for (int i = 0; i < n; ++i)
  {
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      sound.push_back(center + rays.Outer[i] * rays.Directions[i]);
    }
  }
  const SkullEllipsoid ellipsoid(center, sound);

  std::vector<double> sizes(n); // of the ellipsoid, mm; NaN where it is open
  for (int i = 0; i < n; ++i)
  {
    sizes[i] = ellipsoid.GetRadius(rays.Directions[i]);
  }
  const auto isClosed = [&](const std::vector<int>& which)
  { return std::none_of(which.begin(), which.end(), [&](int i) { return std::isnan(sizes[i]); }); };
  std::vector<std::uint8_t> roles(n, Beside);
  std::vector<double> outer(n);
  std::vector<double> inner(n);
  const auto setRole = [&](const std::vector<int>& which, Role role)
  {
    for (const int i : which)
    {
      roles[i] = std::max<std::uint8_t>(roles[i], role);
    }
  };
  std::vector<int> seen(n, -1);
  int stamp = 0;
  const int edge = static_cast<int>(std::ceil(rays.RoundedEdge / (rays.Spacing * TypicalRadius)));
  for (const std::vector<int>& hole :
    FindParts(around, [&](int i) { return rays.Kinds[i] == SkullRayKind::Open; }))
  {
    const Surroundings near = LookAround(rays, around, hole, edge, seen, stamp++);
    const auto count = std::count_if(near.Bone.begin(), near.Bone.end(),
      [&](int i) { return rays.Kinds[i] == SkullRayKind::Sound; });
    if (near.IsAtEnd || near.Bone.empty() ||
      static_cast<double>(count) < LeastSound * static_cast<double>(near.Bone.size()) ||
      IsWide(rays, sizes, hole, near.Border, diameter) || !isClosed(hole) || !isClosed(near.Edge) ||
      !isClosed(near.Bone))
    {
      continue;
    }
    setRole(hole, Hole);
    setRole(near.Edge, Rounded);
    setRole(near.Bone, Known);
    std::array<double, 2> mean{ 0, 0 };
    for (const int i : near.Border)
    {
      const double size = sizes[i] * static_cast<double>(near.Border.size());
      mean[0] += rays.Outer[i] / size;
      mean[1] += rays.Inner[i] / size;
    }
    for (const int i : hole)
    {
      outer[i] = mean[0];
      inner[i] = mean[1];
    }
  }
  std::vector<int> open;
  for (int i = 0; i < n; ++i)
  {
    if (roles[i] >= Rounded)
    {
      open.push_back(i);
    }
    if (roles[i] == Known || roles[i] == Rounded)
    {
      outer[i] = rays.Outer[i] / sizes[i];
      inner[i] = rays.Inner[i] / sizes[i];
    }
  }
  Stretch(outer, open, around, roles);
  Stretch(inner, open, around, roles);

  // Each ray gives its tables to the voxels beside it, the nearer the more.
  const Matrix4 toIndex = volume.IndexToWorld.Inverse();
  const Vec3 first = toIndex.Point(center);
  double edges[3];
  for (int a = 0; a < 3; ++a)
  {
    edges[a] = Norm(volume.IndexToWorld.Column(a));
  }
  const double beside = 2 * std::hypot(edges[0], edges[1], edges[2]);
  std::unordered_map<std::int64_t, Weighted> voxels;
  for (int i = 0; i < n; ++i)
  {
    if (roles[i] == Beside)
    {
      continue;
    }
    const Vec3& direction = rays.Directions[i];
    const Vec3 along = toIndex.Vector(direction); // voxels a mm
    double least = 0;                             // mm
    for (int a = 0; a < 3; ++a)
    {
      least += std::abs(along[a]) * edges[a] * edges[a];
    }
    const double out = sizes[i] * outer[i];
    const double in = std::min(sizes[i] * inner[i], roles[i] == Hole ? out - least : out);
    const double width = out * rays.Spacing;
    int low[3];
    int high[3];
    for (int a = 0; a < 3; ++a)
    {
      const auto [from, to] =
        std::minmax({ first[a] + (in - beside) * along[a], first[a] + (out + beside) * along[a] });
      low[a] = std::max(0, static_cast<int>(std::ceil(from - 2 * width / edges[a])));
      high[a] =
        std::min(volume.Size[a] - 1, static_cast<int>(std::floor(to + 2 * width / edges[a])));
    }
    for (int k = low[2]; k <= high[2]; ++k)
    {
      for (int j = low[1]; j <= high[1]; ++j)
      {
        for (int x = low[0]; x <= high[0]; ++x)
        {
          const Vec3 from = volume.IndexToWorld.Point({ 1.0 * x, 1.0 * j, 1.0 * k }) - center;
          const double r = Norm(from);
          const double aside = Norm(from - Dot(from, direction) * direction) / width;
          if (aside < 2 && r > in - beside && r < out + beside)
          {
            const double weight = std::exp(-2 * aside * aside);
            Weighted& voxel =
              voxels[x + volume.Size[0] * (j + static_cast<std::int64_t>(volume.Size[1]) * k)];
            voxel.Sum += weight;
            voxel.Missing += roles[i] >= Rounded ? weight : 0;
            voxel.Outer += weight * out;
            voxel.Inner += weight * in;
          }
        }
      }
    }
  }
  std::vector<BridgedVoxel> bridged;
  for (const auto& [index, voxel] : voxels)
  {
    if (voxel.Missing > 0.5 * voxel.Sum)
    {
      const std::int64_t row = index / volume.Size[0];
      const Vec3 at{ static_cast<double>(index % volume.Size[0]),
        static_cast<double>(row % volume.Size[1]), static_cast<double>(row / volume.Size[1]) };
      const double r = Norm(volume.IndexToWorld.Point(at) - center);
      bridged.push_back(
        { index, std::min(voxel.Outer / voxel.Sum - r, r - voxel.Inner / voxel.Sum) });
    }
  }
  std::sort(bridged.begin(), bridged.end(),
    [](const BridgedVoxel& a, const BridgedVoxel& b) { return a.Index < b.Index; });
  return bridged;
}
}
