// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSupportSelection.h"

#include "lacunaDepthDiscontinuity.h"
#include "lacunaDistanceTransform.h"
#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;

// Above it an edge is steep (SteepEdges).
double SteepSlope()
{
  return std::tan(DiscontinuityLimits().MaximumAngle * (Pi / 180));
}

// Share of the edge of a defect without support from which on a fit is said to extrapolate.
constexpr double WarnedShare = 0.25;

std::string Locate(const MapGrid& grid, std::size_t pixel)
{
  std::ostringstream text;
  text << "first at column " << grid.GetColumn(pixel) << ", row " << grid.GetRow(pixel);
  return text.str();
}

// The pixels that may carry the fit, whatever their depths.
MapMask FindCandidates(Execution& execution, const MarkedMap& map, double margin)
{
  const bool painted = !map.Painted.empty();
  MapMask support(map.Grid.GetSize());
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    support[pixel] = map.Valid[pixel] && !map.Defect[pixel] && (!painted || map.Painted[pixel]);
  }
  if (!painted)
  {
    support = SelectWithin(execution, map.Grid, map.Defect, margin, support);
  }
  if (std::find(support.begin(), support.end(), 1) == support.end())
  {
    std::ostringstream message;
    message << "there is no surface to fit: outside of the defect no pixel ";
    if (painted)
    {
      message << "that is marked as support has a depth";
    }
    else
    {
      message << "within SupportMargin = " << margin
              << " mm of it has a depth; raise SupportMargin or mark a smaller defect";
    }
    throw std::invalid_argument(message.str());
  }
  return support;
}

void MarkWithoutPrior(
  const MarkedMap& map, const std::vector<double>& prior, SupportSelection& selection)
{
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t pixel = 0; pixel < prior.size(); ++pixel)
  {
    if (selection.Support[pixel] && std::isnan(prior[pixel]))
    {
      selection.Use[pixel] = SupportUse::NoPrior;
      first = count++ == 0 ? pixel : first;
    }
  }
  const auto support =
    static_cast<std::size_t>(std::count(selection.Support.begin(), selection.Support.end(), 1));
  if (count > 0 && count < support)
  {
    std::ostringstream message;
    message
      << "at " << count << " pixels around the defect, " << Locate(map.Grid, first)
      << ", the prior surface is missing or lies beyond a depth step; the bone takes its place "
      << "there";
    selection.Warnings.push_back(message.str());
  }
  if (count == support)
  {
    throw std::invalid_argument(
      "the prior surface is nowhere around the defect; it must lie in the "
      "same patient coordinates and be seen in this view");
  }
}

// Whether the edge to the next pixel of the row, or of the column, is steep: depths are uncertain
// there, since a small shift of the surface across the view is a large one along it.
class SteepEdges
{
public:
  explicit SteepEdges(const MarkedMap& map)
    : Map(map)
    , Width(map.Grid.Width)
    , Rule(DiscontinuityLimits())
  {
  }

  // Calls visit(pixel, next) of each steep edge between pixels of mask.
  template <class Visitor>
  void ForEach(const MapMask& mask, const Visitor& visit) const
  {
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
    {
      const auto test = [&](bool inside, std::size_t next, double spacing)
      {
        if (inside && mask[pixel] && mask[next] &&
          this->Rule.IsSteep({ this->Map.Depth[next] - this->Map.Depth[pixel], spacing }))
        {
          visit(pixel, next);
        }
      };
      test((pixel + 1) % this->Width != 0, pixel + 1, this->Map.Grid.Spacing[0]);
      test(pixel + this->Width < mask.size(), pixel + this->Width, this->Map.Grid.Spacing[1]);
    }
  }

private:
  const MarkedMap& Map;
  std::size_t Width;
  SlopeRule Rule;
};

// The pixels within margin of a steep edge or of a pixel without a depth; none if margin is 0.
MapMask FindNearSteps(
  Execution& execution, const MarkedMap& map, double margin, const MapMask& candidates)
{
  if (!(margin > 0))
  {
    return MapMask(candidates.size(), 0);
  }
  MapMask steps(map.Valid.size());
  std::transform(
    map.Valid.begin(), map.Valid.end(), steps.begin(), [](unsigned char v) { return v ? 0 : 1; });
  SteepEdges(map).ForEach(map.Valid,
    [&](std::size_t pixel, std::size_t next)
    {
      steps[pixel] = 1;
      steps[next] = 1;
    });
  return SelectWithin(execution, map.Grid, steps, margin, candidates);
}

// Before those near steps: what the margin takes makes a gap of a step, over which the depths of
// both sides look like those of one surface.
void LeaveOutBeyondSteps(
  const MarkedMap& map, const StepSlopes& slopes, const MapMask& near, SupportSelection& selection)
{
  const MapMask before = selection.Support;
  const StepReport steps = RemoveBeyondSteps(map.Grid, map.Depth, slopes, selection.Support);
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t pixel = 0; pixel < before.size(); ++pixel)
  {
    // What is near the step, too, was asked to be left out.
    if (before[pixel] && !selection.Support[pixel] && !near[pixel])
    {
      selection.Use[pixel] = SupportUse::BeyondStep;
      first = count++ == 0 ? pixel : first;
    }
  }
  if (count > 0)
  {
    std::ostringstream message;
    message << count << " pixels around the defect, " << Locate(map.Grid, first)
            << ", lie beyond a depth step of up to " << steps.LargestStep
            << " mm from the rest and were not used for the fit: a part that "
            << "is seen through the hole, or the far side of an edge. Mark them as defect if they "
            << "shall be replaced, or choose a view in which the surface is not so steep";
    selection.Warnings.push_back(message.str());
  }
}

