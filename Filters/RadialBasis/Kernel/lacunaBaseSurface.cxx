// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBaseSurface.h"

#include "lacunaDepthDiscontinuity.h"
#include "lacunaDepthPlane.h"
#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::size_t Count = 6;
// Of the normal equations, whose terms are all about 1.
constexpr double ConditionLimit = 1e13;
// Of the greatest root: 1 / (1 + tan^2) of a sphere's slope of 65 degrees.
constexpr double SteepShare = 0.18;
constexpr const char* Undetermined =
  "the surface around the defect does not determine an ellipsoid (it is flat, or curved like a "
  "saddle); set Trend to None";

std::array<double, Count> GetTerms(const Vec3& p)
{
  return { p[0] * p[0] - p[1] * p[1], p[0] * p[1], p[0], p[1], p[2], 1 };
}
}

EllipsoidTrend::EllipsoidTrend(const std::vector<Vec3>& points)
{
  if (points.size() < Count)
  {
    throw std::invalid_argument(Undetermined);
  }
  const auto n = static_cast<double>(points.size());
  for (const Vec3& p : points)
  {
    this->Center = this->Center + (1 / n) * p;
  }
  double extent = 0;
  for (const Vec3& p : points)
  {
    extent = std::max(extent, Norm(p - this->Center));
  }
  if (!(extent > 0))
  {
    throw std::invalid_argument(Undetermined);
  }
  this->Scale = 1 / extent;
  SquareMatrix normal(Count);
  std::fill_n(normal.Column(0), Count * Count, 0.0);
  std::vector<double> right(Count, 0.0);
  for (const Vec3& p : points)
  {
    const Vec3 u = this->Scale * (p - this->Center);
    const std::array<double, Count> terms = GetTerms(u);
    for (std::size_t j = 0; j < Count; ++j)
    {
      right[j] -= terms[j] * Dot(u, u) / n;
      for (std::size_t i = j; i < Count; ++i)
      {
        normal.Column(j)[i] += terms[i] * terms[j] / n;
      }
    }
  }
  try
  {
    const SymmetricFactorization factorization(std::move(normal));
    if (!(factorization.GetConditionEstimate() < ConditionLimit))
    {
      throw std::invalid_argument(Undetermined);
    }
    factorization.Solve(right);
  }
  catch (const std::runtime_error&)
  {
    throw std::invalid_argument(Undetermined);
  }
  std::copy(right.begin(), right.end(), this->Terms.begin());
  // (1 + a) (1 - a) > (b / 2)^2 makes it an ellipsoid
  if (!((1 - this->Terms[0] * this->Terms[0]) > 0.25 * this->Terms[1] * this->Terms[1]))
  {
    throw std::invalid_argument(Undetermined);
  }
  std::size_t above = 0;
  for (const Vec3& p : points)
  {
    above += this->Scale * (p[2] - this->Center[2]) > -0.5 * this->Terms[4];
  }
  this->Side = 2 * above > points.size() ? 1 : -1;
  // the middle, where the root is greatest
  const double a = 1 + this->Terms[0];
  const double b = 0.5 * this->Terms[1];
  const double c = 1 - this->Terms[0];
  const double u = -0.5 * (c * this->Terms[2] - b * this->Terms[3]) / (a * c - b * b);
  const double v = -0.5 * (a * this->Terms[3] - b * this->Terms[2]) / (a * c - b * b);
  const double greatest =
    this->GetRoot(this->Center[0] + u / this->Scale, this->Center[1] + v / this->Scale);
  if (!(greatest > 0))
  {
    throw std::invalid_argument(Undetermined);
  }
  this->LeastRoot = SteepShare * greatest;
}

//------------------------------------------------------------------------------
double EllipsoidTrend::GetRoot(double x, double y) const
{
  // z^2 + linear z + rest = 0
  const double u = this->Scale * (x - this->Center[0]);
  const double v = this->Scale * (y - this->Center[1]);
  const double rest = u * u + v * v + this->Terms[0] * (u * u - v * v) + this->Terms[1] * u * v +
    this->Terms[2] * u + this->Terms[3] * v + this->Terms[5];
  return 0.25 * this->Terms[4] * this->Terms[4] - rest;
}

