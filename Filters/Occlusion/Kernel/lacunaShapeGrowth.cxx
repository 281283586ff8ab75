// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeGrowth.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr int HistogramBins = 256;
constexpr int MostSmoothings = 4000;

void Check(const AttenuationField& field, const GrowthOptions& options)
{
  if (options.Steps.empty())
  {
    throw std::invalid_argument("there is no threshold; give one per iteration");
  }
  const double full = GetFullAngle(field);
  for (const GrowthStep& step : options.Steps)
  {
    if (!(step.Threshold > 0 && step.Threshold <= full))
    {
      throw std::invalid_argument("a threshold of " + std::to_string(step.Threshold) +
        " is not an angle above 0 and up to " + std::to_string(full) +
        (field.IsFlat() ? " rad (2 pi)" : " sr (4 pi)"));
    }
  }
  Properties properties;
  options.Describe(properties);
  properties.Check();
  if (options.MedianKernel % 2 == 0)
  {
    throw std::invalid_argument("MedianKernel is " + std::to_string(options.MedianKernel) +
      "; it must be odd (1: no filter)");
  }
}

void RequireAttenuation(const AttenuationField& field)
{
  const auto& n = field.GetDimensions();
  for (std::int64_t r = 0; r < n[1] * n[2]; ++r)
  {
    const float* row = field.Row(r % n[1], r / n[1]);
    if (std::any_of(row, row + n[0], [](float value) { return value > 0; }))
    {
      return;
    }
  }
  throw std::invalid_argument("no voxel of the reconstruction space attenuates: there is "
                              "nothing to reconstruct from");
}

template <class Row>
void ForRows(const AttenuationField& field, Execution& execution, Row&& row)
{
  const auto& n = field.GetDimensions();
  execution.For(n[1] * n[2], std::max<std::int64_t>(1, (1 << 16) / n[0]),
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        row(r % n[1], r / n[1], r * n[0]);
      }
    });
}

void FilterMedian(const AttenuationField& field, int kernel, float* angle, Execution& execution)
{
  const auto& n = field.GetDimensions();
  const std::vector<float> copy(angle, angle + field.GetNumberOfVoxels());
  const std::int64_t reach = kernel / 2;
  ForRows(field, execution,
    [&](std::int64_t j, std::int64_t k, std::int64_t first)
    {
      std::vector<float> window;
      const auto clip = [reach](std::int64_t c, std::int64_t count)
      {
        return std::pair(
          std::max<std::int64_t>(0, c - reach), std::min<std::int64_t>(count - 1, c + reach));
      };
      const auto [k0, k1] = clip(k, n[2]);
      const auto [j0, j1] = clip(j, n[1]);
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        const auto [i0, i1] = clip(i, n[0]);
        window.clear();
        for (std::int64_t c = k0; c <= k1; ++c)
        {
          for (std::int64_t b = j0; b <= j1; ++b)
          {
            const float* row = copy.data() + (c * n[1] + b) * n[0];
            window.insert(window.end(), row + i0, row + i1 + 1);
          }
        }
        const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
        std::nth_element(window.begin(), middle, window.end());
        angle[first + i] = *middle;
      }
    });
}

/// Counts in integers and in planes summed in order: the same for any number of threads.
GrowthStatistics Threshold(AttenuationField& field, double threshold, const std::vector<bool>& kept,
  const float* angle, unsigned char* object, std::vector<std::int64_t>& histogram)
{
  const auto& n = field.GetDimensions();
  const double full = GetFullAngle(field);
  GrowthStatistics statistics;
  histogram.assign(HistogramBins, 0);
  double sum = 0;
  std::int64_t inside = 0;
  // A float's angle just below a threshold that it stands for counts: 2 pi in floats is below it.
  const float level = static_cast<float>(threshold * (1 - 1e-6));
  for (std::int64_t k = 0; k < n[2]; ++k)
  {
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      const float* row = field.Row(j, k);
      const std::int64_t first = (k * n[1] + j) * n[0];
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        const bool outside = AttenuationField::IsOutsideSpace(row[i]);
        const float value = angle[first + i];
        object[first + i] = !outside && (value >= level || (!kept.empty() && kept[first + i]));
        statistics.ObjectVoxels += object[first + i];
        if (!outside)
        {
          ++inside;
          sum += value;
          // what already was object says nothing about where inside ends
          if (row[i] == 0)
          {
            const int bin = static_cast<int>(value / full * HistogramBins);
            ++histogram[std::min(HistogramBins - 1, std::max(0, bin))];
          }
        }
      }
    }
  }
  statistics.MeanAngle = inside > 0 ? sum / static_cast<double>(inside) : 0;
  return statistics;
}
}

