// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepEnds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Steps before and after that say what is usual.
constexpr std::size_t StepsAround = 32;
// Steps before and after that say where the probe goes.
constexpr std::size_t StepsOfDirection = 5;
// Of the diagonal of the image.
constexpr double PartAtRest = 0.01;
// In usual steps.
constexpr double LongestTurn = 3;
constexpr double LongestStraight = 8;
constexpr double LongestPerInterval = 2;
// In usual intervals. Not a whole number: rounding must not decide.
constexpr double LongestMissing = 10.5;
// A step beside a fast one, compared with it.
constexpr double FastNeighbour = 0.4;
constexpr double SmallestCosine = 0.4;

struct Step
{
  double Distance;
  double Numbers;
  double Time;                ///< s, NaN when not known
  std::array<Vec3, 4> Motion; ///< of the corners, along the first slice's axes; of length 1, or 0
  std::size_t Moved;          ///< how many steps of a probe that is not at rest were before
};

double GetThirdQuartile(std::vector<double> values)
{
  const auto place = values.begin() + static_cast<std::ptrdiff_t>((3 * values.size() + 3) / 4 - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// Of items [first, last) around one, at most StepsAround on each side of it.
template <class Get>
std::vector<double> GetAround(std::size_t middle, std::size_t count, const Get& get)
{
  std::vector<double> values;
  const std::size_t last = std::min(count, middle + StepsAround + 1);
  for (std::size_t i = middle > StepsAround ? middle - StepsAround : 0; i < last; ++i)
  {
    const double value = get(i);
    if (value > 0) // or not known
    {
      values.push_back(value);
    }
  }
  return values;
}

// As the probe sees it: a probe that turns steadily has a steady motion.
std::array<Vec3, 4> GetMotion(const SlicePlace& a, const SlicePlace& b)
{
  const Vec3 x = Normalized(a.Corners[1] - a.Corners[0]);
  const Vec3 y = Normalized(a.Corners[2] - a.Corners[0]);
  const Vec3 z = Cross(x, y);
  std::array<Vec3, 4> motion;
  double square = 0;
  for (std::size_t c = 0; c < 4; ++c)
  {
    const Vec3 way = b.Corners[c] - a.Corners[c];
    motion[c] = { Dot(way, x), Dot(way, y), Dot(way, z) };
    square += Dot(motion[c], motion[c]);
  }
  for (Vec3& way : motion)
  {
    way = square > 0 ? (1 / std::sqrt(square)) * way : Vec3{ 0, 0, 0 };
  }
  return motion;
}

double GetCosine(const Step& a, const Step& b)
{
  double sum = 0;
  for (std::size_t c = 0; c < 4; ++c)
  {
    sum += Dot(a.Motion[c], b.Motion[c]);
  }
  return sum;
}

class Sweep
{
public:
  Sweep(const std::vector<SlicePlace>& slices, const std::vector<double>& times)
  {
    std::size_t kept = 0;
    for (std::size_t i = 1; i < slices.size(); ++i)
    {
      const SlicePlace& a = slices[i - 1];
      const SlicePlace& b = slices[i];
      this->Steps.push_back(
        { GetStep(a, b), static_cast<double>(std::max<std::int64_t>(1, b.Number - a.Number)),
          times[i] - times[i - 1], GetMotion(a, b), this->Moves.size() });
      const double moved = GetStep(slices[kept], b);
      if (moved >= PartAtRest * Norm(slices[kept].Corners[3] - slices[kept].Corners[0]))
      {
        this->Moves.push_back(moved);
        kept = i;
      }
    }
  }

  const std::vector<Step>& GetSteps() const { return this->Steps; }

  // Whether the step ends a sweep; limit: mm, the longest step that would not have done so.
  bool IsEnd(std::size_t i, double& limit) const
  {
    const std::vector<double> moves = GetAround(
      this->Steps[i].Moved, this->Moves.size(), [&](std::size_t m) { return this->Moves[m]; });
    if (moves.empty()) // the probe is at rest all the time
    {
      return false;
    }
    const double usual = GetThirdQuartile(moves);
    limit = usual * LongestTurn;
    if (this->Steps[i].Distance <= limit)
    {
      return false; // as nearly all of them: what follows takes time
    }
    const double intervals = this->GetIntervals(i);
    if (intervals > LongestMissing)
    {
      return true;
    }
    if (this->GoesOn(i))
    {
      limit = usual * std::max(LongestStraight, LongestPerInterval * intervals);
    }
    return this->Steps[i].Distance > limit && !this->IsFast(i);
  }

private:
  // How many usual ones of number or of time the step takes. Time that runs backwards is that of
  // another recording.
  double GetIntervals(std::size_t i) const
  {
    const Step& step = this->Steps[i];
    double intervals = 0;
    for (double Step::*const size : { &Step::Numbers, &Step::Time })
    {
      const std::vector<double> around =
        GetAround(i, this->Steps.size(), [&](std::size_t s) { return this->Steps[s].*size; });
      if (!around.empty())
      {
        const double usual = GetThirdQuartile(around);
        intervals = std::max(intervals, step.*size / usual);
      }
    }
    return step.Time < 0 ? 2 * LongestMissing : intervals;
  }

  // True when the step has the direction of those before and of those after it, as far as there are
  // any.
  bool GoesOn(std::size_t i) const
  {
    const auto isStraight = [&](std::size_t first, std::size_t last)
    {
      double sum = 0;
      for (std::size_t s = first; s < last; ++s)
      {
        sum += GetCosine(this->Steps[i], this->Steps[s]);
      }
      return first == last || sum >= SmallestCosine * static_cast<double>(last - first);
    };
    return isStraight(i > StepsOfDirection ? i - StepsOfDirection : 0, i) &&
      isStraight(i + 1, std::min(i + 1 + StepsOfDirection, this->Steps.size()));
  }

  // True where a step beside this one is about as fast and has the same direction.
  bool IsFast(std::size_t i) const
  {
    const double speed = this->Steps[i].Distance / this->GetIntervals(i);
    const auto isLike = [&](std::size_t j)
    {
      return this->Steps[j].Distance / this->GetIntervals(j) >= FastNeighbour * speed &&
        GetCosine(this->Steps[i], this->Steps[j]) >= SmallestCosine;
    };
    return (i > 0 && isLike(i - 1)) || (i + 1 < this->Steps.size() && isLike(i + 1));
  }

  std::vector<Step> Steps;
  std::vector<double> Moves; // steps of slices that are not at rest
};
}

std::vector<SweepEnd> FindSweepEnds(
  const std::vector<SlicePlace>& slices, const std::vector<double>& times)
{
  if (times.size() != slices.size())
  {
    throw std::invalid_argument("each slice needs a time");
  }
  std::vector<SweepEnd> found;
  if (slices.size() < 2)
  {
    return found;
  }
  const Sweep sweep(slices, times);
  const std::vector<Step>& steps = sweep.GetSteps();
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    double limit = 0;
    if (sweep.IsEnd(i, limit))
    {
      found.push_back({ i + 1, steps[i].Distance, limit, steps[i].Time });
    }
  }
  return found;
}
}
