// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullResection.h"

#include "lacunaImplantMesh.h"
#include "lacunaParameterText.h"
#include "lacunaSkullChart.h"
#include "lacunaVoxelSampler.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double NodeSpacing = 0.5;  // mm, of the outer table
constexpr double OutlineSpacing = 1; // mm
constexpr double Depth = 25; // mm below the outer table, along the direction: all of the bone
constexpr double Above = 40; // mm above the outline, from where the outer table is looked for
constexpr double Below = 60; // mm below it
constexpr double SearchStep = 0.25;   // mm
constexpr double Beside = 3;          // mm of the table beside the guide
constexpr double BridgedReach = 4;    // mm over which the guide goes on where the table has gaps
constexpr double ContactReach = 0.8;  // mm: the guide lies on the highest places around
constexpr double SmoothReach = 2;     // mm: of its top
constexpr double GuideTriangle = 0.8; // mm
constexpr std::size_t GuideHoles = 4;
constexpr double LeastTop = 2; // mm: width of the guide's upper face
constexpr double MostUnsupported = 0.2;
constexpr double MostMissing = 0.05; // of the outline: of which is told
constexpr double FarAway = -1e3;     // mm
constexpr double Farthest = 500;     // mm from the middle of all bone
constexpr ValueRange GuideWidths = ValueRange::Between(3, 40, "mm");

// Unit, square to the plane that is nearest to points around their mean, away from a place.
Vec3 FindOut(const std::vector<Vec3>& curve, const Vec3& from)
{
  // the area that a closed curve encloses, as a vector
  Vec3 mean{ 0, 0, 0 };
  for (const Vec3& x : curve)
  {
    mean = mean + (1.0 / static_cast<double>(curve.size())) * x;
  }
  Vec3 area{ 0, 0, 0 };
  for (std::size_t k = 0; k < curve.size(); ++k)
  {
    area = area + Cross(curve[k] - mean, curve[(k + 1) % curve.size()] - mean);
  }
  if (!(Norm(area) > 1))
  {
    throw std::invalid_argument("the outline encloses no area: draw a closed curve on the skull");
  }
  const Vec3 out = Normalized(area);
  return Dot(out, mean - from) < 0 ? -1 * out : out;
}

// A place of the guide's inner edge: the way out of the cut, and how far (mm) neighbours can go along theirs.
struct InnerPlace
{
  Vec2 Foot{};
  Vec2 Out{};
  double Most = std::numeric_limits<double>::infinity();
};

// Clockwise. loop: counterclockwise.
std::vector<InnerPlace> FindInnerPlaces(const Loop& loop)
{
  const std::size_t n = loop.size();
  const std::size_t reach = std::clamp<std::size_t>(n / 12, 1, 4);
  std::vector<InnerPlace> places(n);
  for (std::size_t k = 0; k < n; ++k)
  {
    const Vec2& before = loop[(k + n - reach) % n];
    const Vec2& after = loop[(k + reach) % n];
    const double length = std::max(std::hypot(after[0] - before[0], after[1] - before[1]), 1e-9);
    places[n - 1 - k].Foot = loop[k];
    places[n - 1 - k].Out = { (after[1] - before[1]) / length, -(after[0] - before[0]) / length };
  }
  for (std::size_t k = 0; k < n; ++k)
  {
    InnerPlace& a = places[k];
    InnerPlace& b = places[(k + 1) % n];
    const Vec2 way{ b.Foot[0] - a.Foot[0], b.Foot[1] - a.Foot[1] };
    const double closing = (b.Out[0] - a.Out[0]) * way[0] + (b.Out[1] - a.Out[1]) * way[1];
    if (closing < 0)
    {
      const double most = 0.7 * (way[0] * way[0] + way[1] * way[1]) / -closing;
      a.Most = std::min(a.Most, most);
      b.Most = std::min(b.Most, most);
    }
  }
  return places;
}