void LeaveOutNearSteps(double margin, const MapMask& near, SupportSelection& selection)
{
  for (std::size_t pixel = 0; pixel < near.size(); ++pixel)
  {
    if (near[pixel])
    {
      selection.Support[pixel] = 0;
      selection.Use[pixel] = SupportUse::NearStep;
    }
  }
  if (std::find(selection.Support.begin(), selection.Support.end(), 1) == selection.Support.end())
  {
    std::ostringstream message;
    message << "there is no surface to fit: all of it around the defect lies within "
            << "SupportStepMargin = " << margin
            << " mm of a depth step or of pixels without a depth; lower SupportStepMargin, or "
            << "raise SupportMargin";
    throw std::invalid_argument(message.str());
  }
}

void FindSteep(const MarkedMap& map, SupportSelection& selection)
{
  SteepEdges(map).ForEach(selection.Support,
    [&](std::size_t pixel, std::size_t) { selection.Use[pixel] = SupportUse::Steep; });
  const auto steep = std::find(selection.Use.begin(), selection.Use.end(), SupportUse::Steep);
  const auto count = std::count(steep, selection.Use.end(), SupportUse::Steep);
  const std::size_t first = steep - selection.Use.begin();
  if (count > 0)
  {
    std::ostringstream message;
    message << "at " << count << " pixels around the defect, " << Locate(map.Grid, first)
            << ", the surface is steeper than " << DiscontinuityLimits().MaximumAngle
            << " degrees against the map: depths are uncertain there. Choose a view that faces the "
            << "defect, or leave these pixels out with SupportStepMargin";
    selection.Warnings.push_back(message.str());
  }
}

// What the edge of the defect has beside it: the border of the map, or no support.
void WarnOfOpenEdges(
  Execution& execution, const MarkedMap& map, double reach, SupportSelection& selection)
{
  const auto width = static_cast<std::size_t>(map.Grid.Width);
  const auto height = static_cast<std::size_t>(map.Grid.Height);
  const std::vector<double> squared = SquaredDistanceTransform(
    execution, map.Grid.Width, map.Grid.Height, map.Grid.Spacing, selection.Support);
  bool atBorder = false;
  std::size_t edge = 0;
  std::size_t open = 0;
  std::size_t first = 0;
  for (std::size_t pixel = 0; pixel < map.Defect.size(); ++pixel)
  {
    const std::size_t i = pixel % width;
    const std::size_t j = pixel / width;
    const bool outermost = i == 0 || j == 0 || i + 1 == width || j + 1 == height;
    if (map.Defect[pixel] &&
      (outermost || !map.Defect[pixel - 1] || !map.Defect[pixel + 1] ||
        !map.Defect[pixel - width] || !map.Defect[pixel + width]))
    {
      atBorder = atBorder || outermost;
      ++edge;
      if (!(squared[pixel] <= reach * reach))
      {
        first = open++ == 0 ? pixel : first;
      }
    }
  }
  if (atBorder)
  {
    selection.Warnings.emplace_back("the defect touches the border of the map: there is no surface "
                                    "on that side, and the fit extrapolates");
  }
  if (map.Painted.empty() && static_cast<double>(open) >= WarnedShare * static_cast<double>(edge) &&
    open > 0)
  {
    std::ostringstream message;
    message << "along "
            << std::lround(100.0 * static_cast<double>(open) / static_cast<double>(edge))
            << " % of its edge, " << Locate(map.Grid, first)
            << ", the defect has no surface to fit within " << reach
            << " mm: the fit extrapolates there. Give control points or a prior surface, or choose "
            << "a view in which the bone on that side is seen";
    selection.Warnings.push_back(message.str());
  }
}
}

//------------------------------------------------------------------------------
SupportSelection SelectSupport(Execution& execution, const MarkedMap& map,
  const SupportMargins& margins, const std::vector<double>& prior)
{
  SupportSelection selection;
  selection.Support = FindCandidates(execution, map, margins.Defect);
  selection.Use.assign(selection.Support.size(), SupportUse::None);
  const MapMask near = FindNearSteps(execution, map, margins.Step, selection.Support);
  // Over a gap nothing shows that a steep surface goes on.
  const double overGap = SteepSlope();
  LeaveOutBeyondSteps(
    map, { margins.Step > 0 ? overGap : MaximumSupportSlope, overGap }, near, selection);
  LeaveOutNearSteps(margins.Step, near, selection);
  for (std::size_t pixel = 0; pixel < selection.Use.size(); ++pixel)
  {
    if (selection.Support[pixel])
    {
      selection.Use[pixel] = SupportUse::Used;
    }
  }
  FindSteep(map, selection);
  // Half of the rim: where a hole is the defect, the rim begins at the step margin.
  WarnOfOpenEdges(execution, map, 0.5 * (margins.Step + margins.Defect), selection);
  MarkWithoutPrior(map, prior, selection);
  return selection;
}
}
