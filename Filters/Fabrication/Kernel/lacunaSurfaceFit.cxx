// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceFit.h"

#include "lacunaCubicSpline.h"
#include "lacunaExecution.h"
#include "lacunaGridChecks.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
struct KnotSelection::Trial
{
  std::vector<double> Interior;
  std::vector<double> AtSites; // deviation
  double Deviation = 0;        // the largest of them
};

//------------------------------------------------------------------------------
KnotSelection::KnotSelection(const std::vector<double>& sites, const std::vector<double>& samples,
  std::int64_t width, int components)
  : Sites(sites)
  , Samples(samples)
  , Width(width)
  , Components(components)
{
  const auto count = static_cast<std::int64_t>(sites.size());
  // Divided differences of order 4, five sites each; 24 times them is the fourth derivative.
  std::vector<double> fourth(std::max<std::int64_t>(0, count - 4), 0.0);
  for (std::int64_t i = 0; i + 4 < count; ++i)
  {
    double weight[5];
    for (int a = 0; a < 5; ++a)
    {
      weight[a] = 1;
      for (int b = 0; b < 5; ++b)
      {
        weight[a] /= a == b ? 1 : sites[i + a] - sites[i + b];
      }
    }
    const double* d = samples.data() + i * width;
    for (std::int64_t k = 0; k < width; k += components)
    {
      double sum = 0;
      for (int c = 0; c < components; ++c)
      {
        double difference = 0;
        for (int a = 0; a < 5; ++a)
        {
          difference += weight[a] * d[a * width + k + c];
        }
        sum += difference * difference;
      }
      fourth[i] = std::max(fourth[i], sum);
    }
  }
  // The fourth root of the largest difference in which an interval takes part.
  this->Density.assign(count - 1, 0.0);
  double total = 0;
  for (std::int64_t i = 0; i + 1 < count; ++i)
  {
    double largest = 0;
    for (std::int64_t j = std::max<std::int64_t>(0, i - 3);
         j <= i && j < static_cast<std::int64_t>(fourth.size()); ++j)
    {
      largest = std::max(largest, fourth[j]);
    }
    this->Density[i] = std::sqrt(std::sqrt(std::sqrt(largest)));
    total += this->Density[i] * (sites[i + 1] - sites[i]);
  }
  // Nowhere is it nothing: the differences of a part say little of long intervals.
  const double least =
    total > 0 ? 0.1 * total / (sites.back() - sites.front()) : 1 / (sites.back() - sites.front());
  for (double& d : this->Density)
  {
    d = std::max(d, least);
  }
}

//------------------------------------------------------------------------------
std::vector<double> KnotSelection::Place(std::int64_t count) const
{
  const auto sites = static_cast<std::int64_t>(this->Sites.size());
  std::vector<double> mass(sites, 0.0);
  for (std::int64_t i = 1; i < sites; ++i)
  {
    mass[i] = mass[i - 1] + this->Density[i - 1] * (this->Sites[i] - this->Sites[i - 1]);
  }
  // Positions in numbers of sites, at equal steps of the mass.
  std::vector<double> positions(count);
  double closest = static_cast<double>(sites);
  double previous = 0;
  std::int64_t i = 1;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const double wanted = mass.back() * static_cast<double>(k + 1) / static_cast<double>(count + 1);
    while (i + 1 < sites && mass[i] < wanted)
    {
      ++i;
    }
    positions[k] = static_cast<double>(i) - (mass[i] - wanted) / (mass[i] - mass[i - 1]);
    closest = std::min(closest, positions[k] - previous);
    previous = positions[k];
  }
  std::vector<double> interior(count);
  if (count == 0 || closest >= 1.25)
  {
    // Every interval holds a site: anywhere will do. Short decimals make a short file.
    double spacing = this->Sites.back() - this->Sites.front();
    for (std::int64_t s = 1; s < sites; ++s)
    {
      spacing = std::min(spacing, this->Sites[s] - this->Sites[s - 1]);
    }
    const double steps = std::pow(10, std::ceil(-std::log10(0.101 * spacing)));
    for (std::int64_t k = 0; k < count; ++k)
    {
      const auto whole = static_cast<std::int64_t>(positions[k]);
      const double x = this->Sites[whole] +
        (positions[k] - static_cast<double>(whole)) * (this->Sites[whole + 1] - this->Sites[whole]);
      interior[k] = std::round(steps * x) / steps;
    }
    return interior;
  }
  // At sites, each one's own, those of interpolation at most: always well posed.
  std::int64_t lowest = 2;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const std::int64_t highest = sites - 3 - (count - 1 - k);
    const std::int64_t site =
      std::clamp(static_cast<std::int64_t>(std::llround(positions[k])), lowest, highest);
    interior[k] = this->Sites[site];
    lowest = site + 1;
  }
  return interior;
}

