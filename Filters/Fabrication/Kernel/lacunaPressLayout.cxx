// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressLayout.h"

#include "lacunaDepthPlane.h"
#include "lacunaExecution.h"
#include "lacunaFlangeBlend.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
//------------------------------------------------------------------------------
LevelledRelief::LevelledRelief(
  const ReliefSurface& relief, const Vec2& slopes, const Vec2& low, const Vec2& high)
  : Relief(relief)
  , Slopes(slopes)
  , Low(low)
  , High(high)
{
}

//------------------------------------------------------------------------------
LevelledRelief::Argument LevelledRelief::GetArgument(int axis, double x) const
{
  if (x >= this->Low[axis] && x <= this->High[axis])
  {
    return { x, 1, 0 };
  }
  // The slope falls from 1 to 0 as a cubic with level ends, over twice the way there is.
  const bool above = x > this->High[axis];
  const double sign = above ? 1 : -1;
  const double from = above ? this->High[axis] : this->Low[axis];
  const double room = above ? this->Relief.GetExtent()[axis] - from : from;
  const double t = room > 0 ? std::min(1.0, sign * (x - from) / (2 * room)) : 1;
  return { from + sign * (t < 1 ? 2 * room * (t - t * t * t + 0.5 * t * t * t * t) : room),
    1 - t * t * (3 - 2 * t), t < 1 ? -sign * 6 * t * (1 - t) / (2 * room) : 0 };
}

//------------------------------------------------------------------------------
ReliefSurface::Frame LevelledRelief::GetFrame(const Vec2& p) const
{
  const Argument x = this->GetArgument(0, p[0]);
  const Argument y = this->GetArgument(1, p[1]);
  const auto f = this->Relief.GetDerivatives({ x.Value, y.Value });
  ReliefSurface::Derivatives g;
  g.F = f.F + this->Slopes[0] * (p[0] - x.Value) + this->Slopes[1] * (p[1] - y.Value);
  g.X = f.X * x.First + this->Slopes[0] * (1 - x.First);
  g.Y = f.Y * y.First + this->Slopes[1] * (1 - y.First);
  g.XX = f.XX * x.First * x.First + (f.X - this->Slopes[0]) * x.Second;
  g.XY = f.XY * x.First * y.First;
  g.YY = f.YY * y.First * y.First + (f.Y - this->Slopes[1]) * y.Second;
  return ReliefSurface::MakeFrame(p, g);
}

//------------------------------------------------------------------------------
//------------------------------------------------------------------------------
PressFrame MakePressFrame(const Vec3& normal, PressSide side)
{
  if (!IsFinite(normal) || !(std::abs(normal[2]) > 1e-6 * Norm(normal)))
  {
    throw std::invalid_argument("the plane of the fit stands on edge in the depth map (its normal "
                                "is not a number or perpendicular to the view)");
  }
  const double c1 = -normal[0] / normal[2];
  const double c2 = -normal[1] / normal[2];
  PressFrame frame;
  frame.Theta = std::atan(-c2 / std::sqrt(1 + c1 * c1));
  frame.Psi = std::atan(c1);
  frame.Rotation =
    Matrix4::Rotation({ 1, 0, 0 }, frame.Theta) * Matrix4::Rotation({ 0, 1, 0 }, frame.Psi);
  frame.Inwards = Normalized({ -c1, -c2, 1 });
  if (side == PressSide::TowardsViewer)
  {
    frame.Rotation =
      Matrix4::FromColumns({ 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 0, 0, 0 }) * frame.Rotation;
  }
  return frame;
}

