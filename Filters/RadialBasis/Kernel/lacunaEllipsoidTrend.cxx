// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEllipsoidTrend.h"

#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::size_t Count = 6;
// Of the normal equations, whose terms are all about 1.
constexpr double ConditionLimit = 1e13;
// Of the greatest root: 1 / (1 + tan^2) of a sphere's slope of 65 degrees.
constexpr double SteepShare = 0.18;
constexpr const char* Undetermined =
  "the surface around the defect does not determine an ellipsoid (it is flat, or curved like a "
  "saddle); set Trend to None";

std::array<double, Count> GetTerms(const Vec3& p)
{
  return { p[0] * p[0] - p[1] * p[1], p[0] * p[1], p[0], p[1], p[2], 1 };
}
}

EllipsoidTrend::EllipsoidTrend(const std::vector<Vec3>& points)
{
  if (points.size() < Count)
  {
    throw std::invalid_argument(Undetermined);
  }
  const auto n = static_cast<double>(points.size());
  for (const Vec3& p : points)
  {
    this->Center = this->Center + (1 / n) * p;
  }
  double extent = 0;
  for (const Vec3& p : points)
  {
    extent = std::max(extent, Norm(p - this->Center));
  }
  if (!(extent > 0))
  {
    throw std::invalid_argument(Undetermined);
  }
  this->Scale = 1 / extent;
  SquareMatrix normal(Count);
  std::fill_n(normal.Column(0), Count * Count, 0.0);
  std::vector<double> right(Count, 0.0);
  for (const Vec3& p : points)
  {
    const Vec3 u = this->Scale * (p - this->Center);
    const std::array<double, Count> terms = GetTerms(u);
    for (std::size_t j = 0; j < Count; ++j)
    {
      right[j] -= terms[j] * Dot(u, u) / n;
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
  // (1 + a) (1 - a) > (b / 2)^2 makes it an ellipsoid
  if (!((1 - this->Terms[0] * this->Terms[0]) > 0.25 * this->Terms[1] * this->Terms[1]))
  {
    throw std::invalid_argument(Undetermined);
  }
  std::size_t above = 0;
  for (const Vec3& p : points)
  {
    above += this->Scale * (p[2] - this->Center[2]) > -0.5 * this->Terms[4];
  }
  this->Side = 2 * above > points.size() ? 1 : -1;
  // the middle, where the root is greatest
  const double a = 1 + this->Terms[0];
  const double b = 0.5 * this->Terms[1];
  const double c = 1 - this->Terms[0];
  const double u = -0.5 * (c * this->Terms[2] - b * this->Terms[3]) / (a * c - b * b);
  const double v = -0.5 * (a * this->Terms[3] - b * this->Terms[2]) / (a * c - b * b);
  const double greatest =
    this->GetRoot(this->Center[0] + u / this->Scale, this->Center[1] + v / this->Scale);
  if (!(greatest > 0))
  {
    throw std::invalid_argument(Undetermined);
  }
  this->LeastRoot = SteepShare * greatest;
}

//------------------------------------------------------------------------------
double EllipsoidTrend::GetRoot(double x, double y) const
{
  // z^2 + linear z + rest = 0
  const double u = this->Scale * (x - this->Center[0]);
  const double v = this->Scale * (y - this->Center[1]);
  const double rest = u * u + v * v + this->Terms[0] * (u * u - v * v) + this->Terms[1] * u * v +
    this->Terms[2] * u + this->Terms[3] * v + this->Terms[5];
  return 0.25 * this->Terms[4] * this->Terms[4] - rest;
}

//------------------------------------------------------------------------------
double EllipsoidTrend::GetDepth(double x, double y) const
{
  const double root = this->GetRoot(x, y);
  const double least = this->LeastRoot;
  const double half =
    root >= least ? std::sqrt(root) : std::sqrt(least) + (root - least) / (2 * std::sqrt(least));
  return this->Center[2] + (-0.5 * this->Terms[4] + this->Side * half) / this->Scale;
}
}
