// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectModel.h"

#include "lacunaDefectContours.h"
#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaReliefSurface.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace lacuna
{
//------------------------------------------------------------------------------
void DefectModelOptions::Describe(Properties& properties) const
{
  constexpr ValueRange Block = ValueRange::Above(0, "mm").UpTo(LargestBlock);
  properties.Add("Margin", this->Margin, ValueRange::AtLeast(0, "mm"))
    .Add("FloorShape", static_cast<int>(this->Floor), DefectFloorNames)
    .Add("DefectDepth", this->DefectDepth, Block)
    .Add("BaseThickness", this->BaseThickness, Block)
    .Add(
      "MaximumHeight", this->MaximumHeight, ValueRange::Above(0, "mm").OrZero("as the bone needs"));
}

//------------------------------------------------------------------------------
void CheckDefectModelOptions(const DefectModelOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
}

//------------------------------------------------------------------------------
namespace
{
constexpr double LeastMargin = 2;     // pixels
constexpr double MaximumPixels = 3e7; // of the rectangle
}

//------------------------------------------------------------------------------
DefectModelPlan PlanDefectModel(const DefectScene& scene, const DefectModelOptions& options)
{
  CheckDefectModelOptions(options);
  DefectModelPlan plan;
  const double speck = 2 * scene.Spacing[0] * scene.Spacing[1];
  for (Loop& contour : FindDefectContours(scene.Size, scene.Spacing, scene.Mask))
  {
    const double area = SignedArea(contour);
    if (std::abs(area) > speck)
    {
      plan.Contours.push_back(std::move(contour));
      plan.Defects += area > 0;
    }
  }
  if (plan.Defects == 0)
  {
    throw std::runtime_error(
      "the defect is too small for a model: fewer than a few pixels of FilledMask are marked");
  }
  std::int64_t first[2];
  std::int64_t last[2];
  const std::int64_t size[2] = { scene.MapSize.Columns, scene.MapSize.Rows };
  const std::int64_t from[2] = { scene.Column, scene.Row };
  double count = 1;
  for (int axis = 0; axis < 2; ++axis)
  {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Loop& loop : plan.Contours)
    {
      for (const Vec2& p : loop)
      {
        low = std::min(low, p[axis]);
        high = std::max(high, p[axis]);
      }
    }
    const double pixel = scene.Spacing[axis];
    const double margin = std::max(options.Margin / pixel, LeastMargin);
    const double a = static_cast<double>(from[axis]) + std::floor(low / pixel - margin);
    const double b = static_cast<double>(from[axis]) + std::ceil(high / pixel + margin);
    const auto end = static_cast<double>(size[axis] - 1);
    plan.Cut = plan.Cut || a < 0 || b > end;
    first[axis] = static_cast<std::int64_t>(std::max(a, 0.0));
    last[axis] = static_cast<std::int64_t>(std::min(b, end));
    count *= static_cast<double>(last[axis] - first[axis] + 1);
  }
  if (count > MaximumPixels)
  {
    throw std::runtime_error(
      "the model would have over thirty million pixels; make Margin smaller");
  }
  plan.Column = first[0];
  plan.Row = first[1];
  plan.Size = { last[0] - first[0] + 1, last[1] - first[1] + 1 };
  return plan;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double LeastWall = 0.1;     // mm between the upper side and the base, and of walls
constexpr double NodeToOutline = 0.5; // of a pixel: no slivers there

std::string Rounded(double mm)
{
  return FormatNumber(std::round(100 * mm) / 100) + " mm";
}

class Builder
{
public:
  Builder(Execution& execution, const DefectScene& scene, const ReliefSurface& surface,
    const DefectModelOptions& options, const Matrix4& toWorld)
    : Run(execution)
    , Scene(scene)
    , Plan(PlanDefectModel(scene, options))
    , Surface(surface)
    , Options(options)
    , ToWorld(toWorld)
    , Pixel(std::min(scene.Spacing[0], scene.Spacing[1]))
  {
  }

  DefectModel Make()
  {
    this->Model.Defects = this->Plan.Defects;
    this->Model.Column = this->Plan.Column;
    this->Model.Row = this->Plan.Row;
    this->Model.TopSize = this->Plan.Size;
    if (this->Plan.Cut)
    {
      this->Model.Warnings.emplace_back("the depth map ends within Margin of the defect, and the "
                                        "model with it; make a larger map or Margin smaller");
    }
    this->FillTop();
    this->Run.SetStage(0.1, 0.6);
    for (const Loop& contour : this->Plan.Contours)
    {
      this->Outlines.push_back(
        SmoothStaircase(contour, std::sqrt(this->Scene.Spacing[0] * this->Scene.Spacing[1])));
    }
    this->ChooseFloor();
    this->Run.SetStage(0.6, 1);
    try
    {
      this->AddFaces();
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error(std::string("outlines of defects meet (") + error.what() +
        "); mark less, or make the gap between them wider than two pixels");
    }
    this->Measure();
    return std::move(this->Model);
  }

private:
  Vec2 GetNode(std::int64_t i, std::int64_t j) const // of the rectangle
  {
    return { this->Scene.Spacing[0] *
        static_cast<double>(this->Model.Column + i - this->Scene.Column),
      this->Scene.Spacing[1] * static_cast<double>(this->Model.Row + j - this->Scene.Row) };
  }

  double& Top(std::int64_t i, std::int64_t j)
  {
    return this->Model.Top[i + this->Model.TopSize.Columns * j];
  }

  // What was measured, the fit in the defect; where there is nothing, NaN.
  void FillTop()
  {
    const GridSize& size = this->Model.TopSize;
    this->Model.Top.resize(static_cast<std::size_t>(size.Columns * size.Rows));
    this->Model.TopFaces.assign(this->Model.Top.size(), ModelFace::Bone);
    this->Deepest = -std::numeric_limits<double>::infinity();
    for (std::int64_t j = 0; j < size.Rows; ++j)
    {
      for (std::int64_t i = 0; i < size.Columns; ++i)
      {
        const std::int64_t column = this->Model.Column + i;
        const std::int64_t row = this->Model.Row + j;
        const std::int64_t k = this->GetFittedIndex(column, row);
        const bool defect = k >= 0 && this->Scene.Mask[k];
        double z = this->Scene.MapDepths[column + this->Scene.MapSize.Columns * row];
        if (defect)
        {
          z = this->Scene.Fitted[k];
        }
        else if (std::isfinite(z))
        {
          this->Deepest = std::max(this->Deepest, z);
        }
        this->Top(i, j) = z;
      }
    }
    if (!std::isfinite(this->Deepest))
    {
      throw std::runtime_error(
        "no bone was measured around the defect (Depth is no number there); nothing would be left "
        "to fit a plate to");
    }
  }

  std::int64_t GetFittedIndex(std::int64_t column, std::int64_t row) const
  {
    const std::int64_t i = column - this->Scene.Column;
    const std::int64_t j = row - this->Scene.Row;
    const bool within =
      i >= 0 && j >= 0 && i < this->Scene.Size.Columns && j < this->Scene.Size.Rows;
    return within ? i + this->Scene.Size.Columns * j : -1;
  }

  void ChooseFloor()
  {
    this->FindInside();
    this->FindHighest();
    this->FindFloor();
    this->ChooseBase();
    this->LiftTop();
  }

  void FindHighest()
  {
    this->Model.Highest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < this->Model.Top.size(); ++k)
    {
      if (this->Model.TopFaces[k] == ModelFace::Bone && std::isfinite(this->Model.Top[k]))
      {
        this->Model.Highest = std::min(this->Model.Highest, this->Model.Top[k]);
      }
    }
  }

  // The floor at every point of the outlines and every pixel within, DefectDepth below the fit.
  void FindFloor()
  {
    std::vector<Vec2> places;
    for (const Loop& outline : this->Outlines)
    {
      places.insert(places.end(), outline.begin(), outline.end());
    }
    places.insert(places.end(), this->Inside.begin(), this->Inside.end());
    this->Floor.assign(places.size(), 0);
    const bool flat = this->Options.Floor == DefectFloor::Flat;
    std::atomic<std::int64_t> folded{ std::numeric_limits<std::int64_t>::max() };
    this->Run.For(static_cast<std::int64_t>(places.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          const double depth = this->Options.DefectDepth;
          if (flat)
          {
            this->Floor[k] = this->Surface.GetPoint(places[k])[2] + depth;
          }
          else if (!this->Surface.FindOffsetDepth(places[k], -depth, this->Floor[k]))
          {
            std::int64_t least = folded;
            while (k < least && !folded.compare_exchange_weak(least, k))
            {
            }
          }
        }
      });
    if (folded < static_cast<std::int64_t>(places.size()))
    {
      const Vec3 p = this->ToWorld.Point(this->Surface.GetPoint(places[folded]));
      throw std::runtime_error("a floor parallel to the fit, " +
        Rounded(this->Options.DefectDepth) + " below it, would cut itself at (" +
        FormatNumber(std::round(10 * p[0]) / 10) + ", " + FormatNumber(std::round(10 * p[1]) / 10) +
        ", " + FormatNumber(std::round(10 * p[2]) / 10) +
        "), where the fit bends more sharply or is too steep; make DefectDepth smaller, or "
        "FloorShape Flat");
    }
  }

  // Below the floor and all bone, unless MaximumHeight ends before. A flat floor is the base.
  void ChooseBase()
  {
    const double lowest = *std::max_element(this->Floor.begin(), this->Floor.end());
    this->Model.Base = std::max(lowest, this->Deepest + LeastWall);
    if (this->Options.MaximumHeight > 0)
    {
      const double limit = this->Model.Highest + this->Options.MaximumHeight;
      if (lowest > limit)
      {
        throw std::runtime_error("MaximumHeight is " + FormatNumber(this->Options.MaximumHeight) +
          " mm, but the floor of the defect lies " + Rounded(lowest - this->Model.Highest) +
          " below the highest bone; make MaximumHeight larger, or DefectDepth smaller");
      }
      this->Model.Base = std::min(this->Model.Base, limit);
    }
    if (this->Options.Floor == DefectFloor::Flat)
    {
      std::fill(this->Floor.begin(), this->Floor.end(), this->Model.Base);
    }
    this->Model.Bottom = this->Model.Base + this->Options.BaseThickness;
  }

  // Lifts what is deeper than the base, or was not measured, onto it.
  void LiftTop()
  {
    std::int64_t none = 0;
    std::int64_t cut = 0;
    for (double& z : this->Model.Top)
    {
      none += !std::isfinite(z);
      cut += z > this->Model.Base - LeastWall;
      z =
        std::isfinite(z) ? std::min(z, this->Model.Base - LeastWall) : this->Model.Base - LeastWall;
    }
    const auto share = [&](std::int64_t pixels)
    { return std::to_string(pixels) + " of " + std::to_string(this->Model.Top.size()); };
    if (none > 0)
    {
      this->Model.Warnings.push_back("no bone was measured at " + share(none) +
        " pixels of the model; it is as low as its base there");
    }
    if (cut > 0)
    {
      this->Model.Warnings.push_back(
        share(cut) + " pixels of the model lie deeper than MaximumHeight and are cut off");
    }
  }

  // The pixels within the outlines (Inside, InsidePixels) and those outside (Outside), without the
  // ones at the rectangle's border and too near to an outline. TopFaces of all.
  void FindInside()
  {
    std::vector<std::vector<Vec3>> flat;
    for (const Loop& outline : this->Outlines)
    {
      flat.emplace_back();
      for (const Vec2& p : outline)
      {
        flat.back().push_back({ p[0], p[1], 0 });
      }
    }
    const CurveIndex index(flat, 2 * this->Pixel);
    const double clearance = NodeToOutline * this->Pixel;
    const GridSize& size = this->Model.TopSize;
    for (std::int64_t j = 0; j < size.Rows; ++j)
    {
      const std::vector<double> crossings = FindCrossings(this->Outlines, this->GetNode(0, j)[1]);
      for (std::int64_t i = 0; i < size.Columns; ++i)
      {
        const Vec2 p = this->GetNode(i, j);
        const bool inside = IsInside(crossings, p[0]);
        const std::int64_t k = i + size.Columns * j;
        if (inside)
        {
          this->Model.TopFaces[k] = ModelFace::Floor;
        }
        const bool border = i == 0 || j == 0 || i + 1 == size.Columns || j + 1 == size.Rows;
        const bool near = index.Find({ p[0], p[1], 0 }, clearance).Distance < clearance;
        if (inside)
        {
          this->Inside.push_back(p);
          this->InsidePixels.push_back(k);
          this->InsideNear.push_back(near);
        }
        else if (!border && !near)
        {
          this->Outside.push_back(k);
        }
      }
    }
  }

  // Bilinear in the pixels.
  double GetBone(const Vec2& p)
  {
    const GridSize& size = this->Model.TopSize;
    const Vec2 first = this->GetNode(0, 0);
    const double u = std::clamp(
      (p[0] - first[0]) / this->Scene.Spacing[0], 0.0, static_cast<double>(size.Columns - 1));
    const double v = std::clamp(
      (p[1] - first[1]) / this->Scene.Spacing[1], 0.0, static_cast<double>(size.Rows - 1));
    const auto i = std::min(static_cast<std::int64_t>(u), size.Columns - 2);
    const auto j = std::min(static_cast<std::int64_t>(v), size.Rows - 2);
    const double s = u - static_cast<double>(i);
    const double t = v - static_cast<double>(j);
    return (1 - t) * ((1 - s) * this->Top(i, j) + s * this->Top(i + 1, j)) +
      t * ((1 - s) * this->Top(i, j + 1) + s * this->Top(i + 1, j + 1));
  }

  using Ring = std::vector<std::int32_t>;

  std::int32_t AddPoint(const Vec2& p, double z)
  {
    this->Model.Points.push_back({ p[0], p[1], z });
    return static_cast<std::int32_t>(this->Model.Points.size()) - 1;
  }

  void AddTriangle(std::int32_t a, std::int32_t b, std::int32_t c, ModelFace face)
  {
    this->Model.Triangles.push_back({ a, b, c });
    this->Model.Faces.push_back(face);
  }

  // Between a ring and the one below it, with the material on the left of both.
  void AddWall(const Ring& upper, const Ring& lower, ModelFace face)
  {
    for (std::size_t k = 0; k < upper.size(); ++k)
    {
      const std::size_t next = (k + 1) % upper.size();
      this->AddTriangle(upper[k], upper[next], lower[next], face);
      this->AddTriangle(upper[k], lower[next], lower[k], face);
    }
  }

  // The triangles between rings and over the nodes; up: seen by the viewer.
  void AddSheet(const std::vector<Ring>& rings, const Ring& nodes, bool up, ModelFace face)
  {
    std::vector<Vec2> flat;
    std::vector<std::int32_t> points;
    const auto add = [&](std::int32_t point)
    {
      points.push_back(point);
      flat.push_back({ this->Model.Points[point][0], this->Model.Points[point][1] });
      return static_cast<std::int32_t>(points.size()) - 1;
    };
    std::vector<Ring> loops;
    for (const Ring& ring : rings)
    {
      loops.emplace_back();
      for (const std::int32_t point : ring)
      {
        loops.back().push_back(add(point));
      }
    }
    for (const std::int32_t point : nodes)
    {
      add(point);
    }
    for (const auto& [a, b, c] : TriangulateRegion(flat, loops))
    {
      // counterclockwise is seen from below
      this->AddTriangle(points[a], points[up ? c : b], points[up ? b : c], face);
    }
  }

  void AddFaces()
  {
    const GridSize& size = this->Model.TopSize;
    // around the rectangle, counterclockwise
    std::vector<std::int64_t> border;
    for (std::int64_t i = 0; i + 1 < size.Columns; ++i)
    {
      border.push_back(i);
    }
    for (std::int64_t j = 0; j + 1 < size.Rows; ++j)
    {
      border.push_back(size.Columns - 1 + size.Columns * j);
    }
    for (std::int64_t i = size.Columns - 1; i > 0; --i)
    {
      border.push_back(i + size.Columns * (size.Rows - 1));
    }
    for (std::int64_t j = size.Rows - 1; j > 0; --j)
    {
      border.push_back(size.Columns * j);
    }
    Ring upper;
    Ring lower;
    for (const std::int64_t k : border)
    {
      const Vec2 p = this->GetNode(k % size.Columns, k / size.Columns);
      upper.push_back(this->AddPoint(p, this->Model.Top[k]));
      lower.push_back(this->AddPoint(p, this->Model.Bottom));
    }
    this->AddWall(upper, lower, ModelFace::Side);
    this->AddSheet({ lower }, {}, false, ModelFace::Bottom);

    std::vector<Ring> bone{ upper };
    std::vector<Ring> floor;
    std::size_t place = 0;
    for (const Loop& outline : this->Outlines)
    {
      bone.emplace_back();
      floor.emplace_back();
      for (const Vec2& p : outline)
      {
        const double top = this->GetBone(p);
        // where the bone's edge has sunk below a parallel floor, the floor gives way
        double& bottom = this->Floor[place++];
        bottom = std::max(bottom, top + LeastWall);
        bone.back().push_back(this->AddPoint(p, top));
        floor.back().push_back(this->AddPoint(p, bottom));
      }
      // the material is on the right of an outline
      this->AddWall(Ring(bone.back().rbegin(), bone.back().rend()),
        Ring(floor.back().rbegin(), floor.back().rend()), ModelFace::Wall);
    }
    Ring nodes;
    for (const std::int64_t k : this->Outside)
    {
      nodes.push_back(
        this->AddPoint(this->GetNode(k % size.Columns, k / size.Columns), this->Model.Top[k]));
    }
    this->AddSheet(bone, nodes, true, ModelFace::Bone);
    nodes.clear();
    for (std::size_t k = 0; k < this->Inside.size(); ++k)
    {
      const double z = this->Floor[place + k];
      this->Model.Top[this->InsidePixels[k]] = z;
      if (!this->InsideNear[k])
      {
        nodes.push_back(this->AddPoint(this->Inside[k], z));
      }
    }
    this->AddSheet(floor, nodes, true, ModelFace::Floor);
  }

  void Measure()
  {
    const Vec3 middle = this->Model.Points.front();
    double six = 0;
    for (const Triangle& t : this->Model.Triangles)
    {
      six += Dot(this->Model.Points[t[0]] - middle,
        Cross(this->Model.Points[t[1]] - middle, this->Model.Points[t[2]] - middle));
    }
    this->Model.Volume = six / 6;
  }

  Execution& Run;
  const DefectScene& Scene;
  const DefectModelPlan Plan;
  const ReliefSurface& Surface;
  const DefectModelOptions& Options;
  const Matrix4& ToWorld;
  double Pixel;
  double Deepest = 0;
  std::vector<Loop> Outlines;
  std::vector<Vec2> Inside;
  std::vector<std::int64_t> InsidePixels;
  std::vector<char> InsideNear;
  std::vector<std::int64_t> Outside;
  std::vector<double> Floor; // of the outlines' points, then of Inside
  DefectModel Model;
};
}

//------------------------------------------------------------------------------
DefectModel MakeDefectModel(Execution& execution, const DefectScene& scene,
  const ReliefSurface& surface, const DefectModelOptions& options, const Matrix4& toWorld)
{
  return Builder(execution, scene, surface, options, toWorld).Make();
}
}