//------------------------------------------------------------------------------
double EllipsoidTrend::GetDepth(double x, double y) const
{
  const double root = this->GetRoot(x, y);
  const double least = this->LeastRoot;
  const double half =
    root >= least ? std::sqrt(root) : std::sqrt(least) + (root - least) / (2 * std::sqrt(least));
  return this->Center[2] + (-0.5 * this->Terms[4] + this->Side * half) / this->Scale;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();

Vec2 GetPosition(const MapGrid& grid, std::size_t pixel)
{
  return { static_cast<double>(grid.GetColumn(pixel)) * grid.Spacing[0],
    static_cast<double>(grid.GetRow(pixel)) * grid.Spacing[1] };
}

bool IsInside(const MapGrid& grid, const std::array<int, 4>& rectangle, std::size_t pixel)
{
  const auto i = static_cast<int>(pixel % static_cast<std::size_t>(grid.Width));
  const auto j = static_cast<int>(pixel / static_cast<std::size_t>(grid.Width));
  return i >= rectangle[0] && i <= rectangle[1] && j >= rectangle[2] && j <= rectangle[3];
}

double SteepSlope()
{
  constexpr double Pi = 3.14159265358979323846;
  return std::tan(DiscontinuityLimits().MaximumAngle * (Pi / 180));
}

MapMask GetFinite(const std::vector<double>& depth)
{
  MapMask mask(depth.size());
  std::transform(depth.begin(), depth.end(), mask.begin(),
    [](double z) { return static_cast<unsigned char>(std::isfinite(z)); });
  return mask;
}

// The pixels that are reached from start over edges without a step.
MapMask Follow(const MapGrid& grid, const std::vector<double>& depth, const MapMask& start)
{
  const double slope = SteepSlope();
  const auto width = static_cast<std::size_t>(grid.Width);
  MapMask reached = start;
  std::vector<std::size_t> open;
  for (std::size_t pixel = 0; pixel < start.size(); ++pixel)
  {
    if (start[pixel])
    {
      open.push_back(pixel);
    }
  }
  while (!open.empty())
  {
    const std::size_t pixel = open.back();
    open.pop_back();
    const auto visit = [&](bool inside, std::size_t next, double distance)
    {
      if (inside && !reached[next] && std::abs(depth[next] - depth[pixel]) <= slope * distance)
      {
        reached[next] = 1;
        open.push_back(next);
      }
    };
    visit(pixel % width > 0, pixel - 1, grid.Spacing[0]);
    visit((pixel + 1) % width > 0, pixel + 1, grid.Spacing[0]);
    visit(pixel >= width, pixel - width, grid.Spacing[1]);
    visit(pixel + width < depth.size(), pixel + width, grid.Spacing[1]);
  }
  return reached;
}

// Takes away the pixels of mask where the difference of two surfaces is larger than where they are
// nearest: through a hole of one of them the other is compared with a far wall, perhaps in most pixels.
// Returns the least difference, mm.
double KeepNearest(const std::vector<double>& difference, MapMask& mask)
{
  constexpr double Least = 0.05; // of the pixels
  constexpr double Band = 10;    // mm, less than the distance of any two walls of a skull's cavity
  std::vector<double> sizes;
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel])
    {
      sizes.push_back(std::abs(difference[pixel]));
    }
  }
  if (sizes.empty())
  {
    return 0;
  }
  const auto least =
    sizes.begin() + static_cast<std::ptrdiff_t>(Least * static_cast<double>(sizes.size()));
  std::nth_element(sizes.begin(), least, sizes.end());
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    mask[pixel] = mask[pixel] && std::abs(difference[pixel]) <= *least + Band;
  }
  return *least;
}
}

//------------------------------------------------------------------------------
BaseSurface::BaseSurface(Execution& execution, const SurfaceSheet& prior, const MarkedMap& map,
  const SupportMargins& margins)
  : Prior(prior)
  , Map(map)
  , Grid(map.Grid)
{
  if (prior.Points.empty())
  {
    return;
  }
  this->OnMap = ProjectSheet(execution, prior, MaximumSupportSlope, this->Grid);
  // where it lies along the surface: their difference has no step there
  MapMask along = GetFinite(this->OnMap);
  std::vector<double> difference(along.size(), 0.0);
  for (std::size_t pixel = 0; pixel < along.size(); ++pixel)
  {
    along[pixel] = along[pixel] && map.Valid[pixel] && !map.Defect[pixel] &&
      (map.Painted.empty() || map.Painted[pixel]);
    difference[pixel] = along[pixel] ? map.Depth[pixel] - this->OnMap[pixel] : 0;
  }
  if (map.Painted.empty())
  {
    along = SelectWithin(execution, this->Grid, map.Defect, margins.Defect, along);
  }
  this->Distance = KeepNearest(difference, along);
  RemoveBeyondSteps(this->Grid, difference, { SteepSlope(), SteepSlope() }, along);
  this->Sound = Follow(this->Grid, this->OnMap, along);
  if (margins.Step > 0)
  {
    MapMask gaps(this->Sound.size());
    std::transform(this->Sound.begin(), this->Sound.end(), gaps.begin(),
      [](unsigned char sound) { return sound ? 0 : 1; });
    const MapMask near = SelectWithin(execution, this->Grid, gaps, margins.Step, this->Sound);
    for (std::size_t pixel = 0; pixel < near.size(); ++pixel)
    {
      this->Sound[pixel] = this->Sound[pixel] && !near[pixel];
    }
  }
  for (std::size_t pixel = 0; pixel < this->Sound.size(); ++pixel)
  {
    this->OnMap[pixel] = this->Sound[pixel] ? this->OnMap[pixel] : NotANumber;
  }
}

