// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBlendedSpline.h"

#include "lacunaExecution.h"
#include "lacunaPointNormals.h"
#include "lacunaScramble.h"
#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace lacuna
{
namespace
{
// Points and nodes of a ball.
constexpr std::size_t BallPoints = 200;
constexpr std::size_t BallNodes = 80;
// Points that count at the first level; each further one has four times as many.
constexpr std::size_t LevelPoints = 20000;
constexpr double Overlap = 0.7; // of the radius: points nearer than this need no further ball
constexpr double LeastGain = 2; // standard errors

// Where the sum of the weights is below this, the local splines fade out.
constexpr double LeastWeight = 0.02;

// Wendland's function in C2, and its derivative by r divided by r; 0 from r = 1.
double GetWeight(double r, double& slope)
{
  const double rest = std::max(0.0, 1 - r);
  slope = -20 * rest * rest * rest;
  return rest * rest * rest * rest * (4 * r + 1);
}
}

//------------------------------------------------------------------------------
// Local splines, and which of them are near a point.
class BlendedSpline::Level
{
public:
  struct Ball
  {
    Vec3 Center;
    double Radius;
    std::unique_ptr<SurfaceSpline> Spline;
  };

  explicit Level(std::vector<Ball> balls)
    : Balls(std::move(balls))
  {
    for (std::size_t b = 0; b < this->Balls.size(); ++b)
    {
      const Ball& ball = this->Balls[b];
      int scale = 0;
      std::frexp(ball.Radius, &scale); // cells are at least as wide as the radius
      auto& grid = this->Grids[scale];
      Cell low = GetCell(ball.Center - Vec3{ ball.Radius, ball.Radius, ball.Radius }, scale);
      Cell high = GetCell(ball.Center + Vec3{ ball.Radius, ball.Radius, ball.Radius }, scale);
      for (std::int64_t i = low[0]; i <= high[0]; ++i)
      {
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
        {
          for (std::int64_t k = low[2]; k <= high[2]; ++k)
          {
            grid[GetKey({ i, j, k })].push_back(static_cast<std::uint32_t>(b));
          }
        }
      }
    }
  }

  std::size_t GetSize() const { return this->Balls.size(); }
  const Ball& Get(std::size_t ball) const { return this->Balls[ball]; }

  // Balls with a point inside, always in the same order.
  void Find(const Vec3& x, std::vector<std::uint32_t>& balls) const
  {
    balls.clear();
    for (const auto& grid : this->Grids)
    {
      const auto cell = grid.second.find(GetKey(GetCell(x, grid.first)));
      if (cell != grid.second.end())
      {
        for (const std::uint32_t b : cell->second)
        {
          if (Norm(x - this->Balls[b].Center) < this->Balls[b].Radius)
          {
            balls.push_back(b);
          }
        }
      }
    }
  }

  void Add(Execution& execution, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const
  {
    constexpr std::size_t slab = 1 << 17;
    for (std::size_t from = 0; from < points.size(); from += slab)
    {
      this->Add(execution, points.data() + from, std::min(slab, points.size() - from),
        values.data() + from, gradients ? gradients->data() + from : nullptr);
    }
  }

private:
  using Cell = std::array<std::int64_t, 3>;

  static Cell GetCell(const Vec3& x, int scale)
  {
    Cell cell;
    for (int c = 0; c < 3; ++c)
    {
      constexpr double most = 1e15;
      cell[c] =
        static_cast<std::int64_t>(std::floor(std::clamp(std::ldexp(x[c], -scale), -most, most)));
    }
    return cell;
  }

  // Cells that share a key do no harm: distances decide.
  static std::uint64_t GetKey(const Cell& cell)
  {
    std::uint64_t key = 0;
    for (const std::int64_t i : cell)
    {
      key = Scramble(key ^ static_cast<std::uint64_t>(i));
    }
    return key;
  }

  // Ball after ball, so that many points are evaluated at once; then the sums of each point.
  void Add(Execution& execution, const Vec3* points, std::size_t count, double* values,
    Vec3* gradients) const
  {
    const auto n = static_cast<std::int64_t>(count);
    std::vector<std::vector<std::uint32_t>> near(count);
    execution.For(n, 512,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->Find(points[i], near[i]);
        }
      });
    // pairs of a point and a ball, in the order of the balls and in that of the points
    std::vector<std::size_t> starts(this->Balls.size() + 1, 0);
    std::vector<std::size_t> firsts(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i)
    {
      firsts[i + 1] = firsts[i] + near[i].size();
      for (const std::uint32_t b : near[i])
      {
        ++starts[b + 1];
      }
    }
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<std::size_t> at(starts.begin(), starts.end() - 1);
    std::vector<std::uint32_t> members(firsts.back());
    std::vector<std::size_t> places(firsts.back());
    for (std::size_t i = 0; i < count; ++i)
    {
      for (std::size_t k = 0; k < near[i].size(); ++k)
      {
        const std::size_t place = at[near[i][k]]++;
        members[place] = static_cast<std::uint32_t>(i);
        places[firsts[i] + k] = place;
      }
    }
    std::vector<double> local(members.size());
    std::vector<Vec3> slopes(gradients ? members.size() : 0);
    execution.For(static_cast<std::int64_t>(this->Balls.size()), 4,
      [&](std::int64_t begin, std::int64_t end)
      {
        Vec3 block[RadialBlock];
        for (std::int64_t b = begin; b < end; ++b)
        {
          for (std::size_t first = starts[b]; first < starts[b + 1]; first += RadialBlock)
          {
            const std::size_t size = std::min(RadialBlock, starts[b + 1] - first);
            for (std::size_t i = 0; i < size; ++i)
            {
              block[i] = points[members[first + i]];
            }
            this->Balls[b].Spline->EvaluateBlock(
              block, size, local.data() + first, gradients ? slopes.data() + first : nullptr);
          }
        }
      });
    execution.For(n, 1024,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          double weights = 0;
          double sum = 0;
          Vec3 weightSlope{};
          Vec3 sumSlope{};
          for (std::size_t k = 0; k < near[i].size(); ++k)
          {
            const Ball& ball = this->Balls[near[i][k]];
            const std::size_t place = places[firsts[i] + k];
            const Vec3 away = (1 / ball.Radius) * (points[i] - ball.Center);
            double slope = 0;
            const double w = GetWeight(Norm(away), slope);
            weights += w;
            sum += w * local[place];
            if (gradients)
            {
              const Vec3 g = (slope / ball.Radius) * away;
              weightSlope = weightSlope + g;
              sumSlope = sumSlope + w * slopes[place] + local[place] * g;
            }
          }
          if (!(weights > 0))
          {
            continue;
          }
          // 1 / weights, and where these are small what it joins to in C2
          const double u = std::min(1.0, weights / LeastWeight);
          const double factor = u < 1 ? (3 - 3 * u + u * u) / LeastWeight : 1 / weights;
          values[i] += factor * sum;
          if (gradients)
          {
            const double change =
              u < 1 ? (2 * u - 3) / (LeastWeight * LeastWeight) : -1 / (weights * weights);
            gradients[i] = gradients[i] + factor * sumSlope + (change * sum) * weightSlope;
          }
        }
      });
  }

  std::vector<Ball> Balls;
  // By the exponent of the width of cells.
  std::unordered_map<int, std::unordered_map<std::uint64_t, std::vector<std::uint32_t>>> Grids;
};

