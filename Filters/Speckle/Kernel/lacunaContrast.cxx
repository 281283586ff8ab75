// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaContrast.h"

#include "lacunaScalarType.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace lacuna
{
namespace
{
/// The rows of a box of bounds, row after row.
class BoundsTest
{
public:
  BoundsTest(const std::array<double, 6>& bounds, const Matrix4& indexToWorld)
    : Bounds(bounds)
    , IndexToWorld(indexToWorld)
  {
    // Coordinates such as 0.1 + 2 * 0.1 miss 0.3 by their rounding.
    const double spacing = std::min(
      { Norm(indexToWorld.Column(0)), Norm(indexToWorld.Column(1)), Norm(indexToWorld.Column(2)) });
    for (std::size_t i = 0; i < 6; ++i)
    {
      this->Bounds[i] += (i % 2 == 0 ? -1e-6 : 1e-6) * spacing;
    }
  }

  bool Holds(int x, int y, int z) const
  {
    const Vec3 p = this->IndexToWorld.Point(
      { static_cast<double>(x), static_cast<double>(y), static_cast<double>(z) });
    return this->Bounds[0] <= p[0] && p[0] <= this->Bounds[1] && this->Bounds[2] <= p[1] &&
      p[1] <= this->Bounds[3] && this->Bounds[4] <= p[2] && p[2] <= this->Bounds[5];
  }

private:
  std::array<double, 6> Bounds;
  Matrix4 IndexToWorld;
};

/// Clears the flags of the samples first, first + 1, ... whose value is 0 or NaN.
void KeepMarked(const RegionMask& mask, std::int64_t first, std::vector<std::uint8_t>& flags)
{
  DispatchScalars(mask.Type, mask.Values,
    [&](const auto* values)
    {
      for (std::size_t i = 0; i < flags.size(); ++i)
      {
        const auto value = values[first + static_cast<std::int64_t>(i)];
        flags[i] &= static_cast<std::uint8_t>(value != 0 && value == value);
      }
    });
}
}

bool RegionRule::HasBounds() const
{
  return this->Bounds[0] <= this->Bounds[1] && this->Bounds[2] <= this->Bounds[3] &&
    this->Bounds[4] <= this->Bounds[5];
}

void MarkRegion(const Extent& box, const Matrix4& indexToWorld, const RegionRule& rule,
  Region region, std::uint8_t* regions, Execution& execution)
{
  const int nx = SizeOf(box, 0);
  const int ny = SizeOf(box, 1);
  const bool bounded = rule.HasBounds();
  const BoundsTest bounds(rule.Bounds, indexToWorld);
  const std::int64_t rows = std::int64_t(ny) * SizeOf(box, 2);
  execution.For(rows, 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<std::uint8_t> flags;
      for (std::int64_t row = begin; row < end; ++row)
      {
        std::uint8_t* to = regions + row * nx;
        flags.assign(nx, 1);
        for (const RegionMask& mask : rule.Masks)
        {
          KeepMarked(mask, row * nx, flags);
        }
        const int y = box[2] + static_cast<int>(row % ny);
        const int z = box[4] + static_cast<int>(row / ny);
        for (int i = 0; i < nx; ++i)
        {
          if (flags[i] && to[i] == NoRegion && (!bounded || bounds.Holds(box[0] + i, y, z)))
          {
            to[i] = region;
          }
        }
      }
    });
}

//------------------------------------------------------------------------------
namespace
{
/// Sums of one slice: slices are added in order, so that threads make no difference.
struct Sums
{
  std::array<std::int64_t, 2> Count{};
  std::array<double, 2> Sum{};
};

/// Sums power (1 or 2) of the difference to a reference.
template <class T>
Sums SumRegions(const ImageView<const T>& view, const std::uint8_t* regions,
  const std::array<double, 2>& reference, bool squared, Execution& execution)
{
  std::vector<Sums> slices(SizeOf(view.Box, 2));
  const std::int64_t nx = SizeOf(view.Box, 0);
  const std::int64_t ny = SizeOf(view.Box, 1);
  execution.For(static_cast<std::int64_t>(slices.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t k = begin; k < end; ++k)
      {
        for (std::int64_t j = 0; j < ny; ++j)
        {
          const T* row = view.Data + k * view.Stride[2] + j * view.Stride[1];
          const std::uint8_t* region = regions + (k * ny + j) * nx;
          for (std::int64_t i = 0; i < nx; ++i)
          {
            const double value = static_cast<double>(row[i * view.Stride[0]]);
            if (region[i] < NoRegion && value == value)
            {
              const double d = value - reference[region[i]];
              ++slices[k].Count[region[i]];
              slices[k].Sum[region[i]] += squared ? d * d : d;
            }
          }
        }
      }
    });
  Sums total;
  for (const Sums& slice : slices)
  {
    for (int r = 0; r < 2; ++r)
    {
      total.Count[r] += slice.Count[r];
      total.Sum[r] += slice.Sum[r];
    }
  }
  return total;
}

