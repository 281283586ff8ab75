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

// A local spline.
struct Ball
{
  Vec3 Center;
  double Radius;
  std::unique_ptr<SurfaceSpline> Spline;
};

// What the splines so far leave of the points' values and normals, and where more may be of use.
struct Rest
{
  explicit Rest(std::size_t points)
    : Values(points)
    , Gradients(points)
    , Open(points, 1)
    , Squares(points, -1)
  {
  }

  std::vector<double> Values;
  std::vector<Vec3> Gradients; // to be the normals
  std::vector<char> Open;      // 1 in the balls of the last level
  std::vector<double> Squares; // of the expected errors; below 0: in no ball
};
}

//------------------------------------------------------------------------------
// Local splines, and which of them are near a point.
class BlendedSpline::Level
{
public:
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

  // Finds the points in balls, and their expected errors.
  void Mark(Execution& execution, const std::vector<Vec3>& points, Rest& rest) const
  {
    execution.For(static_cast<std::int64_t>(points.size()), 1024,
      [&](std::int64_t begin, std::int64_t end)
      {
        std::vector<std::uint32_t> near;
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->Find(points[i], near);
          rest.Open[i] = !near.empty();
          double square = 0;
          for (const std::uint32_t b : near)
          {
            const double e = this->Balls[b].Spline->GetReport().PointError;
            square += e * e / static_cast<double>(near.size());
          }
          rest.Squares[i] = rest.Open[i] ? square : rest.Squares[i];
        }
      });
  }

private:
  using Cell = std::array<std::int64_t, 3>;

  // Pairs of a point and a ball around it, in the order of the balls and in that of the points.
  struct Pairs
  {
    std::vector<std::vector<std::uint32_t>> Near; // balls around each point
    std::vector<std::size_t> Firsts;              // of each point, in Places
    std::vector<std::size_t> Places;              // in Members
    std::vector<std::size_t> Starts;              // of each ball, in Members
    std::vector<std::uint32_t> Members;           // points
  };

  // Of the pairs, in the order of Members.
  struct LocalValues
  {
    std::vector<double> Values;
    std::vector<Vec3> Slopes; // empty: not wanted
  };

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
    const Pairs pairs = this->FindPairs(execution, points, count);
    const LocalValues local = this->EvaluateBalls(execution, points, pairs, gradients != nullptr);
    execution.For(static_cast<std::int64_t>(count), 1024,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->AddBlend(
            pairs, local, i, points[i], values[i], gradients ? gradients + i : nullptr);
        }
      });
  }

  Pairs FindPairs(Execution& execution, const Vec3* points, std::size_t count) const
  {
    Pairs pairs;
    pairs.Near.resize(count);
    execution.For(static_cast<std::int64_t>(count), 512,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->Find(points[i], pairs.Near[i]);
        }
      });
    pairs.Starts.assign(this->Balls.size() + 1, 0);
    pairs.Firsts.assign(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i)
    {
      pairs.Firsts[i + 1] = pairs.Firsts[i] + pairs.Near[i].size();
      for (const std::uint32_t b : pairs.Near[i])
      {
        ++pairs.Starts[b + 1];
      }
    }
    std::partial_sum(pairs.Starts.begin(), pairs.Starts.end(), pairs.Starts.begin());
    std::vector<std::size_t> at(pairs.Starts.begin(), pairs.Starts.end() - 1);
    pairs.Members.resize(pairs.Firsts.back());
    pairs.Places.resize(pairs.Firsts.back());
    for (std::size_t i = 0; i < count; ++i)
    {
      for (std::size_t k = 0; k < pairs.Near[i].size(); ++k)
      {
        const std::size_t place = at[pairs.Near[i][k]]++;
        pairs.Members[place] = static_cast<std::uint32_t>(i);
        pairs.Places[pairs.Firsts[i] + k] = place;
      }
    }
    return pairs;
  }

  LocalValues EvaluateBalls(
    Execution& execution, const Vec3* points, const Pairs& pairs, bool withSlopes) const
  {
    LocalValues local;
    local.Values.resize(pairs.Members.size());
    local.Slopes.resize(withSlopes ? pairs.Members.size() : 0);
    execution.For(static_cast<std::int64_t>(this->Balls.size()), 4,
      [&](std::int64_t begin, std::int64_t end)
      {
        Vec3 block[RadialBlock];
        for (std::int64_t b = begin; b < end; ++b)
        {
          const std::size_t last = pairs.Starts[b + 1];
          for (std::size_t first = pairs.Starts[b]; first < last; first += RadialBlock)
          {
            const std::size_t size = std::min(RadialBlock, last - first);
            for (std::size_t i = 0; i < size; ++i)
            {
              block[i] = points[pairs.Members[first + i]];
            }
            this->Balls[b].Spline->EvaluateBlock(block, size, local.Values.data() + first,
              withSlopes ? local.Slopes.data() + first : nullptr);
          }
        }
      });
    return local;
  }

  // Adds the weighted mean of the balls around point i, which is at x. gradient may be null.
  void AddBlend(const Pairs& pairs, const LocalValues& local, std::size_t i, const Vec3& x,
    double& value, Vec3* gradient) const
  {
    double weights = 0;
    double sum = 0;
    Vec3 weightSlope{};
    Vec3 sumSlope{};
    for (std::size_t k = 0; k < pairs.Near[i].size(); ++k)
    {
      const Ball& ball = this->Balls[pairs.Near[i][k]];
      const std::size_t place = pairs.Places[pairs.Firsts[i] + k];
      const Vec3 away = (1 / ball.Radius) * (x - ball.Center);
      double slope = 0;
      const double w = GetWeight(Norm(away), slope);
      weights += w;
      sum += w * local.Values[place];
      if (gradient)
      {
        const Vec3 g = (slope / ball.Radius) * away;
        weightSlope = weightSlope + g;
        sumSlope = sumSlope + w * local.Slopes[place] + local.Values[place] * g;
      }
    }
    if (!(weights > 0))
    {
      return;
    }
    // 1 / weights, and where these are small what it joins to in C2
    const double u = std::min(1.0, weights / LeastWeight);
    const double factor = u < 1 ? (3 - 3 * u + u * u) / LeastWeight : 1 / weights;
    value += factor * sum;
    if (gradient)
    {
      const double change =
        u < 1 ? (2 * u - 3) / (LeastWeight * LeastWeight) : -1 / (weights * weights);
      *gradient = *gradient + factor * sumSlope + (change * sum) * weightSlope;
    }
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

// A spline of what is left of some points; null: it is of no use.
std::unique_ptr<SurfaceSpline> FitRest(const OrientedPoints& data, const Rest& rest,
  const std::vector<std::size_t>& which, const BlendedSplineOptions& options)
{
  OrientedPoints part;
  part.Points = Pick(data.Points, which);
  part.Normals = Pick(data.Normals, which);
  part.Errors = Pick(data.Errors, which);
  part.Free = Pick(data.Free, which);
  double square = 0;
  for (const std::size_t i : which)
  {
    part.Values.push_back(-rest.Values[i]);
    part.Slopes.push_back(data.Normals[i] - rest.Gradients[i]);
    square += rest.Values[i] * rest.Values[i] / static_cast<double>(which.size());
  }
  if (square <= options.Accuracy * options.Accuracy)
  {
    return nullptr;
  }
  try
  {
    ThreadExecution alone(1);
    auto spline = std::make_unique<SurfaceSpline>(alone, part, options);
    return spline->GetReport().Gain > LeastGain ? std::move(spline) : nullptr;
  }
  catch (const SurfaceSpline::Unsolvable&)
  {
    return nullptr; // too few places in this ball: what there is stays
  }
}

std::vector<Ball> FitBalls(Execution& execution, const OrientedPoints& data, const Rest& rest,
  const std::vector<Members>& cover, const BlendedSplineOptions& options)
{
  std::vector<Ball> balls(cover.size());
  execution.For(static_cast<std::int64_t>(cover.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t b = begin; b < end; ++b)
      {
        balls[b] = { cover[b].Center, cover[b].Radius,
          FitRest(data, rest, cover[b].Points, options) };
      }
    });
  balls.erase(
    std::remove_if(balls.begin(), balls.end(), [](const Ball& ball) { return !ball.Spline; }),
    balls.end());
  return balls;
}