//------------------------------------------------------------------------------
KnotSelection::Trial KnotSelection::Try(Execution& execution, std::int64_t count) const
{
  Trial trial;
  trial.Interior = this->Place(count);
  const CubicSplineFit fit(
    CubicSplineSpace(this->Sites.front(), trial.Interior, this->Sites.back()), this->Sites);
  trial.AtSites = fit.Deviation(execution, this->Samples, this->Width, this->Components);
  trial.Deviation = *std::max_element(trial.AtSites.begin(), trial.AtSites.end());
  return trial;
}

//------------------------------------------------------------------------------
void KnotSelection::Equalise(const Trial& trial)
{
  if (!(trial.Deviation > 0))
  {
    return;
  }
  // Deviation goes with the fourth power of an interval's length.
  std::size_t first = 0;
  for (std::size_t k = 0; k <= trial.Interior.size(); ++k)
  {
    const double end = k < trial.Interior.size() ? trial.Interior[k] : this->Sites.back();
    std::size_t last = first;
    double largest = trial.AtSites[first];
    while (last + 1 < this->Sites.size() && this->Sites[last + 1] <= end)
    {
      ++last;
      largest = std::max(largest, trial.AtSites[last]);
    }
    const double factor = std::pow(std::max(largest / trial.Deviation, 0.01), 0.125);
    for (std::size_t i = first; i < std::max(last, first + 1) && i < this->Density.size(); ++i)
    {
      this->Density[i] *= factor;
    }
    first = last;
  }
}

//------------------------------------------------------------------------------
KnotSelection::Result KnotSelection::Select(Execution& execution, double tolerance)
{
  const auto sites = static_cast<std::int64_t>(this->Sites.size());
  Trial best;
  best.Interior.assign(this->Sites.begin() + 2, this->Sites.end() - 2);
  Trial failed;
  std::int64_t lo = -1;        // not enough knots
  std::int64_t hi = sites - 4; // interpolation
  // The fewest knots of this density. Deviation goes with the fourth power of the intervals'
  // length, which leads from a known number to a good guess.
  while (hi - lo > 1)
  {
    double law = 0;
    if (this->LastDeviation > 0)
    {
      law = std::ceil((this->LastCount + 1) * std::pow(this->LastDeviation / tolerance, 0.25) - 1);
    }
    std::int64_t guess = (lo + hi) / 2;
    if (law < static_cast<double>(hi))
    {
      guess = std::max(lo + 1, static_cast<std::int64_t>(law));
    }
    Trial trial = this->Try(execution, guess);
    this->LastCount = static_cast<double>(guess);
    this->LastDeviation = trial.Deviation;
    if (trial.Deviation <= tolerance)
    {
      best = std::move(trial);
      hi = guess;
    }
    else
    {
      failed = std::move(trial);
      lo = guess;
    }
  }
  // Fewer by moving them, as long as that brings the deviation down.
  for (int round = 0; round < 5 && lo > 0; ++round)
  {
    this->Equalise(failed);
    Trial trial = this->Try(execution, lo);
    if (trial.Deviation <= tolerance)
    {
      best = std::move(trial);
      round = -1;
      trial = this->Try(execution, --lo);
    }
    else if (round > 1 && trial.Deviation > failed.Deviation)
    {
      break;
    }
    failed = std::move(trial);
  }
  return { best.Interior, best.Deviation };
}