//------------------------------------------------------------------------------
void BaseSurface::SetTrend(const MapMask& support)
{
  std::vector<Vec3> points;
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    if (support[pixel])
    {
      const Vec2 p = GetPosition(this->Grid, pixel);
      points.push_back({ p[0], p[1], this->Map.Depth[pixel] });
    }
  }
  this->Trend = std::make_unique<EllipsoidTrend>(points);
  this->OnMap.assign(this->Grid.GetSize(), NotANumber);
  std::size_t missing = 0;
  std::size_t first = 0;
  for (std::size_t pixel = 0; pixel < this->OnMap.size(); ++pixel)
  {
    const Vec2 p = GetPosition(this->Grid, pixel);
    if (this->Trend->Covers(p[0], p[1]))
    {
      this->OnMap[pixel] = this->Trend->GetDepth(p[0], p[1]);
    }
    else if (this->Map.Defect[pixel])
    {
      first = missing++ == 0 ? pixel : first;
    }
  }
  if (missing > 0)
  {
    std::ostringstream message;
    message << "the ellipsoid of Trend ends before the defect does, at " << missing
            << " of its pixels, first at column " << this->Grid.GetColumn(first) << ", row "
            << this->Grid.GetRow(first)
            << "; mark a smaller defect, choose a view that faces it, or set Trend to None";
    throw std::invalid_argument(message.str());
  }
}

//------------------------------------------------------------------------------
void BaseSurface::WarnOfGaps(std::vector<std::string>& warnings) const
{
  constexpr double Doubtful = 25; // mm
  if (this->Distance > Doubtful)
  {
    std::ostringstream message;
    message << "the prior surface is " << std::lround(this->Distance)
            << " mm from the bone around the defect, where they are nearest. It may be a far wall, "
            << "seen through a hole of the prior that is larger than the defect, or lie in other "
            << "coordinates: show it together with the bone";
    warnings.push_back(message.str());
  }
  std::size_t missing = 0;
  std::size_t first = 0;
  std::size_t all = 0;
  for (std::size_t pixel = 0; pixel < this->OnMap.size(); ++pixel)
  {
    all += this->Map.Defect[pixel];
    if (this->Map.Defect[pixel] && !this->Sound[pixel])
    {
      first = missing++ == 0 ? pixel : first;
    }
  }
  if (missing > 0)
  {
    std::ostringstream message;
    message
      << "at " << missing << " of " << all << " pixels of the defect, first at column "
      << this->Grid.GetColumn(first) << ", row " << this->Grid.GetRow(first)
      << ", the prior surface is missing or lies beyond a depth step, as in a hole of its own: "
      << "a thin plate bridges them. Where they are many, take a prior that is whole there";
    warnings.push_back(message.str());
  }
}

