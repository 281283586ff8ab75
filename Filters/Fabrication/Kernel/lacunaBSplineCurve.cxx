// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBSplineCurve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
//------------------------------------------------------------------------------
Vec3 BSplineCurve::Evaluate(double t) const
{
  const auto size = static_cast<std::int64_t>(this->ControlPoints.size());
  t = std::clamp(t, this->Knots.front(), this->Knots.back());
  const auto above = std::upper_bound(this->Knots.begin() + 4, this->Knots.begin() + size, t);
  const std::int64_t span = above - this->Knots.begin() - 1;
  // de Boor's algorithm
  std::array<Vec3, 4> d;
  std::copy_n(this->ControlPoints.begin() + span - 3, 4, d.begin());
  for (std::int64_t r = 1; r <= 3; ++r)
  {
    for (std::int64_t i = 3; i >= r; --i)
    {
      const double low = this->Knots[span - 3 + i];
      const double high = this->Knots[span + 1 + i - r];
      const double x = (t - low) / (high - low);
      d[i] = (1 - x) * d[i - 1] + x * d[i];
    }
  }
  return d[3];
}

//------------------------------------------------------------------------------
bool BSplineCurve::IsClosed() const
{
  return this->ControlPoints.front() == this->ControlPoints.back();
}

//------------------------------------------------------------------------------
void BSplineCurve::Round(int decimals)
{
  const double steps = std::pow(10, decimals);
  for (Vec3& p : this->ControlPoints)
  {
    for (double& x : p.Elements)
    {
      x = std::round(x * steps) / steps + 0.0;
    }
  }
}

//------------------------------------------------------------------------------
BSplineCurve InterpolateClosed(const std::vector<Vec3>& points, double step)
{
  const auto count = static_cast<std::int64_t>(points.size());
  if (count < 3)
  {
    throw std::invalid_argument("a closed cubic needs three points");
  }
  // Coefficients of the periodic spline: the inverse of the filter (1, 4, 1) / 6 is symmetric and
  // falls off by 2 - sqrt(3) from one to the next.
  const double pole = std::sqrt(3.0) - 2;
  constexpr std::int64_t reach = 32;
  std::vector<Vec3> c(points.size());
  for (std::int64_t k = 0; k < count; ++k)
  {
    double weight = std::sqrt(3.0);
    c[k] = weight * points[k];
    for (std::int64_t j = 1; j <= reach; ++j)
    {
      weight *= pole;
      c[k] =
        c[k] + weight * (points[(k + j) % count] + points[(k - j + (reach + 1) * count) % count]);
    }
  }
  // The same curve with clamped ends: its first and last coefficients are polar forms.
  BSplineCurve curve;
  curve.Knots.assign(3, 0.0);
  for (std::int64_t k = 0; k <= count; ++k)
  {
    curve.Knots.push_back(step * static_cast<double>(k));
  }
  curve.Knots.insert(curve.Knots.end(), 3, curve.Knots.back());
  curve.ControlPoints.reserve(points.size() + 3);
  curve.ControlPoints.push_back(points[0]);
  curve.ControlPoints.push_back((1.0 / 3) * (2.0 * c[0] + c[1]));
  curve.ControlPoints.insert(curve.ControlPoints.end(), c.begin() + 1, c.end());
  curve.ControlPoints.push_back((1.0 / 3) * (c[count - 1] + 2.0 * c[0]));
  curve.ControlPoints.push_back(points[0]);
  return curve;
}

//------------------------------------------------------------------------------
BSplineCurve FitClosedCurve(const std::function<Vec3(double)>& curve, double length,
  double tolerance, std::int64_t first, const std::function<std::int64_t(std::int64_t)>& grow,
  bool unitSteps)
{
  constexpr std::int64_t most = 100000;
  constexpr int between = 8;
  constexpr double seen = 0.96; // of the largest distance between neighbours, by eight places
  for (std::int64_t count = first; count <= most; count = grow(count))
  {
    const double step = length / static_cast<double>(count);
    std::vector<Vec3> points;
    points.reserve(count);
    for (std::int64_t k = 0; k < count; ++k)
    {
      points.push_back(curve(step * static_cast<double>(k)));
    }
    const double own = unitSteps ? 1 : step;
    BSplineCurve result = InterpolateClosed(points, own);
    bool good = true;
    for (std::int64_t k = 0; k < between * count && good; ++k)
    {
      const double at = (static_cast<double>(k) + 0.5) / between;
      good = Norm(result.Evaluate(own * at) - curve(step * at)) <= seen * tolerance;
    }
    if (good)
    {
      return result;
    }
  }
  throw std::runtime_error("a curve on the surface cannot be kept within the tolerance");
}
}