//------------------------------------------------------------------------------
KnotSelection::Result KnotSelection::SelectCount(Execution& execution, std::int64_t count)
{
  Trial best = this->Try(execution, count);
  Trial trial = best;
  for (int round = 0; round < 3 && count > 0; ++round)
  {
    this->Equalise(trial);
    trial = this->Try(execution, count);
    if (trial.Deviation < best.Deviation)
    {
      best = trial;
    }
  }
  return { best.Interior, best.Deviation };
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Farthest = 1e6; // mm

// Samples with the given number of values each, at the crossings of two sets of parameters.
struct Problem
{
  std::vector<double> U;
  std::vector<double> V;
  int Components = 0;
  std::vector<double> ByU; // one row for each u, v fastest
  std::vector<double> ByV; // one row for each v, u fastest

  std::int64_t Columns() const { return static_cast<std::int64_t>(this->U.size()); }
  std::int64_t Rows() const { return static_cast<std::int64_t>(this->V.size()); }
};

struct Spaces
{
  CubicSplineSpace U;
  CubicSplineSpace V;
  std::int64_t GetSize() const { return this->U.GetSize() * this->V.GetSize(); }
};

// in: rows x columns groups of values; out: columns x rows.
std::vector<double> Transposed(
  const std::vector<double>& in, std::int64_t rows, std::int64_t columns, int group)
{
  std::vector<double> out(in.size());
  for (std::int64_t r = 0; r < rows; ++r)
  {
    for (std::int64_t c = 0; c < columns; ++c)
    {
      std::copy_n(
        in.data() + (r * columns + c) * group, group, out.data() + (c * rows + r) * group);
    }
  }
  return out;
}

Spaces Interpolation(const Problem& problem)
{
  return { CubicSplineSpace::NotAKnot(problem.U), CubicSplineSpace::NotAKnot(problem.V) };
}

// Coefficients of the tensor product least squares fit, u fastest.
std::vector<double> Solve(Execution& execution, const Problem& problem, const Spaces& spaces)
{
  const std::int64_t sizeU = spaces.U.GetSize();
  const int group = problem.Components;
  std::vector<double> alongU;
  CubicSplineFit(spaces.U, problem.U).Solve(execution, problem.ByU, problem.Rows() * group, alongU);
  std::vector<double> coefficients;
  CubicSplineFit(spaces.V, problem.V)
    .Solve(
      execution, Transposed(alongU, sizeU, problem.Rows(), group), sizeU * group, coefficients);
  return coefficients;
}

// The largest distance between the samples (by u) and the spline with these coefficients.
double Deviation(Execution& execution, const Problem& problem, const Spaces& spaces,
  const std::vector<double>& coefficients, const std::vector<double>& samples, int group)
{
  const std::int64_t sizeU = spaces.U.GetSize();
  std::vector<double> alongV;
  CubicSplineFit(spaces.V, problem.V).Evaluate(execution, coefficients, sizeU * group, alongV);
  std::vector<double> values;
  CubicSplineFit(spaces.U, problem.U)
    .Evaluate(
      execution, Transposed(alongV, problem.Rows(), sizeU, group), problem.Rows() * group, values);
  double largest = 0;
  for (std::size_t i = 0; i < samples.size(); i += group)
  {
    double sum = 0;
    for (int c = 0; c < group; ++c)
    {
      sum += (samples[i + c] - values[i + c]) * (samples[i + c] - values[i + c]);
    }
    largest = std::max(largest, sum);
  }
  return std::sqrt(largest);
}

// The spaces with the fewest control points found whose fit deviates by no more than tolerance.
Spaces Economise(Execution& execution, const Problem& problem, double tolerance)
{
  KnotSelection selectU(
    problem.U, problem.ByU, problem.Rows() * problem.Components, problem.Components);
  KnotSelection selectV(
    problem.V, problem.ByV, problem.Columns() * problem.Components, problem.Components);
  const auto make = [&](const KnotSelection::Result& u, const KnotSelection::Result& v) -> Spaces
  {
    return { CubicSplineSpace(problem.U.front(), u.Interior, problem.U.back()),
      CubicSplineSpace(problem.V.front(), v.Interior, problem.V.back()) };
  };
  const auto deviation = [&](const Spaces& spaces)
  {
    return Deviation(execution, problem, spaces, Solve(execution, problem, spaces), problem.ByU,
      problem.Components);
  };

  Spaces best = Interpolation(problem);
  // The two directions share the tolerance. Their deviations seldom add up at one place, so what
  // is left over after the first round is shared out again.
  double share = tolerance;
  double longest = 0; // share known to do
  for (int round = 0; round < 4; ++round)
  {
    execution.Report(0.2 * round);
    const KnotSelection::Result v = selectV.Select(execution, 0.5 * share);
    const KnotSelection::Result u =
      selectU.Select(execution, std::max(0.5 * share, share - v.Deviation));
    const Spaces spaces = make(u, v);
    const double reached = deviation(spaces);
    const bool good = reached <= tolerance;
    if (good)
    {
      best = spaces.GetSize() <= best.GetSize() ? spaces : best;
      longest = share;
    }
    if (reached == 0 || (good && reached > 0.97 * tolerance))
    {
      break;
    }
    const double next = share * std::clamp(0.99 * tolerance / reached, 0.3, 3.0);
    share = next > longest ? next : 0.5 * (share + longest);
  }
  // A knot less along one direction, as long as it goes.
  for (bool fewer = true; fewer;)
  {
    fewer = false;
    execution.Report(0.8);
    for (const bool alongU :
      { best.U.GetSize() < best.V.GetSize(), best.U.GetSize() >= best.V.GetSize() })
    {
      CubicSplineSpace& shrunk = alongU ? best.U : best.V;
      const std::int64_t count = shrunk.GetSize() - 5;
      if (count < 0)
      {
        continue;
      }
      const KnotSelection::Result result =
        (alongU ? selectU : selectV).SelectCount(execution, count);
      if (result.Deviation > tolerance)
      {
        continue;
      }
      Spaces trial = best;
      (alongU ? trial.U : trial.V) =
        CubicSplineSpace(shrunk.GetFirst(), result.Interior, shrunk.GetLast());
      if (deviation(trial) <= tolerance)
      {
        best = trial;
        fewer = true;
        break;
      }
    }
  }
  return best;
}

// The points that a surface has to go through, and how points are made of its components.
struct Target
{
  const std::function<Vec3(double u, double v, const double* values)>& Place;
  std::vector<double> Coordinates; // of the points, by u
};

// The surface in its spaces. decimals: to which control points are rounded; 17: not at all.
SurfaceFit Build(Execution& execution, const Problem& problem, const Spaces& spaces, int decimals,
  const Target& target)
{
  SurfaceFit fit;
  fit.Surface.U = spaces.U;
  fit.Surface.V = spaces.V;
  fit.U = problem.U;
  fit.V = problem.V;
  fit.Decimals = decimals;
  std::vector<double> coefficients;
  if (problem.Components > 0)
  {
    coefficients = Solve(execution, problem, spaces);
  }
  const double steps = std::pow(10, decimals);
  const std::int64_t sizeU = spaces.U.GetSize();
  std::vector<double> flat;
  flat.reserve(3 * spaces.GetSize());
  for (std::int64_t k = 0; k < spaces.GetSize(); ++k)
  {
    Vec3 p = target.Place(spaces.U.GetIdentityCoefficient(k % sizeU),
      spaces.V.GetIdentityCoefficient(k / sizeU), coefficients.data() + k * problem.Components);
    for (double& x : p.Elements)
    {
      x = decimals < 17 ? std::round(x * steps) / steps + 0.0 : x;
      flat.push_back(x);
    }
    fit.Surface.ControlPoints.push_back(p);
  }
  fit.MaximumDeviation = Deviation(execution, problem, spaces, flat, target.Coordinates, 3);
  return fit;
}

// Fits the components that need it, lets place make points of their coefficients and verifies
// what came out, rounding included.
SurfaceFit FitComponents(Execution& execution, Problem& problem, double neglected,
  const std::function<Vec3(double u, double v, const double* values)>& place,
  const std::vector<Vec3>& points, const SurfaceFitOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  // Samples by u and by v, points, coordinates, and as much again for solutions.
  RequireMemory("a surface through so many samples",
    sizeof(double) * 4.0 * (problem.Components + 3) * static_cast<double>(points.size()));
  problem.ByU = Transposed(problem.ByV, problem.Rows(), problem.Columns(), problem.Components);
  Target target{ place, std::vector<double>(3 * points.size()) };
  for (std::int64_t j = 0; j < problem.Rows(); ++j)
  {
    for (std::int64_t i = 0; i < problem.Columns(); ++i)
    {
      std::copy_n(points[i + problem.Columns() * j].data(), 3,
        target.Coordinates.data() + 3 * (j + problem.Rows() * i));
    }
  }

  if (options.Tolerance > 0)
  {
    // A control point moved by rounding moves the surface by no more than that.
    const int decimals = static_cast<int>(std::ceil(1 - std::log10(options.Tolerance) - 1e-9));
    const bool round = decimals >= 0 && decimals <= 12;
    const double left = options.Tolerance - neglected -
      (round ? 0.5 * std::sqrt(3.0) * std::pow(10, -decimals) : 0.0);
    Spaces spaces;
    spaces.U = CubicSplineSpace(problem.U.front(), {}, problem.U.back());
    spaces.V = CubicSplineSpace(problem.V.front(), {}, problem.V.back());
    if (problem.Components > 0)
    {
      spaces = Economise(execution, problem, left);
    }
    SurfaceFit fit = Build(execution, problem, spaces, round ? decimals : 17, target);
    if (fit.MaximumDeviation <= options.Tolerance)
    {
      return fit;
    }
  }
  SurfaceFit fit = Build(execution, problem, Interpolation(problem), 17, target);
  if (options.Tolerance > 0 && fit.MaximumDeviation > options.Tolerance)
  {
    std::ostringstream message;
    message << "double precision reaches a deviation of " << fit.MaximumDeviation
            << " mm here, the tolerance is " << options.Tolerance << " mm";
    throw std::runtime_error(message.str());
  }
  return fit;
}

// Differences are squared twice: numbers that mean nothing else than no data would be infinite.
void CheckPlace(GridSize size, std::size_t index, const Vec3& p)
{
  if (std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) }) > Farthest)
  {
    ThrowAt(size, index, "the point is more than a kilometre away");
  }
}

