// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaImplantEdge.h"
#include "lacunaImplantMesh.h"
#include "lacunaImplantSpace.h"
#include "lacunaParameterText.h"
#include "lacunaPlanarCurves.h"
#include "lacunaPlanarLattice.h"
#include "lacunaSkullChart.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double ErrorSpacing = 3;      // mm: standard errors vary slowly
constexpr double AutomaticTriangle = 1; // mm
constexpr double LeastLost = 50;        // mm^2 of a part: of which is told
constexpr double BareGap = 3;           // mm, beyond the clearance: bone is not beside the rim
constexpr double MostBare = 0.1;        // of the rim: of which is told
constexpr double MostContact = 0.1;     // mm: of which is not told
constexpr double BesideCut = 0.5;       // mm: of a screw, more than it needs

class Builder
{
public:
  Builder(const VoxelVolume& volume, const SkullRays& rays, const std::vector<int>& defect,
    const SkullShape& shape, const BoneDistance& bone, const SkullImplantOptions& options,
    Execution& execution)
    : Rays(rays)
    , Shape(shape)
    , Bone(bone)
    , Options(options)
    , Run(execution)
    , Space(volume, rays, defect, shape, bone, options, execution)
    , Slab(Space.GetSlab())
  {
  }

  SkullImplant Make()
  {
    this->Run.SetStage(0.05, 0.2);
    const std::vector<Loop> hole = this->Space.FindHole();
    this->Space.Offset(hole);
    this->Run.SetStage(0.25, 0.3);
    std::vector<Loop> outline = this->Space.MoveInwards(hole);
    this->Run.SetStage(0.3, 0.5);
    const InsertionPath path(
      this->Bone, this->Space.ChooseDirection(outline), this->Options.EdgeClearance);
    const std::vector<double> free = this->Space.FindFreeWays(path);
    outline = this->Space.FindOutline(free);
    if (outline.empty())
    {
      throw std::runtime_error(
        "no implant can be put in along this direction: bone is above all of "
        "the hole. Give another direction");
    }
    this->Run.SetStage(0.5, 0.55);
    const ImplantEdge edge = this->Follow(this->Bone, path, outline);
    this->Run.SetStage(0.55, 0.6);
    const Cuts cuts = this->FindCuts(edge, path);
    const double ofCut = 0.5 * this->Options.EdgeClearance +
      GetLeastToRim(this->Options, this->Options.ScrewDiameter) + BesideCut;
    this->Implant.Plates =
      PlacePlates(this->Slab, this->Rays, this->Space.GetChart(), edge.Levels, this->Options,
        [&](const Vec3& x)
        {
          return std::all_of(cuts.At.begin(), cuts.At.end(),
            [&](double at) { return std::abs(Dot(x, cuts.Axis) - at) > ofCut; });
        });
    if (this->Options.Parts == 1)
    {
      this->AddPart(edge, 1);
    }
    else
    {
      this->AddParts(free, edge, path, cuts);
    }
    auto& plates = this->Implant.Plates; // those that have a hole
    plates.erase(std::remove_if(plates.begin(), plates.end(),
                   [&](const ImplantPlateScrews& plate) {
                     return std::find(this->Holes.begin(), this->Holes.end(), plate.Foot) ==
                       this->Holes.end();
                   }),
      plates.end());
    this->Run.SetStage(0.6, 0.95);
    this->AddErrors();
    this->Run.SetStage(0.95, 1);
    this->Measure();
    this->MeasureThickness();
    this->SetHoleArea(hole, edge.Levels[0]);
    this->SetInsertion(edge, path);
    this->Warn(this->FindBareRim(edge));
    return std::move(this->Implant);
  }

private:
  ImplantEdge Follow(const BoneDistance& bone, const InsertionPath& path, std::vector<Loop> outline)
  {
    for (Loop& loop : outline)
    {
      loop = Resample(loop, 0.5 * this->Options.TriangleSize);
    }
    return FollowWall(this->Slab, bone, path, outline, this->Options.EdgeClearance, this->Run);
  }

