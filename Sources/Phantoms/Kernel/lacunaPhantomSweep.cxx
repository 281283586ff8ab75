// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPhantomSweep.h"

#include "lacunaCounterNoise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna
{
namespace
{
constexpr std::uint64_t SpeckleStream = 0;
constexpr std::int64_t RowsPerTask = 16;

void Store(double value, unsigned char& pixel)
{
  if (!(value > 0))
  {
    pixel = 0;
    return;
  }
  const double raised = std::min(value, 255.0) + 0.5; // truncation then rounds half up
  pixel = static_cast<unsigned char>(raised);
}

void Store(double value, float& pixel)
{
  pixel = static_cast<float>(value);
}
}

double CountPoints(const Extent& extent)
{
  return (1.0 + extent[1] - extent[0]) * (1.0 + extent[3] - extent[2]) *
    (1.0 + extent[5] - extent[4]);
}

template <class T>
void SampleSlices(Execution& execution, const PhantomScene& scene, const SliceImaging& imaging,
  const Extent& extent, T* pixels)
{
  SpeckleLevels.Check("SpeckleLevel", imaging.SpeckleLevel);
  const int columns = extent[1] - extent[0] + 1;
  const std::int64_t rows = extent[3] - extent[2] + 1;
  const std::int64_t slices = extent[5] - extent[4] + 1;
  const CounterNoise noise(imaging.Seed, SpeckleStream);
  execution.For(rows * slices, RowsPerTask,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> levels(columns);
      std::int64_t slice = -1;
      Matrix4 pose;
      for (std::int64_t r = begin; r < end; ++r)
      {
        const std::int64_t k = extent[4] + r / rows;
        const std::int64_t j = extent[2] + r % rows;
        if (k != slice)
        {
          slice = k;
          pose = imaging.ImageToReference(slice);
        }
        scene.SampleRow(pose.Point({ 0, static_cast<double>(j), 0 }), pose.Column(0), extent[0],
          columns, levels.data());
        if (imaging.SpeckleLevel > 0)
        {
          const std::int64_t counter = (k * imaging.Rows + j) * imaging.Columns + extent[0];
          for (int i = 0; i < columns; ++i)
          {
            levels[i] *= 1 + imaging.SpeckleLevel * noise.Normal(counter + i);
          }
        }
        T* row = pixels + r * columns;
        for (int i = 0; i < columns; ++i)
        {
          Store(levels[i], row[i]);
        }
      }
    });
}

void SampleGrid(Execution& execution, const PhantomScene& scene,
  const std::array<int, 3>& dimensions, const Matrix4& indexToReference, float* values)
{
  const std::int64_t rows = static_cast<std::int64_t>(dimensions[1]) * dimensions[2];
  execution.For(rows, RowsPerTask,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> levels(dimensions[0]);
      for (std::int64_t r = begin; r < end; ++r)
      {
        const std::int64_t j = r % dimensions[1];
        const std::int64_t k = r / dimensions[1];
        const Vec3 index{ 0, static_cast<double>(j), static_cast<double>(k) };
        scene.SampleRow(indexToReference.Point(index), indexToReference.Column(0), 0, dimensions[0],
          levels.data());
        std::transform(levels.begin(), levels.end(), values + r * dimensions[0],
          [](double level) { return static_cast<float>(level); });
      }
    });
}

template void SampleSlices(
  Execution&, const PhantomScene&, const SliceImaging&, const Extent&, unsigned char*);
template void SampleSlices(
  Execution&, const PhantomScene&, const SliceImaging&, const Extent&, float*);
}
