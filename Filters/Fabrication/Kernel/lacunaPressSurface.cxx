// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressSurface.h"

#include "lacunaExecution.h"
#include "lacunaFlangeBlend.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr int MaximumSteps = 100;
constexpr double Converged = 1e-10; // mm, across the axis of the mill
constexpr double Unfilled = 1e-9;   // mm, of the true surface

// The lesser of h and 0 with a C2 fillet where |h| < radius, and its derivative: 0 or less.
struct SoftMinimum
{
  double Value = 0;
  double Slope = 0;

  SoftMinimum(double h, double radius)
  {
    if (h <= -radius)
    {
      this->Value = h;
      this->Slope = 1;
    }
    else if (h < radius)
    {
      const double t = 0.5 * (h + radius) / radius;
      this->Value = std::min(0.0, 2 * radius * (t - t * t * t + 0.5 * t * t * t * t) - radius);
      this->Slope = 1 - t * t * (3 - 2 * t);
    }
  }
};

// What is above a node.
struct Node
{
  FlangeBlend::Value Blend;
  Vec2 Foot{};
  double Height = 0;
  Vec2 Slope{};
};

class Maker
{
public:
  Maker(const ReliefSurface& surface, GridSize size, const Vec2& spacing, const PressLayout& layout,
    const PressOptions& options, const Matrix4& toWorld)
    : View(surface, layout)
    , Size(size)
    , Spacing(spacing)
    , Layout(layout)
    , Options(options)
    , ToWorld(toWorld)
    , Nodes(static_cast<std::size_t>(layout.Grid.Columns * layout.Grid.Rows))
  {
  }

  PressSurface Run(Execution& execution, const std::vector<unsigned char>& mask)
  {
    execution.SetStage(0, 0.2);
    const FlangeBlend blend(execution, LoopDistance(this->Layout.Outlines),
      this->Options.PlateMargin, this->Options.FlangeWidth);
    execution.SetStage(0.2, 0.9);
    execution.For(this->Layout.Grid.Rows, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t j = begin; j < end; ++j)
        {
          this->FindRow(blend, j);
        }
      });
    execution.SetStage(0.9, 1);
    this->CheckSheet();
    PressSurface result = this->GetSurface(mask);
    execution.Report(1);
    return result;
  }