std::vector<double> Uniform(std::int64_t count)
{
  std::vector<double> parameters(count);
  for (std::int64_t i = 0; i < count; ++i)
  {
    parameters[i] = static_cast<double>(i);
  }
  return parameters;
}

// Parameters for given mean distances between neighbours.
std::vector<double> Parameters(const std::vector<double>& distances, const char* what)
{
  const auto intervals = static_cast<std::int64_t>(distances.size());
  double total = 0;
  bool smooth = true;
  for (std::int64_t i = 0; i < intervals; ++i)
  {
    total += distances[i];
    const double previous = distances[std::max<std::int64_t>(0, i - 1)];
    smooth = smooth && distances[i] <= 1.25 * previous && previous <= 1.25 * distances[i];
  }
  std::vector<double> parameters = Uniform(intervals + 1);
  double sum = 0;
  for (std::int64_t i = 0; i < intervals; ++i)
  {
    const double part = distances[i] / total * static_cast<double>(intervals);
    if (!(part > 1e-4))
    {
      std::ostringstream message;
      message << what << " " << i << " and " << i + 1 << " of the grid coincide";
      throw std::invalid_argument(message.str());
    }
    sum += part;
    if (!smooth && i + 1 < intervals)
    {
      parameters[i + 1] = std::round(1e6 * sum) / 1e6; // short in the file
    }
  }
  return parameters;
}
}

