// SPDX-License-Identifier: BSD-3-Clause
// Path of a ball end of 8 mm over 121 x 121 points at 1 mm, lines at 1 mm, beside a drop-cutter that
// tries every triangle within reach at each of the path's positions (positions only: it neither
// looks between them nor links lines). Then the left-over map, and the judge of the tests: the depth
// of the surface within the tool at 10^7 pairs of a triangle and a place on the swept path.
// Counters: positions, microseconds for each, largest depth in um.
#include "lacunaBenchmark.h"
#include "lacunaExecution.h"
#include "lacunaMaterialRemoval.h"
#include "lacunaMillScene.h"
#include "lacunaToolPath.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

using lacunaBenchmark::Measure;

namespace
{
using lacuna::Vec3;

const lacuna::MillSurface& Mould()
{
  static const lacuna::MillSurface surface = lacunaMill::Surface(121, 121, 1, lacunaMill::Mould);
  return surface;
}

lacuna::MillSurface MouldOf(std::int64_t count)
{
  return lacunaMill::Surface(count, count, 120 / static_cast<double>(count - 1), lacunaMill::Mould);
}

void Report(benchmark::State& state, double positions)
{
  state.counters["positions"] = positions;
  state.counters["s_per_position"] = benchmark::Counter(
    positions, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// With the surface's blocks, as a filter would: the whole work.
void Path(benchmark::State& state)
{
  const std::vector<Vec3> points = Mould().GetPoints();
  lacuna::ThreadExecution execution(static_cast<int>(state.range(0)));
  lacuna::ToolPath path;
  for (auto _ : state)
  {
    const lacuna::MillSurface surface({ 121, 121 }, points);
    path = lacuna::MakeToolPath(execution, surface, {});
  }
  Report(state, static_cast<double>(path.Points.size()));
}

// As many lines as the surface has rows. argument: points along an edge
void PathOfPoints(benchmark::State& state)
{
  const lacuna::MillSurface mould = MouldOf(state.range(0));
  const std::vector<Vec3> points = mould.GetPoints();
  lacuna::ThreadExecution execution(2);
  lacuna::ToolPathOptions options;
  options.StepOver = 120 / static_cast<double>(state.range(0) - 1);
  lacuna::ToolPath path;
  for (auto _ : state)
  {
    const lacuna::MillSurface surface(mould.GetSize(), points);
    path = lacuna::MakeToolPath(execution, surface, options);
  }
  Report(state, static_cast<double>(path.Points.size()));
}

void PathAndLeftOver(benchmark::State& state)
{
  lacuna::ThreadExecution execution(static_cast<int>(state.range(0)));
  lacuna::ToolPath path;
  lacuna::LeftOverMap map;
  for (auto _ : state)
  {
    path = lacuna::MakeToolPath(execution, Mould(), {});
    map = lacuna::MapLeftOver(execution, Mould(), {}, path, 0.25);
  }
  Report(state, static_cast<double>(path.Points.size()));
  state.counters["map_points"] = static_cast<double>(map.Points.size());
  state.counters["left_over_um"] = 1000 * map.LargestLeftOver;
  state.counters["gouge_um"] = 1000 * map.LargestGouge;
}

//------------------------------------------------------------------------------
// The plain way: every feature of every triangle whose box the tool's circle meets.
double PlainDrop(const lacuna::MillSurface& surface, double radius, double x, double y)
{
  double best = -1e300;
  const auto vertex = [&](const Vec3& p)
  {
    const double d2 = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
    best = d2 < radius * radius ? std::max(best, p[2] + std::sqrt(radius * radius - d2)) : best;
  };
  const auto edge = [&](const Vec3& p, const Vec3& q)
  {
    const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
    const double ux = (q[0] - p[0]) / length;
    const double uy = (q[1] - p[1]) / length;
    const double along = ux * (x - p[0]) + uy * (y - p[1]);
    const double across = ux * (y - p[1]) - uy * (x - p[0]);
    if (std::abs(across) < radius)
    {
      const double w = std::sqrt(radius * radius - across * across);
      const double slope = (q[2] - p[2]) / length;
      const double secant = std::sqrt(1 + slope * slope);
      const double foot = along + w * slope / secant;
      best = foot >= 0 && foot <= length ? std::max(best, p[2] + slope * along + w * secant) : best;
    }
  };
  const auto triangle = [&](const Vec3& a, const Vec3& b, const Vec3& c)
  {
    if (std::min({ a[0], b[0], c[0] }) > x + radius ||
      std::max({ a[0], b[0], c[0] }) < x - radius || std::min({ a[1], b[1], c[1] }) > y + radius ||
      std::max({ a[1], b[1], c[1] }) < y - radius)
    {
      return;
    }
    Vec3 n = Normalized(Cross(b - a, c - a));
    n = n[2] < 0 ? -1.0 * n : n;
    const Vec3 p{ x - radius * n[0], y - radius * n[1], 0 };
    const double z = a[2] - (n[0] * (p[0] - a[0]) + n[1] * (p[1] - a[1])) / n[2];
    const auto side = [&p](const Vec3& s, const Vec3& e)
    { return (e[0] - s[0]) * (p[1] - s[1]) - (e[1] - s[1]) * (p[0] - s[0]); };
    const double sides[3] = { side(a, b), side(b, c), side(c, a) };
    if ((sides[0] >= 0 && sides[1] >= 0 && sides[2] >= 0) ||
      (sides[0] <= 0 && sides[1] <= 0 && sides[2] <= 0))
    {
      best = std::max(best, z + radius * n[2]);
    }
    edge(a, b);
    edge(b, c);
    edge(c, a);
    vertex(a);
    vertex(b);
    vertex(c);
  };
  for (std::int64_t j = 0; j + 1 < surface.GetSize().Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < surface.GetSize().Columns; ++i)
    {
      triangle(surface.At(i, j), surface.At(i + 1, j), surface.At(i + 1, j + 1));
      triangle(surface.At(i, j), surface.At(i + 1, j + 1), surface.At(i, j + 1));
    }
  }
  return best - radius;
}

void DropPlainly(benchmark::State& state, const lacuna::MillSurface& surface, int threads)
{
  lacuna::ThreadExecution execution(threads);
  std::vector<double> heights(surface.GetPoints().size());
  for (auto _ : state)
  {
    execution.For(static_cast<std::int64_t>(heights.size()), 64,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          const Vec3& p = surface.GetPoints()[k];
          heights[k] = PlainDrop(surface, 4, p[0], p[1]);
        }
      });
  }
  double difference = 0;
  const lacuna::DropCutter cutter(surface, {});
  lacuna::DropCutter::Scratch scratch;
  for (std::size_t k = 0; k < heights.size(); ++k)
  {
    const Vec3& p = surface.GetPoints()[k];
    difference = std::max(difference, std::abs(cutter.Drop(p[0], p[1], scratch) - heights[k]));
  }
  Report(state, static_cast<double>(heights.size()));
  state.counters["difference_um"] = 1000 * difference;
}