// Numbers up to n so that each beginning is spread evenly.
std::vector<std::size_t> GetScrambledOrder(std::size_t n)
{
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
    [](std::size_t a, std::size_t b) { return Scramble(a) < Scramble(b); });
  return order;
}

// Root mean square of what is expected in balls, and of what is left elsewhere.
double GetPointError(Rest& rest)
{
  const std::size_t n = rest.Squares.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    if (rest.Squares[i] < 0) // in no ball
    {
      const double slope = std::max(0.1, Norm(rest.Gradients[i]));
      rest.Squares[i] = rest.Values[i] * rest.Values[i] / (slope * slope);
    }
  }
  return std::sqrt(
    std::accumulate(rest.Squares.begin(), rest.Squares.end(), 0.0) / static_cast<double>(n));
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
  const SingleBlasThread single(execution.GetNumberOfThreads());
  const std::vector<std::size_t> order = GetScrambledOrder(n);
  Rest rest(n);
  this->Evaluate(execution, data.Points, rest.Values, &rest.Gradients);
  BlendedSplineOptions local = options;
  local.Nodes = BallNodes;
  double stage = 0.3;
  for (std::size_t count = LevelPoints;; count *= 4)
  {
    count = std::min(count, n);
    execution.SetStage(stage, count == n ? 1 : stage + 0.3 * (1 - stage));
    stage += 0.3 * (1 - stage);
    const std::vector<Members> cover = CoverPoints(data.Points,
      { order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count) }, rest.Open);
    std::vector<Ball> balls = FitBalls(execution, data, rest, cover, local);
    if (balls.empty())
    {
      break;
    }
    for (const Ball& ball : balls)
    {
      this->Report.Centers += 2 * ball.Spline->GetReport().Nodes;
    }
    this->Report.LocalSplines += balls.size();
    this->Levels.push_back(std::make_unique<Level>(std::move(balls)));
    this->Levels.back()->Add(execution, data.Points, rest.Values, &rest.Gradients);
    this->Levels.back()->Mark(execution, data.Points, rest);
    if (count == n)
    {
      break;
    }
  }
  if (!(options.PointError > 0))
  {
    this->Report.PointError = GetPointError(rest);
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