//------------------------------------------------------------------------------
namespace
{
template <class T>
std::vector<T> Pick(const std::vector<T>& all, const std::vector<std::size_t>& which)
{
  std::vector<T> picked;
  for (std::size_t i = 0; i < which.size() && !all.empty(); ++i)
  {
    picked.push_back(all[which[i]]);
  }
  return picked;
}

struct Members
{
  Vec3 Center;
  double Radius;
  std::vector<std::size_t> Points;
};

// Balls around the chosen points so that each open one lies well inside of one.
std::vector<Members> CoverPoints(const std::vector<Vec3>& all,
  const std::vector<std::size_t>& chosen, const std::vector<char>& open)
{
  const std::vector<Vec3> points = Pick(all, chosen);
  const PointNeighbors tree(points);
  std::vector<char> covered(points.size(), 0);
  std::vector<Members> balls;
  std::vector<std::size_t> nearest;
  std::vector<double> distances;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (covered[i] || !open[chosen[i]])
    {
      continue;
    }
    tree.Find(points[i], BallPoints, nearest, &distances);
    Members ball{ points[i], distances.back(), {} };
    for (std::size_t k = 0; k < nearest.size(); ++k)
    {
      covered[nearest[k]] = covered[nearest[k]] || distances[k] <= Overlap * ball.Radius;
      ball.Points.push_back(chosen[nearest[k]]);
    }
    if (ball.Radius > 0)
    {
      balls.push_back(std::move(ball));
    }
  }
  return balls;
}
}