  // The same text, holes where there is room for them.
  void AddPart(ImplantEdge edge, int number)
  {
    std::vector<std::vector<Loop>>& levels = edge.Levels;
    const std::vector<Loop> outline = levels[0];
    const ImplantRim rim(this->Slab, levels);
    const SkullImplantOptions& options = this->Options;
    const TextPlace text =
      PlaceText(this->Slab, rim, levels.back(), options.Text, options.Up, options.MinimumThickness);
    if (!options.Text.empty() && !text.IsGood)
    {
      this->Implant.Warnings.push_back("there is no place for the text on the inner face" +
        this->NameOf(number) + ": make it shorter or its letters smaller");
    }
    std::vector<Vec2> screws;
    for (const ImplantPlateScrews& plate : this->Implant.Plates)
    {
      screws.push_back(plate.Foot);
    }
    for (const ImplantHole& hole :
      PlaceHoles(this->Slab, rim, outline, screws, text, options, this->Run))
    {
      const std::vector<Loop> tunnel = FindTunnel(this->Slab, hole, 0.5 * options.TriangleSize);
      for (std::size_t level = 0; level < tunnel.size(); ++level)
      {
        levels[level].push_back(tunnel[level]);
      }
      if (!tunnel.empty())
      {
        this->Holes.push_back(hole.Middle);
        ++this->Implant.Holes;
      }
    }
    const std::vector<Vec2> feet =
      AddImplantMesh(this->Slab, levels, text.Text, options.TriangleSize, this->Run, this->Implant);
    this->Feet.insert(this->Feet.end(), feet.begin(), feet.end());
    this->Implant.Parts.resize(this->Implant.Triangles.size(), number);
    this->PartArea += GetArea(outline);
    this->MeshedArea += GetArea(levels[0]);
  }

  std::string NameOf(int part) const
  {
    return this->Options.Parts > 1 ? " of part " + std::to_string(part) : "";
  }

  struct Cuts
  {
    Vec3 Axis{ 0, 0, 0 };   // unit, across the cuts
    std::vector<double> At; // along it, mm
    double Length = 0;      // of a cut, at most
  };

  // Across the longest extent, parallel to the way in, between equal shares of the outer surface.
  Cuts FindCuts(const ImplantEdge& whole, const InsertionPath& path) const
  {
    Cuts cuts;
    if (this->Options.Parts == 1)
    {
      return cuts;
    }
    const std::vector<Vec3> points = this->FindOuterPoints(whole.Levels[0]);
    cuts.Axis = FindLongestAxis(points, path.GetDirection());
    cuts.Length = FindExtent(points, Cross(cuts.Axis, path.GetDirection()));
    std::vector<double> along;
    for (const Vec3& x : points)
    {
      along.push_back(Dot(x, cuts.Axis));
    }
    std::sort(along.begin(), along.end());
    for (int part = 1; part < this->Options.Parts; ++part)
    {
      cuts.At.push_back(along[along.size() * part / this->Options.Parts]);
    }
    return cuts;
  }

  void AddParts(const std::vector<double>& free, const ImplantEdge& whole,
    const InsertionPath& path, const Cuts& cuts)
  {
    const int parts = this->Options.Parts;
    const double clearance = this->Options.EdgeClearance;
    // each side keeps half of the clearance from a cut, which counts as a wall of bone behind it
    const double behind = 0.5 * clearance;
    for (int part = 0; part < parts; ++part)
    {
      const double low = part == 0 ? -Far : cuts.At[part - 1] - behind;
      const double high = part + 1 == parts ? Far : cuts.At[part] + behind;
      const PartBone bone(this->Bone, cuts.Axis, low, high);
      const InsertionPath way(bone, path.GetDirection(), clearance);
      const std::vector<Loop> outline =
        this->Space.FindOutline(this->Space.FindPart(free, bone, clearance));
      if (outline.empty())
      {
        throw std::runtime_error("part " + std::to_string(part + 1) + " of " +
          std::to_string(parts) + " is too narrow: give fewer parts");
      }
      this->AddPart(this->Follow(bone, way, outline), part + 1);
    }
    const double lost =
      GetArea(whole.Levels[0]) - this->PartArea - clearance * (parts - 1) * cuts.Length;
    if (lost > LeastLost)
    {
      this->Implant.Warnings.push_back("the parts leave about " +
        FormatNumber(std::round(lost / 10) / 10) +
        " cm^2 of the hole open, where a cut leaves pieces that are narrow or apart");
    }
  }

  std::vector<Vec3> FindOuterPoints(const std::vector<Loop>& outline) const
  {
    std::vector<Vec3> points;
    for (const Vec2& p : FillWithLattice(this->Run, outline, 1, 0))
    {
      points.push_back(this->Slab.GetPoint(p, 0));
    }
    return points;
  }

  static double FindExtent(const std::vector<Vec3>& points, const Vec3& axis)
  {
    double low = Far;
    double high = -Far;
    for (const Vec3& x : points)
    {
      low = std::min(low, Dot(x, axis));
      high = std::max(high, Dot(x, axis));
    }
    return high - low;
  }