// So far apart, in space.
std::vector<Vec3> ResampleCurve(const std::vector<Vec3>& curve, double spacing)
{
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < curve.size(); ++k)
  {
    const Vec3& a = curve[k];
    const Vec3& b = curve[(k + 1) % curve.size()];
    const int steps = std::max(1, static_cast<int>(std::ceil(Norm(b - a) / spacing)));
    for (int s = 0; s < steps && Norm(b - a) > 0; ++s)
    {
      points.push_back(a + (static_cast<double>(s) / steps) * (b - a));
    }
  }
  return points;
}
}

//------------------------------------------------------------------------------
void ResectionOptions::Describe(Properties& properties) const
{
  properties.Add("Bevel", this->Bevel, ValueRange::Between(0, 45, "degrees"))
    .Add("GuideWidth", this->GuideWidth, GuideWidths.OrZero("no guide"))
    .Add("GuideHeight", this->GuideHeight, ValueRange::Between(2, 20, "mm"))
    .Add("GuideClearance", this->GuideClearance, ValueRange::Between(0, 1, "mm"))
    .Add("GuideHole", this->GuideHole, ValueRange::Between(0.5, 5, "mm").OrZero("no holes"));
}

//------------------------------------------------------------------------------
void CheckResectionOptions(const ResectionOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  GuideWidths.Check("GuideWidth", options.GuideWidth);
  // its inner wall leans outwards
  const double least = std::tan(options.Bevel * Pi / 180) * options.GuideHeight +
    std::max(LeastTop, options.GuideHole == 0 ? 0 : options.GuideHole + 2 * LeastHoleToRim);
  if (options.GuideWidth < least)
  {
    throw std::invalid_argument("GuideWidth is " + FormatNumber(options.GuideWidth) +
      " mm; with this Bevel, GuideHeight and GuideHole it must be at least " +
      FormatNumber(std::ceil(10 * least) / 10));
  }
}

