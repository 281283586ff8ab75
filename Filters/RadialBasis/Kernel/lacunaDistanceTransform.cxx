// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDistanceTransform.h"

#include "lacunaExecution.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace lacuna
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();

// Along each column: the squared distance to the nearest feature of that column.
void ColumnPass(int width, int height, double spacing, const std::vector<unsigned char>& feature,
  std::vector<double>& result)
{
  std::vector<std::int64_t> last(width, -1); // row of the nearest feature seen so far
  const auto visit = [&](int row)
  {
    for (int i = 0; i < width; ++i)
    {
      const std::size_t pixel = static_cast<std::size_t>(row) * width + i;
      if (feature[pixel])
      {
        last[i] = row;
      }
      if (last[i] >= 0)
      {
        const double d = spacing * static_cast<double>(row - last[i]);
        if (d * d < result[pixel])
        {
          result[pixel] = d * d;
        }
      }
    }
  };
  for (int row = 0; row < height; ++row)
  {
    visit(row);
  }
  last.assign(width, -1);
  for (int row = height - 1; row >= 0; --row)
  {
    visit(row);
  }
}

// Along one row: min over q of (spacing (p - q))^2 + f(q), f from the column pass.
void RowPass(int width, double spacing, double* row, std::vector<double>& f,
  std::vector<int>& vertex, std::vector<double>& from)
{
  f.assign(row, row + width);
  int parabolas = 0;
  for (int q = 0; q < width; ++q)
  {
    if (f[q] == Infinity)
    {
      continue;
    }
    double start = -Infinity; // where parabola q goes below the last one of the envelope
    while (parabolas > 0)
    {
      const int v = vertex[parabolas - 1];
      start = 0.5 * (q + v) + (f[q] - f[v]) / (2 * spacing * spacing * (q - v));
      if (start > from[parabolas - 1])
      {
        break;
      }
      --parabolas;
      start = -Infinity;
    }
    vertex[parabolas] = q;
    from[parabolas] = start;
    ++parabolas;
  }
  if (parabolas == 0)
  {
    return;
  }
  int k = 0;
  for (int p = 0; p < width; ++p)
  {
    while (k + 1 < parabolas && from[k + 1] < p)
    {
      ++k;
    }
    const double d = spacing * (p - vertex[k]);
    row[p] = d * d + f[vertex[k]];
  }
}
}

std::vector<double> SquaredDistanceTransform(Execution& execution, int width, int height,
  const Vec2& spacing, const std::vector<unsigned char>& feature)
{
  std::vector<double> result(feature.size(), Infinity);
  ColumnPass(width, height, spacing[1], feature, result);
  execution.For(height, 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> f;
      std::vector<int> vertex(width);
      std::vector<double> from(width);
      for (std::int64_t row = begin; row < end; ++row)
      {
        RowPass(width, spacing[0], result.data() + row * width, f, vertex, from);
      }
    });
  return result;
}
}