  // Unit, across a direction.
  static Vec3 FindLongestAxis(const std::vector<Vec3>& points, const Vec3& across)
  {
    const Vec3 u =
      Normalized(Cross(across, std::abs(across[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
    const Vec3 v = Cross(across, u);
    double longest = 0;
    Vec3 axis = u;
    for (int k = 0; k < 180; ++k)
    {
      const double angle = k * std::acos(-1.0) / 180;
      const Vec3 each = std::cos(angle) * u + std::sin(angle) * v;
      const double extent = FindExtent(points, each);
      if (extent > longest)
      {
        longest = extent;
        axis = each;
      }
    }
    return axis;
  }

  // The part of the rim that has no bone beside it.
  double FindBareRim(const ImplantEdge& edge) const
  {
    const double reach = this->Options.EdgeClearance + BareGap;
    double length = 0;
    double bare = 0;
    for (std::size_t l = 0; l < edge.Levels[0].size(); ++l)
    {
      const std::size_t n = edge.Levels[0][l].size();
      for (std::size_t k = 0; k < n; ++k)
      {
        bool isBare = true;
        for (int level = 0; level <= this->Slab.Steps && isBare; ++level)
        {
          const Vec3 x = this->Slab.GetPoint(edge.Levels[level][l][k], this->Slab.DepthOf(level));
          isBare = this->Bone.Find(x, reach).Distance >= reach;
        }
        const Vec2& a = edge.Levels[0][l][k];
        const Vec2& b = edge.Levels[0][l][(k + 1) % n];
        const double step = std::hypot(b[0] - a[0], b[1] - a[1]);
        length += step;
        bare += isBare ? step : 0;
      }
    }
    return bare / length;
  }

  void Warn(double bareRim)
  {
    std::vector<std::string>& warnings = this->Implant.Warnings;
    const std::vector<std::string>& before = this->Space.GetWarnings();
    warnings.insert(warnings.begin(), before.begin(), before.end());
    if (bareRim > MostBare && before.empty())
    {
      warnings.push_back("on " + FormatNumber(std::round(100 * bareRim)) +
        " % of its rim the implant has no bone beside it: draw DefectOutline around all of the "
        "hole");
    }
    if (this->Implant.InsertionClearance < -MostContact)
    {
      warnings.push_back("the implant touches bone by " +
        FormatNumber(std::round(-10 * this->Implant.InsertionClearance) / 10) +
        " mm when it is put in: give another InsertionDirection, or a larger EdgeClearance");
    }
    const auto& plates = this->Implant.Plates;
    if (static_cast<int>(plates.size()) < this->Options.Plates)
    {
      warnings.push_back("only " + std::to_string(plates.size()) + " of " +
        std::to_string(this->Options.Plates) +
        " plates have a place: with bone beside the rim, and room for a hole in the implant");
    }
    const auto thin = std::count_if(plates.begin(), plates.end(),
      [&](const ImplantPlateScrews& p) { return p.BoneThickness < this->Options.ScrewLength; });
    if (thin > 0)
    {
      warnings.push_back(std::to_string(thin) + " of the plates' screws are in bone thinner than " +
        FormatNumber(this->Options.ScrewLength) + " mm: use shorter screws there");
    }
  }

  //----------------------------------------------------------------------------
  // Of a coarse grid, linear between its nodes.
  void AddErrors()
  {
    const PlanarGrid grid = MakeGrid(this->Feet, ErrorSpacing, ErrorSpacing);
    struct Cell
    {
      std::int64_t Node;
      double X;
      double Y;
    };
    std::vector<Cell> cells;
    std::vector<int> used(static_cast<std::size_t>(grid.Columns * grid.Rows), -1);
    std::vector<Vec2> points;
    for (const Vec2& p : this->Feet)
    {
      const double x = (p[0] - grid.Origin[0]) / ErrorSpacing;
      const double y = (p[1] - grid.Origin[1]) / ErrorSpacing;
      const auto i = static_cast<std::int64_t>(x);
      const auto j = static_cast<std::int64_t>(y);
      cells.push_back(
        { i + grid.Columns * j, x - static_cast<double>(i), y - static_cast<double>(j) });
      for (const int m : { 0, 1 })
      {
        for (const int n : { 0, 1 })
        {
          const std::int64_t node = i + m + grid.Columns * (j + n);
          if (used[node] < 0)
          {
            used[node] = static_cast<int>(points.size());
            points.push_back(grid.GetNode(i + m, j + n));
          }
        }
      }
    }
    const std::vector<SkullEstimate> estimates =
      this->Shape.Predict(this->Space.DirectionsOf(points), this->Run);
    SkullImplant& implant = this->Implant;
    const std::size_t count = this->Feet.size();
    implant.Errors.resize(count);
    implant.ThicknessErrors.resize(count);
    for (std::size_t k = 0; k < count; ++k)
    {
      const Cell& cell = cells[k];
      double error = 0;
      double thickness = 0;
      for (const int m : { 0, 1 })
      {
        for (const int n : { 0, 1 })
        {
          const SkullEstimate& e = estimates[used[cell.Node + m + grid.Columns * n]];
          const double weight = (m ? cell.X : 1 - cell.X) * (n ? cell.Y : 1 - cell.Y);
          error += weight * e.OuterError;
          thickness += weight * e.ThicknessError;
        }
      }
      implant.Errors[k] = error;
      implant.ThicknessErrors[k] = thickness;
      if (error > implant.LargestError)
      {
        implant.LargestError = error;
        implant.LargestErrorPoint = this->Slab.GetPoint(this->Feet[k], 0);
      }
    }
  }

  void Measure()
  {
    SkullImplant& implant = this->Implant;
    double square = 0;
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      const Triangle& triangle = implant.Triangles[t];
      const Vec3 a = implant.Points[triangle[0]] - this->Rays.Center;
      const Vec3 b = implant.Points[triangle[1]] - this->Rays.Center;
      const Vec3 c = implant.Points[triangle[2]] - this->Rays.Center;
      implant.Volume += Dot(a, Cross(b, c)) / 6;
      if (implant.Faces[t] == SkullImplantFace::Outer)
      {
        const double area = 0.5 * Norm(Cross(b - a, c - a));
        implant.OuterArea += area;
        for (const std::int32_t corner : triangle)
        {
          implant.DoubtfulArea +=
            area / 3 * std::erfc(1 / (std::sqrt(2.0) * implant.Errors[corner]));
          square += area / 3 * implant.Errors[corner] * implant.Errors[corner];
        }
      }
    }
    implant.ErrorRMS = std::sqrt(square / implant.OuterArea);
  }

  // By the ratio of areas in the chart: the surface goes on evenly over the clearance.
  void SetHoleArea(const std::vector<Loop>& hole, const std::vector<Loop>& outline)
  {
    double length = 0;
    for (const Loop& loop : outline)
    {
      for (std::size_t k = 0; k < loop.size(); ++k)
      {
        const Vec2& next = loop[(k + 1) % loop.size()];
        length += std::hypot(next[0] - loop[k][0], next[1] - loop[k][1]);
      }
    }
    const double area = GetArea(outline);
    const double whole = std::max(GetArea(hole), area + this->Options.EdgeClearance * length);
    this->Implant.HoleArea = this->Implant.OuterArea * whole / this->MeshedArea;
  }

  // Of the points of one face that are not at the edge, the least distance to the triangles of the other.
  void MeasureThickness()
  {
    SkullImplant& implant = this->Implant;
    TriangleSurface inner;
    inner.Points = implant.Points;
    std::vector<bool> isOuter(implant.Points.size(), false);
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      if (implant.Faces[t] == SkullImplantFace::Inner || implant.Faces[t] == SkullImplantFace::Text)
      {
        inner.Triangles.push_back(implant.Triangles[t]);
      }
      for (const std::int32_t corner : implant.Triangles[t])
      {
        isOuter[corner] = isOuter[corner] || implant.Faces[t] == SkullImplantFace::Outer;
      }
    }
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < isOuter.size(); ++k)
    {
      if (isOuter[k])
      {
        points.push_back(k);
      }
    }
    const TriangleBone face(std::move(inner), [](const Vec3&) { return false; });
    std::vector<double> distances(points.size());
    this->Run.For(static_cast<std::int64_t>(points.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          const Vec3& x = implant.Points[points[k]];
          distances[k] = face.Find(x, 1.1 * implant.Thickness[points[k]] + 0.1).Distance;
        }
      });
    const auto least = std::min_element(distances.begin(), distances.end());
    implant.MinimumThickness = *least;
    implant.ThinnestPoint = implant.Points[points[least - distances.begin()]];
  }

