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
std::vector<std::size_t> FindRuns(
  const std::vector<Vec3>& points, const std::vector<Vec3>& free, double longest)
{
  std::vector<std::size_t> runs(points.size(), 0);
  double length = 0;
  for (std::size_t i = 1; i < runs.size(); ++i)
  {
    length += Norm(points[i] - points[i - 1]);
    const bool goesOn =
      !free.empty() && HasDirection(free[i]) && free[i] == free[i - 1] && length <= longest;
    runs[i] = runs[i - 1] + (goesOn ? 0 : 1);
    length = goesOn ? length : 0;
  }
  return runs;
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
  const SurfaceSplineOptions& options, const SurfaceSplineReport& fit,
  const TriangleSurface& surface)
{
  constexpr std::size_t trials = 16;
  constexpr double pieces = 3; // of the longest extent
  SurfaceSplineOptions coarse = options;
  coarse.PointError = fit.PointError;
  coarse.Stiffness = fit.Stiffness;
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
  const std::vector<double> areas = GetAreas(surface);
  // of the surface, by how much the zeros of a spline enclose more, mm^3
  const auto getVolume = [&](Execution& runner, const SurfaceSpline& spline)
  {
    std::vector<double> values(areas.size());
    std::vector<Vec3> gradients(areas.size());
    spline.Evaluate(runner, surface.Points, values, &gradients);
    double volume = 0;
    for (std::size_t p = 0; p < areas.size(); ++p)
    {
      volume -= areas[p] * values[p] / std::max(0.3, Norm(gradients[p]));
    }
    return volume;
  };
  const SurfaceSpline middle(execution, data, coarse);
  std::vector<double> misses(data.Points.size());
  middle.Evaluate(execution, data.Points, misses, nullptr);
  double squares = 0;
  for (std::size_t i = 0; i < misses.size(); ++i)
  {
    const double miss = misses[i] / (data.Errors.empty() ? 1 : data.Errors[i]);
    squares += miss * miss / static_cast<double>(misses.size());
  }
  // The surface follows errors in part, so what it misses is too little.
  const double factor = squares > 0 ? std::max(1.0, fit.PointError / std::sqrt(squares)) : 1;
  const double reference = getVolume(execution, middle);
  std::vector<double> volumes(trials);
  const SingleBlasThread single(execution.GetNumberOfThreads());
  execution.For(trials, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t t = begin; t < end; ++t)
      {
        OrientedPoints other = data;
        other.Values.resize(data.Points.size());
        for (std::size_t i = 0; i < misses.size(); ++i)
        {
          const bool turned = (Scramble(trials * runs[i] + static_cast<std::uint64_t>(t)) & 1) != 0;
          other.Values[i] = misses[i] + (turned ? factor : -factor) * misses[i];
        }
        ThreadExecution alone(1);
        volumes[t] = getVolume(alone, SurfaceSpline(alone, other, coarse)) - reference;
      }
    });
  double sum = 0;
  for (const double v : volumes)
  {
    sum += v * v;
  }
  return std::sqrt(sum / trials);
}
}
