// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSymmetrySearch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr const char* NoPlane =
  "no plane mirrors enough of the data onto data: too little of one side is there";
constexpr double LongestInCells = 10000;
constexpr std::size_t FirstCandidates = 16;
constexpr std::size_t LastCandidates = 4;
constexpr std::size_t ComparedLevels = 3;

struct Candidate
{
  MirrorPlane Plane;
  double Rating;
};

bool AreSame(
  const MirrorPlane& a, const MirrorPlane& b, const Vec3& center, double cosine, double distance)
{
  const double c = Dot(a.Normal, b.Normal);
  const double other = c < 0 ? -b.Distance(center) : b.Distance(center);
  return std::abs(c) > cosine && std::abs(a.Distance(center) - other) < distance;
}

// The best count candidates of which no two are the same, the best first.
std::vector<Candidate> SelectBest(std::vector<Candidate> candidates, std::size_t count,
  const Vec3& center, double angle, double distance)
{
  std::stable_sort(candidates.begin(), candidates.end(),
    [](const Candidate& a, const Candidate& b) { return a.Rating > b.Rating; });
  std::vector<Candidate> best;
  for (const Candidate& c : candidates)
  {
    if (best.size() < count && c.Rating > -1 &&
      std::none_of(best.begin(), best.end(),
        [&](const Candidate& b)
        { return AreSame(b.Plane, c.Plane, center, std::cos(angle * Pi / 180), distance); }))
    {
      best.push_back(c);
    }
  }
  return best;
}

std::array<Vec3, 2> TurnsOf(const Vec3& n)
{
  int least = 0;
  for (int a = 1; a < 3; ++a)
  {
    least = std::abs(n[a]) < std::abs(n[least]) ? a : least;
  }
  Vec3 axis{ 0, 0, 0 };
  axis[least] = 1;
  const Vec3 first = Normalized(Cross(n, axis));
  return { first, Cross(n, first) };
}

// Solves with the diagonal enlarged by the factor 1 + damping. Unknowns are scaled by their diagonal
// first; those that nothing depends on (but for rounding) stay 0, such as turns out of a slice.
std::array<double, 3> SolveDamped(const SymmetryEquations& e, double damping)
{
  const auto& m = e.Matrix;
  double a[3][4] = { { m[0], m[1], m[2], e.Right[0] }, { m[1], m[3], m[4], e.Right[1] },
    { m[2], m[4], m[5], e.Right[2] } };
  const double least = 1e-14 * (m[0] + m[3] + m[5]);
  std::array<double, 3> scale;
  for (int i = 0; i < 3; ++i)
  {
    scale[i] = a[i][i] > least ? 1 / std::sqrt(a[i][i]) : 0;
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      a[i][j] *= scale[i] * scale[j];
    }
    a[i][3] *= scale[i];
    a[i][i] = 1 + damping;
  }
  for (int i = 0; i < 3; ++i) // positive definite: no pivots needed
  {
    for (int r = i + 1; r < 3; ++r)
    {
      const double f = a[r][i] / a[i][i];
      for (int j = i; j < 4; ++j)
      {
        a[r][j] -= f * a[i][j];
      }
    }
  }
  std::array<double, 3> x{};
  for (int i = 2; i >= 0; --i)
  {
    x[i] = a[i][3];
    for (int j = i + 1; j < 3; ++j)
    {
      x[i] -= a[i][j] * x[j];
    }
    x[i] /= a[i][i];
  }
  for (int i = 0; i < 3; ++i)
  {
    x[i] *= scale[i];
  }
  return x;
}

// Turns and shifts a plane about the middle of the data.
MirrorPlane Move(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
  const std::array<double, 3>& step, const Vec3& center)
{
  const double distance = plane.Offset - Dot(plane.Normal, center);
  MirrorPlane moved;
  moved.Normal = Normalized(plane.Normal + step[0] * turns[0] + step[1] * turns[1]);
  moved.Offset = Dot(moved.Normal, center) + distance + step[2];
  return moved;
}