//------------------------------------------------------------------------------
void SurfaceFitOptions::Describe(Properties& properties) const
{
  properties.Add("Tolerance", this->Tolerance, ValueRange::AtLeast(0, "mm"));
}

//------------------------------------------------------------------------------
SurfaceFit FitHeights(Execution& execution, GridSize size, const std::vector<double>& heights,
  const Matrix4& toWorld, const SurfaceFitOptions& options)
{
  CheckSize(size, heights.size());
  const Vec3 view = toWorld.Column(2);
  const auto is = [](double x, double wanted) { return std::abs(x - wanted) <= 1e-6; };
  if (!(is(Norm(view), 1) && is(Dot(view, Normalized(toWorld.Column(0))), 0) &&
        is(Dot(view, Normalized(toWorld.Column(1))), 0) && toWorld.Determinant3() > 0))
  {
    throw std::invalid_argument("the axes of the height field are not right-handed with a unit "
                                "vector perpendicular to the columns and rows");
  }
  Problem problem;
  problem.U = Uniform(size.Columns);
  problem.V = Uniform(size.Rows);
  problem.Components = 1;
  problem.ByV = heights;
  std::vector<Vec3> points(heights.size());
  std::size_t k = 0;
  for (const double row : problem.V)
  {
    for (const double column : problem.U)
    {
      points[k] = toWorld.Point({ column, row, heights[k] });
      if (!IsFinite(points[k]))
      {
        ThrowAt(size, k, "the height is not a number");
      }
      CheckPlace(size, k, points[k]);
      ++k;
    }
  }
  return FitComponents(
    execution, problem, 0,
    [&](double u, double v, const double* height) {
      return toWorld.Point({ u, v, *height });
    },
    points, options);
}

