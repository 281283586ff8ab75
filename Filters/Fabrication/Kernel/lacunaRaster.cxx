// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRaster.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double ShortestMotion = 0.01; // mm; shorter ones are lifted, not divided
constexpr double Micrometre = 0.001;
constexpr double ClippingSlack = 1e-7; // mm, so that lines on the border are not lost
}

//------------------------------------------------------------------------------
double Raster::Line::GetLength() const
{
  return std::hypot(this->Last[0] - this->First[0], this->Last[1] - this->First[1]);
}

//------------------------------------------------------------------------------
Raster::Raster(const MillSurface& surface, double degrees, double overrun)
  : Along{ std::cos(degrees * Pi / 180), std::sin(degrees * Pi / 180) }
  , Across{ -Along[1], Along[0] }
  , Low{ surface.GetLowest()[0] - overrun, surface.GetLowest()[1] - overrun }
  , High{ surface.GetHighest()[0] + overrun, surface.GetHighest()[1] + overrun }
  , Overrun(overrun)
  , Range{ std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity() }
{
  for (const double x : { this->Low[0], this->High[0] })
  {
    for (const double y : { this->Low[1], this->High[1] })
    {
      const double offset = x * this->Across[0] + y * this->Across[1];
      this->Range[0] = std::min(this->Range[0], offset);
      this->Range[1] = std::max(this->Range[1], offset);
    }
  }
}

//------------------------------------------------------------------------------
Raster::Line Raster::GetLine(double offset) const
{
  // the part of the infinite line within the rectangle
  double first = -std::numeric_limits<double>::infinity();
  double last = -first;
  for (int c = 0; c < 2; ++c)
  {
    const double start = offset * this->Across[c];
    if (std::abs(this->Along[c]) > 1e-12)
    {
      const double a = (this->Low[c] - ClippingSlack - start) / this->Along[c];
      const double b = (this->High[c] + ClippingSlack - start) / this->Along[c];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
  }
  last = std::max(first, last);
  const auto at = [&](double t)
  {
    Vec2 p{};
    for (int c = 0; c < 2; ++c)
    {
      p[c] = std::clamp(offset * this->Across[c] + t * this->Along[c], this->Low[c], this->High[c]);
    }
    return p;
  };
  return { at(first), at(last) };
}

//------------------------------------------------------------------------------
std::vector<double> Raster::GetOffsets(double step) const
{
  const double width = this->Range[1] - this->Range[0];
  const auto count = static_cast<std::int64_t>(std::max(1.0, std::ceil(width / step - 1e-9)));
  std::vector<double> offsets;
  offsets.reserve(count + 1);
  for (std::int64_t k = 0; k <= count; ++k)
  {
    offsets.push_back(this->Range[0] + width * static_cast<double>(k) / static_cast<double>(count));
  }
  return offsets;
}

//------------------------------------------------------------------------------
std::vector<double> Raster::GetOffsets(
  Execution& execution, const DropCutter& cutter, double distance, double along) const
{
  double range[2] = { std::numeric_limits<double>::infinity(), 0 };
  range[1] = -range[0];
  for (const double x : { this->Low[0], this->High[0] })
  {
    for (const double y : { this->Low[1], this->High[1] })
    {
      const double t = x * this->Along[0] + y * this->Along[1];
      range[0] = std::min(range[0], t);
      range[1] = std::max(range[1], t);
    }
  }
  const auto count = static_cast<std::int64_t>(std::ceil((range[1] - range[0]) / along)) + 1;
  const auto drop = [&](double offset, std::vector<double>& heights)
  {
    heights.resize(count);
    execution.For(count, 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        DropCutter::Scratch scratch;
        for (std::int64_t k = begin; k < end; ++k)
        {
          const double t = range[0] + along * static_cast<double>(k);
          const double x = offset * this->Across[0] + t * this->Along[0];
          const double y = offset * this->Across[1] + t * this->Along[1];
          heights[k] =
            this->Overrun > 0 ? cutter.DropBeyond(x, y, scratch) : cutter.Drop(x, y, scratch);
        }
      });
  };
  const double width = this->Range[1] - this->Range[0];
  std::vector<double> offsets{ this->Range[0] };
  std::vector<double> here;
  std::vector<double> next;
  drop(offsets.back(), here);
  double step = distance;
  while (offsets.back() < this->Range[1])
  {
    execution.SetStage(0, 1);
    const double left = this->Range[1] - offsets.back();
    step = std::min({ 1.3 * step, distance, left });
    for (;;)
    {
      drop(offsets.back() + step, next);
      double largest = 0; // height between neighbouring places
      for (std::int64_t k = 0; k < count; ++k)
      {
        const double difference = std::abs(next[k] - here[k]);
        largest = std::isfinite(difference) ? std::max(largest, difference) : largest;
      }
      const double found = std::hypot(step, largest);
      const double least = std::min(distance / 4, left);
      if (found <= distance * (1 + 1e-9) || step <= least)
      {
        break;
      }
      step = std::max(least, 0.98 * step * distance / found);
    }
    offsets.push_back(left - step < 1e-6 * width ? this->Range[1] : offsets.back() + step);
    here.swap(next);
  }
  return offsets;
}

//------------------------------------------------------------------------------
Vec3 ToMicrometres(double x, double y, double z)
{
  return { std::round(1000 * x) / 1000, std::round(1000 * y) / 1000,
    std::ceil(1000 * z - 1e-6) / 1000 };
}

//------------------------------------------------------------------------------
Vec3 PathTracer::GetPosition(double x, double y)
{
  Vec3 p = ToMicrometres(x, y, this->Floor);
  const double z = this->Beyond ? this->Cutter.DropBeyond(p[0], p[1], this->Scratch)
                                : this->Cutter.Drop(p[0], p[1], this->Scratch);
  p[2] = std::isfinite(z) ? std::max(p[2], std::ceil(1000 * z - 1e-6) / 1000) : z;
  return p;
}

//------------------------------------------------------------------------------
void PathTracer::Connect(std::vector<Vec3>& points, Vec3 point, bool follow)
{
  const Vec3 start = points.back();
  const double length = std::hypot(point[0] - start[0], point[1] - start[1]);
  const auto divide = [&](double fraction)
  {
    const Vec3 chord = start + fraction * (point - start);
    Vec3 middle = this->GetPosition(chord[0], chord[1]);
    if (!follow || !std::isfinite(middle[2]))
    {
      middle[2] = std::max(middle[2], ToMicrometres(0, 0, chord[2])[2]);
    }
    return middle;
  };
  const DropCutter::Excess excess = this->Cutter.FindExcess(start, point, MotionTolerance);
  if (excess.Height > MotionTolerance)
  {
    if (length > ShortestMotion)
    {
      // both parts are shorter, also when rounded
      const double least = std::max(0.05, 3 * Micrometre / length);
      this->Connect(points, divide(std::clamp(excess.Fraction, least, 1 - least)), follow);
      this->Connect(points, point, follow);
      return;
    }
    const double lift = std::ceil(excess.Height / Micrometre) * Micrometre;
    points.back() = ToMicrometres(start[0], start[1], start[2] + lift);
    point = ToMicrometres(point[0], point[1], point[2] + lift);
  }
  else if (follow && length > 2 * ShortestMotion)
  {
    const Vec3 middle = divide(0.5);
    if (0.5 * (start[2] + point[2]) - middle[2] > this->Tolerance + Micrometre)
    {
      this->Connect(points, middle, follow);
      this->Connect(points, point, follow);
      return;
    }
  }
  points.push_back(point);
}
}