double MeanCost(const SymmetryEquations& e)
{
  return e.Count > 0 ? e.Cost / e.Count : std::numeric_limits<double>::infinity();
}

// 4.685 standard deviations, the limit at which Tukey's estimate keeps 95 % efficiency.
double LimitOf(std::vector<double> residuals)
{
  if (residuals.empty())
  {
    return 0;
  }
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return 4.685 * 1.4826 * *middle;
}

MirrorPlane Refine(const SymmetryLevel& level, MirrorPlane plane, Execution& execution)
{
  const double radius = Norm(level.HalfSize);
  const double small = 1e-4 * level.CellSize;
  // From edges a cell out of place, which all count, to what is left when they are in place.
  constexpr double starts[] = { 2, 0.7, 0.2, 0.05, 0.02 };
  for (const double start : starts)
  {
    const double limit =
      std::max(start * level.CellResidual, LimitOf(level.GetResiduals(plane, execution)));
    double damping = 1e-6;
    std::array<Vec3, 2> turns = TurnsOf(plane.Normal);
    SymmetryEquations equations = level.Linearize(plane, turns, limit, execution);
    for (int iteration = 0; iteration < 6 && damping < 1e3 && equations.Count > 0; ++iteration)
    {
      const std::array<double, 3> step = SolveDamped(equations, damping);
      const double length = std::hypot(radius * step[0], radius * step[1], step[2]);
      const MirrorPlane trial = Move(plane, turns, step, level.Center);
      const std::array<Vec3, 2> trialTurns = TurnsOf(trial.Normal);
      const SymmetryEquations there = level.Linearize(trial, trialTurns, limit, execution);
      if (there.Count >= 0.5 * equations.Count && MeanCost(there) <= MeanCost(equations))
      {
        plane = trial;
        turns = trialTurns;
        equations = there;
        damping = std::max(1e-6, damping / 10);
      }
      else
      {
        damping *= 10;
      }
      if (length < small)
      {
        break;
      }
    }
  }
  return plane;
}

// Plane and rating of each candidate at a level, side by side.
void RefineAll(const SymmetryLevel& level, std::vector<Candidate>& candidates, Execution& execution)
{
  execution.For(static_cast<std::int64_t>(candidates.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      ThreadExecution serial(1);
      for (std::int64_t i = begin; i < end; ++i)
      {
        candidates[i].Plane = Refine(level, candidates[i].Plane, serial);
        candidates[i].Rating = level.Rate(candidates[i].Plane);
      }
    });
}

// The best offsets for each direction that are better than their neighbours.
std::vector<Candidate> RateAll(
  const SymmetryLevel& level, const std::vector<Vec3>& directions, Execution& execution)
{
  constexpr std::size_t kept = 3;
  std::vector<std::vector<Candidate>> found(directions.size());
  execution.For(static_cast<std::int64_t>(directions.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const Vec3& n = directions[i];
        double reach = 0;
        for (int a = 0; a < 3; ++a)
        {
          reach += std::abs(n[a]) * level.HalfSize[a];
        }
        const int steps = static_cast<int>(std::ceil(0.7 * reach / level.CellSize));
        std::vector<Candidate> line;
        for (int k = -steps; k <= steps; ++k)
        {
          const MirrorPlane plane{ n, Dot(n, level.Center) + k * level.CellSize };
          line.push_back({ plane, level.Rate(plane) });
        }
        std::vector<Candidate> peaks;
        for (std::size_t k = 0; k < line.size(); ++k)
        {
          const double before = k > 0 ? line[k - 1].Rating : -1;
          const double after = k + 1 < line.size() ? line[k + 1].Rating : -1;
          if (line[k].Rating > -1 && line[k].Rating >= before && line[k].Rating >= after)
          {
            peaks.push_back(line[k]);
          }
        }
        found[i] = SelectBest(peaks, kept, level.Center, 1, 1.5 * level.CellSize);
      }
    });
  std::vector<Candidate> all;
  for (const auto& some : found)
  {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}
}