//------------------------------------------------------------------------------
std::vector<Vec3> FindOutlineAround(
  const std::vector<Vec3>& points, double margin, const Vec3& middleOfBone)
{
  if (points.empty())
  {
    throw std::invalid_argument("the tumour has no points");
  }
  ResectionMargins.Check("Margin", margin);
  Vec3 mean{ 0, 0, 0 };
  for (const Vec3& x : points)
  {
    mean = mean + (1.0 / static_cast<double>(points.size())) * x;
  }
  if (!(Norm(mean - middleOfBone) > 10))
  {
    throw std::invalid_argument("the tumour lies around the middle of the head: draw an outline on "
                                "the skull for the way to it");
  }
  const Vec3 out = Normalized(mean - middleOfBone);
  const Vec3 u = Normalized(Cross(out, std::abs(out[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
  const Vec3 v = Cross(out, u);
  std::vector<Vec2> flat;
  double top = -std::numeric_limits<double>::infinity();
  for (const Vec3& x : points)
  {
    flat.push_back({ Dot(x, u), Dot(x, v) });
    top = std::max(top, Dot(x, out));
  }
  const PlanarGrid grid = MakeGrid(flat, margin + 3, NodeSpacing);
  std::vector<double> within = FindDistances(grid, flat, margin + 1.5);
  for (double& distance : within)
  {
    distance = margin - distance;
  }
  const std::size_t parts = FindFreeParts(grid, within).size();
  if (parts > 1)
  {
    throw std::invalid_argument("the tumour is in " + std::to_string(parts) +
      " parts that are farther apart than twice the margin: leave all but one out, give a larger "
      "margin, or draw an outline around them");
  }
  const std::vector<Loop> loops = KeepLargest(FindContours(grid, within, 0));
  std::vector<Vec3> outline;
  for (const Vec2& p : Resample(loops.at(0), OutlineSpacing))
  {
    outline.push_back(p[0] * u + p[1] * v + top * out);
  }
  return outline;
}

//------------------------------------------------------------------------------
SkullResection::SkullResection(const VoxelVolume& volume, const std::vector<Vec3>& outline,
  const Vec3& middleOfBone, const ResectionOptions& options, Execution& execution)
  : Volume(volume)
  , Options(options)
  , Slope(std::tan(options.Bevel * Pi / 180))
{
  CheckResectionOptions(options);
  if (outline.size() < 3)
  {
    throw std::invalid_argument("the outline has fewer than three points");
  }
  if (!std::all_of(outline.begin(), outline.end(),
        [&](const Vec3& x) { return Norm(x - middleOfBone) < Farthest; }))
  {
    throw std::invalid_argument("the outline is not at the head: draw it on the skull, in mm");
  }
  this->Outline = ResampleCurve(outline, OutlineSpacing);
  const Vec3 out = FindOut(this->Outline, middleOfBone);
  this->Direction = -1 * out;
  this->U = Normalized(Cross(out, std::abs(out[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
  this->V = Cross(out, this->U);
  for (const Vec3& x : this->Outline)
  {
    this->Flat.push_back(this->ToPlane(x));
    this->Heights.push_back(this->HeightOf(x));
  }
  if (CrossesItself(this->Flat))
  {
    throw std::invalid_argument(
      "the outline crosses itself as seen from outside: draw it once around");
  }
  if (SignedArea(this->Flat) < 0)
  {
    std::reverse(this->Flat.begin(), this->Flat.end());
    std::reverse(this->Outline.begin(), this->Outline.end());
    std::reverse(this->Heights.begin(), this->Heights.end());
  }
  this->Top = *std::max_element(this->Heights.begin(), this->Heights.end()) + Above;
  this->FindTable(execution);
  // onto the outer table
  std::size_t found = 0;
  for (std::size_t k = 0; k < this->Flat.size(); ++k)
  {
    const double height = this->GetTable(this->Flat[k]);
    if (!std::isnan(height))
    {
      this->Heights[k] = height;
      this->Outline[k] = this->ToWorld(this->Flat[k], height);
      ++found;
    }
  }
  if (2 * found < this->Flat.size())
  {
    throw std::runtime_error("below the outline is no bone: draw it on the skull, and look at the "
                             "bone at this Level");
  }
  const double missing = 1 - static_cast<double>(found) / static_cast<double>(this->Flat.size());
  if (missing > MostMissing)
  {
    this->Warnings.push_back("below " + FormatNumber(std::round(100 * missing)) +
      " % of the outline is no bone: the cut ends there at a hole, or at the end of the scan");
  }
}

//------------------------------------------------------------------------------
void SkullResection::FindTable(Execution& execution)
{
  const double margin = this->Options.GuideWidth + this->Slope * Above + Beside;
  this->Grid = MakeGrid(this->Flat, margin, NodeSpacing);
  this->Table.assign(static_cast<std::size_t>(this->Grid.Columns * this->Grid.Rows), NotANumber);
  const double low = *std::min_element(this->Heights.begin(), this->Heights.end()) - Below;
  DispatchScalars(this->Volume.Type, this->Volume.Voxels,
    [&](const auto* voxels)
    {
      const VoxelSampler sample(this->Volume, voxels);
      const auto isBone = [&](const Vec2& p, double height)
      { return sample(this->ToWorld(p, height)) >= this->Options.Level; };
      execution.For(this->Grid.Rows, 2,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t j = begin; j < end; ++j)
          {
            for (std::int64_t i = 0; i < this->Grid.Columns; ++i)
            {
              const Vec2 p = this->Grid.GetNode(i, j);
              double height = this->Top;
              while (height > low && !isBone(p, height))
              {
                height -= SearchStep;
              }
              if (height <= low || height == this->Top)
              {
                continue;
              }
              double below = height;
              double above = height + SearchStep;
              for (int step = 0; step < 30; ++step)
              {
                const double middle = 0.5 * (below + above);
                (isBone(p, middle) ? below : above) = middle;
              }
              this->Table[i + this->Grid.Columns * j] = below;
            }
          }
        });
    });
}

//------------------------------------------------------------------------------
double SkullResection::GetTable(const Vec2& p) const
{
  const double x = (p[0] - this->Grid.Origin[0]) / NodeSpacing;
  const double y = (p[1] - this->Grid.Origin[1]) / NodeSpacing;
  const auto i = static_cast<std::int64_t>(std::floor(x));
  const auto j = static_cast<std::int64_t>(std::floor(y));
  if (i < 0 || j < 0 || i + 1 >= this->Grid.Columns || j + 1 >= this->Grid.Rows)
  {
    return NotANumber;
  }
  const double u = x - static_cast<double>(i);
  const double v = y - static_cast<double>(j);
  double sum = 0;
  double weight = 0;
  for (const int m : { 0, 1 })
  {
    for (const int n : { 0, 1 })
    {
      const double height = this->Table[i + m + this->Grid.Columns * (j + n)];
      const double part = std::isnan(height) ? 0 : (m ? u : 1 - u) * (n ? v : 1 - v);
      sum += std::isnan(height) ? 0 : part * height;
      weight += part;
    }
  }
  return weight > 0 ? sum / weight : NotANumber;
}

//------------------------------------------------------------------------------
SkullResection::Wall SkullResection::FindWall(const Vec2& p) const
{
  double least = std::numeric_limits<double>::infinity();
  Wall wall{ 0, 0 };
  for (std::size_t k = 0; k < this->Flat.size(); ++k)
  {
    const std::size_t next = (k + 1) % this->Flat.size();
    const Vec2& a = this->Flat[k];
    const Vec2 way{ this->Flat[next][0] - a[0], this->Flat[next][1] - a[1] };
    const double square = way[0] * way[0] + way[1] * way[1];
    const double t = square > 0
      ? std::clamp(((p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1]) / square, 0.0, 1.0)
      : 0;
    const double distance = std::hypot(p[0] - a[0] - t * way[0], p[1] - a[1] - t * way[1]);
    if (distance < least)
    {
      least = distance;
      wall.Height = (1 - t) * this->Heights[k] + t * this->Heights[next];
    }
  }
  wall.Distance = IsInside(std::vector<Loop>{ this->Flat }, p) ? least : -least;
  return wall;
}

//------------------------------------------------------------------------------
double SkullResection::GetInside(const Vec3& x) const
{
  const Vec2 p = this->ToPlane(x);
  const double height = this->HeightOf(x);
  const double table = this->GetTable(p);
  if (std::isnan(table) || height < table - Depth)
  {
    return FarAway;
  }
  const Wall wall = this->FindWall(p);
  return (wall.Distance + this->Slope * (height - wall.Height)) /
    std::sqrt(1 + this->Slope * this->Slope);
}

//------------------------------------------------------------------------------
template <class Sampler>
double SkullResection::FindContrast(const Sampler& sample) const
{
  std::vector<double> above;
  for (std::size_t k = 0; k < this->Flat.size(); ++k)
  {
    for (double depth = 0; depth < Depth; depth += NodeSpacing)
    {
      const double value = sample(this->ToWorld(this->Flat[k], this->Heights[k] - depth));
      if (std::isfinite(value) && value > this->Options.Level)
      {
        above.push_back(value - this->Options.Level);
      }
    }
  }
  if (above.empty())
  {
    return this->Options.Level;
  }
  const auto quarter = above.begin() + static_cast<std::ptrdiff_t>(above.size() / 4);
  std::nth_element(above.begin(), quarter, above.end());
  return *quarter;
}

//------------------------------------------------------------------------------
void SkullResection::Cut(void* kept, void* piece, Execution& execution) const
{
  const VoxelVolume& volume = this->Volume;
  const std::array<int, 3> size = volume.Size;
  double ramp = 0; // mm: between levels of bone and of none
  for (int a = 0; a < 3; ++a)
  {
    ramp = std::max(ramp, Norm(volume.IndexToWorld.Column(a)));
  }
  // as far from the wall a voxel can be bone and its neighbour not
  const double reach = 2 * ramp;
  const double low = *std::min_element(this->Heights.begin(), this->Heights.end());
  DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* values)
    {
      using T = std::remove_cv_t<std::remove_reference_t<decltype(*values)>>;
      auto* without = static_cast<T*>(kept);
      auto* alone = static_cast<T*>(piece);
      const double contrast =
        std::min(this->FindContrast(VoxelSampler(volume, values)), // unsigned voxels
          this->Options.Level - static_cast<double>(std::numeric_limits<T>::lowest()));
      const auto toValue = [&](double wanted)
      {
        const double least = static_cast<double>(std::numeric_limits<T>::lowest());
        const double bounded = std::max(wanted, least);
        return static_cast<T>(std::numeric_limits<T>::is_integer ? std::floor(bounded) : bounded);
      };
      execution.For(size[2], 1,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t k = begin; k < end; ++k)
          {
            for (int j = 0; j < size[1]; ++j)
            {
              for (int i = 0; i < size[0]; ++i)
              {
                const std::int64_t at = i + size[0] * (j + size[1] * k);
                const auto value = static_cast<double>(values[at]);
                const double below = this->Options.Level - contrast;
                without[at] = values[at];
                alone[at] = toValue(std::isnan(value) ? value : std::min(value, below));
                const Vec3 x = volume.IndexToWorld.Point(
                  { static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) });
                const double height = this->HeightOf(x);
                if (!(value > below) || height > this->Top || height < low - Below - Depth)
                {
                  continue;
                }
                const double inside = this->GetInside(x);
                if (inside < -reach)
                {
                  continue;
                }
                const double part = std::clamp(inside / ramp, -1.0, 1.0) * contrast;
                const bool isBorder = i == 0 || j == 0 || k == 0 || i == size[0] - 1 ||
                  j == size[1] - 1 || k == size[2] - 1;
                without[at] = toValue(std::min(value, this->Options.Level - part));
                alone[at] =
                  isBorder ? alone[at] : toValue(std::min(value, this->Options.Level + part));
              }
            }
          }
        });
    });
}

//------------------------------------------------------------------------------
double SkullResection::SmoothTable(
  std::int64_t i, std::int64_t j, double radius, bool isHighest) const
{
  const auto reach = static_cast<std::int64_t>(std::ceil(radius / NodeSpacing));
  double sum = 0;
  double weight = 0;
  double highest = NotANumber;
  for (std::int64_t n = std::max<std::int64_t>(j - reach, 0);
       n <= std::min(j + reach, this->Grid.Rows - 1); ++n)
  {
    for (std::int64_t m = std::max<std::int64_t>(i - reach, 0);
         m <= std::min(i + reach, this->Grid.Columns - 1); ++m)
    {
      const double height = this->Table[m + this->Grid.Columns * n];
      const double distance =
        NodeSpacing * std::hypot(static_cast<double>(m - i), static_cast<double>(n - j));
      if (distance <= radius && !std::isnan(height))
      {
        const double part = 1 - distance / (radius + NodeSpacing);
        sum += part * height;
        weight += part;
        highest = std::isnan(highest) ? height : std::max(highest, height);
      }
    }
  }
  return isHighest ? highest : sum / weight; // NaN without bone
}

//------------------------------------------------------------------------------
struct SkullResection::Guide
{
  ImplantSlab Slab;
  double Reach = 0;                       // mm from the outline, of the slab
  std::vector<double> Away;               // mm from the outline, of nodes, negative inside
  std::vector<unsigned char> IsSupported; // nodes
  double Area = 0;                        // nodes
  double Unsupported = 0;
  std::vector<InnerPlace> Places;
  std::vector<std::vector<Loop>> Levels; // the outer wall, the inner wall, then holes for screws

  bool IsNear(std::size_t node) const
  {
    return this->Away[node] >= -Beside && this->Away[node] <= this->Reach;
  }
};

//------------------------------------------------------------------------------
void SkullResection::FindFaces(Guide& guide, Execution& execution) const
{
  const double height = this->Options.GuideHeight;
  const double lean = this->Slope * (2 * height + Beside) + Beside;
  const auto count = this->Table.size();
  guide.Reach = this->Options.GuideWidth + lean;
  guide.Away.assign(count, 0);
  guide.IsSupported.assign(count, 0);
  ImplantSlab& slab = guide.Slab;
  slab.Grid = this->Grid;
  slab.IsKnown.assign(count, false);
  slab.Outer.assign(count, Vec3{ 0, 0, 0 });
  slab.Inner = slab.Outer;
  execution.For(this->Grid.Rows, 2,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        for (std::int64_t i = 0; i < this->Grid.Columns; ++i)
        {
          const std::int64_t node = i + this->Grid.Columns * j;
          const Vec2 p = this->Grid.GetNode(i, j);
          guide.Away[node] = -this->FindWall(p).Distance;
          if (!guide.IsNear(node))
          {
            continue;
          }
          // lying on the highest places around; where there are none, on what is farther away
          double lower = this->SmoothTable(i, j, ContactReach, true);
          guide.IsSupported[node] = !std::isnan(lower);
          lower = std::isnan(lower) ? this->SmoothTable(i, j, BridgedReach, false) : lower;
          const double upper = this->SmoothTable(i, j, std::isnan(lower) ? 0 : SmoothReach, false);
          const double top = std::isnan(upper) ? lower : std::max(upper, lower - 0.3 * height);
          slab.Inner[node] = this->ToWorld(p, lower + this->Options.GuideClearance);
          slab.Outer[node] = this->ToWorld(p, top + height);
        }
      }
    });
}

