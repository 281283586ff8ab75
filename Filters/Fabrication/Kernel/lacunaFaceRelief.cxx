// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFaceRelief.h"

#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaPressLayout.h"
#include "lacunaSplineEquations.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr int ViewSteps = 2000;        // towards the steepest place, each shorter
constexpr double LargestAngle = 85;    // degrees: steeper places are not seen well enough
constexpr double GoodDistance = 0.005; // mm, of the face's points from the surface
constexpr double Refinement = 0.62;    // of the spacing of control points
constexpr double Finest = 0.6;         // of edges of the mesh and of the spacing of samples
constexpr int CoarsestSpans = 8;
constexpr double MostControlPoints = 150000;
constexpr double LargestSize = 1000; // mm

// Of all points; zero where there is no triangle.
std::vector<Vec3> FindNormals(
  const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
{
  std::vector<Vec3> normals(points.size(), Vec3{ 0, 0, 0 });
  for (const auto& [a, b, c] : triangles)
  {
    const Vec3 area = Cross(points[b] - points[a], points[c] - points[a]);
    for (const auto corner : { a, b, c })
    {
      normals[corner] = normals[corner] + area;
    }
  }
  for (Vec3& normal : normals)
  {
    normal = Normalized(normal);
  }
  return normals;
}

std::size_t FindSteepest(const std::vector<Vec3>& normals, const Vec3& view)
{
  std::size_t steepest = 0;
  double least = 2;
  for (std::size_t k = 0; k < normals.size(); ++k)
  {
    const double facing = HasDirection(normals[k]) ? -Dot(normals[k], view) : 2;
    if (facing < least)
    {
      least = facing;
      steepest = k;
    }
  }
  return steepest;
}

double Edge(const Vec3& a, const Vec3& b, double x, double y)
{
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

void MarkFace(const std::vector<Vec3>& flat, const std::vector<Triangle>& triangles, double spacing,
  FaceRelief& relief)
{
  relief.Mask.assign(relief.Depths.size(), 0);
  for (const auto& [ia, ib, ic] : triangles)
  {
    const Vec3* corners[] = { &flat[ia], &flat[ib], &flat[ic] };
    double low[2];
    double high[2];
    for (int a = 0; a < 2; ++a)
    {
      const auto [least, most] =
        std::minmax({ (*corners[0])[a], (*corners[1])[a], (*corners[2])[a] });
      low[a] = std::ceil(least / spacing);
      high[a] = std::floor(most / spacing);
    }
    for (auto j = static_cast<std::int64_t>(low[1]); j <= static_cast<std::int64_t>(high[1]); ++j)
    {
      for (auto i = static_cast<std::int64_t>(low[0]); i <= static_cast<std::int64_t>(high[0]); ++i)
      {
        const double x = spacing * static_cast<double>(i);
        const double y = spacing * static_cast<double>(j);
        const double sides[] = { Edge(*corners[0], *corners[1], x, y),
          Edge(*corners[1], *corners[2], x, y), Edge(*corners[2], *corners[0], x, y) };
        const auto [least, most] = std::minmax({ sides[0], sides[1], sides[2] });
        if (least >= 0 || most <= 0)
        {
          relief.Mask[i + j * relief.Size.Columns] = 1;
        }
      }
    }
  }
  // holes are what the border of the field does not reach
  constexpr unsigned char outside = 2;
  std::vector<std::int64_t> stack{ 0 };
  relief.Mask[0] = outside;
  const std::int64_t columns = relief.Size.Columns;
  while (!stack.empty())
  {
    const std::int64_t k = stack.back();
    stack.pop_back();
    const std::int64_t steps[4][2] = { { k - 1, k % columns > 0 },
      { k + 1, k % columns + 1 < columns }, { k - columns, k >= columns },
      { k + columns, k / columns + 1 < relief.Size.Rows } };
    for (const auto& [next, isThere] : steps)
    {
      if (isThere != 0 && relief.Mask[next] == 0)
      {
        relief.Mask[next] = outside;
        stack.push_back(next);
      }
    }
  }
  for (unsigned char& mask : relief.Mask)
  {
    mask = mask == outside ? 0 : 1;
  }
}
}

//------------------------------------------------------------------------------
Vec3 FindSquareView(const std::vector<Vec3>& normals)
{
  Vec3 sum{ 0, 0, 0 };
  for (const Vec3& normal : normals)
  {
    sum = sum + normal;
  }
  Vec3 view = Normalized(-1.0 * sum);
  if (!HasDirection(view))
  {
    return { 0, 0, -1 };
  }
  // the centre of the smallest ball around the normals (Badoiu and Clarkson 2003)
  Vec3 centre = -1.0 * view;
  Vec3 best = view;
  double bestFacing = -2;
  for (int step = 1; step <= ViewSteps; ++step)
  {
    const std::size_t steepest = FindSteepest(normals, view);
    const double facing = -Dot(normals[steepest], view);
    if (facing > bestFacing)
    {
      bestFacing = facing;
      best = view;
    }
    centre = centre + (1.0 / (step + 1)) * (normals[steepest] - centre);
    if (!HasDirection(centre))
    {
      break;
    }
    view = Normalized(-1.0 * centre);
  }
  return best;
}

//------------------------------------------------------------------------------
FaceRelief MakeFaceRelief(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Triangle>& triangles, double spacing, double margin)
{
  FaceRelief relief;
  const std::vector<Vec3> normals = FindNormals(points, triangles);
  std::vector<Vec3> used;
  std::copy_if(normals.begin(), normals.end(), std::back_inserter(used),
    [](const Vec3& normal) { return HasDirection(normal); });
  if (used.empty())
  {
    throw std::runtime_error("the face has no area");
  }
  const Vec3 view = FindSquareView(used);
  const std::size_t steepest = FindSteepest(normals, view);
  relief.SteepestPoint = points[steepest];
  relief.SteepestAngle = Degrees * std::acos(std::clamp(-Dot(normals[steepest], view), -1.0, 1.0));
  if (!(relief.SteepestAngle <= LargestAngle))
  {
    throw std::runtime_error(
      "no direction of pressing sees all of the face: even in the best one the wall at " +
      FormatPlace({}, relief.SteepestPoint) + " mm is " +
      FormatNumber(std::round(relief.SteepestAngle)) + " degrees steep, and more than " +
      FormatNumber(LargestAngle) +
      " cannot be pressed. One mould cannot make it: make the implant in parts");
  }

  // axes: x right, y down, z the view
  int least = 0;
  for (int a = 1; a < 3; ++a)
  {
    least = std::abs(view[a]) < std::abs(view[least]) ? a : least;
  }
  Vec3 helper{ 0, 0, 0 };
  helper[least] = 1;
  const Vec3 right = Normalized(Cross(helper, view));
  const Vec3 down = Cross(view, right);
  const auto turn = [&](const Vec3& p) -> Vec3 {
    return { Dot(p, right), Dot(p, down), Dot(p, view) };
  };
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Vec3 low{ infinite, infinite, infinite };
  Vec3 high{ -infinite, -infinite, -infinite };
  std::vector<Vec3> flat(points.size(), Vec3{ 0, 0, 0 });
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (HasDirection(normals[k]))
    {
      flat[k] = turn(points[k]);
      for (int a = 0; a < 3; ++a)
      {
        low[a] = std::min(low[a], flat[k][a]);
        high[a] = std::max(high[a], flat[k][a]);
      }
    }
  }
  low = low - Vec3{ margin, margin, 0 };
  high = high + Vec3{ margin, margin, 0 };
  const double width = std::max(high[0] - low[0], high[1] - low[1]);
  if (!(width <= LargestSize))
  {
    throw std::runtime_error("the face and what a mould needs around it (PlateMargin) are " +
      FormatNumber(std::round(width)) + " mm wide; the largest mould is made of " +
      FormatNumber(LargestSize) + " mm. Is the surface in mm?");
  }
  const Vec3 origin = low[0] * right + low[1] * down + low[2] * view;
  relief.ToWorld = Matrix4::FromColumns(right, down, view, origin);
  for (Vec3& p : flat)
  {
    p = p - low;
  }
  std::vector<SplinePoint> samples;
  double edges = 0;
  for (const auto& [a, b, c] : triangles)
  {
    edges +=
      (Norm(points[b] - points[a]) + Norm(points[c] - points[b]) + Norm(points[a] - points[c])) /
      (3 * static_cast<double>(triangles.size()));
  }
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (HasDirection(normals[k]))
    {
      samples.push_back({ { flat[k][0], flat[k][1] }, flat[k] });
    }
  }
  relief.Size = { static_cast<std::int64_t>(std::ceil((high[0] - low[0]) / spacing)) + 1,
    static_cast<std::int64_t>(std::ceil((high[1] - low[1]) / spacing)) + 1 };
  const Vec2 far{ spacing * static_cast<double>(relief.Size.Columns - 1),
    spacing * static_cast<double>(relief.Size.Rows - 1) };
  BSplineSurface best;
  relief.Deviation = infinite;
  double step = std::max(far[0], far[1]) / CoarsestSpans;
  do
  {
    execution.Report(0);
    const BSplineSurface surface = FitScattered(samples, { 0, 0 }, far, step);
    double deviation = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
    {
      if (HasDirection(normals[k]))
      {
        const double off = surface.Evaluate(flat[k][0], flat[k][1])[2] - flat[k][2];
        deviation = std::max(deviation, std::abs(off * Dot(normals[k], view)));
      }
    }
    if (deviation < relief.Deviation)
    {
      relief.Deviation = deviation;
      best = surface;
    }
    step *= Refinement;
  } while (relief.Deviation > GoodDistance && step > Finest * std::max(edges, spacing) &&
    far[0] * far[1] < MostControlPoints * step * step);
  for (std::int64_t j = 0; j < relief.Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < relief.Size.Columns; ++i)
    {
      relief.Depths.push_back(
        best.Evaluate(spacing * static_cast<double>(i), spacing * static_cast<double>(j))[2]);
    }
  }
  MarkFace(flat, triangles, spacing, relief);
  return relief;
}
}
