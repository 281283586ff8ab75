// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutlines.h"

#include "lacunaExecution.h"
#include "lacunaScramble.h"
#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lacuna
{
namespace
{
void Refine(
  Execution& execution, OrientedPoints& data, const SurfaceSplineOptions& options, int rounds)
{
  const Execution::NestedStages stages(execution);
  for (int round = 0; round < rounds; ++round)
  {
    execution.SetStage(static_cast<double>(round) / rounds, (round + 1.0) / rounds);
    const SurfaceSpline spline(execution, data, options);
    std::vector<double> values(data.Points.size());
    std::vector<Vec3> gradients(data.Points.size());
    spline.Evaluate(execution, data.Points, values, &gradients);
    for (std::size_t i = 0; i < data.Free.size(); ++i)
    {
      // a normal that has turned over is of no use
      if (HasDirection(data.Free[i]) && Dot(gradients[i], data.Normals[i]) > 0)
      {
        data.Normals[i] = Normalized(gradients[i]);
      }
    }
  }
}

// A third of the areas of the triangles around each point, mm^2.
std::vector<double> GetAreas(const TriangleSurface& surface)
{
  std::vector<double> areas(surface.Points.size(), 0.0);
  for (const auto& t : surface.Triangles)
  {
    const Vec3& a = surface.Points[t[0]];
    const double area = 0.5 * Norm(Cross(surface.Points[t[1]] - a, surface.Points[t[2]] - a));
    for (const std::int32_t p : t)
    {
      areas[p] += area / 3;
    }
  }
  return areas;
}
}

//------------------------------------------------------------------------------
void FindOutlineNormals(
  Execution& execution, OrientedPoints& data, const SurfaceSplineOptions& options)
{
  constexpr int rounds = 4;
  Refine(execution, data, options, rounds);
}

//------------------------------------------------------------------------------
double EstimateVolumeError(Execution& execution, const OrientedPoints& data,
  const SurfaceSplineOptions& options, const TriangleSurface& surface)
{
  constexpr std::size_t groups = 12;
  constexpr double pieces = 12; // of the longest extent
  constexpr int rounds = 3;
  SurfaceSplineOptions coarse = options;
  coarse.Nodes = std::min<std::size_t>(150, options.Nodes);
  Vec3 low = data.Points.at(0);
  Vec3 high = low;
  for (const Vec3& x : data.Points)
  {
    for (int c = 0; c < 3; ++c)
    {
      low[c] = std::min(low[c], x[c]);
      high[c] = std::max(high[c], x[c]);
    }
  }
  const double extent = std::max({ high[0] - low[0], high[1] - low[1], high[2] - low[2] });
  const std::vector<std::size_t> runs = FindRuns(data.Points, data.Free, extent / pieces);
  std::vector<std::size_t> order(runs.back() + 1);
  for (std::size_t r = 0; r < order.size(); ++r)
  {
    order[r] = r;
  }
  std::sort(order.begin(), order.end(),
    [](std::size_t a, std::size_t b) { return Scramble(a) < Scramble(b); });
  std::vector<std::size_t> groupOf(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
  {
    groupOf[order[k]] = k % groups;
  }
  const std::vector<double> areas = GetAreas(surface);
  std::vector<double> volumes(groups, 0.0); // beyond the surface
  const SingleBlasThread single(execution.GetNumberOfThreads());
  execution.For(groups, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t g = begin; g < end; ++g)
      {
        OrientedPoints rest;
        for (std::size_t i = 0; i < data.Points.size(); ++i)
        {
          if (groupOf[runs[i]] != static_cast<std::size_t>(g))
          {
            rest.Points.push_back(data.Points[i]);
            rest.Normals.push_back(data.Normals[i]);
            rest.Free.push_back(data.Free[i]);
            rest.Errors.push_back(data.Errors.empty() ? 1 : data.Errors[i]);
          }
        }
        ThreadExecution alone(1);
        Refine(alone, rest, coarse, rounds - 1);
        const SurfaceSpline spline(alone, rest, coarse);
        std::vector<double> values(areas.size());
        std::vector<Vec3> gradients(areas.size());
        spline.Evaluate(alone, surface.Points, values, &gradients);
        for (std::size_t p = 0; p < areas.size(); ++p)
        {
          volumes[g] -= areas[p] * values[p] / std::max(0.3, Norm(gradients[p]));
        }
      }
    });
  double mean = 0;
  for (const double v : volumes)
  {
    mean += v / groups;
  }
  double squares = 0;
  for (const double v : volumes)
  {
    squares += (v - mean) * (v - mean);
  }
  return std::sqrt(squares * (groups - 1) / groups);
}
}
