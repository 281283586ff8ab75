// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBaseSurface.h"

#include "lacunaDepthPlane.h"
#include "lacunaSupportSelection.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace lacuna
{
namespace
{
Vec2 GetPosition(const MapGrid& grid, std::size_t pixel)
{
  return { static_cast<double>(grid.GetColumn(pixel)) * grid.Spacing[0],
    static_cast<double>(grid.GetRow(pixel)) * grid.Spacing[1] };
}

std::vector<double> GetDepths(const EllipsoidTrend& trend, const MapGrid& grid)
{
  std::vector<double> depths(grid.GetSize());
  for (std::size_t pixel = 0; pixel < depths.size(); ++pixel)
  {
    const Vec2 p = GetPosition(grid, pixel);
    depths[pixel] = trend.GetDepth(p[0], p[1]);
  }
  return depths;
}
}

BaseSurface::BaseSurface(Execution& execution, const SurfaceSheet& prior, const MapGrid& grid)
  : Prior(prior)
  , Grid(grid)
{
  if (!prior.Points.empty())
  {
    this->OnMap = ProjectSheet(execution, prior, MaximumSupportSlope, grid);
  }
}

void BaseSurface::SetTrend(const std::vector<double>& depth, const MapMask& support)
{
  std::vector<Vec3> points;
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    if (support[pixel])
    {
      const Vec2 p = GetPosition(this->Grid, pixel);
      points.push_back({ p[0], p[1], depth[pixel] });
    }
  }
  this->Trend = std::make_unique<EllipsoidTrend>(points);
  this->OnMap = GetDepths(*this->Trend, this->Grid);
}

std::vector<double> BaseSurface::Evaluate(Execution& execution, const MapGrid& grid) const
{
  if (this->Trend)
  {
    return GetDepths(*this->Trend, grid);
  }
  return this->Exists() ? ProjectSheet(execution, this->Prior, MaximumSupportSlope, grid)
                        : std::vector<double>();
}

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