//------------------------------------------------------------------------------
BlendedSpline::BlendedSpline(Execution& execution, const OrientedPoints& data,
  const BlendedSplineOptions& options, const ImplicitFunction* prior)
{
  if (!(options.Accuracy >= 0))
  {
    throw std::invalid_argument("Accuracy must be a number >= 0");
  }
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.3);
  this->Whole = std::make_unique<SurfaceSpline>(execution, data, options);
  const std::size_t n = data.Points.size();
  OrientedPoints difference;
  if (prior)
  {
    std::vector<double> values(n);
    std::vector<Vec3> gradients(n);
    prior->Evaluate(execution, data.Points, values, &gradients);
    difference = data;
    for (std::size_t i = 0; i < n; ++i)
    {
      difference.Values.push_back(-values[i]);
      difference.Slopes.push_back(data.Normals[i] - gradients[i]);
    }
    auto spline = std::make_unique<SurfaceSpline>(execution, difference, options);
    if (spline->GetReport().HeldOutError < this->Whole->GetReport().HeldOutError)
    {
      this->Whole = std::move(spline);
      this->Prior = prior;
      this->Report.UsesPrior = true;
    }
  }
  if (!options.Inside.empty() || !options.Outside.empty())
  {
    auto kept = this->KeepSides(execution, this->Prior ? difference : data, options);
    this->Whole = kept ? std::move(kept) : std::move(this->Whole);
  }
  this->Report.Spline = this->Whole->GetReport();
  this->Report.PointError = this->Report.Spline.PointError;
  this->Report.Centers = 2 * this->Report.Spline.Nodes;
  // errors of a hand along an outline are no detail
  const auto drawn = std::count_if(
    data.Free.begin(), data.Free.end(), [](const Vec3& across) { return HasDirection(across); });
  if (2 * static_cast<std::size_t>(drawn) < n)
  {
    this->AddLevels(execution, data, options);
  }
  for (const double side : { -1, 1 })
  {
    const std::vector<Vec3>& places = side < 0 ? options.Inside : options.Outside;
    std::vector<double> values(places.size());
    this->Evaluate(execution, places, values, nullptr);
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      if (!(side * values[i] > 0))
      {
        this->Report.WrongSideAt = places[i];
        ++this->Report.WrongSides;
      }
    }
  }
}

//------------------------------------------------------------------------------
// The spline again, with the places as points that the surface would leave on the wrong side or comes too
// near to, until these are the same ones. Null: there is none.
std::unique_ptr<SurfaceSpline> BlendedSpline::KeepSides(
  Execution& execution, const OrientedPoints& fitted, const BlendedSplineOptions& options) const
{
  constexpr int rounds = 8;
  constexpr int last = 4;           // from this round on none is let go
  constexpr double nearest = 0.002; // of the extent
  // Expected error of a place's value, of the margin: so small that a stiff spline keeps its side, too.
  constexpr double firmness = 0.02;
  std::vector<Vec3> places = options.Inside;
  places.insert(places.end(), options.Outside.begin(), options.Outside.end());
  Vec3 low = fitted.Points[0];
  Vec3 high = low;
  for (const Vec3& x : fitted.Points)
  {
    for (int c = 0; c < 3; ++c)
    {
      low[c] = std::min(low[c], x[c]);
      high[c] = std::max(high[c], x[c]);
    }
  }
  const double extent = std::max({ high[0] - low[0], high[1] - low[1], high[2] - low[2] });
  SurfaceSplineOptions fixed = options;
  fixed.PointError = this->Whole->GetReport().PointError;
  const double margin = std::max(2 * fixed.PointError, nearest * extent);
  std::vector<double> base(places.size(), 0.0);
  if (this->Prior)
  {
    this->Prior->Evaluate(execution, places, base, nullptr);
  }
  OrientedPoints start = fitted;
  const std::size_t n = fitted.Points.size();
  start.Errors.resize(n, 1.0);
  start.Values.resize(n, 0.0);
  start.Slopes = fitted.Slopes.empty() ? fitted.Normals : fitted.Slopes;
  start.Beside.resize(n, 0);
  std::vector<char> active(places.size(), 0);
  std::unique_ptr<SurfaceSpline> kept;
  for (int round = 0; round < rounds; ++round)
  {
    std::vector<double> values(places.size());
    std::vector<Vec3> gradients(places.size());
    const SurfaceSpline& spline = kept ? *kept : *this->Whole;
    spline.Evaluate(execution, places, values, &gradients);
    std::vector<char> now(places.size(), 0);
    OrientedPoints with = start;
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      const double side = i < options.Inside.size() ? -1 : 1;
      now[i] = side * (values[i] + base[i]) < margin || (round >= last && active[i]);
      if (now[i])
      {
        with.Points.push_back(places[i]);
        with.Normals.push_back(
          HasDirection(gradients[i]) ? Normalized(gradients[i]) : Vec3{ 1, 0, 0 });
        with.Slopes.push_back({});
        with.Errors.push_back(firmness * margin / fixed.PointError);
        with.Values.push_back(side * margin - base[i]);
        with.Beside.push_back(1);
        if (!with.Free.empty())
        {
          with.Free.push_back({});
        }
      }
    }
    if (now == active)
    {
      break;
    }
    active = now;
    kept = std::make_unique<SurfaceSpline>(execution, with, fixed);
  }
  return kept;
}