private:
  // Newton's method for the foot whose offset lies at p, from a guess; steps that do not come nearer
  // are halved.
  bool FindFoot(const Vec2& p, Vec2& foot) const
  {
    PressView::Sample sample = this->View.Get(foot);
    double miss[2] = { p[0] - sample.Point[0], p[1] - sample.Point[1] };
    double distance = std::hypot(miss[0], miss[1]);
    for (int step = 0; step < MaximumSteps && distance > Converged; ++step)
    {
      const Vec3& x = sample.AlongX;
      const Vec3& y = sample.AlongY;
      const double determinant = x[0] * y[1] - x[1] * y[0];
      if (determinant == 0)
      {
        return false;
      }
      const double dx = (miss[0] * y[1] - miss[1] * y[0]) / determinant;
      const double dy = (x[0] * miss[1] - x[1] * miss[0]) / determinant;
      bool nearer = false;
      for (double factor = 1; factor > 1e-4 && !nearer; factor *= 0.5)
      {
        const Vec2 next{ foot[0] + factor * dx, foot[1] + factor * dy };
        const PressView::Sample there = this->View.Get(next);
        const double left[2] = { p[0] - there.Point[0], p[1] - there.Point[1] };
        if (std::hypot(left[0], left[1]) < distance)
        {
          nearer = true;
          foot = next;
          sample = there;
          miss[0] = left[0];
          miss[1] = left[1];
          distance = std::hypot(left[0], left[1]);
        }
      }
      if (!nearer)
      {
        return false;
      }
    }
    return distance <= Converged;
  }

  // The sample whose offset is nearest to p.
  Vec2 FindNearestSample(const Vec2& p) const
  {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < this->Layout.Images.size(); ++k)
    {
      const Vec2& q = this->Layout.Images[k];
      const double square = (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]);
      if (square < least)
      {
        least = square;
        nearest = k;
      }
    }
    const auto k = static_cast<std::int64_t>(nearest);
    const PlanarGrid& samples = this->Layout.Samples;
    return samples.GetNode(k % samples.Columns, k / samples.Columns);
  }

  void FindRow(const FlangeBlend& blend, std::int64_t j)
  {
    const PlanarGrid& grid = this->Layout.Grid;
    bool hasGuess = false;
    Vec2 guess{};
    for (std::int64_t i = 0; i < grid.Columns; ++i)
    {
      Node& node = this->Nodes[i + grid.Columns * j];
      const Vec2 p = grid.GetNode(i, j);
      node.Blend = blend.Evaluate(p);
      if (node.Blend.Weight == 0)
      {
        hasGuess = false;
        continue;
      }
      node.Foot = hasGuess ? guess : this->FindNearestSample(p);
      if (!this->FindFoot(p, node.Foot))
      {
        node.Foot = this->FindNearestSample(p);
        if (!this->FindFoot(p, node.Foot))
        {
          ThrowFold(this->View.GetPoint(node.Foot), this->Options, this->ToWorld);
        }
      }
      const PressView::Sample sample = this->View.Get(node.Foot);
      if (!(sample.Stretch >= LeastStretch && sample.Normal[2] > 0))
      {
        ThrowFold(this->View.GetPoint(node.Foot), this->Options, this->ToWorld);
      }
      node.Height = sample.Point[2];
      node.Slope = { -sample.Normal[0] / sample.Normal[2], -sample.Normal[1] / sample.Normal[2] };
      guess = node.Foot;
      hasGuess = true;
    }
  }

  // Whether the levelled relief is the relief.
  bool IsInCore(const Vec2& foot) const
  {
    const Vec2& low = this->Layout.CoreLow;
    const Vec2& high = this->Layout.CoreHigh;
    return foot[0] >= low[0] && foot[0] <= high[0] && foot[1] >= low[1] && foot[1] <= high[1];
  }

  // Feet of neighbours must turn the same way everywhere: otherwise the offset cuts itself.
  void CheckSheet() const
  {
    const PlanarGrid& grid = this->Layout.Grid;
    const double turn = this->Layout.Side == PressSide::IntoBody ? 1 : -1;
    for (std::int64_t j = 0; j + 1 < grid.Rows; ++j)
    {
      for (std::int64_t i = 0; i + 1 < grid.Columns; ++i)
      {
        const Node& node = this->Nodes[i + grid.Columns * j];
        const Node& right = this->Nodes[i + 1 + grid.Columns * j];
        const Node& below = this->Nodes[i + grid.Columns * (j + 1)];
        if (node.Blend.Weight == 0 || right.Blend.Weight == 0 || below.Blend.Weight == 0)
        {
          continue;
        }
        const double area = (right.Foot[0] - node.Foot[0]) * (below.Foot[1] - node.Foot[1]) -
          (right.Foot[1] - node.Foot[1]) * (below.Foot[0] - node.Foot[0]);
        if (!(turn * area > 0))
        {
          ThrowFold(this->View.GetPoint(node.Foot), this->Options, this->ToWorld);
        }
      }
    }
  }

  PressSurface GetSurface(const std::vector<unsigned char>& mask) const
  {
    const PlanarGrid& grid = this->Layout.Grid;
    const bool female = this->Options.Mould == PressMould::Female;
    // heights as of a cavity: below the plane
    const double sign = female ? 1 : -1;
    const double fillet = FilletPerWidth * this->Options.FlangeWidth;
    const double plane = sign * this->Layout.Top + fillet;
    PressSurface result;
    const Vec3 middle{ grid.Origin[0] + 0.5 * this->Layout.BlockSize[0],
      grid.Origin[1] + 0.5 * this->Layout.BlockSize[1], sign * plane };
    const Matrix4& turn = this->Layout.Frame.Rotation;
    // the inverse of a rotation is its transpose
    const Matrix4 back = Matrix4::FromColumns({ turn(0, 0), turn(0, 1), turn(0, 2) },
      { turn(1, 0), turn(1, 1), turn(1, 2) }, { turn(2, 0), turn(2, 1), turn(2, 2) }, { 0, 0, 0 });
    result.PressToRelief = back * Matrix4::Translation(middle);
    for (std::int64_t j = 0; j < grid.Rows; ++j)
    {
      for (std::int64_t i = 0; i < grid.Columns; ++i)
      {
        const Node& node = this->Nodes[i + grid.Columns * j];
        const double w = node.Blend.Weight;
        const SoftMinimum below(sign * node.Height - plane, fillet); // of no use without weight
        // exactly the same distances on both sides of the middle
        const double x = (static_cast<double>(i) - 0.5 * static_cast<double>(grid.Columns - 1));
        const double y = (static_cast<double>(j) - 0.5 * static_cast<double>(grid.Rows - 1));
        result.Points.push_back(
          { x * grid.Spacing[0], y * grid.Spacing[1], w > 0 ? sign * w * below.Value : 0 });
        const double filled = sign * node.Height - plane - below.Value; // by the fillet
        const bool plate = w == 1 && std::abs(filled) < Unfilled && this->IsInCore(node.Foot);
        result.Regions.push_back(w == 0 ? PressRegion::Plane
            : plate                     ? PressRegion::Plate
                                        : PressRegion::Flange);
        const double column = std::round(node.Foot[0] / this->Spacing[0]);
        const double row = std::round(node.Foot[1] / this->Spacing[1]);
        const bool inside = w > 0 && column >= 0 && row >= 0 &&
          column < static_cast<double>(this->Size.Columns) &&
          row < static_cast<double>(this->Size.Rows);
        result.Defect.push_back(inside &&
          mask[static_cast<std::int64_t>(column) +
            this->Size.Columns * static_cast<std::int64_t>(row)] != 0);
        double slope[2] = { 0, 0 };
        for (int a = 0; a < 2 && w > 0; ++a)
        {
          slope[a] = node.Blend.Gradient[a] * sign * below.Value + w * below.Slope * node.Slope[a];
        }
        result.WallAngles.push_back(Degrees * std::atan(std::hypot(slope[0], slope[1])));
        result.Depth = std::max(result.Depth, std::abs(result.Points.back()[2]));
        result.DraftAngle = std::max(result.DraftAngle, result.WallAngles.back());
      }
    }
    result.BlockSize = this->Layout.BlockSize;
    if (result.BlockSize[2] == 0)
    {
      result.BlockSize[2] = result.Depth + BlockFloor;
    }
    else if (result.BlockSize[2] <= result.Depth)
    {
      throw std::runtime_error("the block is too small: BlockSize is " +
        FormatNumber(result.BlockSize[2]) + " mm along z, and the mould is " +
        FormatNumber(std::ceil(10 * result.Depth) / 10) +
        " mm deep; make it higher (0: as low as it takes)");
    }
    return result;
  }

  PressView View;
  GridSize Size;
  Vec2 Spacing;
  const PressLayout& Layout;
  const PressOptions& Options;
  const Matrix4& ToWorld;
  std::vector<Node> Nodes;
};
}

//------------------------------------------------------------------------------
PressSurface MakePressSurface(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const PressLayout& layout,
  const PressOptions& options, const Matrix4& toWorld)
{
  const Execution::NestedStages nested(execution);
  return Maker(surface, size, spacing, layout, options, toWorld).Run(execution, mask);
}
}
