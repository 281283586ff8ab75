// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceRayCaster.h"

#include "lacunaDepthDiscontinuity.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace lacuna
{
namespace
{
template <class T>
std::pair<double, double> GetRange(const SliceImage& slice)
{
  using Limits = std::numeric_limits<T>;
  T low = Limits::has_infinity ? Limits::infinity() : Limits::max();
  T high = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  for (int j = 0; j < slice.Height; ++j)
  {
    const T* const row = static_cast<const T*>(slice.Pixels) + j * slice.RowStride;
    for (int i = 0; i < slice.Width; ++i)
    {
      if constexpr (std::is_floating_point_v<T>)
      {
        if (!std::isfinite(row[i]))
        {
          continue;
        }
      }
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
    }
  }
  return { static_cast<double>(low), static_cast<double>(high) };
}
}

void GreyRange::Update(const std::vector<SliceImage>& slices)
{
  for (; this->Seen < slices.size(); ++this->Seen)
  {
    const SliceImage& slice = slices[this->Seen];
    const auto [low, high] =
      DispatchScalarType(slice.Type, [&](auto zero) { return GetRange<decltype(zero)>(slice); });
    this->Low = std::min(this->Low, low);
    this->High = std::max(this->High, high);
  }
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;

// (point - origin) . gradient as a function of the map's pixels.
PixelFunction MakeFunction(const ImagePlane& plane, const Vec3& origin, const Vec3& gradient)
{
  return { Dot(plane.Origin - origin, gradient), plane.PixelSpacing * Dot(plane.Right, gradient),
    plane.PixelSpacing * Dot(plane.Down, gradient) };
}

// The index of a real number, cut to columns and their neighbours.
std::int64_t ToIndex(double x, IndexInterval columns)
{
  return x > static_cast<double>(columns.First) - 1
    ? (x < static_cast<double>(columns.Last) + 1 ? static_cast<std::int64_t>(x) : columns.Last + 1)
    : columns.First - 1;
}

// Keeps the columns i with low <= atRow + step i <= high, just those at which this is so as
// computed: rounding keeps the order, so they form an interval.
IndexInterval Narrow(double atRow, double step, double low, double high, IndexInterval columns)
{
  if (step < 0)
  {
    atRow = -atRow;
    step = -step;
    low = -std::exchange(high, -low);
  }
  const auto at = [&](std::int64_t i) { return atRow + step * static_cast<double>(i); };
  // Divisions come within a pixel or so of both ends; then the comparisons decide.
  IndexInterval kept = columns;
  if (step > 0)
  {
    kept.First = std::max(columns.First, ToIndex(std::ceil((low - atRow) / step), columns));
    kept.Last = std::min(columns.Last, ToIndex(std::floor((high - atRow) / step), columns));
  }
  while (kept.First > columns.First && at(kept.First - 1) >= low)
  {
    --kept.First;
  }
  while (kept.First <= columns.Last && !(at(kept.First) >= low))
  {
    ++kept.First;
  }
  while (kept.Last < columns.Last && at(kept.Last + 1) <= high)
  {
    ++kept.Last;
  }
  while (kept.Last >= kept.First && !(at(kept.Last) <= high))
  {
    --kept.Last;
  }
  return kept;
}
}

bool SliceProjection::IsEdgeOn(const SliceImage& slice, const ImagePlane& plane)
{
  const Vec3 normal =
    Normalized(Cross(slice.PixelToReference.Column(0), slice.PixelToReference.Column(1)));
  return std::abs(Dot(normal, plane.View)) < std::sin(SmallestAngle * Degree);
}

SliceProjection::SliceProjection(const SliceImage& slice, const ImagePlane& plane)
  : Slice(slice)
  , LastColumn(slice.Width - 1)
  , LastRow(slice.Height - 1)
{
  // A ray's point is origin + column x + row y: what is perpendicular to the ray and to y tells the
  // column, what is perpendicular to the ray and to x the row, and the slice's normal the depth.
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  const Vec3 origin = slice.PixelToReference.Column(3);
  const Vec3 area = Cross(x, y);
  const double towards = Dot(area, plane.View);
  this->Column = MakeFunction(plane, origin, (1 / towards) * Cross(y, plane.View));
  this->Row = MakeFunction(plane, origin, (1 / towards) * Cross(plane.View, x));
  this->Depth = MakeFunction(plane, origin, (-1 / towards) * area);
  for (const PixelFunction& f : { this->Column, this->Row, this->Depth })
  {
    if (!std::isfinite(f.C) || !std::isfinite(f.I) || !std::isfinite(f.J))
    {
      throw std::invalid_argument(slice.Label + ": its pose lies too far off to be seen");
    }
  }
}

IndexInterval SliceProjection::GetRow(std::int64_t j, IndexInterval columns) const
{
  columns = Narrow(
    this->Column.AtRow(j), this->Column.I, -Tolerance, this->LastColumn + Tolerance, columns);
  return Narrow(this->Row.AtRow(j), this->Row.I, -Tolerance, this->LastRow + Tolerance, columns);
}

//------------------------------------------------------------------------------
namespace
{
constexpr double NoDepth = std::numeric_limits<double>::max();
// The depth of a front sample that is still to be found: deeper than any sample, so that no sample
// replaces it but every new solid one looks at it again.
constexpr double ToBeFound = std::numeric_limits<double>::infinity();
// Rows that are worked on together: their state stays in the cache while the slices pass by.
constexpr std::int64_t RowsAtOnce = 8;

// The grey level at a pixel whose ray meets the slice.
double Sample(const SliceProjection& projection, std::int64_t i, std::int64_t j)
{
  const SliceImage& slice = projection.GetSlice();
  return DispatchScalarType(slice.Type,
    [&](auto zero)
    {
      const SliceProjection::RowSampler<decltype(zero)> sample(projection, j);
      return slice.Fan ? sample.InFan(i, *slice.Fan) : sample(i);
    });
}
}

double GetWidestStepAlongRays(const std::vector<SliceImage>& slices, const ImagePlane& plane)
{
  double widest = 0;
  for (std::size_t i = 1; i < slices.size(); ++i)
  {
    const SliceImage& a = slices[i - 1];
    const SliceImage& b = slices[i];
    if (b.BeginsSweep || SliceProjection::IsEdgeOn(a, plane) || SliceProjection::IsEdgeOn(b, plane))
    {
      continue;
    }
    const auto measure = [&](const SliceImage& from, const SliceImage& to)
    {
      const Vec3 normal = Cross(to.PixelToReference.Column(0), to.PixelToReference.Column(1));
      for (const Vec3& corner : GetCorners(from))
      {
        const Vec3 way = to.PixelToReference.Column(3) - corner;
        widest = std::max(widest, std::abs(Dot(way, normal) / Dot(plane.View, normal)));
      }
    };
    measure(a, b);
    measure(b, a);
  }
  return widest;
}

/// The state of a row of pixels; the first one is that of the extent's first column.
struct SliceRayCaster::Row
{
  double* SolidDepth;
  double* SolidLevel;
  double* FrontDepth;
  double* FrontLevel;
  std::int32_t* Sweep;
  double* NearestDepth;
};

SliceRayCaster::SliceRayCaster(
  const ImagePlane& plane, const std::array<int, 4>& extent, double isoValue, SolidSide side)
  : Plane(plane)
  , Wanted(extent)
  , Sign(side == SolidSide::Above ? 1 : -1)
  , Threshold(this->Sign * isoValue)
{
  if (std::isnan(isoValue))
  {
    throw std::invalid_argument("the iso-value is not a number");
  }
  if (extent[0] < 0 || extent[1] >= plane.Size[0] || extent[2] < 0 || extent[3] >= plane.Size[1] ||
    extent[0] > extent[1] || extent[2] > extent[3])
  {
    throw std::invalid_argument("pixels outside of the depth map were asked for");
  }
  this->Extent = { std::max(extent[0] - 1, 0), std::min(extent[1] + 1, plane.Size[0] - 1),
    std::max(extent[2] - 1, 0), std::min(extent[3] + 1, plane.Size[1] - 1) };
  const auto size = static_cast<std::size_t>(this->Extent[1] - this->Extent[0] + 1) *
    static_cast<std::size_t>(this->Extent[3] - this->Extent[2] + 1);
  RequireMemory("this part of the depth map",
    static_cast<double>(size) * static_cast<double>(GetBytesPerPixel()));
  this->SolidDepth.assign(size, NoDepth);
  this->SolidLevel.resize(size);
  this->FrontDepth.assign(size, -NoDepth);
  this->FrontLevel.resize(size);
  this->Sweep.resize(size);
  this->NearestDepth.assign(size, NoDepth);
}

SliceRayCaster::Row SliceRayCaster::GetRow(std::int64_t j)
{
  const std::int64_t start =
    (j - this->Extent[2]) * (static_cast<std::int64_t>(this->Extent[1]) - this->Extent[0] + 1);
  return { this->SolidDepth.data() + start, this->SolidLevel.data() + start,
    this->FrontDepth.data() + start, this->FrontLevel.data() + start, this->Sweep.data() + start,
    this->NearestDepth.data() + start };
}

void SliceRayCaster::AddSlices(const std::vector<SliceImage>& slices, Execution& execution)
{
  std::vector<SliceProjection> added;
  std::vector<std::int64_t> numbers;
  std::vector<std::int32_t> sweeps;
  std::int64_t number = this->NumberOfSlices;
  std::int32_t sweep = this->LastSweep;
  for (const SliceImage& slice : slices)
  {
    CheckSlice(slice);
    sweep += slice.BeginsSweep ? 1 : 0;
    if (!SliceProjection::IsEdgeOn(slice, this->Plane))
    {
      added.emplace_back(slice, this->Plane);
      numbers.push_back(number);
      sweeps.push_back(sweep);
    }
    ++number;
  }
  this->NumberOfSlices = number;
  this->LastSweep = sweep;
  const std::size_t first = this->Projections.size();
  this->Projections.insert(this->Projections.end(), added.begin(), added.end());
  this->Numbers.insert(this->Numbers.end(), numbers.begin(), numbers.end());
  this->Sweeps.insert(this->Sweeps.end(), sweeps.begin(), sweeps.end());
  if (added.empty())
  {
    return;
  }

  const std::int64_t rows = this->Extent[3] - this->Extent[2] + 1;
  execution.For(rows, RowsAtOnce,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<char> incomplete(static_cast<std::size_t>(end - begin));
      for (std::size_t s = first; s < this->Projections.size(); ++s)
      {
        const SliceImage& slice = this->Projections[s].GetSlice();
        DispatchScalarType(slice.Type,
          [&](auto zero)
          {
            for (std::int64_t y = begin; y < end; ++y)
            {
              const std::int64_t j = this->Extent[2] + y;
              const bool displaced = slice.Fan ? this->AddToRow<decltype(zero), true>(s, j)
                                               : this->AddToRow<decltype(zero), false>(s, j);
              incomplete[y - begin] |= displaced ? 1 : 0;
            }
          });
      }
      for (std::int64_t y = begin; y < end; ++y)
      {
        if (incomplete[y - begin])
        {
          this->FindFronts(this->Extent[2] + y);
        }
      }
    });
}