//------------------------------------------------------------------------------
void BlendedSpline::AddLevels(
  Execution& execution, const OrientedPoints& data, const BlendedSplineOptions& options)
{
  const std::size_t n = data.Points.size();
  std::vector<double> values(n);
  std::vector<Vec3> gradients(n);
  const SingleBlasThread single(execution.GetNumberOfThreads());
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
    [](std::size_t a, std::size_t b) { return Scramble(a) < Scramble(b); });
  this->Evaluate(execution, data.Points, values, &gradients);
  std::vector<char> open(n, 1);
  std::vector<double> squares(n, -1); // of the expected errors
  SurfaceSplineOptions local = options;
  local.Nodes = BallNodes;
  double stage = 0.3;
  for (std::size_t count = LevelPoints;; count *= 4)
  {
    count = std::min(count, n);
    execution.SetStage(stage, count == n ? 1 : stage + 0.3 * (1 - stage));
    stage += 0.3 * (1 - stage);
    const std::vector<Members> cover = CoverPoints(
      data.Points, { order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count) }, open);
    std::vector<Level::Ball> balls(cover.size());
    execution.For(static_cast<std::int64_t>(cover.size()), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t b = begin; b < end; ++b)
        {
          const std::vector<std::size_t>& which = cover[b].Points;
          OrientedPoints part;
          part.Points = Pick(data.Points, which);
          part.Normals = Pick(data.Normals, which);
          part.Errors = Pick(data.Errors, which);
          part.Free = Pick(data.Free, which);
          double square = 0;
          for (const std::size_t i : which)
          {
            part.Values.push_back(-values[i]);
            part.Slopes.push_back(data.Normals[i] - gradients[i]);
            square += values[i] * values[i] / static_cast<double>(which.size());
          }
          if (square <= options.Accuracy * options.Accuracy)
          {
            continue;
          }
          try
          {
            ThreadExecution alone(1);
            auto spline = std::make_unique<SurfaceSpline>(alone, part, local);
            if (spline->GetReport().Gain > LeastGain)
            {
              balls[b] = { cover[b].Center, cover[b].Radius, std::move(spline) };
            }
          }
          catch (const SurfaceSpline::Unsolvable&)
          {
            // too few places in this ball: what there is stays
          }
        }
      });
    balls.erase(std::remove_if(
                  balls.begin(), balls.end(), [](const Level::Ball& ball) { return !ball.Spline; }),
      balls.end());
    if (balls.empty())
    {
      break;
    }
    for (const Level::Ball& ball : balls)
    {
      this->Report.Centers += 2 * ball.Spline->GetReport().Nodes;
    }
    this->Report.LocalSplines += balls.size();
    this->Levels.push_back(std::make_unique<Level>(std::move(balls)));
    this->Levels.back()->Add(execution, data.Points, values, &gradients);
    execution.For(static_cast<std::int64_t>(n), 1024,
      [&](std::int64_t begin, std::int64_t end)
      {
        std::vector<std::uint32_t> near;
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->Levels.back()->Find(data.Points[i], near);
          open[i] = !near.empty();
          double square = 0;
          for (const std::uint32_t b : near)
          {
            const double e = this->Levels.back()->Get(b).Spline->GetReport().PointError;
            square += e * e / static_cast<double>(near.size());
          }
          squares[i] = open[i] ? square : squares[i];
        }
      });
    if (count == n)
    {
      break;
    }
  }
  if (!(options.PointError > 0))
  {
    for (std::size_t i = 0; i < n; ++i)
    {
      if (squares[i] < 0) // in no ball
      {
        const double slope = std::max(0.1, Norm(gradients[i]));
        squares[i] = values[i] * values[i] / (slope * slope);
      }
    }
    this->Report.PointError =
      std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(n));
  }
}

BlendedSpline::~BlendedSpline() = default;
BlendedSpline::BlendedSpline(BlendedSpline&&) noexcept = default;

//------------------------------------------------------------------------------
void BlendedSpline::Evaluate(Execution& execution, const std::vector<Vec3>& points,
  std::vector<double>& values, std::vector<Vec3>* gradients) const
{
  this->Whole->Evaluate(execution, points, values, gradients);
  if (this->Prior)
  {
    std::vector<double> base(points.size());
    std::vector<Vec3> slopes(gradients ? points.size() : 0);
    this->Prior->Evaluate(execution, points, base, gradients ? &slopes : nullptr);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      values[i] += base[i];
      if (gradients)
      {
        (*gradients)[i] = (*gradients)[i] + slopes[i];
      }
    }
  }
  for (const auto& level : this->Levels)
  {
    level->Add(execution, points, values, gradients);
  }
}
}