void PlainDropCutter(benchmark::State& state)
{
  DropPlainly(state, Mould(), static_cast<int>(state.range(0)));
}

void PlainDropCutterOfPoints(benchmark::State& state)
{
  DropPlainly(state, MouldOf(state.range(0)), 2);
}

void DropAlone(benchmark::State& state)
{
  const double spacing = 1.0 / static_cast<double>(state.range(0));
  const lacuna::MillSurface surface =
    lacunaMill::Surface(static_cast<std::int64_t>(120 / spacing) + 1,
      static_cast<std::int64_t>(120 / spacing) + 1, spacing, lacunaMill::Mould);
  const lacuna::DropCutter cutter(surface, {});
  lacuna::DropCutter::Scratch scratch;
  double sum = 0;
  for (auto _ : state)
  {
    for (int j = 0; j < 40; ++j)
    {
      for (int i = 0; i < 40; ++i)
      {
        sum += cutter.Drop(3.1 * i, 3.1 * j, scratch);
      }
    }
  }
  benchmark::DoNotOptimize(sum);
  Report(state, 1600);
}

void Judge(benchmark::State& state)
{
  lacuna::ThreadExecution execution;
  const lacuna::ToolPath path = lacuna::MakeToolPath(execution, Mould(), {});
  double depth = 0;
  double checks = 0;
  for (auto _ : state)
  {
    lacunaMill::Judge judge(Mould(), {});
    depth = judge.LargestDepth(path, 10000000, 7);
    checks = static_cast<double>(judge.GetChecks());
  }
  state.counters["checks"] = checks;
  state.counters["depth_um"] = 1000 * depth;
}
}

BENCHMARK(Path)->Arg(1)->Arg(2)->Arg(4)->Apply(Measure);
BENCHMARK(PathOfPoints)->ArgName("points")->Arg(39)->Arg(122)->Arg(384)->Apply(Measure);
BENCHMARK(PathAndLeftOver)->Arg(1)->Arg(2)->Apply(Measure);
BENCHMARK(PlainDropCutterOfPoints)->ArgName("points")->Arg(39)->Arg(122)->Apply(Measure);
BENCHMARK(PlainDropCutter)->Arg(1)->Arg(2)->Apply(Measure);
BENCHMARK(DropAlone)->Arg(1)->Arg(2)->Arg(5)->Arg(10)->Apply(Measure);
BENCHMARK(Judge)->Apply(Measure);
BENCHMARK_MAIN();