// Returns true when front samples are to be found.
template <class T, bool HasFan>
bool SliceRayCaster::AddToRow(std::size_t slice, std::int64_t j)
{
  const SliceProjection& projection = this->Projections[slice];
  const IndexInterval columns = projection.GetRow(j, { this->Extent[0], this->Extent[1] });
  if (columns.IsEmpty())
  {
    return false;
  }
  const Row row = this->GetRow(j);
  const PixelFunction depths = projection.GetDepth();
  const double depthAtRow = depths.AtRow(j);
  const SliceProjection::RowSampler<T> sample(projection, j);
  const double sign = this->Sign;
  const double threshold = this->Threshold;
  const std::int32_t sweep = this->Sweeps[slice];
  bool incomplete = false;
  for (std::int64_t i = columns.First; i <= columns.Last; ++i)
  {
    const std::int64_t x = i - this->Extent[0];
    const double depth = depths.At(depthAtRow, i);
    const double solid = row.SolidDepth[x];
    if (!(depth <= solid))
    {
      continue; // what lies behind the solid does not matter
    }
    double level;
    if constexpr (HasFan)
    {
      level = sign * sample.InFan(i, *projection.GetSlice().Fan);
    }
    else
    {
      level = sign * sample(i);
    }
    if constexpr (HasFan || std::is_floating_point_v<T>)
    {
      if (!std::isfinite(level))
      {
        continue;
      }
    }
    if (level >= threshold)
    {
      if (depth < solid)
      {
        if (row.Sweep[x] != sweep || row.FrontDepth[x] >= depth)
        {
          const bool hasFront = row.NearestDepth[x] < depth;
          row.FrontDepth[x] = hasFront ? ToBeFound : -NoDepth;
          incomplete |= hasFront;
        }
        row.SolidDepth[x] = depth;
        row.SolidLevel[x] = level;
        row.Sweep[x] = sweep;
      }
      else if (row.Sweep[x] == sweep)
      {
        row.SolidLevel[x] = std::max(row.SolidLevel[x], level);
      }
    }
    else if (row.Sweep[x] != sweep)
    {
      if (solid == NoDepth) // and no earlier sweep will get a solid sample any more
      {
        row.FrontLevel[x] = level;
        row.FrontDepth[x] = depth;
        row.Sweep[x] = sweep;
      }
    }
    else if (depth < solid && depth >= row.FrontDepth[x])
    {
      row.FrontLevel[x] = depth > row.FrontDepth[x] ? level : std::max(row.FrontLevel[x], level);
      row.FrontDepth[x] = depth;
    }
    row.NearestDepth[x] = std::min(row.NearestDepth[x], depth);
  }
  return incomplete;
}

