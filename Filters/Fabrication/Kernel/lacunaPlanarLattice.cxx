// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlanarLattice.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
//------------------------------------------------------------------------------
Loop FillWithLattice(
  Execution& execution, const std::vector<Loop>& loops, double spacing, double clearance)
{
  std::vector<std::vector<Vec3>> flat;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Loop& loop : loops)
  {
    flat.emplace_back();
    for (const Vec2& p : loop)
    {
      flat.back().push_back({ p[0], p[1], 0 });
      low = std::min(low, p[1]);
      high = std::max(high, p[1]);
    }
  }
  const CurveIndex index(flat, 2 * spacing);
  const double rise = spacing * std::sqrt(0.75);
  const auto first = static_cast<std::int64_t>(std::ceil(low / rise));
  const auto last = static_cast<std::int64_t>(std::floor(high / rise));
  const std::int64_t rows = std::max<std::int64_t>(last - first + 1, 0);
  std::vector<Loop> found(static_cast<std::size_t>(rows));
  execution.For(rows, 2,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t row = begin; row < end; ++row)
      {
        const double y = static_cast<double>(first + row) * rise;
        const double shift = (first + row) % 2 ? 0.5 * spacing : 0;
        const std::vector<double> crossings = FindCrossings(loops, y);
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
        {
          auto i = static_cast<std::int64_t>(std::ceil((crossings[k] - shift) / spacing));
          for (;; ++i)
          {
            const double x = shift + spacing * static_cast<double>(i);
            if (x > crossings[k + 1])
            {
              break;
            }
            if (index.Find({ x, y, 0 }, clearance).Distance >= clearance)
            {
              found[row].push_back({ x, y });
            }
          }
        }
      }
    });
  Loop lattice;
  for (const Loop& row : found)
  {
    lattice.insert(lattice.end(), row.begin(), row.end());
  }
  return lattice;
}
}
