// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectModelPlan.h"

#include "lacunaDefectContours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
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
}