  void SetInsertion(const ImplantEdge& edge, const InsertionPath& path)
  {
    SkullImplant& implant = this->Implant;
    implant.InsertionDirection = path.GetDirection();
    implant.LeastTaper = edge.LeastTaper;
    implant.UndercutVolume = edge.UndercutVolume;
    implant.UndercutWidth = edge.UndercutWidth;
    implant.UndercutPoint = edge.UndercutPoint;
    std::vector<Vec3> places = implant.Points;
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      if (implant.Faces[t] == SkullImplantFace::Edge) // corners of bone are between its points
      {
        const Triangle& c = implant.Triangles[t];
        places.push_back(
          (1.0 / 3) * (implant.Points[c[0]] + implant.Points[c[1]] + implant.Points[c[2]]));
      }
    }
    std::vector<double> clearances(places.size());
    this->Run.For(static_cast<std::int64_t>(clearances.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          clearances[k] = path.GetClearance(places[k]);
        }
      });
    implant.InsertionClearance = *std::min_element(clearances.begin(), clearances.end());
  }

  static constexpr double Far = 1e6; // mm

  const SkullRays& Rays;
  const SkullShape& Shape;
  const BoneDistance& Bone;
  const SkullImplantOptions& Options;
  Execution& Run;
  ImplantSpace Space;
  const ImplantSlab& Slab;
  std::vector<Vec2> Feet;  // of the implant's points
  std::vector<Vec2> Holes; // their middles
  double PartArea = 0;     // mm^2 in the chart
  double MeshedArea = 0;   // the same without holes
  SkullImplant Implant;
};

