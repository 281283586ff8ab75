// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullEllipsoid.h"

#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::size_t Count = 9;
// Of the normal equations, whose terms are all about 1.
constexpr double ConditionLimit = 1e12;
constexpr const char* Undetermined =
  "the sound bone does not determine an ellipsoid around the centre: give more of the skull, or a "
  "centre inside it";

std::array<double, Count> GetTerms(const Vec3& p)
{
  return { p[0] * p[0], p[1] * p[1], p[2] * p[2], p[0] * p[1], p[1] * p[2], p[0] * p[2], p[0], p[1],
    p[2] };
}
}

SkullEllipsoid::SkullEllipsoid(const Vec3& center, const std::vector<Vec3>& points)
{
  if (points.size() < Count)
  {
    throw std::invalid_argument(Undetermined);
  }
  const auto n = static_cast<double>(points.size());
  double mean = 0;
  for (const Vec3& p : points)
  {
    mean += Norm(p - center) / n;
  }
  if (!(mean > 0) || !std::isfinite(mean))
  {
    throw std::invalid_argument(Undetermined);
  }
  this->Scale = 1 / mean;
  SquareMatrix normal(Count);
  std::fill_n(normal.Column(0), Count * Count, 0.0);
  std::vector<double> right(Count, 0.0);
  for (const Vec3& p : points)
  {
    const std::array<double, Count> terms = GetTerms(this->Scale * (p - center));
    for (std::size_t j = 0; j < Count; ++j)
    {
      right[j] += terms[j] / n;
      for (std::size_t i = j; i < Count; ++i)
      {
        normal.Column(j)[i] += terms[i] * terms[j] / n;
      }
    }
  }
  try
  {
    const SymmetricFactorization factorization(std::move(normal));
    if (!(factorization.GetConditionEstimate() < ConditionLimit))
    {
      throw std::invalid_argument(Undetermined);
    }
    factorization.Solve(right);
  }
  catch (const std::runtime_error&)
  {
    throw std::invalid_argument(Undetermined);
  }
  std::copy(right.begin(), right.end(), this->Terms.begin());
}

double SkullEllipsoid::GetRadius(const Vec3& direction) const
{
  // a r^2 + b r = 1
  const std::array<double, Count> terms = GetTerms(direction);
  double a = 0;
  double b = 0;
  for (std::size_t i = 0; i < Count; ++i)
  {
    (i < 6 ? a : b) += this->Terms[i] * terms[i];
  }
  const double root = b * b + 4 * a;
  // the positive root in a form that also holds for small a
  const double sum = root >= 0 ? b + std::sqrt(root) : 0;
  return sum > 0 ? 2 / (sum * this->Scale) : std::numeric_limits<double>::quiet_NaN();
}
}