//------------------------------------------------------------------------------
Vec3 FitPlaneNormal(GridSize size, const std::vector<double>& depths, const Vec2& spacing,
  const std::vector<unsigned char>& mask)
{
  const auto forEach = [&](auto&& body)
  {
    for (std::int64_t j = 0; j < size.Rows; ++j)
    {
      for (std::int64_t i = 0; i < size.Columns; ++i)
      {
        const std::int64_t k = i + size.Columns * j;
        if (mask.empty() || mask[k])
        {
          body(Vec3{
            static_cast<double>(i) * spacing[0], static_cast<double>(j) * spacing[1], depths[k] });
        }
      }
    }
  };
  const DepthPlane plane = FitDepthPlane(forEach);
  if (!plane.IsUnique)
  {
    throw std::invalid_argument("the pixels of the defect lie on a line; there is no plane through "
                                "them");
  }
  return Normalized({ plane.Coefficients[1], plane.Coefficients[2], -1 });
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr double PlainRim = 5;       // mm of press plane around the flange, when the block is ours
constexpr double MaximumNodes = 1e8; // of the mould
constexpr double BytesPerNode = 160;
constexpr double Flat = 1e-9;  // 1/mm
constexpr int SubSamples = 8;  // along each side of a pixel, where plate and margin may be highest
constexpr double LeastRim = 2; // mm of relief in which levelling begins

std::string Tenths(double value)
{
  return FormatNumber(std::round(10 * value) / 10);
}

void CheckOptions(const PressOptions& o)
{
  Properties properties;
  o.Describe(properties);
  properties.Check();
  ValueRange::Above(0, "mm").Check("OutputSpacing", o.Spacing);
  if (o.Spacing > (1 + 1e-9) * o.FlangeWidth / NodesPerFlange)
  {
    throw std::invalid_argument("OutputSpacing is " + FormatNumber(o.Spacing) +
      " mm, too coarse for a flange of " + FormatNumber(o.FlangeWidth) +
      " mm (FlangeWidth); it must be at most an eighth of that, " +
      FormatNumber(o.FlangeWidth / NodesPerFlange) + " mm");
  }
}

// Outer contours of the defects, on the relief.
std::vector<Loop> FindOutlines(GridSize size, const Vec2& spacing,
  const std::vector<unsigned char>& mask, const ReliefSurface& surface)
{
  PlanarGrid grid;
  grid.Origin = { -spacing[0], -spacing[1] };
  grid.Spacing = spacing;
  grid.Columns = size.Columns + 2;
  grid.Rows = size.Rows + 2;
  std::vector<double> padded(static_cast<std::size_t>(grid.Columns * grid.Rows), 0);
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < size.Columns; ++i)
    {
      padded[i + 1 + (j + 1) * grid.Columns] = mask[i + j * size.Columns] ? 1 : 0;
    }
  }
  std::vector<Loop> outlines;
  for (Loop& loop : FindContours(grid, padded, 0.5))
  {
    if (SignedArea(loop) > 0) // the others go around islands
    {
      for (Vec2& p : loop)
      {
        p = { std::clamp(p[0], 0.0, surface.GetExtent()[0]),
          std::clamp(p[1], 0.0, surface.GetExtent()[1]) };
      }
      outlines.push_back(std::move(loop));
    }
  }
  return outlines;
}

// Whether the surface bulges to the viewer over the defects, by the integral of its mean curvature,
// which knows no slopes.
bool BulgesOutward(const std::vector<unsigned char>& mask, GridSize size, const Vec2& spacing,
  const ReliefSurface& surface)
{
  double sum = 0;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(mask.size()); ++k)
  {
    if (mask[k])
    {
      const auto frame = surface.GetFrame({ static_cast<double>(k % size.Columns) * spacing[0],
        static_cast<double>(k / size.Columns) * spacing[1] });
      sum += frame.Curvatures[0] + frame.Curvatures[1];
    }
  }
  return sum <= Flat * static_cast<double>(mask.size()); // a plane is as good as a bulge
}

class Planner
{
public:
  Planner(const ReliefSurface& surface, GridSize size, const Vec2& spacing,
    const PressOptions& options, const Matrix4& toWorld, PressLayout& layout)
    : Surface(surface)
    , Options(options)
    , ToWorld(toWorld)
    , Layout(layout)
  {
    layout.CoreHigh = surface.GetExtent();
    layout.Samples = { { 0, 0 }, spacing, size.Columns, size.Rows };
  }