//------------------------------------------------------------------------------
void SkullResection::FindSupport(Guide& guide) const
{
  ImplantSlab& slab = guide.Slab;
  bool hasGap = false;
  for (std::size_t node = 0; node < guide.Away.size(); ++node)
  {
    slab.IsKnown[node] =
      guide.IsNear(node) && IsFinite(slab.Inner[node]) && IsFinite(slab.Outer[node]);
    if (guide.Away[node] > 0 && guide.Away[node] < this->Options.GuideWidth)
    {
      guide.Area += 1;
      guide.Unsupported += guide.IsSupported[node] ? 0 : 1;
      hasGap = hasGap || !slab.IsKnown[node];
    }
  }
  if (hasGap)
  {
    throw std::runtime_error("no bone is below a part of the guide: make it narrower, or draw the "
                             "outline farther from holes and from the end of the scan");
  }
}

//------------------------------------------------------------------------------
void SkullResection::FindWalls(Guide& guide) const
{
  // the outer wall is straight, the inner one leans on with the cut
  const ImplantSlab& slab = guide.Slab;
  std::vector<double> ring(guide.Away.size());
  for (std::size_t node = 0; node < ring.size(); ++node)
  {
    ring[node] = slab.IsKnown[node] ? this->Options.GuideWidth - guide.Away[node] : -1;
  }
  std::vector<Loop> outside = KeepLargest(FindContours(slab.Grid, ring, 0));
  const Loop inner = Resample(this->Flat, 0.5 * GuideTriangle);
  if (outside.empty() || SignedArea(outside[0]) < SignedArea(this->Flat))
  {
    throw std::runtime_error("the guide has no room around the cut");
  }
  outside[0] = Resample(outside[0], 0.5 * GuideTriangle);
  guide.Places = FindInnerPlaces(inner);
  for (int level = 0; level <= slab.Steps; ++level)
  {
    guide.Levels.push_back({ outside[0], this->FindInnerWall(guide, slab.DepthOf(level)) });
  }
}

