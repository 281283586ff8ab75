// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMapResampling.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
// In pixels: pixel centres so near to an edge belong to the triangle, and positions so near to a
// pixel are the pixel.
constexpr double Tie = 1e-9;

bool IsTear(const Vec3& a, const Vec3& b, double maximumSlope)
{
  return !(std::abs(a[2] - b[2]) <= maximumSlope * std::hypot(a[0] - b[0], a[1] - b[1]));
}

// Pixels first..last of count whose centres lie between two positions (in pixels).
std::array<std::int64_t, 2> GetRange(double low, double high, int count)
{
  if (!(high >= -1) || !(low <= count))
  {
    return { 0, -1 };
  }
  return { static_cast<std::int64_t>(std::ceil(std::max(low, 0.0) - Tie)),
    static_cast<std::int64_t>(std::floor(std::min(high, count - 1.0) + Tie)) };
}

// Fills the pixels of a triangle, nearest depth first. Corners: pixels of grid, depth.
void FillTriangle(
  const Vec3& a, const Vec3& b, const Vec3& c, const MapGrid& grid, std::vector<double>& depth)
{
  const double area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  if (!(std::abs(area) > 0))
  {
    return;
  }
  const auto rows =
    GetRange(std::min({ a[1], b[1], c[1] }), std::max({ a[1], b[1], c[1] }), grid.Height);
  const auto columns =
    GetRange(std::min({ a[0], b[0], c[0] }), std::max({ a[0], b[0], c[0] }), grid.Width);
  for (std::int64_t j = rows[0]; j <= rows[1]; ++j)
  {
    for (std::int64_t i = columns[0]; i <= columns[1]; ++i)
    {
      const double x = static_cast<double>(i) - a[0];
      const double y = static_cast<double>(j) - a[1];
      const double s = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area;
      const double t = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area;
      if (s >= -Tie && t >= -Tie && s + t <= 1 + Tie)
      {
        double& pixel = depth[static_cast<std::size_t>(j) * grid.Width + i];
        const double z = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]);
        pixel = std::isnan(pixel) ? z : std::min(pixel, z);
      }
    }
  }
}
}

//------------------------------------------------------------------------------
std::vector<double> ProjectSheet(
  Execution& execution, const SurfaceSheet& sheet, double maximumSlope, const MapGrid& grid)
{
  std::vector<double> depth(grid.GetSize(), NotANumber);
  const auto toPixel = [&](const Vec3& p) -> Vec3
  {
    return { p[0] / grid.Spacing[0] - grid.FirstColumn, p[1] / grid.Spacing[1] - grid.FirstRow,
      p[2] };
  };
  for (int j = 0; j + 1 < sheet.Height; ++j)
  {
    execution.Report(static_cast<double>(j) / sheet.Height);
    for (int i = 0; i + 1 < sheet.Width; ++i)
    {
      const std::size_t first = static_cast<std::size_t>(j) * sheet.Width + i;
      // Around the square; without one point a triangle is left.
      const std::size_t around[4] = { first, first + 1, first + sheet.Width + 1,
        first + sheet.Width };
      std::array<Vec3, 4> corners;
      std::size_t count = 0;
      for (const std::size_t k : around)
      {
        if (IsFinite(sheet.Points[k]))
        {
          corners[count++] = sheet.Points[k];
        }
      }
      for (std::size_t k = 2; k < count; ++k)
      {
        const Vec3& a = corners[0];
        const Vec3& b = corners[k - 1];
        const Vec3& c = corners[k];
        if (!IsTear(a, b, maximumSlope) && !IsTear(b, c, maximumSlope) &&
          !IsTear(c, a, maximumSlope))
        {
          FillTriangle(toPixel(a), toPixel(b), toPixel(c), grid, depth);
        }
      }
    }
  }
  return depth;
}

//------------------------------------------------------------------------------
GridTransfer TransferMap(const MapGrid& from, const std::vector<double>& depth,
  const MapMask& valid, double maximumSlope, const MapGrid& to)
{
  // Of each new column and row: old ones before and after, and how far between them.
  struct Place
  {
    std::int64_t Nearest;
    std::int64_t Before;
    double Fraction; // 0: at Before
  };
  const auto find = [](
                      std::int64_t index, double spacing, std::int64_t first, double old, int count)
  {
    const double at = static_cast<double>(index) * spacing / old - static_cast<double>(first);
    const double nearest = std::round(at);
    Place place{ -1, -1, 0 };
    if (nearest >= 0 && nearest < count)
    {
      place.Nearest = static_cast<std::int64_t>(nearest);
    }
    if (std::abs(at - nearest) <= Tie)
    {
      place.Before = place.Nearest;
    }
    else if (at > 0 && at < count - 1)
    {
      place.Before = static_cast<std::int64_t>(std::floor(at));
      place.Fraction = at - std::floor(at);
    }
    return place;
  };
  std::vector<Place> columns;
  for (int i = 0; i < to.Width; ++i)
  {
    columns.push_back(
      find(to.FirstColumn + i, to.Spacing[0], from.FirstColumn, from.Spacing[0], from.Width));
  }
  GridTransfer transfer;
  transfer.Nearest.reserve(to.GetSize());
  transfer.Depth.reserve(to.GetSize());
  for (int j = 0; j < to.Height; ++j)
  {
    const Place row =
      find(to.FirstRow + j, to.Spacing[1], from.FirstRow, from.Spacing[1], from.Height);
    for (const Place& column : columns)
    {
      transfer.Nearest.push_back(
        row.Nearest < 0 || column.Nearest < 0 ? -1 : row.Nearest * from.Width + column.Nearest);
      double value = row.Before < 0 || column.Before < 0 ? NotANumber : 0;
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (int k = 0; k < 4 && !std::isnan(value); ++k)
      {
        const double wx = k % 2 ? column.Fraction : 1 - column.Fraction;
        const double wy = k / 2 ? row.Fraction : 1 - row.Fraction;
        if (wx == 0 || wy == 0)
        {
          continue;
        }
        const auto pixel =
          static_cast<std::size_t>((row.Before + k / 2) * from.Width + column.Before + k % 2);
        value += valid[pixel] ? wx * wy * depth[pixel] : NotANumber;
        low = std::min(low, depth[pixel]);
        high = std::max(high, depth[pixel]);
      }
      const double reach = std::max(from.Spacing[0], from.Spacing[1]);
      transfer.Depth.push_back(high - low > maximumSlope * reach ? NotANumber : value);
    }
  }
  return transfer;
}
}
