// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantPlate.h"

#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaPlanarLattice.h"
#include "lacunaPlateMeasures.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr int RoundSteps = 8;
}

//------------------------------------------------------------------------------
void ImplantPlateOptions::Describe(Properties& properties) const
{
  constexpr ValueRange Positive = ValueRange::Above(0, "mm");
  properties.Add("Thickness", this->Thickness, Positive)
    .Add("Side", static_cast<int>(this->Side), PlateSideNames)
    .Add("EdgeClearance", this->EdgeClearance, ValueRange::Any("mm"))
    .Add("EdgeShape", static_cast<int>(this->Edge), PlateEdgeNames)
    .Add("Bevel", this->EdgeSize, Positive.OrZero("sharp edge"))
    .Add("BevelBothFaces", this->BothFaces)
    .Add("CornerRadius", this->CornerRadius, ValueRange::AtLeast(0, "mm"))
    .Add("TriangleSize", this->TriangleSize, Positive.OrZero("automatic"))
    .Add("HoleDiameter", this->Hole.Diameter, Positive)
    .Add("CountersinkDiameter", this->Hole.CountersinkDiameter, Positive.OrZero("none"))
    .Add("CountersinkAngle", this->Hole.CountersinkAngle, ValueRange::Between(30, 150, "degrees"))
    .Add("DrainageSpacing", this->DrainageSpacing, Positive.OrZero("no holes"))
    .Add("DrainageDiameter", this->DrainageDiameter, Positive);
}

//------------------------------------------------------------------------------
void CheckPlateOptions(const ImplantPlateOptions& o)
{
  Properties properties;
  o.Describe(properties);
  properties.Check();
  ValueRange::Above(0, "mm").Check("TriangleSize", o.TriangleSize);
  const auto fail = [](const char* name, double value, const std::string& right)
  {
    throw std::invalid_argument(name + (" is " + FormatNumber(value)) + " mm; it must be " + right);
  };
  if (o.Edge != PlateEdge::Square)
  {
    const double most = o.BothFaces ? 0.5 * o.Thickness : o.Thickness;
    if (o.EdgeSize > most)
    {
      fail("Bevel", o.EdgeSize,
        "from 0 to " + FormatNumber(most) +
          (o.BothFaces ? " mm, half of Thickness" : " mm, the Thickness"));
    }
  }
  if (!o.HolePoints.empty())
  {
    const double head = o.Hole.CountersinkDiameter;
    if (head != 0 && head <= o.Hole.Diameter)
    {
      fail("CountersinkDiameter", head,
        "0 (none) or larger than HoleDiameter, " + FormatNumber(o.Hole.Diameter) + " mm");
    }
  }
  if (o.DrainageSpacing != 0 && o.DrainageSpacing < o.DrainageDiameter + 2 * MinimumWeb)
  {
    fail("DrainageSpacing", o.DrainageSpacing,
      "0 (no holes) or at least DrainageDiameter + 1 mm, so that the holes stay apart");
  }
}