  void Run(
    Execution& execution, const std::vector<Loop>& outlines, const std::vector<unsigned char>& mask)
  {
    const double margin = this->Options.PlateMargin;
    const PressView view(this->Surface, this->Layout);
    for (const Loop& loop : outlines)
    {
      Loop image;
      for (const Vec2& p : loop)
      {
        const Vec3 point = view.Get(p).Point;
        image.push_back({ point[0], point[1] });
      }
      this->Layout.Outlines.push_back(std::move(image));
    }
    const LoopDistance curves(this->Layout.Outlines);
    this->TakeSamples(execution, view);
    std::vector<unsigned char> used = this->FindUsed(execution, curves, margin);
    std::transform(used.begin(), used.end(), mask.begin(), used.begin(),
      [](unsigned char a, unsigned char b) { return a || b; });
    if (!this->IsSeen(used, view))
    {
      return;
    }
    this->CheckFolds(used, view);
    this->ChooseCore(curves, used);

    const double reach = margin + this->Options.FlangeWidth;
    this->GrowSamples(reach);
    const PressView levelled(this->Surface, this->Layout);
    this->TakeSamples(execution, levelled);
    used = this->FindUsed(execution, curves, reach);
    if (this->IsSeen(used, levelled))
    {
      this->CheckFolds(used, levelled);
      this->PlaceBlock(curves);
      this->FindTop(execution, curves, levelled);
    }
  }

private:
  void TakeSamples(Execution& execution, const PressView& view)
  {
    const PlanarGrid& samples = this->Layout.Samples;
    const auto count = static_cast<std::size_t>(samples.Columns * samples.Rows);
    this->Layout.Images.resize(count);
    this->Heights.resize(count);
    this->Facing.resize(count);
    this->Stretch.resize(count);
    execution.For(samples.Rows, 8,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin * samples.Columns; k < end * samples.Columns; ++k)
        {
          const auto sample = view.Get(this->GetFoot(static_cast<std::size_t>(k)));
          this->Layout.Images[k] = { sample.Point[0], sample.Point[1] };
          this->Heights[k] = sample.Point[2];
          this->Facing[k] = sample.Normal[2];
          this->Stretch[k] = sample.Stretch;
        }
      });
  }

  Vec2 GetFoot(std::size_t k) const
  {
    const auto at = static_cast<std::int64_t>(k);
    return this->Layout.Samples.GetNode(
      at % this->Layout.Samples.Columns, at / this->Layout.Samples.Columns);
  }

  // The samples whose offsets are less than limit away from the defect in the press plane.
  std::vector<unsigned char> FindUsed(
    Execution& execution, const LoopDistance& curves, double limit) const
  {
    std::vector<unsigned char> used(this->Facing.size());
    execution.For(static_cast<std::int64_t>(used.size()), 4096,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          used[k] = curves.Find(this->Layout.Images[k], limit) < limit;
        }
      });
    return used;
  }

  // The sample for which values are least, of those that are used.
  static std::size_t FindLeast(
    const std::vector<double>& values, const std::vector<unsigned char>& used)
  {
    std::size_t least = values.size();
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      if (used[k] && (least == values.size() || values[k] < values[least]))
      {
        least = k;
      }
    }
    return least; // there is one: the defect is not empty
  }

  bool IsSeen(const std::vector<unsigned char>& used, const PressView& view)
  {
    const std::size_t steepest = FindLeast(this->Facing, used);
    this->Layout.SteepestPoint = view.GetPoint(this->GetFoot(steepest));
    this->Layout.SteepestAngle = Degrees * std::acos(std::clamp(this->Facing[steepest], -1.0, 1.0));
    this->Layout.SingleValued = this->Facing[steepest] > 0;
    return this->Layout.SingleValued;
  }

  void CheckFolds(const std::vector<unsigned char>& used, const PressView& view) const
  {
    const std::size_t tightest = FindLeast(this->Stretch, used);
    if (this->Stretch[tightest] < LeastStretch)
    {
      ThrowFold(view.GetPoint(this->GetFoot(tightest)), this->Options, this->ToWorld);
    }
  }

  // The part of the relief that is kept, and whether there is some left around it.
  void ChooseCore(const LoopDistance& curves, const std::vector<unsigned char>& used)
  {
    const PlanarGrid& samples = this->Layout.Samples;
    const double pixel = std::max(samples.Spacing[0], samples.Spacing[1]);
    const double margin = this->Options.PlateMargin;
    const double needed = margin + std::max(LeastRim, 3 * pixel);
    double reach = needed;
    Vec2 low = this->Layout.CoreHigh;
    Vec2 high = this->Layout.CoreLow;
    for (std::size_t k = 0; k < used.size(); ++k)
    {
      const auto i = static_cast<std::int64_t>(k) % samples.Columns;
      const auto j = static_cast<std::int64_t>(k) / samples.Columns;
      if (i == 0 || j == 0 || i + 1 == samples.Columns || j + 1 == samples.Rows)
      {
        reach = curves.Find(this->Layout.Images[k], reach);
      }
      if (used[k])
      {
        const Vec2 p = samples.GetNode(i, j);
        for (int a = 0; a < 2; ++a)
        {
          low[a] = std::min(low[a], p[a]);
          high[a] = std::max(high[a], p[a]);
        }
      }
    }
    if (reach < needed)
    {
      throw std::runtime_error("the fitted surface reaches only " + Tenths(reach) +
        " mm beyond the defect, and " + Tenths(needed) + " mm are needed for PlateMargin (" +
        FormatNumber(margin) +
        " mm) and the beginning of the flange; raise OutputMargin of RBF Hole "
        "Filler by " +
        FormatNumber(std::ceil(needed - reach)) +
        " mm or more (the depth map must reach so far), or make PlateMargin smaller");
    }
    for (int a = 0; a < 2; ++a)
    {
      // used points may lie up to a sample beyond
      this->Layout.CoreLow[a] = std::max(0.0, low[a] - samples.Spacing[a]);
      this->Layout.CoreHigh[a] =
        std::min(this->Surface.GetExtent()[a], high[a] + samples.Spacing[a]);
    }
  }

  // Levelled ground looks no smaller to the mill than to the viewer.
  void GrowSamples(double reach)
  {
    PlanarGrid& samples = this->Layout.Samples;
    std::int64_t* count[2] = { &samples.Columns, &samples.Rows };
    double nodes = 1;
    for (int a = 0; a < 2; ++a)
    {
      const double more =
        std::ceil((1.2 * reach + 2 + std::abs(this->Layout.Offset)) / samples.Spacing[a]);
      nodes *= static_cast<double>(*count[a]) + 2 * more;
      if (!(nodes <= MaximumNodes))
      {
        throw std::runtime_error("FlangeWidth (" + FormatNumber(this->Options.FlangeWidth) +
          " mm) is too large for the pixels of this depth map; make it smaller");
      }
      samples.Origin[a] -= more * samples.Spacing[a];
      *count[a] += 2 * static_cast<std::int64_t>(more);
    }
  }

  void PlaceBlock(const LoopDistance& curves)
  {
    const double reach = this->Options.PlateMargin + this->Options.FlangeWidth;
    PlanarGrid& grid = this->Layout.Grid;
    double nodes = 1;
    double count[2];
    for (int i = 0; i < 2; ++i)
    {
      const double needed = curves.GetHigh()[i] - curves.GetLow()[i] + 2 * reach;
      const double given = this->Options.BlockSize[i];
      const char axis = i == 0 ? 'x' : 'y';
      if (given != 0 && given < needed)
      {
        throw std::runtime_error(std::string("the block is too small: BlockSize is ") +
          FormatNumber(given) + " mm along " + axis + ", and plate and flange need " +
          Tenths(needed + 0.05) + " mm; make it larger (0: as small as it takes)");
      }
      const double size = given != 0 ? given : needed + 2 * PlainRim;
      count[i] = std::max(1.0, std::ceil(size / this->Options.Spacing - 1e-9));
      nodes *= count[i] + 1;
      grid.Spacing[i] = given != 0 ? given / count[i] : this->Options.Spacing;
      this->Layout.BlockSize[i] = given != 0 ? given : count[i] * this->Options.Spacing;
      grid.Origin[i] =
        0.5 * (curves.GetLow()[i] + curves.GetHigh()[i]) - 0.5 * this->Layout.BlockSize[i];
    }
    this->Layout.BlockSize[2] = this->Options.BlockSize[2];
    if (!(nodes <= MaximumNodes))
    {
      throw std::runtime_error("OutputSpacing " + FormatNumber(this->Options.Spacing) +
        " mm would give " + FormatNumber(nodes) + " nodes, " + DescribeBytes(BytesPerNode * nodes) +
        "; make it larger");
    }
    RequireMemory("the mould", BytesPerNode * nodes);
    grid.Columns = static_cast<std::int64_t>(count[0]) + 1;
    grid.Rows = static_cast<std::int64_t>(count[1]) + 1;
  }

  // Between the samples that may be next to the highest point lie more, and what they may miss at
  // the border of the margin is within their distance.
  void FindTop(Execution& execution, const LoopDistance& curves, const PressView& view)
  {
    const PlanarGrid& samples = this->Layout.Samples;
    const double pixel = std::hypot(samples.Spacing[0], samples.Spacing[1]);
    const double limit = this->Options.PlateMargin + pixel / SubSamples;
    const double sign = this->Options.Mould == PressMould::Female ? 1 : -1;
    double top = -std::numeric_limits<double>::infinity();
    const std::vector<unsigned char> inside = this->FindUsed(execution, curves, limit);
    for (std::size_t k = 0; k < inside.size(); ++k)
    {
      top = inside[k] ? std::max(top, sign * this->Heights[k]) : top;
    }
    const double coarse = top;
    const std::vector<unsigned char> near = this->FindUsed(execution, curves, limit + 2 * pixel);
    for (std::size_t k = 0; k < near.size(); ++k)
    {
      const double cosine = std::max(this->Facing[k], 1e-3);
      const double rise = pixel * (0.1 + std::sqrt(1 - std::min(1.0, cosine * cosine)) / cosine);
      if (!near[k] || sign * this->Heights[k] + rise < coarse)
      {
        continue;
      }
      const Vec2 middle = this->GetFoot(k);
      for (int a = 0; a <= SubSamples * SubSamples + 2 * SubSamples; ++a)
      {
        const Vec2 foot{ middle[0] +
            (static_cast<double>(a % (SubSamples + 1)) / SubSamples - 0.5) * samples.Spacing[0],
          middle[1] +
            (static_cast<double>(a / (SubSamples + 1)) / SubSamples - 0.5) * samples.Spacing[1] };
        const Vec3 point = view.Get(foot).Point;
        if (sign * point[2] > top && curves.Find({ point[0], point[1] }, limit) < limit)
        {
          top = sign * point[2];
        }
      }
    }
    this->Layout.Top = sign * top;
  }

  const ReliefSurface& Surface;
  const PressOptions& Options;
  const Matrix4& ToWorld;
  PressLayout& Layout;
  std::vector<double> Heights; // of the samples
  std::vector<double> Facing;
  std::vector<double> Stretch;
};
}