//------------------------------------------------------------------------------
SurfaceFit FitPoints(Execution& execution, GridSize size, const std::vector<Vec3>& points,
  const SurfaceFitOptions& options)
{
  CheckSize(size, points.size());
  std::vector<double> alongU(size.Columns - 1, 0.0);
  std::vector<double> alongV(size.Rows - 1, 0.0);
  double scale = 0;
  const std::int64_t columns = size.Columns;
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (!IsFinite(points[k]))
    {
      ThrowAt(size, k, "the point is not finite");
    }
    CheckPlace(size, k, points[k]);
    const std::int64_t i = static_cast<std::int64_t>(k) % columns;
    const std::int64_t j = static_cast<std::int64_t>(k) / columns;
    alongU[std::max<std::int64_t>(0, i - 1)] += i > 0 ? Norm(points[k] - points[k - 1]) : 0;
    alongV[std::max<std::int64_t>(0, j - 1)] += j > 0 ? Norm(points[k] - points[k - columns]) : 0;
    scale = std::max(scale, Norm(points[k]));
  }
  Problem problem;
  problem.U = Parameters(alongU, "columns");
  problem.V = Parameters(alongV, "rows");

  // Coordinates that are linear in u and v (as in height fields) need no fit.
  const Vec3& origin = points.front();
  const Vec3 slopeU = (1 / problem.U.back()) * (points[columns - 1] - origin);
  const Vec3 slopeV = (1 / problem.V.back()) * (points[columns * (size.Rows - 1)] - origin);
  const auto plane = [&](double u, double v, int c)
  { return origin[c] + u * slopeU[c] + v * slopeV[c]; };
  const double negligible =
    std::max(0.005 * options.Tolerance, 4 * std::numeric_limits<double>::epsilon() * scale);
  std::vector<int> fitted;
  for (int c = 0; c < 3; ++c)
  {
    for (std::size_t k = 0; k < points.size(); ++k)
    {
      const auto at = static_cast<std::int64_t>(k);
      if (std::abs(points[k][c] - plane(problem.U[at % columns], problem.V[at / columns], c)) >
        negligible)
      {
        fitted.push_back(c);
        break;
      }
    }
  }
  problem.Components = static_cast<int>(fitted.size());
  problem.ByV.reserve(points.size() * fitted.size());
  for (const Vec3& p : points)
  {
    for (const int c : fitted)
    {
      problem.ByV.push_back(p[c] - origin[c]);
    }
  }
  return FitComponents(
    execution, problem, std::sqrt(3.0) * negligible,
    [&](double u, double v, const double* values)
    {
      Vec3 p{ plane(u, v, 0), plane(u, v, 1), plane(u, v, 2) };
      for (const int c : fitted)
      {
        p[c] = origin[c] + *values++;
      }
      return p;
    },
    points, options);
}
}