void CheckToRim(const char* what, double distance, double least)
{
  if (distance < least)
  {
    throw std::invalid_argument("RimDistance is " + FormatNumber(distance) + " mm; for these " +
      what + " it must be at least " + FormatNumber(least));
  }
}
}

//------------------------------------------------------------------------------
void SkullImplantOptions::Describe(Properties& properties) const
{
  constexpr ValueRange Diameters = ValueRange::Between(0.5, 10, "mm");
  constexpr ValueRange Spacings = ValueRange::Between(4, 50, "mm").OrZero("no holes");
  properties.Add("EdgeClearance", this->EdgeClearance, ValueRange::Between(0, 5, "mm"))
    .Add("Thickness", this->Thickness, ValueRange::Between(0.5, 20, "mm").OrZero("as the bone"))
    .Add("MinimumThickness", this->MinimumThickness, ValueRange::Between(0, 10, "mm"))
    .Add("InsertionDirection", this->InsertionDirection.Elements,
      ValueRange::Any().OrZero("automatic"))
    .Add("OuterOffset", this->OuterOffset, ValueRange::Between(-10, 10, "mm"))
    .Add("InnerOffset", this->InnerOffset, ValueRange::Between(-10, 10, "mm"))
    .Add("OffsetFade", this->OffsetFade, ValueRange::Between(0, 50, "mm"))
    .Add("Parts", this->Parts, ValueRange::Between(1, 6))
    .Add("DrainageSpacing", this->DrainageSpacing, Spacings)
    .Add("DrainageDiameter", this->DrainageDiameter, Diameters)
    .Add("SutureSpacing", this->SutureSpacing, Spacings)
    .Add("SutureDiameter", this->SutureDiameter, Diameters)
    .Add("Plates", this->Plates, ValueRange::Between(1, 12).OrZero("none"))
    .Add("ScrewDiameter", this->ScrewDiameter, Diameters)
    .Add("ScrewLength", this->ScrewLength, ValueRange::Between(1, 20, "mm"))
    .Add("RimDistance", this->RimDistance, ValueRange::Between(2, 20, "mm"))
    .Add("TriangleSize", this->TriangleSize, ValueRange::Between(0.2, 5, "mm").OrZero("automatic"));
}

//------------------------------------------------------------------------------
void CheckSkullImplantOptions(const SkullImplantOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  if (options.Plates > 0)
  {
    CheckToRim("plates", options.RimDistance,
      std::max(LeastPlateToRim, 0.5 * options.ScrewDiameter + LeastHoleToRim));
  }
  if (options.SutureSpacing > 0)
  {
    CheckToRim(
      "holes for sutures", options.RimDistance, 0.5 * options.SutureDiameter + LeastHoleToRim);
  }
}

//------------------------------------------------------------------------------
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const BoneDistance& bone,
  const SkullImplantOptions& options, Execution& execution)
{
  if (defect.empty())
  {
    throw std::invalid_argument("there is no defect to fill");
  }
  CheckSkullImplantOptions(options);
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.05);
  SkullImplantOptions used = options;
  used.TriangleSize = options.TriangleSize == 0 ? AutomaticTriangle : options.TriangleSize;
  if (options.Thickness > 0) // what is asked for is not too thin
  {
    used.MinimumThickness = std::min(options.MinimumThickness, options.Thickness);
  }
  return Builder(volume, rays, defect, shape, bone, used, execution).Make();
}
}