//------------------------------------------------------------------------------
void BaseSurface::Complete(Execution& execution, const MapMask& carried,
  const std::array<int, 4>& rectangle, const HoleFillOptions& options,
  std::vector<std::string>& warnings)
{
  if (this->Sound.empty())
  {
    return; // there is no prior
  }
  this->WarnOfGaps(warnings);
  MapMask known(this->Sound.size(), 0);
  MapMask gaps(this->Sound.size(), 0);
  for (std::size_t pixel = 0; pixel < known.size(); ++pixel)
  {
    const bool isInside = IsInside(this->Grid, rectangle, pixel);
    known[pixel] = isInside && this->Sound[pixel];
    gaps[pixel] = isInside && !this->Sound[pixel];
  }
  this->IsSmooth = options.Smoothing > 0 || options.CutoffWavelength > 0;
  const bool hasGaps = std::find(gaps.begin(), gaps.end(), 1) != gaps.end();
  // Other pixels may need more of the prior than those of the map.
  const bool isSame = options.OutputMargin == 0 && options.OutputSpacing == Vec2{ 0, 0 };
  if (!this->IsSmooth && !hasGaps && isSame)
  {
    return;
  }

  const std::vector<double> depth = this->CarryOn(carried);
  MapMask nodes(known.size(), 0);
  for (std::size_t pixel = 0; pixel < carried.size(); ++pixel)
  {
    // a smooth fit must not see the eye socket that the prior may be beside them
    nodes[pixel] =
      (known[pixel] && (!this->IsSmooth || this->Map.Defect[pixel] || carried[pixel])) ||
      (carried[pixel] && !this->Sound[pixel]);
  }
  MapMask taken(nodes.size(), 0);
  for (const std::size_t pixel : ThinNodes(this->Grid, nodes, options.NodeSpacing))
  {
    taken[pixel] = 1;
  }
  if (!this->IsSmooth && hasGaps) // the bridge begins where the prior ends
  {
    constexpr double Seam = 2.5; // pixels
    const double reach = Seam * std::max(this->Grid.Spacing[0], this->Grid.Spacing[1]);
    const MapMask seam = SelectWithin(execution, this->Grid, gaps, reach, known);
    std::transform(taken.begin(), taken.end(), seam.begin(), taken.begin(),
      [](unsigned char a, unsigned char b) { return a | b; });
  }
  const double area = static_cast<double>(std::count(nodes.begin(), nodes.end(), 1)) *
    this->Grid.Spacing[0] * this->Grid.Spacing[1];
  this->MakeFit(execution, taken, depth, area, options);
  this->TakeFit(execution, rectangle);
}

//------------------------------------------------------------------------------
std::vector<double> BaseSurface::CarryOn(const MapMask& carried) const
{
  const auto forEach = [&](const auto& body)
  {
    for (std::size_t pixel = 0; pixel < carried.size(); ++pixel)
    {
      if (carried[pixel] && this->Sound[pixel])
      {
        const Vec2 p = GetPosition(this->Grid, pixel);
        body(Vec3{ p[0], p[1], this->Map.Depth[pixel] - this->OnMap[pixel] });
      }
    }
  };
  const std::array<double, 3> above = FitDepthPlane(forEach).Coefficients;
  std::vector<double> depth = this->OnMap;
  for (std::size_t pixel = 0; pixel < carried.size(); ++pixel)
  {
    if (carried[pixel] && !this->Sound[pixel])
    {
      const Vec2 p = GetPosition(this->Grid, pixel);
      depth[pixel] = this->Map.Depth[pixel] - (above[0] + above[1] * p[0] + above[2] * p[1]);
    }
  }
  return depth;
}

//------------------------------------------------------------------------------
void BaseSurface::MakeFit(Execution& execution, const MapMask& nodes,
  const std::vector<double>& depth, double area, const HoleFillOptions& options)
{
  std::vector<std::array<double, 2>> places;
  std::vector<double> values;
  for (std::size_t pixel = 0; pixel < nodes.size(); ++pixel)
  {
    if (nodes[pixel])
    {
      const Vec2 p = GetPosition(this->Grid, pixel);
      places.push_back({ p[0], p[1] });
      values.push_back(depth[pixel]);
    }
  }
  RadialBasisOptions fit =
    GetFitOptions(options, area / std::max(1.0, static_cast<double>(places.size())), false);
  fit.Kernel = this->IsSmooth ? options.Kernel : RadialKernel::ThinPlate;
  // Its shape in the hole is what it is for; half the wavelength is still above the voxels' ripple.
  fit.Smoothing *= this->IsSmooth ? std::pow(0.5, GetRadialPower(fit.Kernel) + 2) : 1;
  this->Fit = std::make_unique<RadialBasis<2>>(execution, places, values, fit);
  this->Accuracy = options.Accuracy;
}

//------------------------------------------------------------------------------
void BaseSurface::TakeFit(Execution& execution, const std::array<int, 4>& rectangle)
{
  std::vector<std::size_t> pixels;
  std::vector<std::array<double, 2>> points;
  for (std::size_t pixel = 0; pixel < this->OnMap.size(); ++pixel)
  {
    if (IsInside(this->Grid, rectangle, pixel) && (this->IsSmooth || !this->Sound[pixel]))
    {
      const Vec2 p = GetPosition(this->Grid, pixel);
      pixels.push_back(pixel);
      points.push_back({ p[0], p[1] });
    }
  }
  std::vector<double> values;
  this->EvaluateFit(execution, points, values);
  for (std::size_t k = 0; k < pixels.size(); ++k)
  {
    this->OnMap[pixels[k]] = values[k];
  }
}

