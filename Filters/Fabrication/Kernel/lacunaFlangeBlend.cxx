// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFlangeBlend.h"

#include "lacunaExecution.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double StepsPerWidth = 24;
constexpr double MaximumNodes = 2e7;
constexpr double SplineReach = 2 * 1.4142135623730951; // lattice steps, of a control point
constexpr double EdgeReach = 0.5;                      // lattice steps, of the softened edge

std::vector<std::vector<Vec3>> Flat(const std::vector<Loop>& loops)
{
  std::vector<std::vector<Vec3>> flat;
  for (const Loop& loop : loops)
  {
    flat.emplace_back();
    for (const Vec2& p : loop)
    {
      flat.back().push_back({ p[0], p[1], 0 });
    }
  }
  return flat;
}

// Uniform cubic B-splines at t of 0..1 between the second and the third, and their derivatives.
struct UniformBasis
{
  double Value[4];
  double Slope[4];

  explicit UniformBasis(double t)
  {
    const double s = 1 - t;
    this->Value[0] = s * s * s / 6;
    this->Value[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    this->Value[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    this->Value[3] = t * t * t / 6;
    this->Slope[0] = -0.5 * s * s;
    this->Slope[1] = 1.5 * t * t - 2 * t;
    this->Slope[2] = 2 * s - 1.5 * s * s;
    this->Slope[3] = 0.5 * t * t;
  }
};
}

//------------------------------------------------------------------------------
LoopDistance::LoopDistance(const std::vector<Loop>& loops)
  : Loops(loops)
  , Index(Flat(loops), 2)
{
  const double infinity = std::numeric_limits<double>::infinity();
  this->Low = { infinity, infinity };
  this->High = { -infinity, -infinity };
  for (const Loop& loop : loops)
  {
    for (const Vec2& p : loop)
    {
      for (int i = 0; i < 2; ++i)
      {
        this->Low[i] = std::min(this->Low[i], p[i]);
        this->High[i] = std::max(this->High[i], p[i]);
      }
    }
  }
}

//------------------------------------------------------------------------------
double LoopDistance::Find(const Vec2& p, double limit) const
{
  double distance;
  this->FindRow(p, 1, 1, limit, &distance);
  return distance;
}

//------------------------------------------------------------------------------
void LoopDistance::FindRow(
  const Vec2& first, double step, std::int64_t count, double limit, double* distances) const
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    const Vec3 p{ first[0] + step * static_cast<double>(i), first[1], 0 };
    const bool far = p[0] < this->Low[0] - limit || p[0] > this->High[0] + limit ||
      p[1] < this->Low[1] - limit || p[1] > this->High[1] + limit;
    distances[i] = far ? limit : this->Index.Find(p, limit).Distance;
  }
  for (const Loop& loop : this->Loops)
  {
    const std::vector<double> crossings = FindCrossings({ loop }, first[1]);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
    {
      const double from =
        std::clamp(std::ceil((crossings[k] - first[0]) / step), 0.0, static_cast<double>(count));
      for (auto i = static_cast<std::int64_t>(from);
           i < count && first[0] + step * static_cast<double>(i) <= crossings[k + 1]; ++i)
      {
        distances[i] = 0;
      }
    }
  }
}

//------------------------------------------------------------------------------
FlangeBlend::FlangeBlend(
  Execution& execution, const LoopDistance& curves, double margin, double width)
{
  const double middle = margin + 0.5 * width;
  this->CoverCurves(curves, middle, width);
  this->Smooth(execution, this->FindSet(execution, curves, middle));
}

//------------------------------------------------------------------------------
void FlangeBlend::CoverCurves(const LoopDistance& curves, double middle, double width)
{
  const double h = width / StepsPerWidth;
  const double reach = middle + 0.5 * width + 4 * h;
  double count[2];
  for (int i = 0; i < 2; ++i)
  {
    this->Lattice.Origin[i] = curves.GetLow()[i] - reach;
    this->Lattice.Spacing[i] = h;
    count[i] = std::ceil((curves.GetHigh()[i] - curves.GetLow()[i] + 2 * reach) / h) + 1;
  }
  if (!(count[0] * count[1] <= MaximumNodes))
  {
    throw std::runtime_error("a flange of " + FormatNumber(width) +
      " mm is too narrow for a surface of " +
      FormatNumber(std::round(curves.GetHigh()[0] - curves.GetLow()[0])) + " x " +
      FormatNumber(std::round(curves.GetHigh()[1] - curves.GetLow()[1])) +
      " mm; make FlangeWidth larger");
  }
  this->Lattice.Columns = static_cast<std::int64_t>(count[0]);
  this->Lattice.Rows = static_cast<std::int64_t>(count[1]);
}

