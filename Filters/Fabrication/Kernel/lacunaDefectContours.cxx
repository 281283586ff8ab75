// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectContours.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
//------------------------------------------------------------------------------
std::vector<Loop> FindDefectContours(
  GridSize size, const Vec2& spacing, const std::vector<unsigned char>& mask)
{
  // Gaussian of one pixel on a frame of four more
  constexpr int reach = 4;
  double weights[2 * reach + 1];
  double sum = 0;
  for (int k = -reach; k <= reach; ++k)
  {
    sum += weights[k + reach] = std::exp(-0.5 * k * k);
  }
  const std::int64_t columns = size.Columns + 2 * reach;
  const std::int64_t rows = size.Rows + 2 * reach;
  std::vector<double> across(static_cast<std::size_t>(columns * rows), 0);
  std::vector<double> smooth(across.size(), 0);
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < size.Columns; ++i)
    {
      if (!mask[i + size.Columns * j])
      {
        continue;
      }
      if (i == 0 || j == 0 || i + 1 == size.Columns || j + 1 == size.Rows)
      {
        throw std::runtime_error("the defect reaches the border of the fit (pixel " +
          std::to_string(i) + ", " + std::to_string(j) +
          " of Fitted), so its outline is not known there; make a larger depth map");
      }
      for (int k = -reach; k <= reach; ++k)
      {
        across[i + reach + k + columns * (j + reach)] += weights[k + reach] / sum;
      }
    }
  }
  for (std::int64_t j = reach; j < rows - reach; ++j)
  {
    for (std::int64_t i = 0; i < columns; ++i)
    {
      for (int k = -reach; k <= reach; ++k)
      {
        smooth[i + columns * (j + k)] += across[i + columns * j] * weights[k + reach] / sum;
      }
    }
  }
  const PlanarGrid grid{ { -reach * spacing[0], -reach * spacing[1] }, spacing, columns, rows };
  return FindContours(grid, smooth, 0.5);
}

//------------------------------------------------------------------------------
Loop SmoothStaircase(const Loop& loop, double pixel)
{
  // equal steps of about half a pixel
  const double sigma = 3 * pixel;
  std::vector<double> at(loop.size() + 1, 0);
  for (std::size_t k = 0; k < loop.size(); ++k)
  {
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    at[k + 1] = at[k] + std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  const auto count = std::max<std::int64_t>(16, std::llround(at.back() / (0.5 * pixel)));
  const double step = at.back() / static_cast<double>(count);
  Loop even;
  std::size_t k = 0;
  for (std::int64_t i = 0; i < count; ++i)
  {
    const double s = step * static_cast<double>(i);
    while (at[k + 1] < s)
    {
      ++k;
    }
    const double t = at[k + 1] > at[k] ? (s - at[k]) / (at[k + 1] - at[k]) : 0;
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    even.push_back({ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
  }
  // not farther than half of a small loop
  const auto reach = std::min(static_cast<std::int64_t>(std::ceil(4 * sigma / step)), count / 2);
  const double width = std::min(sigma, static_cast<double>(reach) * step / 4);
  std::vector<double> weights;
  double sum = 0;
  for (std::int64_t i = -reach; i <= reach; ++i)
  {
    const double x = step * static_cast<double>(i) / width;
    weights.push_back((1.5 - 0.5 * x * x) * std::exp(-0.5 * x * x));
    sum += weights.back();
  }
  Loop smooth;
  for (std::int64_t i = 0; i < count; ++i)
  {
    Vec2 p{};
    for (std::int64_t o = -reach; o <= reach; ++o)
    {
      const Vec2& q = even[(i + o + count) % count];
      p[0] += weights[o + reach] / sum * q[0];
      p[1] += weights[o + reach] / sum * q[1];
    }
    smooth.push_back(p);
  }
  return smooth;
}
}
