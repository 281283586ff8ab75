// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceLattice.h"

#include <algorithm>
#include <stdexcept>

namespace lacuna
{
namespace
{
std::vector<int> GetPositions(int size, int step)
{
  std::vector<int> positions;
  for (std::int64_t i = 0; i < size - 1; i += step)
  {
    positions.push_back(static_cast<int>(i));
  }
  positions.push_back(size - 1);
  return positions;
}

std::int64_t CountPositions(int size, std::int64_t step)
{
  return (static_cast<std::int64_t>(size) - 1 + step - 1) / step + 1;
}

// A symmetric box of pixels: the outermost two may count half.
struct Box
{
  int Center, Radius;
  double EndWeight;

  Box(int center, int size, int step)
    : Center(center)
    , Radius(std::min({ step / 2, center, size - 1 - center }))
    , EndWeight(this->Radius > 0 && this->Radius == step / 2 && step % 2 == 0 ? 0.5 : 1)
  {
  }

  // Mean of what get(i) gives.
  template <class Get>
  double Average(const Get& get) const
  {
    if (this->Radius == 0)
    {
      return get(this->Center);
    }
    double sum =
      this->EndWeight * (get(this->Center - this->Radius) + get(this->Center + this->Radius));
    for (int i = this->Center - this->Radius + 1; i < this->Center + this->Radius; ++i)
    {
      sum += get(i);
    }
    return sum / (2 * this->EndWeight + 2 * this->Radius - 1);
  }
};
}

SliceLattice::SliceLattice(int width, int height, int step)
  : Width(width)
  , Height(height)
  , Step(step)
{
  if (width < 1 || height < 1 || step < 1)
  {
    throw std::invalid_argument("a lattice needs at least 1 pixel and a step of at least 1");
  }
  this->Columns = GetPositions(width, step);
  this->Rows = GetPositions(height, step);
}

int SliceLattice::ChooseStep(int width, int height, std::int64_t slices, std::int64_t most)
{
  const auto fits = [&](std::int64_t step)
  {
    return static_cast<double>(CountPositions(width, step)) *
      static_cast<double>(CountPositions(height, step)) * static_cast<double>(slices) <=
      static_cast<double>(most);
  };
  std::int64_t low = 1;
  std::int64_t high = std::max({ width - 1, height - 1, 1 });
  while (low < high)
  {
    const std::int64_t middle = (low + high) / 2;
    if (fits(middle))
    {
      high = middle;
    }
    else
    {
      low = middle + 1;
    }
  }
  return static_cast<int>(low);
}

void SliceLattice::Reduce(ScalarType type, const void* pixels, float* levels) const
{
  DispatchScalars(type, pixels,
    [&](const auto* values)
    {
      // along the rows first, into the pixel rows that a lattice row needs
      const std::size_t columns = this->Columns.size();
      std::vector<Box> boxes;
      for (const int column : this->Columns)
      {
        boxes.emplace_back(column, this->Width, this->Step);
      }
      std::vector<double> means(static_cast<std::size_t>(this->Step + 2) * columns);
      float* out = levels;
      for (const int row : this->Rows)
      {
        const Box box(row, this->Height, this->Step);
        const int first = row - box.Radius;
        for (int y = first; y <= row + box.Radius; ++y)
        {
          const auto* line = values + static_cast<std::int64_t>(y) * this->Width;
          double* mean = means.data() + static_cast<std::size_t>(y - first) * columns;
          for (std::size_t c = 0; c < columns; ++c)
          {
            mean[c] = boxes[c].Average([&](int i) { return static_cast<double>(line[i]); });
          }
        }
        for (std::size_t c = 0; c < columns; ++c)
        {
          *out++ = static_cast<float>(box.Average(
            [&](int y) { return means[static_cast<std::size_t>(y - first) * columns + c]; }));
        }
      }
    });
}
}