//------------------------------------------------------------------------------
void GrowthOptions::Describe(Properties& properties) const
{
  properties.Add("ObjectOpacity", this->ObjectOpacity, ValueRange::Above(0).UpTo(1))
    .Add("Dilation", this->Dilation, DilationRange)
    .Add("KeepData", this->KeepData)
    .Add("MedianKernel", this->MedianKernel, ValueRange::Between(1, 255, "voxels"));
}

double GetLargestAttenuation(const AttenuationField& field)
{
  return 12 / field.GetShortestEdge();
}

double GetAttenuation(const AttenuationField& field, double opacity)
{
  return std::min(GetLargestAttenuation(field), -std::log1p(-opacity) / field.GetShortestEdge());
}

double SuggestThreshold(const std::vector<std::int64_t>& counts, double full)
{
  const int n = static_cast<int>(counts.size());
  std::vector<double> h(counts.begin(), counts.end());
  // Far more voxels are outside than inside, and the ends of the range count as well.
  for (double& value : h)
  {
    value = std::sqrt(value);
  }
  std::vector<double> smooth(h.size());
  for (int pass = 0; pass < MostSmoothings; ++pass)
  {
    for (int i = 0; i < n; ++i)
    {
      smooth[i] = 0.25 * h[std::max(0, i - 1)] + 0.5 * h[i] + 0.25 * h[std::min(n - 1, i + 1)];
    }
    h.swap(smooth);
    std::vector<int> peaks;
    for (int i = 0; i < n; ++i)
    {
      const bool risen = i == 0 || h[i] > h[i - 1];
      const bool falls = i == n - 1 || h[i] >= h[i + 1];
      if (risen && falls && h[i] > 0)
      {
        peaks.push_back(i);
      }
    }
    if (peaks.size() < 2)
    {
      return 0;
    }
    if (peaks.size() == 2)
    {
      const double lowest = *std::min_element(h.begin() + peaks[0], h.begin() + peaks[1]);
      const double level = lowest + 0.02 * (h[peaks[1]] - lowest);
      int first = peaks[0];
      while (h[first] > level)
      {
        ++first;
      }
      int last = peaks[1];
      while (h[last] > level)
      {
        --last;
      }
      return full * (0.5 * (first + last) + 0.5) / n;
    }
  }
  return 0;
}

void GrowShape(AttenuationField& field, const GrowthOptions& options, float* angle,
  unsigned char* object, const GrowthObserver& observer, Execution& execution, const Ranks& ranks)
{
  const auto& n = field.GetDimensions();
  const float half = static_cast<float>(GetAttenuation(field, 0.5));
  std::vector<bool> kept;
  // when one rank has nothing, is stopped, or lacks memory, the others shall not wait for it
  ranks.Together(
    [&]
    {
      Check(field, options);
      RequireAttenuation(field);
      kept.reserve(options.KeepData ? field.GetNumberOfVoxels() : 0);
      for (std::int64_t r = 0; options.KeepData && r < n[1] * n[2]; ++r)
      {
        const float* row = field.Row(r % n[1], r / n[1]);
        std::transform(
          row, row + n[0], std::back_inserter(kept), [half](float value) { return value >= half; });
      }
    });
  const int count = static_cast<int>(options.Steps.size());
  const float opaque = static_cast<float>(GetAttenuation(field, options.ObjectOpacity));
  std::vector<std::int64_t> histogram;
  for (int iteration = 0; iteration < count; ++iteration)
  {
    OccludedAngleOptions seeing;
    seeing.Binary = options.Binary;
    seeing.Directions = options.Directions;
    seeing.Dilation = options.Dilation;
    seeing.Radius = options.Steps[iteration].Radius;
    seeing.FirstProgress = static_cast<double>(iteration) / count;
    seeing.LastProgress = (iteration + 0.9) / count;
    ComputeOccludedAngle(field, seeing, angle, execution, ranks);
    execution.SetStage(seeing.LastProgress, (iteration + 1.0) / count);
    ranks.Together(
      [&]
      {
        if (options.MedianKernel > 1)
        {
          FilterMedian(field, options.MedianKernel, angle, execution);
        }
        GrowthStatistics statistics =
          Threshold(field, options.Steps[iteration].Threshold, kept, angle, object, histogram);
        statistics.SuggestedThreshold = SuggestThreshold(histogram, GetFullAngle(field));
        ForRows(field, execution,
          [&](std::int64_t j, std::int64_t k, std::int64_t first)
          {
            float* row = field.Row(j, k);
            for (std::int64_t i = 0; i < n[0]; ++i)
            {
              if (!AttenuationField::IsOutsideSpace(row[i]))
              {
                row[i] = object[first + i] ? opaque : 0.0F;
              }
            }
          });
        observer(iteration, statistics);
      });
  }
}
}