// Searches all slices for the front samples of row j that are to be found.
void SliceRayCaster::FindFronts(std::int64_t j)
{
  const Row row = this->GetRow(j);
  const std::size_t count = this->Projections.size();
  std::vector<double> depthAtRow(count);
  std::vector<double> depthStep(count);
  for (std::size_t s = 0; s < count; ++s)
  {
    const PixelFunction& depths = this->Projections[s].GetDepth();
    depthAtRow[s] = depths.AtRow(j);
    depthStep[s] = depths.I;
  }
  for (std::int64_t i = this->Extent[0]; i <= this->Extent[1]; ++i)
  {
    const std::int64_t x = i - this->Extent[0];
    if (row.FrontDepth[x] != ToBeFound)
    {
      continue;
    }
    const auto [first, last] =
      std::equal_range(this->Sweeps.begin(), this->Sweeps.end(), row.Sweep[x]);
    const auto begin = static_cast<std::size_t>(first - this->Sweeps.begin());
    const auto end = static_cast<std::size_t>(last - this->Sweeps.begin());
    double limit = row.SolidDepth[x];
    const auto column = static_cast<double>(i);
    // Once at most, but where all samples at the depth found are not finite.
    while (row.FrontDepth[x] == ToBeFound)
    {
      double front = -NoDepth;
      for (std::size_t s = begin; s < end; ++s)
      {
        const double depth = depthAtRow[s] + depthStep[s] * column;
        if (depth < limit && depth > front && this->Projections[s].Meets(i, j))
        {
          front = depth;
        }
      }
      double level = -NoDepth;
      for (std::size_t s = begin; s < end && front > -NoDepth; ++s)
      {
        if (depthAtRow[s] + depthStep[s] * column == front && this->Projections[s].Meets(i, j))
        {
          const double sample = Sample(this->Projections[s], i, j);
          level = std::isfinite(sample) ? std::max(level, this->Sign * sample) : level;
        }
      }
      if (level > -NoDepth || front == -NoDepth)
      {
        row.FrontDepth[x] = front;
        row.FrontLevel[x] = level;
      }
      limit = front;
    }
  }
}