//------------------------------------------------------------------------------
std::vector<double> FlangeBlend::FindSet(
  Execution& execution, const LoopDistance& curves, double middle) const
{
  const double h = this->Lattice.Spacing[0];
  const std::int64_t columns = this->Lattice.Columns;
  std::vector<double> set(static_cast<std::size_t>(columns * this->Lattice.Rows));
  execution.For(this->Lattice.Rows, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        double* row = set.data() + j * columns;
        curves.FindRow(this->Lattice.GetNode(0, j), h, columns, middle + h, row);
        for (std::int64_t i = 0; i < columns; ++i)
        {
          row[i] = std::clamp((middle - row[i]) / h + 0.5, 0.0, 1.0);
        }
      }
    });
  return set;
}

//------------------------------------------------------------------------------
void FlangeBlend::Smooth(Execution& execution, const std::vector<double>& set)
{
  // what a control point knows of must not reach the points where the weight is 1 or 0
  constexpr double radius = 0.5 * StepsPerWidth - SplineReach - EdgeReach; // lattice steps
  const std::int64_t columns = this->Lattice.Columns;
  struct Tap
  {
    std::int64_t Step;
    double Weight;
  };
  std::vector<Tap> kernel;
  double sum = 0;
  const auto taps = static_cast<std::int64_t>(radius);
  for (std::int64_t j = -taps; j <= taps; ++j)
  {
    for (std::int64_t i = -taps; i <= taps; ++i)
    {
      const double square = static_cast<double>(i * i + j * j) / (radius * radius);
      if (square < 1)
      {
        kernel.push_back({ i + columns * j, (1 - square) * (1 - square) });
        sum += kernel.back().Weight;
      }
    }
  }
  this->Coefficients.assign(set.size(), 0);
  execution.For(this->Lattice.Rows - 2 * taps, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t node = (begin + taps) * columns + taps;
           node < (end + taps) * columns - taps; ++node)
      {
        // 0 and 1 come out exactly: all taps add up to sum in the same order
        double value = 0;
        for (const Tap& tap : kernel)
        {
          value += tap.Weight * set[node + tap.Step];
        }
        this->Coefficients[node] = value / sum;
      }
    });
}

//------------------------------------------------------------------------------
FlangeBlend::Value FlangeBlend::Evaluate(const Vec2& p) const
{
  const double h = this->Lattice.Spacing[0];
  const double u = (p[0] - this->Lattice.Origin[0]) / h;
  const double v = (p[1] - this->Lattice.Origin[1]) / h;
  Value value{ 0, { 0, 0 } };
  if (!(u >= 1 && v >= 1 && u < static_cast<double>(this->Lattice.Columns - 2) &&
        v < static_cast<double>(this->Lattice.Rows - 2)))
  {
    return value;
  }
  const auto i = static_cast<std::int64_t>(u);
  const auto j = static_cast<std::int64_t>(v);
  const double* corner = this->Coefficients.data() + (j - 1) * this->Lattice.Columns + i - 1;
  // exactly 0 or 1 where all are, not but for rounding
  bool same = true;
  for (int b = 0; b < 4; ++b)
  {
    for (int a = 0; a < 4; ++a)
    {
      same = same && corner[b * this->Lattice.Columns + a] == corner[0];
    }
  }
  if (same)
  {
    value.Weight = corner[0];
    return value;
  }
  const UniformBasis x(u - static_cast<double>(i));
  const UniformBasis y(v - static_cast<double>(j));
  for (int b = 0; b < 4; ++b)
  {
    const double* row = corner + b * this->Lattice.Columns;
    double inner = 0;
    double slope = 0;
    for (int a = 0; a < 4; ++a)
    {
      inner += x.Value[a] * row[a];
      slope += x.Slope[a] * row[a];
    }
    value.Weight += y.Value[b] * inner;
    value.Gradient[0] += y.Value[b] * slope / h;
    value.Gradient[1] += y.Slope[b] * inner / h;
  }
  return value;
}
}
