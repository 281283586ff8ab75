// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaArcFit.h"

#include "lacunaVector.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double LargestRadius = 1e7; // um
constexpr std::size_t MostMotions = 2000;
constexpr int Halvings = 40;
constexpr int Centres = 64;       // tried
constexpr double Rounding = 1e-5; // um, of distances from far centres

double Distance(const Vec2& p, const Vec2& q)
{
  return std::hypot(p[0] - q[0], p[1] - q[1]);
}

double SegmentDistance(const Vec2& c, const Vec2& p, const Vec2& q)
{
  const Vec2 d{ q[0] - p[0], q[1] - p[1] };
  const double t = ((c[0] - p[0]) * d[0] + (c[1] - p[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
  const double s = std::clamp(t, 0.0, 1.0);
  return Distance(c, { p[0] + s * d[0], p[1] + s * d[1] });
}

// A part of the path from the origin on, its first coordinate increasing, the second one z; um.
class Run
{
public:
  Run(std::vector<Vec2> points, double tolerance)
    : Points(std::move(points))
    , Tolerance(tolerance)
    , End(this->Points.back())
    , Half(0.5 * std::hypot(this->End[0], this->End[1]))
  {
  }

  struct Arc
  {
    bool Straight = false;
    bool Upper = false;
    Vec2 Centre{ 0, 0 };
    double Radius = 0;
  };

  // The straight motion, or an arc with a centre in whole micrometres, from the first to the last
  // point.
  std::optional<Arc> Fit() const
  {
    // Arcs between two points are the higher, everywhere, the larger their rise over the chord.
    const auto bound = [this](const auto& isLow)
    {
      double low = -this->Half;
      double high = this->Half;
      for (int k = 0; k < Halvings; ++k)
      {
        const double middle = 0.5 * (low + high);
        (isLow(this->MakeArc(middle)) ? low : high) = middle;
      }
      return 0.5 * (low + high);
    };
    const double least = bound([this](const Arc& arc) { return !this->IsAbove(arc, Rounding); });
    const double most = bound([this](const Arc& arc) { return this->IsNear(arc); });
    if (least <= 0 && most >= 0)
    {
      Arc straight;
      straight.Straight = true;
      return straight;
    }
    std::optional<Arc> best;
    double mismatch = ArcFit::LargestMismatch;
    for (int k = 0; k < Centres && least <= most; ++k)
    {
      Arc arc = this->MakeArc(least + (most - least) * (k + 0.5) / Centres);
      if (arc.Straight)
      {
        continue;
      }
      arc.Centre = { std::round(arc.Centre[0]), std::round(arc.Centre[1]) };
      const double radii[2] = { Distance(arc.Centre, { 0, 0 }), Distance(arc.Centre, this->End) };
      const double difference = std::abs(radii[1] - radii[0]);
      if (difference > mismatch || !this->IsMonotone(arc))
      {
        continue;
      }
      bool good = true;
      for (const double radius : radii)
      {
        arc.Radius = radius;
        good = good && this->IsAbove(arc, difference + Rounding) && this->IsNear(arc);
      }
      if (good)
      {
        arc.Radius = std::max(radii[0], radii[1]);
        best = arc;
        mismatch = difference;
      }
    }
    return best;
  }

private:
  // The arc between the ends that rises so much above the chord.
  Arc MakeArc(double rise) const
  {
    Arc arc;
    const double size = std::abs(rise);
    arc.Straight = size * 2 * LargestRadius < this->Half * this->Half;
    arc.Upper = rise > 0;
    if (!arc.Straight)
    {
      arc.Radius = 0.5 * (this->Half * this->Half + size * size) / size;
      const double t = (rise - (arc.Upper ? 1 : -1) * arc.Radius) / (2 * this->Half);
      arc.Centre = { 0.5 * this->End[0] - t * this->End[1], 0.5 * this->End[1] + t * this->End[0] };
    }
    return arc;
  }

  double AboveChord(const Vec2& p) const
  {
    return (this->End[0] * p[1] - this->End[1] * p[0]) / (2 * this->Half);
  }

  // Whether no point of the path is higher than the arc, but for slack.
  bool IsAbove(const Arc& arc, double slack) const
  {
    for (std::size_t k = 1; k < this->Points.size(); ++k)
    {
      const Vec2& p = this->Points[k];
      const bool below = arc.Straight ? this->AboveChord(p) <= slack
        : arc.Upper                   ? Distance(arc.Centre, p) <= arc.Radius + slack
                    : SegmentDistance(arc.Centre, this->Points[k - 1], p) >= arc.Radius - slack;
      if (!below)
      {
        return false;
      }
    }
    return true;
  }

  // Whether an arc above the path is within the tolerance of it. Lower ones are, too.
  bool IsNear(const Arc& arc) const
  {
    for (std::size_t k = 1; k < this->Points.size(); ++k)
    {
      const Vec2& p = this->Points[k];
      const bool near = arc.Straight ? this->AboveChord(p) >= -this->Tolerance
        : arc.Upper
        ? SegmentDistance(arc.Centre, this->Points[k - 1], p) >= arc.Radius - this->Tolerance
        : Distance(arc.Centre, p) <= arc.Radius + this->Tolerance;
      if (!near)
      {
        return false;
      }
    }
    return true;
  }

  // Whether the arc goes on along the first coordinate all the way.
  bool IsMonotone(const Arc& arc) const
  {
    return arc.Upper ? arc.Centre[1] <= std::min(0.0, this->End[1])
                     : arc.Centre[1] >= std::max(0.0, this->End[1]);
  }

  std::vector<Vec2> Points;
  double Tolerance;
  Vec2 End;
  double Half;
};
}

//------------------------------------------------------------------------------
ArcFit::ArcFit(const std::vector<Micrometres>& points, double tolerance)
  : Points(points)
  , Tolerance(tolerance)
{
}

//------------------------------------------------------------------------------
std::optional<ArcFit::Motion> ArcFit::Find(std::size_t first, std::size_t last) const
{
  const Micrometres& start = this->Points[first];
  if (last < first + 2)
  {
    return {};
  }
  const Micrometres& second = this->Points[first + 1];
  const int normal = second[1] == start[1] ? 1 : 0;
  const int along = 1 - normal;
  const std::int64_t sense = second[along] < start[along] ? -1 : 1;
  std::vector<Vec2> points{ { 0, 0 } };
  for (std::size_t k = first + 1; k <= std::min(last, first + MostMotions); ++k)
  {
    const Micrometres& p = this->Points[k];
    const std::int64_t step = sense * (p[along] - this->Points[k - 1][along]);
    if (p[normal] != start[normal] || step <= 0)
    {
      break;
    }
    points.push_back({ static_cast<double>(sense * (p[along] - start[along])),
      static_cast<double>(p[2] - start[2]) });
  }
  const std::size_t most = points.size() - 1;
  std::size_t count = 0;
  Run::Arc found;
  const auto fits = [&](std::size_t n)
  {
    const auto end = points.begin() + static_cast<std::ptrdiff_t>(n);
    const std::optional<Run::Arc> arc = Run({ points.begin(), end + 1 }, this->Tolerance).Fit();
    if (arc)
    {
      count = n;
      found = *arc;
    }
    return arc.has_value();
  };
  std::size_t failed = most + 1;
  for (std::size_t n = 2; n <= most; n = std::min(2 * n, most))
  {
    if (!fits(n))
    {
      failed = n;
      break;
    }
    if (n == most)
    {
      break;
    }
  }
  while (count > 0 && failed > count + 1)
  {
    const std::size_t middle = count + (failed - count) / 2;
    failed = fits(middle) ? failed : middle;
  }
  if (count < (found.Straight ? 2U : 3U))
  {
    return {};
  }
  const auto whole = [](double x) { return static_cast<std::int64_t>(std::llround(x)); };
  Motion motion{ first + count, found.Straight, normal, found.Upper, start,
    static_cast<double>(std::max(start[2], this->Points[first + count][2])) };
  if (!found.Straight)
  {
    motion.Centre[along] += sense * whole(found.Centre[0]);
    motion.Centre[2] += whole(found.Centre[1]);
    const bool top = found.Upper && found.Centre[0] > 0 && found.Centre[0] < points[count][0];
    motion.Highest = top ? static_cast<double>(motion.Centre[2]) + found.Radius : motion.Highest;
  }
  return motion;
}
}