//------------------------------------------------------------------------------
Loop SkullResection::FindInnerWall(const Guide& guide, double depth) const
{
  Loop wall;
  for (const InnerPlace& place : guide.Places)
  {
    const double below = this->FindWall(place.Foot).Height;
    Vec2 p = place.Foot;
    for (int step = 0; step < 6; ++step)
    {
      if (!guide.Slab.Covers(p))
      {
        throw std::runtime_error("the guide has no bone below all of its inner edge");
      }
      const double moved =
        std::min(this->Slope * (this->HeightOf(guide.Slab.GetPoint(p, depth)) - below), place.Most);
      p = { place.Foot[0] + moved * place.Out[0], place.Foot[1] + moved * place.Out[1] };
    }
    wall.push_back(p);
  }
  return wall;
}

//------------------------------------------------------------------------------
int SkullResection::AddScrewHoles(Guide& guide) const
{
  const ImplantRim rim(guide.Slab, guide.Levels);
  const std::vector<InnerPlace>& places = guide.Places;
  const double radius = 0.5 * this->Options.GuideHole;
  const double middle = 0.5 * (this->Options.GuideWidth + this->Slope * this->Options.GuideHeight);
  const std::size_t quarter = places.size() / GuideHoles;
  int made = 0;
  for (std::size_t hole = 0; hole < GuideHoles; ++hole)
  {
    // in the middle of its quarter, else as near to that as there is room
    bool isMade = false;
    for (std::size_t off = 0; off < quarter && !isMade; ++off)
    {
      const std::size_t at = hole * quarter + quarter / 2 + (off + 1) / 2 * (off % 2 ? 1 : -1);
      const InnerPlace& place = places[at % places.size()];
      const Vec2 p{ place.Foot[0] + middle * place.Out[0], place.Foot[1] + middle * place.Out[1] };
      Vec2 end{};
      if (rim.Find(p, 2 * radius + LeastHoleToRim, end) < radius + 0.9 * LeastHoleToRim)
      {
        continue;
      }
      const std::vector<Loop> tunnel = FindTunnel(guide.Slab, { p, radius }, 0.5 * GuideTriangle);
      isMade = !tunnel.empty();
      for (std::size_t level = 0; level < tunnel.size(); ++level)
      {
        guide.Levels[level].push_back(tunnel[level]);
      }
    }
    made += isMade ? 1 : 0;
  }
  return made;
}