//------------------------------------------------------------------------------
std::vector<Vec2> GetEdgeProfile(const ImplantPlateOptions& options, const PlateLevels& levels)
{
  std::vector<Vec2> profile;
  const auto add = [&](double inset, double level)
  {
    if (profile.empty() || std::abs(profile.back()[0] - inset) > 1e-9 ||
      std::abs(profile.back()[1] - level) > 1e-9)
    {
      profile.push_back({ inset, level });
    }
  };
  const double size = options.Edge == PlateEdge::Square ? 0 : options.EdgeSize;
  const int steps = size == 0 ? 0 : (options.Edge == PlateEdge::Round ? RoundSteps : 1);
  // inset and depth below the face after step i of the turn from face to wall
  const auto turn = [&](int i)
  {
    const double angle = 0.5 * Pi * i / std::max(steps, 1);
    return Vec2{ size * (1 - std::sin(angle)), size * (1 - std::cos(angle)) };
  };
  for (int i = 0; i <= steps; ++i)
  {
    add(turn(i)[0], levels.Outer - turn(i)[1]);
  }
  for (int i = steps; i >= 0 && options.BothFaces; --i)
  {
    add(turn(i)[0], levels.Inner + turn(i)[1]);
  }
  add(options.BothFaces ? size : 0, levels.Inner);
  return profile;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double MaximumPoints = 3e7;     // per face
constexpr double MaximumDrainage = 20000; // holes
constexpr double LatticeToBoundary = 0.6; // of TriangleSize: boundaries stay Delaunay edges
constexpr double LeastStretch = 0.02;     // of the offset surface against the surface

class Builder
{
public:
  Builder(Execution& execution, const ReliefSurface& surface, const ImplantPlateOptions& options,
    const Matrix4& toWorld)
    : Run(execution)
    , Surface(surface)
    , Options(options)
    , ToWorld(toWorld)
  {
    const bool out = options.Side == PlateSide::Outward;
    this->Levels.Outer = out ? options.Thickness : 0;
    this->Levels.Inner = out ? 0 : -options.Thickness;
    this->EdgeSize = options.Edge == PlateEdge::Square ? 0 : options.EdgeSize;
  }

  ImplantPlate Make(GridSize size, const Vec2& spacing, const std::vector<unsigned char>& mask)
  {
    const double h = this->Options.TriangleSize;
    PlateOutlineOptions outline;
    outline.Clearance = this->Options.EdgeClearance;
    outline.CornerRadius = std::max(this->Options.CornerRadius, this->EdgeSize + h);
    outline.Spacing = h;
    this->Run.SetStage(0, 0.3);
    this->Plate.Outline = FindPlateOutline(this->Run, this->Surface, size, spacing, mask, outline);
    const double area = std::abs(SignedArea(this->Plate.Outline.Points));
    if (area / (h * h) > MaximumPoints)
    {
      throw std::runtime_error("TriangleSize " + FormatNumber(h) + " mm would give " +
        FormatNumber(std::round(area / (h * h))) + " points per face; make it larger");
    }
    this->Run.SetStage(0.3, 0.4);
    this->AddScrewHoles();
    this->AddDrainage();
    this->AddEdge();
    this->AddHoleWalls();
    this->Run.SetStage(0.4, 0.65);
    this->OuterSheet = this->AddSheet(true);
    this->Run.SetStage(0.65, 0.9);
    this->InnerSheet = this->AddSheet(false);
    this->Run.SetStage(0.9, 1);
    MeasurePlate(this->Run, this->OuterSheet, this->InnerSheet, this->Plate);
    return std::move(this->Plate);
  }

private:
  std::string Name(const Vec3& p) const
  {
    const Vec3 world = this->ToWorld.Point(p);
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(1);
    text << std::fixed << "(" << world[0] << ", " << world[1] << ", " << world[2] << ")";
    return text.str();
  }

  //----------------------------------------------------------------------------
  // Distance in space from a point on the surface to the plate's edge; negative outside.
  double GetEdgeDistance(const Vec2& p) const
  {
    const double d =
      this->Rim->Find(this->Surface.GetPoint(p), std::numeric_limits<double>::infinity()).Distance;
    return IsInside({ this->Plate.Outline.Points }, p) ? d : -d;
  }

  void AddScrewHoles()
  {
    std::vector<Vec3> rim;
    for (const Vec2& p : this->Plate.Outline.Points)
    {
      rim.push_back(this->Surface.GetPoint(p));
    }
    this->Rim = std::make_unique<CurveIndex>(
      std::vector<std::vector<Vec3>>{ rim }, 4 * this->Options.TriangleSize);
    for (std::size_t k = 0; k < this->Options.HolePoints.size(); ++k)
    {
      const Vec3& picked = this->Options.HolePoints[k];
      const std::string name = "screw hole " + std::to_string(k + 1) + " at " + this->Name(picked);
      Vec2 foot;
      double offset = 0;
      if (!IsFinite(picked) || !FindFoot(this->Surface, picked, foot, offset))
      {
        throw std::runtime_error(name + " does not lie on the plate or above it");
      }
      const double room = this->GetEdgeDistance(foot);
      const double away = std::max(offset - this->Levels.Outer, this->Levels.Inner - offset);
      if (away > this->Options.Thickness + 5)
      {
        throw std::runtime_error(name + " is " + FormatNumber(std::round(10 * away) / 10) +
          " mm away from the plate; pick a point on the filled surface");
      }
      const double radius =
        0.5 * std::max(this->Options.Hole.Diameter, this->Options.Hole.CountersinkDiameter);
      const double needed = radius + this->EdgeSize + MinimumWeb;
      if (room < needed)
      {
        throw std::runtime_error(name +
          (room < 0
              ? " lies " + FormatNumber(std::round(-10 * room) / 10) + " mm outside of the plate"
              : " is only " + FormatNumber(std::round(10 * room) / 10) +
                " mm from the plate's edge") +
          "; its centre must be at least " + FormatNumber(std::round(100 * needed) / 100) +
          " mm inside. For screws into the bone give the plate an overlap (EdgeClearance below 0)");
      }
      this->AddHole(foot, this->Options.Hole, name);
      for (std::size_t i = 0; i < k; ++i)
      {
        const double gap = Norm(this->Holes[i].Centre - this->Holes[k].Centre) - 2 * radius;
        if (gap < MinimumWeb)
        {
          throw std::runtime_error(name + " is too near to screw hole " + std::to_string(i + 1) +
            ": " + FormatNumber(std::round(100 * gap) / 100) + " mm between them, at least " +
            FormatNumber(MinimumWeb) + " are needed");
        }
      }
    }
    this->Plate.Holes = this->Holes;
  }

  void AddHole(const Vec2& foot, const HoleShape& shape, const std::string& name)
  {
    try
    {
      this->CheckBending(this->Surface.GetFrame(foot));
      this->Holes.push_back(
        MakePlateHole(this->Surface, foot, this->Levels, shape, this->Options.TriangleSize));
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error(name + " " + error.what());
    }
  }

  // Whether a disc about p, seen along z, is over the defect, not over bone.
  bool IsOverDefect(const Vec2& p, double radius) const
  {
    for (const double dy : { -radius, 0.0, radius })
    {
      const double dx = dy == 0 ? radius : 0;
      const std::vector<double> crossings =
        FindCrossings({ this->Plate.Outline.Defect }, p[1] + dy);
      for (const double x : { p[0] - dx, p[0] + dx })
      {
        if (!IsInside(crossings, x))
        {
          return false;
        }
      }
    }
    return true;
  }

  // A hexagonal pattern around the middle of the plate, seen along z, where there is room and no
  // bone below.
  void AddDrainage()
  {
    const double step = this->Options.DrainageSpacing;
    if (step == 0)
    {
      return;
    }
    const Loop& outline = this->Plate.Outline.Points;
    Vec2 low = outline[0];
    Vec2 high = outline[0];
    for (const Vec2& p : outline)
    {
      for (int i = 0; i < 2; ++i)
      {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    const Vec2 middle{ 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]) };
    const double rise = step * std::sqrt(0.75);
    if ((high[0] - low[0]) * (high[1] - low[1]) / (step * rise) > MaximumDrainage)
    {
      throw std::runtime_error("DrainageSpacing " + FormatNumber(step) +
        " mm would give over twenty thousand holes; make it larger");
    }
    HoleShape shape;
    shape.Diameter = this->Options.DrainageDiameter;
    const double web = std::max(1.0, 2 * MinimumWeb);
    const double needed = 0.5 * shape.Diameter + this->EdgeSize + web;
    const auto rows = static_cast<int>((high[1] - low[1]) / rise / 2) + 1;
    const auto columns = static_cast<int>((high[0] - low[0]) / step / 2) + 1;
    for (int j = -rows; j <= rows; ++j)
    {
      for (int i = -columns; i <= columns; ++i)
      {
        const Vec2 p{ middle[0] + step * (i + (j % 2 ? 0.5 : 0)), middle[1] + rise * j };
        if (!this->IsOverDefect(p, 0.5 * shape.Diameter) || this->GetEdgeDistance(p) < needed)
        {
          continue;
        }
        const Vec3 centre = this->Surface.GetFrame(p).Offset(this->Levels.Outer);
        const bool free = std::all_of(this->Plate.Holes.begin(), this->Plate.Holes.end(),
          [&](const PlateHole& hole)
          { return Norm(hole.Centre - centre) >= hole.Radius + 0.5 * shape.Diameter + web; });
        if (free)
        {
          this->AddHole(p, shape, "drainage hole at " + this->Name(centre));
        }
      }
    }
    this->Plate.DrainageHoles =
      static_cast<std::int64_t>(this->Holes.size() - this->Plate.Holes.size());
    if (this->Plate.DrainageHoles == 0)
    {
      this->Plate.Outline.Warnings.emplace_back(
        "there is no room for a drainage hole; reduce DrainageSpacing or DrainageDiameter");
    }
  }

  //----------------------------------------------------------------------------
  std::int32_t AddPoint(const Vec3& p)
  {
    this->Plate.Points.push_back(p);
    return static_cast<std::int32_t>(this->Plate.Points.size()) - 1;
  }

  void AddTriangle(std::int32_t a, std::int32_t b, std::int32_t c, PlateFace face)
  {
    this->Plate.Triangles.push_back({ a, b, c });
    this->Plate.Faces.push_back(face);
  }

  // Between a ring and the next one away from the viewer, with the material on the left of both.
  void AddStrip(
    const std::vector<std::int32_t>& upper, const std::vector<std::int32_t>& lower, PlateFace face)
  {
    const std::size_t n = upper.size();
    for (std::size_t k = 0; k < n; ++k)
    {
      const std::size_t next = (k + 1) % n;
      this->AddTriangle(upper[k], upper[next], lower[next], face);
      this->AddTriangle(upper[k], lower[next], lower[k], face);
    }
  }

  // The walls around the plate: rings at (inset, level) from the outer face to the inner one.
  void AddEdge()
  {
    const std::vector<Vec2> profile = GetEdgeProfile(this->Options, this->Levels);
    const PlateOutline& outline = this->Plate.Outline;
    std::vector<std::int32_t> last;
    for (const Vec2& ring : profile)
    {
      Loop feet;
      std::vector<std::int32_t> points;
      for (std::size_t k = 0; k < outline.Points.size(); ++k)
      {
        feet.push_back(outline.GetInset(k, ring[0]));
        const auto frame = this->Surface.GetFrame(feet.back());
        this->CheckBending(frame);
        points.push_back(this->AddPoint(frame.Offset(ring[1])));
      }
      if (last.empty())
      {
        this->OuterLoops.push_back({ feet, points });
      }
      else
      {
        this->AddStrip(last, points, PlateFace::Edge);
      }
      if (&ring == &profile.back())
      {
        this->InnerLoops.push_back({ feet, points });
      }
      last = points;
    }
  }

  void AddHoleWalls()
  {
    for (std::size_t k = 0; k < this->Holes.size(); ++k)
    {
      const PlateHole& hole = this->Holes[k];
      const PlateFace face =
        k < this->Plate.Holes.size() ? PlateFace::ScrewHole : PlateFace::DrainageHole;
      std::vector<std::int32_t> last;
      for (const auto& ring : hole.Rings)
      {
        std::vector<std::int32_t> points;
        points.reserve(ring.size());
        for (const Vec3& p : ring)
        {
          points.push_back(this->AddPoint(p));
        }
        if (last.empty())
        {
          this->OuterLoops.push_back({ hole.OuterFeet, points });
        }
        else
        {
          this->AddStrip(last, points, face);
        }
        last = points;
      }
      this->InnerLoops.push_back({ hole.InnerFeet, last });
    }
  }

  //----------------------------------------------------------------------------
  // Throws when the offset surfaces turn inside out at a point.
  void CheckBending(const ReliefSurface::Frame& frame) const
  {
    for (const double curvature : frame.Curvatures)
    {
      for (const double level : { this->Levels.Outer, this->Levels.Inner })
      {
        if (1 - level * curvature < LeastStretch)
        {
          throw std::runtime_error("the surface bends with a radius of " +
            FormatNumber(std::round(100 / std::abs(curvature)) / 100) + " mm at " +
            this->Name(frame.Point) + ", which is not more than Thickness (" +
            FormatNumber(this->Options.Thickness) +
            " mm): a plate's other face would cut itself there. Make Thickness smaller or the "
            "other Side, or smooth the fit (Smoothing of RBF Hole Filler)");
        }
      }
    }
  }

  PlateSheet AddSheet(bool outer)
  {
    const double level = outer ? this->Levels.Outer : this->Levels.Inner;
    const auto& boundaries = outer ? this->OuterLoops : this->InnerLoops;
    std::vector<Loop> loops;
    std::vector<std::vector<std::int32_t>> edges;
    PlateSheet sheet;
    for (const Boundary& boundary : boundaries)
    {
      loops.push_back(boundary.Feet);
      edges.emplace_back();
      for (std::size_t k = 0; k < boundary.Feet.size(); ++k)
      {
        edges.back().push_back(static_cast<std::int32_t>(sheet.Feet.size()));
        sheet.Feet.push_back(boundary.Feet[k]);
        sheet.Points.push_back(boundary.Points[k]);
      }
    }
    sheet.BorderSize = sheet.Feet.size();
    const double h = this->Options.TriangleSize;
    const Loop lattice = FillWithLattice(this->Run, loops, h, LatticeToBoundary * h);
    sheet.Feet.insert(sheet.Feet.end(), lattice.begin(), lattice.end());
    std::vector<Vec2> rounded = sheet.Feet;
    std::vector<Triangle> triangles;
    try
    {
      triangles = TriangulateRegion(rounded, edges);
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error(std::string("the outline of the plate meets itself or a hole (") +
        error.what() +
        "); make EdgeClearance larger, smooth the mask of the defect, or move the "
        "holes");
    }

    // the lattice on the offset surface
    const std::size_t first = this->Plate.Points.size();
    this->Plate.Points.resize(first + lattice.size());
    std::vector<double> radii(lattice.size());
    this->Run.For(static_cast<std::int64_t>(lattice.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          const auto frame = this->Surface.GetFrame(lattice[k]);
          this->CheckBending(frame);
          this->Plate.Points[first + k] = frame.Offset(level);
          radii[k] = 1 / std::max(std::abs(frame.Curvatures[0]), std::abs(frame.Curvatures[1]));
        }
      });
    for (std::size_t k = 0; k < lattice.size(); ++k)
    {
      sheet.Points.push_back(static_cast<std::int32_t>(first + k));
      if (radii[k] < this->Plate.MinimumRadius)
      {
        this->Plate.MinimumRadius = radii[k];
        this->Plate.MinimumRadiusPoint = this->Surface.GetPoint(lattice[k]);
      }
    }
    for (const Triangle& t : triangles)
    {
      const Vec3& a = this->Plate.Points[sheet.Points[t[0]]];
      const Vec3 normal = Cross(
        this->Plate.Points[sheet.Points[t[1]]] - a, this->Plate.Points[sheet.Points[t[2]]] - a);
      if (normal[2] <= 0)
      {
        throw std::runtime_error("the " + std::string(outer ? "outer" : "inner") +
          " face folds over at " + this->Name(a) +
          "; make Thickness smaller or smooth the fit (Smoothing of RBF Hole Filler)");
      }
      const auto [i, j, k] = t;
      // counterclockwise is seen from behind
      this->AddTriangle(sheet.Points[i], sheet.Points[outer ? k : j], sheet.Points[outer ? j : k],
        outer ? PlateFace::Outer : PlateFace::Inner);
    }
    sheet.Triangles = std::move(triangles);
    return sheet;
  }

  struct Boundary
  {
    Loop Feet;
    std::vector<std::int32_t> Points;
  };

  Execution& Run;
  const ReliefSurface& Surface;
  const ImplantPlateOptions& Options;
  const Matrix4& ToWorld;
  PlateLevels Levels;
  double EdgeSize = 0;
  std::unique_ptr<CurveIndex> Rim;
  std::vector<PlateHole> Holes; // screws first
  std::vector<Boundary> OuterLoops;
  std::vector<Boundary> InnerLoops;
  PlateSheet OuterSheet;
  PlateSheet InnerSheet;
  ImplantPlate Plate;
};
}

//------------------------------------------------------------------------------
ImplantPlate MakeImplantPlate(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const ImplantPlateOptions& options,
  const Matrix4& toWorld)
{
  CheckPlateOptions(options);
  return Builder(execution, surface, options, toWorld).Make(size, spacing, mask);
}
}