/// Sets that are joined; each is known by one of its members.
class DisjointSets
{
public:
  std::int64_t Add()
  {
    this->Parent.push_back(static_cast<std::int64_t>(this->Parent.size()));
    ++this->Count;
    return this->Parent.back();
  }

  void Join(std::int64_t a, std::int64_t b)
  {
    a = this->Find(a);
    b = this->Find(b);
    if (a != b)
    {
      this->Parent[std::max(a, b)] = std::min(a, b);
      --this->Count;
    }
  }

  std::int64_t GetCount() const { return this->Count; }

private:
  std::int64_t Find(std::int64_t a)
  {
    while (this->Parent[a] != a)
    {
      a = this->Parent[a] = this->Parent[this->Parent[a]];
    }
    return a;
  }

  std::vector<std::int64_t> Parent;
  std::int64_t Count = 0;
};

/// Samples begin <= x < end of a row at or above the threshold.
struct RowRun
{
  std::int64_t Begin;
  std::int64_t End;
  std::int64_t Set;
};

/// Samples at or above a value: those not below the least sample that T has there.
template <class T>
class Threshold
{
public:
  explicit Threshold(double value)
  {
    if (value != value)
    {
      throw std::invalid_argument("the iso-value is not a number");
    }
    if constexpr (std::is_integral_v<T>)
    {
      using Limits = std::numeric_limits<T>;
      const double whole = std::ceil(value);
      this->OutOfReach = whole >= std::ldexp(1.0, Limits::digits); // the greatest T, plus 1
      this->Least = this->OutOfReach || whole <= static_cast<double>(Limits::lowest())
        ? Limits::lowest()
        : static_cast<T>(whole);
    }
    else
    {
      this->Least = value;
    }
  }

  bool IsReached(T sample) const { return sample >= this->Least && !this->OutOfReach; }

private:
  std::conditional_t<std::is_integral_v<T>, T, double> Least;
  bool OutOfReach = false;
};

void JoinOverlaps(const std::vector<RowRun>& a, const std::vector<RowRun>& b, DisjointSets& sets)
{
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();)
  {
    if (a[i].Begin < b[j].End && b[j].Begin < a[i].End)
    {
      sets.Join(a[i].Set, b[j].Set);
    }
    ++(a[i].End < b[j].End ? i : j);
  }
}
}

double RegionStatistics::SignalToNoise() const
{
  return this->Mean / std::sqrt(this->Variance);
}

template <class T>
std::array<RegionStatistics, 2> MeasureRegions(
  const ImageView<const T>& view, const std::uint8_t* regions, Execution& execution)
{
  // Twice through the data: the variance about the mean itself loses no digits.
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.5);
  const Sums sums = SumRegions(view, regions, { 0, 0 }, false, execution);
  std::array<RegionStatistics, 2> statistics;
  std::array<double, 2> means{};
  for (int r = 0; r < 2; ++r)
  {
    statistics[r].Count = sums.Count[r];
    statistics[r].Mean = means[r] = sums.Sum[r] / static_cast<double>(sums.Count[r]);
  }
  execution.SetStage(0.5, 1);
  const Sums squares = SumRegions(view, regions, means, true, execution);
  for (int r = 0; r < 2; ++r)
  {
    statistics[r].Variance = squares.Sum[r] / static_cast<double>(sums.Count[r]);
  }
  return statistics;
}

double ContrastToSpeckle(const RegionStatistics& inside, const RegionStatistics& outside)
{
  const double difference = std::abs(inside.Mean - outside.Mean);
  return difference > 0 ? difference / std::sqrt(inside.Variance + outside.Variance) : difference;
}

template <class T>
std::int64_t CountThresholdedRegions(
  const ImageView<const T>& view, double isoValue, Execution& execution)
{
  const std::int64_t nx = SizeOf(view.Box, 0);
  const int ny = SizeOf(view.Box, 1);
  const int nz = SizeOf(view.Box, 2);
  const Threshold<T> threshold(isoValue);
  DisjointSets sets;
  std::vector<std::vector<RowRun>> before(ny); // the rows of the slice before
  std::vector<RowRun> runs;
  for (int k = 0; k < nz; ++k)
  {
    execution.Report(double(k) / nz);
    for (int j = 0; j < ny; ++j)
    {
      const T* row = view.Data + k * view.Stride[2] + j * view.Stride[1];
      runs.clear();
      bool above = false;
      for (std::int64_t i = 0; i < nx; ++i)
      {
        const bool now = threshold.IsReached(row[i * view.Stride[0]]);
        if (now && !above)
        {
          runs.push_back({ i, nx, sets.Add() });
        }
        else if (!now && above)
        {
          runs.back().End = i;
        }
        above = now;
      }
      if (k > 0)
      {
        JoinOverlaps(runs, before[j], sets);
      }
      before[j].swap(runs);
      if (j > 0)
      {
        JoinOverlaps(before[j], before[j - 1], sets);
      }
    }
  }
  return sets.GetCount();
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template std::array<RegionStatistics, 2> MeasureRegions(                                         \
    const ImageView<const T>&, const std::uint8_t*, Execution&);                                   \
  template std::int64_t CountThresholdedRegions(const ImageView<const T>&, double, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