//------------------------------------------------------------------------------
SkullImplant SkullResection::MakeGuide(Execution& execution) const
{
  Guide guide;
  this->FindFaces(guide, execution);
  this->FindSupport(guide);
  this->FindWalls(guide);
  SkullImplant made;
  if (this->Options.GuideHole > 0)
  {
    made.Holes = this->AddScrewHoles(guide);
    if (made.Holes < static_cast<int>(GuideHoles))
    {
      made.Warnings.push_back("only " + std::to_string(made.Holes) + " of " +
        std::to_string(GuideHoles) +
        " holes for screws have room in the guide: make it wider, or lower");
    }
  }
  AddImplantMesh(guide.Slab, guide.Levels, {}, GuideTriangle, execution, made);
  for (const Triangle& t : made.Triangles)
  {
    const Vec3& first = made.Points[0];
    made.Volume +=
      Dot(made.Points[t[0]] - first, Cross(made.Points[t[1]] - first, made.Points[t[2]] - first)) /
      6;
  }
  if (guide.Unsupported > MostUnsupported * guide.Area)
  {
    made.Warnings.push_back("the guide lies on bone only for " +
      FormatNumber(std::round(100 * (1 - guide.Unsupported / guide.Area))) +
      " % of its area: it may tilt. Move the outline, or make the guide narrower");
  }
  return made;
}
}