//------------------------------------------------------------------------------
void PressOptions::Describe(Properties& properties) const
{
  properties.Add("Mould", static_cast<int>(this->Mould), PressMouldNames)
    .Add("Seating", static_cast<int>(this->Seating), PlateSeatingNames)
    .Add("PlateThickness", this->PlateThickness, ValueRange::Above(0, "mm"))
    .Add("PlateMargin", this->PlateMargin, ValueRange::AtLeast(0, "mm"))
    .Add("FlangeWidth", this->FlangeWidth, ValueRange::Above(0, "mm"))
    .Add("BlockSize", this->BlockSize.Elements, ValueRange::Above(0, "mm").OrZero("automatic"))
    .Add("OutputSpacing", this->Spacing, ValueRange::Above(0, "mm").OrZero("of the map"))
    .Add("ConvexSide", static_cast<int>(this->Convex), ConvexSideNames);
}

//------------------------------------------------------------------------------
Vec3 FindFacingView(const ReliefSurface& surface, GridSize size, const Vec2& spacing,
  const std::vector<unsigned char>& mask, double margin)
{
  const LoopDistance curves(FindOutlines(size, spacing, mask, surface));
  Vec3 area{};
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(mask.size()); ++k)
  {
    const Vec2 p{ static_cast<double>(k % size.Columns) * spacing[0],
      static_cast<double>(k / size.Columns) * spacing[1] };
    if (mask[k] || curves.Find(p, margin) < margin)
    {
      const Vec3 normal = surface.GetFrame(p).Normal; // towards the viewer, at lesser z
      area = area + 1 / normal[2] * normal;           // of a pixel's part of the surface
    }
  }
  return Normalized(area);
}