//------------------------------------------------------------------------------
void BaseSurface::EvaluateFit(Execution& execution,
  const std::vector<std::array<double, 2>>& points, std::vector<double>& values) const
{
  const RadialBasis<2>& fit = *this->Fit;
  constexpr double Least = 1e-9; // of the range: what a sum in doubles can give
  fit.EvaluateWithin(execution, std::max(this->Accuracy, Least) * fit.GetRange(), points, values);
}

//------------------------------------------------------------------------------
// A pinhole may show itself between the pixels of the map only.
bool BaseSurface::IsSoundAt(const Vec2& p, double depth, std::int64_t nearest) const
{
  const auto pixel = static_cast<std::size_t>(nearest);
  if (!std::isfinite(depth) || nearest < 0 || !this->Sound[pixel])
  {
    return false;
  }
  constexpr double Rounding = 1e-3; // mm
  const Vec2 q = GetPosition(this->Grid, pixel);
  return std::abs(depth - this->OnMap[pixel]) <=
    SteepSlope() * std::hypot(p[0] - q[0], p[1] - q[1]) + Rounding;
}

//------------------------------------------------------------------------------
std::vector<double> BaseSurface::Evaluate(Execution& execution, const MapGrid& grid,
  const std::vector<std::int64_t>& nearest, const std::array<int, 4>& rectangle) const
{
  if (!this->Exists())
  {
    return {};
  }
  std::vector<double> depth(grid.GetSize(), NotANumber);
  if (!this->Trend && !this->IsSmooth)
  {
    depth = ProjectSheet(execution, this->Prior, MaximumSupportSlope, grid);
  }
  std::vector<std::size_t> pixels;
  std::vector<std::array<double, 2>> points;
  for (std::size_t pixel = 0; pixel < depth.size(); ++pixel)
  {
    const Vec2 p = GetPosition(grid, pixel);
    if (!IsInside(grid, rectangle, pixel))
    {
      depth[pixel] = NotANumber;
    }
    else if (this->Trend)
    {
      depth[pixel] = this->Trend->GetDepth(p[0], p[1]);
    }
    else if (this->Fit && !this->IsSoundAt(p, depth[pixel], nearest[pixel]))
    {
      pixels.push_back(pixel);
      points.push_back({ p[0], p[1] });
    }
  }
  if (!points.empty())
  {
    std::vector<double> values;
    this->EvaluateFit(execution, points, values);
    for (std::size_t k = 0; k < pixels.size(); ++k)
    {
      depth[pixels[k]] = values[k];
    }
  }
  return depth;
}

//------------------------------------------------------------------------------
double BaseSurface::Evaluate(double x, double y) const
{
  if (!this->Exists() || this->Trend)
  {
    return this->Trend ? this->Trend->GetDepth(x, y) : 0;
  }
  const double i = x / this->Grid.Spacing[0] - this->Grid.FirstColumn;
  const double j = y / this->Grid.Spacing[1] - this->Grid.FirstRow;
  double depth = 0;
  for (int k = 0; k < 4; ++k)
  {
    const double column = std::floor(i) + k % 2;
    const double row = std::floor(j) + k / 2;
    const double weight = (1 - std::abs(i - column)) * (1 - std::abs(j - row));
    if (weight > 0)
    {
      const bool inside =
        column >= 0 && row >= 0 && column < this->Grid.Width && row < this->Grid.Height;
      depth += inside ? weight *
          this->OnMap[static_cast<std::size_t>(row) * this->Grid.Width +
            static_cast<std::size_t>(column)]
                      : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return depth;
}

std::array<double, 3> BaseSurface::FitPlane(const MapMask& mask) const
{
  const auto forEach = [&](const auto& body)
  {
    for (std::size_t pixel = 0; pixel < this->OnMap.size(); ++pixel)
    {
      if (mask[pixel] && std::isfinite(this->OnMap[pixel]))
      {
        const Vec2 p = GetPosition(this->Grid, pixel);
        body(Vec3{ p[0], p[1], this->OnMap[pixel] });
      }
    }
  };
  return FitDepthPlane(forEach).Coefficients;
}
}