//------------------------------------------------------------------------------
void SymmetryEquations::Add(double residual, const std::array<double, 3>& slopes, double limit)
{
  this->Count += 1;
  const double t = residual / limit;
  const double inside = 1 - t * t;
  if (inside <= 0)
  {
    this->Cost += 1;
    return;
  }
  this->Cost += 1 - inside * inside * inside;
  const double weight = inside * inside;
  std::size_t k = 0;
  for (std::size_t i = 0; i < 3; ++i)
  {
    for (std::size_t j = i; j < 3; ++j)
    {
      this->Matrix[k++] += weight * slopes[i] * slopes[j];
    }
    this->Right[i] -= weight * slopes[i] * residual;
  }
}

//------------------------------------------------------------------------------
SymmetryEquations& SymmetryEquations::operator+=(const SymmetryEquations& other)
{
  this->Count += other.Count;
  this->Cost += other.Cost;
  for (std::size_t i = 0; i < this->Matrix.size(); ++i)
  {
    this->Matrix[i] += other.Matrix[i];
  }
  for (std::size_t i = 0; i < this->Right.size(); ++i)
  {
    this->Right[i] += other.Right[i];
  }
  return *this;
}

//------------------------------------------------------------------------------
std::vector<Vec3> HemisphereDirections(int count)
{
  std::vector<Vec3> directions;
  const double golden = Pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i)
  {
    const double z = (i + 0.5) / count;
    const double r = std::sqrt(1 - z * z);
    directions.push_back({ r * std::cos(golden * i), r * std::sin(golden * i), z });
  }
  return directions;
}

//------------------------------------------------------------------------------
std::vector<Vec3> RingDirections(int axis, int count)
{
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i)
  {
    Vec3 n{ 0, 0, 0 };
    n[(axis + 1) % 3] = std::cos(Pi * i / count);
    n[(axis + 2) % 3] = std::sin(Pi * i / count);
    directions.push_back(n);
  }
  return directions;
}

//------------------------------------------------------------------------------
SymmetryResult FindSymmetryPlane(const std::vector<std::unique_ptr<SymmetryLevel>>& levels,
  const std::vector<Vec3>& directions, Execution& execution)
{
  const Execution::NestedStages nested(execution);
  const Vec3 center = levels.front()->Center;
  const double size = Norm(levels.front()->HalfSize);
  // Planes a cell apart are tried: thousands mean a spacing that is wrong, not a patient.
  if (!(size <= LongestInCells * levels.front()->CellSize))
  {
    std::ostringstream message;
    message << "the data reach " << size
            << " mm from their middle, too far to look for symmetry in "
            << "cells of " << levels.front()->CellSize
            << " mm: mend the spacing, or give the plane (PlaneMethod Given)";
    throw std::runtime_error(message.str());
  }
  execution.SetStage(0, 0.3);
  std::vector<Candidate> candidates = SelectBest(RateAll(*levels.front(), directions, execution),
    FirstCandidates, center, 15, 2.5 * levels.front()->CellSize);
  if (candidates.empty())
  {
    throw std::runtime_error(NoPlane);
  }
  for (std::size_t l = 0; l < std::min(ComparedLevels, levels.size()); ++l)
  {
    execution.SetStage(0.3 + 0.1 * static_cast<double>(l), 0.4 + 0.1 * static_cast<double>(l));
    RefineAll(*levels[l], candidates, execution);
    candidates =
      SelectBest(candidates, l == 0 ? FirstCandidates : LastCandidates, center, 10, 0.05 * size);
    if (candidates.empty())
    {
      throw std::runtime_error(NoPlane);
    }
  }
  SymmetryResult result;
  result.Rating = candidates[0].Rating;
  if (candidates.size() > 1)
  {
    const double other = 1 - candidates[1].Rating;
    result.Ambiguity = other > 0 ? std::max(0.0, (1 - result.Rating) / other) : 1;
  }
  execution.SetStage(0.7, 1);
  result.Plane = levels.size() > ComparedLevels
    ? Refine(*levels.back(), candidates[0].Plane, execution)
    : candidates[0].Plane;
  return result;
}
}