//------------------------------------------------------------------------------
std::string FormatPlace(const Matrix4& toWorld, const Vec3& p)
{
  const Vec3 world = toWorld.Point(p);
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(1);
  text << std::fixed << "(" << world[0] << ", " << world[1] << ", " << world[2] << ")";
  return text.str();
}

//------------------------------------------------------------------------------
void ThrowFold(const Vec3& point, const PressOptions& options, const Matrix4& toWorld)
{
  throw std::runtime_error("the surface bends with a radius below PlateThickness (" +
    FormatNumber(options.PlateThickness) + " mm) at " + FormatPlace(toWorld, point) +
    ": the plate's other face would fold there. Choose the other Mould or Seating, a thinner "
    "plate, "
    "or smooth the fit (Smoothing or CutoffWavelength of RBF Hole Filler)");
}

//------------------------------------------------------------------------------
PressView::Sample PressView::Get(const Vec2& foot) const
{
  const ReliefSurface::Frame frame = this->Surface.GetFrame(foot);
  Sample sample;
  sample.Point = this->Rotation.Vector(frame.Offset(this->Offset));
  sample.AlongX = this->Rotation.Vector(frame.AlongX + this->Offset * frame.NormalAlongX);
  sample.AlongY = this->Rotation.Vector(frame.AlongY + this->Offset * frame.NormalAlongY);
  sample.Normal = this->Sign * this->Rotation.Vector(frame.Normal);
  sample.Stretch =
    1 - std::max(this->Offset * frame.Curvatures[0], this->Offset * frame.Curvatures[1]);
  return sample;
}

//------------------------------------------------------------------------------
PressLayout PlanPress(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const Vec3& normal,
  const PressOptions& options, const Matrix4& toWorld)
{
  CheckOptions(options);
  const std::vector<Loop> outlines = FindOutlines(size, spacing, mask, surface);
  if (outlines.empty())
  {
    throw std::runtime_error("no sample of the surface is marked as defect");
  }
  PressLayout layout;
  layout.ConvexOutward = options.Convex == ConvexSide::Automatic
    ? BulgesOutward(mask, size, spacing, surface)
    : options.Convex == ConvexSide::Outward;
  layout.Side = layout.ConvexOutward == (options.Mould == PressMould::Female)
    ? PressSide::IntoBody
    : PressSide::TowardsViewer;
  layout.Frame = MakePressFrame(normal, layout.Side);
  layout.Slopes = { -normal[0] / normal[2], -normal[1] / normal[2] };
  // the mould lies beyond the plate as the mill sees it
  const double outer = options.Seating == PlateSeating::Onlay ? options.PlateThickness : 0;
  layout.Offset = layout.Side == PressSide::IntoBody ? outer : outer - options.PlateThickness;
  Planner(surface, size, spacing, options, toWorld, layout).Run(execution, outlines, mask);
  return layout;
}
}