void SliceRayCaster::MoveSlices(const std::vector<SliceImage>& slices)
{
  if (static_cast<std::int64_t>(slices.size()) != this->NumberOfSlices)
  {
    throw std::invalid_argument("MoveSlices needs all slices that were added");
  }
  for (std::size_t s = 0; s < this->Projections.size(); ++s)
  {
    this->Projections[s].SetPixels(slices[this->Numbers[s]].Pixels);
  }
}

double SliceRayCaster::GetDepth(std::size_t pixel, double maximumGap) const
{
  const double solid = this->SolidDepth[pixel];
  const double front = this->FrontDepth[pixel];
  if (solid == NoDepth)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (front == -NoDepth || (maximumGap > 0 && solid - front > maximumGap))
  {
    return solid;
  }
  const double level = this->FrontLevel[pixel];
  const double part = (this->Threshold - level) / (this->SolidLevel[pixel] - level);
  return front + part * (solid - front);
}

void SliceRayCaster::Write(double maximumGap, const DepthPixels& pixels, Execution& execution) const
{
  if (pixels.Extent != this->Wanted)
  {
    throw std::invalid_argument("a slice ray caster writes all of its extent");
  }
  const std::int64_t width = this->Extent[1] - this->Extent[0] + 1;
  const std::int64_t wantedWidth = this->Wanted[1] - this->Wanted[0] + 1;
  const double spacing = this->Plane.PixelSpacing;
  const SlopeRule cases{ DiscontinuityLimits() };
  execution.For(this->Wanted[3] - this->Wanted[2] + 1, RowsAtOnce,
    [&](std::int64_t begin, std::int64_t end)
    {
      // The rows with one more on each side, of depths with one more on each side: NaN outside.
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      const std::int64_t lineLength = wantedWidth + 2;
      std::vector<double> depths(static_cast<std::size_t>((end - begin + 2) * lineLength), nothing);
      for (std::int64_t y = begin - 1; y <= end; ++y)
      {
        const std::int64_t j = this->Wanted[2] + y;
        if (j < this->Extent[2] || j > this->Extent[3])
        {
          continue;
        }
        double* line = depths.data() + (y - begin + 1) * lineLength;
        for (std::int64_t i = this->Extent[0]; i <= this->Extent[1]; ++i)
        {
          line[i - this->Wanted[0] + 1] = this->GetDepth(
            static_cast<std::size_t>((j - this->Extent[2]) * width + i - this->Extent[0]),
            maximumGap);
        }
      }
      for (std::int64_t y = begin; y < end; ++y)
      {
        const double* line = depths.data() + (y - begin + 1) * lineLength + 1;
        for (std::int64_t x = 0; x < wantedWidth; ++x)
        {
          const std::int64_t pixel = y * wantedWidth + x;
          const double depth = line[x];
          const bool valid = !std::isnan(depth);
          pixels.Depth[pixel] = depth;
          if (pixels.Valid)
          {
            pixels.Valid[pixel] = valid ? 1 : 0;
          }
          if (pixels.Normals)
          {
            Vec3 normal{ 0, 0, 0 };
            if (valid)
            {
              const double right = cases.SlopeAt(line[x - 1], depth, line[x + 1], spacing);
              const double down =
                cases.SlopeAt(line[x - lineLength], depth, line[x + lineLength], spacing);
              normal =
                Normalized(right * this->Plane.Right + down * this->Plane.Down - this->Plane.View);
            }
            for (int a = 0; a < 3; ++a)
            {
              pixels.Normals[3 * pixel + a] = static_cast<float>(normal[a]);
            }
          }
        }
      }
    });
}
}
