// SPDX-License-Identifier: BSD-3-Clause
// The closed forms of Carr 1996, section 5.3, and how fast they are approached.
#include "OcclusionCases.h"
#include "lacunaSanitized.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

namespace lacuna
{
namespace
{
// Mean error over the pixels at which truth gives a number, for a curve of radius r pixels in an
// image of 4 r pixels. present(angle) says whether the circle exists in that direction.
struct Circle
{
  std::function<bool(double)> Present;
  std::function<double(double x, double y)> Truth; // in units of the radius; NaN: not looked at

  double GetError(int r, int directions) const
  {
    const int n = 4 * r + 1;
    AttenuationField field({ n, n, 1 }, { 1, 1, 1 });
    const int steps = 16 * r; // a closed curve of pixels
    for (int s = 0; s < steps; ++s)
    {
      const double a = 2 * Pi * (s + 0.5) / steps;
      if (this->Present(a))
      {
        field.Row(std::lround(2 * r + r * std::sin(a)), 0)[std::lround(2 * r + r * std::cos(a))] =
          1;
      }
    }
    const auto angle = GetAngle(field, { true, directions, 0 });
    double sum = 0;
    int count = 0;
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const double truth = this->Truth(double(i - 2 * r) / r, double(j - 2 * r) / r);
        if (!std::isnan(truth))
        {
          sum += std::abs(angle[j * n + i] - truth);
          ++count;
        }
      }
    }
    return sum / count;
  }
};

const double None = std::nan("");

// The angle of the gap of half width h around the direction +x, seen from (x, y) inside.
double GetGap(double h, double x, double y)
{
  const double a = std::atan2(std::sin(h) - y, std::cos(h) - x);
  const double b = std::atan2(-std::sin(h) - y, std::cos(h) - x);
  return a - b;
}

double Radius(double x, double y)
{
  return std::sqrt(x * x + y * y);
}
}

TEST(OccludedAngleTruth, InsideAClosedCircleIsTheFullAngle)
{
  const Circle circle{ [](double) { return true; },
    [](double x, double y) { return Radius(x, y) < 0.95 ? 2 * Pi : None; } };
  EXPECT_LT(circle.GetError(30, 100), 0.002);
  EXPECT_LT(circle.GetError(30, 36), 0.002);
}

TEST(OccludedAngleTruth, OutsideAClosedCircle)
{
  const Circle circle{ [](double) { return true; },
    [](double x, double y)
    {
      const double r = Radius(x, y);
      return r > 1.2 && r < 1.9 ? 2 * std::asin(1 / r) : None;
    } };
  // A curve of pixels is half a pixel thick on either side: first order.
  const double coarse = circle.GetError(20, 400);
  const double fine = circle.GetError(80, 400);
  EXPECT_LT(coarse, 0.13);
  EXPECT_LT(fine, 0.032);
  EXPECT_NEAR(coarse / fine, 4, 0.8);
  // so is the angle's sampling
  EXPECT_LT(circle.GetError(80, 40), 0.06);
}

// The ends of a gap are uncertain by a pixel together: first order. Where the pixels end is chance, so
// the order is of 100 gaps of about 40 degrees (Carr 1996, figure 5.13), anywhere on the circle, with
// what it is uncertain by: 0.99 +- 0.08.
TEST(OccludedAngleTruth, OneGap)
{
  const int gaps = Sanitized ? 3 : 100;
  Numbers number(5);
  double mean[2] = { 0, 0 };
  double square[2] = { 0, 0 };
  for (int gap = 0; gap < gaps; ++gap)
  {
    const double half = (16 + 8 * number()) * Pi / 180;
    const double turn = 2 * Pi * number();
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const Circle circle{ [=](double a) { return std::cos(a - turn) < std::cos(half); },
      [=](double x, double y)
      { return Radius(x, y) < 0.8 ? 2 * Pi - GetGap(half, c * x + s * y, c * y - s * x) : None; } };
    for (int fine : { 0, 1 })
    {
      const double error = circle.GetError(fine ? 80 : 20, 400);
      mean[fine] += error / gaps;
      square[fine] += error * error / gaps;
    }
  }
  // the order and 1.96 of its standard errors
  double variance = 0;
  for (int fine : { 0, 1 })
  {
    variance += (square[fine] / (mean[fine] * mean[fine]) - 1) / (gaps - 1);
  }
  const double order = std::log(mean[0] / mean[1]) / std::log(4.0);
  const double uncertainty = 1.96 * std::sqrt(variance) / std::log(4.0);
  EXPECT_LT(mean[1], 0.025);
  if (Sanitized)
  {
    return; // no order of so few
  }
  EXPECT_NEAR(order, 1, 0.1);
  EXPECT_LT(uncertainty, 0.1);
}

// Along the chord the angle is pi, whatever the gap.
TEST(OccludedAngleTruth, ChordOfAGap)
{
  for (double half : { 0.2, 0.35, 0.5 })
  {
    const Circle chord{ [=](double a) { return std::cos(a) < std::cos(half); },
      [=](double x, double y)
      {
        const bool near = std::abs(x - std::cos(half)) < 0.006;
        return near && std::abs(y) < 0.6 * std::sin(half) ? Pi : None;
      } };
    EXPECT_LT(chord.GetError(100, 400), 0.1);
  }
}

// Along the missing arc the angle is pi - psi / 2.
TEST(OccludedAngleTruth, ArcOfAGap)
{
  for (double half : { 0.2, 0.35, 0.5 })
  {
    const Circle arc{ [=](double a) { return std::cos(a) < std::cos(half); },
      [=](double x, double y)
      {
        const bool near = std::abs(Radius(x, y) - 1) < 0.006;
        return near && std::abs(std::atan2(y, x)) < 0.6 * half ? Pi - half : None;
      } };
    EXPECT_LT(arc.GetError(100, 400), 0.1) << half;
  }
}

// The threshold pi - psi / 2, which restores the arc of a gap psi, enlarges the rest by
// 1 / cos(psi / 4) - 1: 0.86 % for 30 degrees, 3.5 % for 60, 41 % for 180.
TEST(OccludedAngleTruth, ThresholdThatRestoresAnArcEnlargesTheRest)
{
  for (const auto& [psi, enlarged] :
    { std::pair(Pi / 6, 0.0086), std::pair(Pi / 3, 0.0353), std::pair(Pi, 0.4142) })
  {
    ASSERT_NEAR(1 / std::cos(psi / 4) - 1, enlarged, 1e-4);
    const double threshold = Pi - psi / 2;
    const double edge = 1 + enlarged;
    // opposite to the gap, a pixel within (unless that is the circle) and a pixel beyond
    for (double side : { -1.0, 1.0 })
    {
      if (side < 0 && enlarged < 0.02)
      {
        continue;
      }
      const Circle circle{ [half = psi / 2](double a) { return std::cos(a) < std::cos(half); },
        [=](double x, double y)
        {
          const double r = Radius(x, y);
          const double place = (r - edge) * side * 100;
          return x < -0.9 * r && place > 1 && place < 2 ? 2 * std::asin(std::min(1.0, 1 / r))
                                                        : None;
        } };
      const double slope = 2 / (edge * std::sqrt(edge * edge - 1)); // of the angle by the radius
      EXPECT_NEAR(2 * std::asin(1 / edge), threshold, 1e-3);
      // at most two pixels
      EXPECT_LT(circle.GetError(100, 400), 0.02 * slope) << psi << ' ' << side;
    }
  }
}

// Equal angles sample the step of what is hidden: first order in their number.
TEST(OccludedAngleTruth, ConvergesWithDirections)
{
  const Circle circle{ [](double) { return true; },
    [](double x, double y)
    {
      const double r = Radius(x, y);
      return r > 1.3 && r < 1.9 ? 2 * std::asin(1 / r) : None;
    } };
  const double few = circle.GetError(100, 8);
  const double more = circle.GetError(100, 16);
  EXPECT_NEAR(few / more, 2, 0.5);
  EXPECT_LT(more, 2 * Pi / 16 / 3); // the mean of a rounded number of directions
}

TEST(OccludedAngleTruth, SeveralGapsAdd)
{
  const double half = Pi / 18;
  const auto turned = [](double x, double y, int i)
  {
    const double a = 2 * Pi * i / 3;
    return std::pair(std::cos(a) * x + std::sin(a) * y, -std::sin(a) * x + std::cos(a) * y);
  };
  const Circle circle{ [=](double a) { return std::cos(3 * a) < std::cos(3 * half); },
    [=](double x, double y)
    {
      double truth = 2 * Pi;
      for (int i = 0; i < 3; ++i)
      {
        const auto [u, v] = turned(x, y, i);
        truth -= GetGap(half, u, v);
      }
      return Radius(x, y) < 0.7 ? truth : None;
    } };
  const double coarse = circle.GetError(25, 400);
  const double fine = circle.GetError(100, 400);
  EXPECT_LT(fine, 0.06);
  EXPECT_NEAR(coarse / fine, 4, 1);
}

// Narrow gaps, evenly spread: the angle inside is 2 pi times the fraction of the circle that the
// pixels cover as seen from the middle, outside it is reduced by 2 p - p^2.
TEST(OccludedAngleTruth, EvenGaps)
{
  const int parts = 60;
  const int r = 300;
  const double open = 0.5; // of the circle, before pixels make the parts longer
  const auto present = [=](double a) { return std::fmod(a * parts / (2 * Pi), 1.0) < 1 - open; };
  const double longer = parts * 1.0 / (2 * Pi * r); // a pixel per part
  const double p = 1 - open + longer;
  const Circle inside{ present,
    [=](double x, double y) { return Radius(x, y) < 0.6 ? 2 * Pi * p : None; } };
  EXPECT_LT(inside.GetError(r, 500), 0.2);
  const Circle outside{ present,
    [=](double x, double y)
    {
      const double d = Radius(x, y);
      return d > 1.4 && d < 1.8 ? (2 * p - p * p) * 2 * std::asin(1 / d) : None;
    } };
  EXPECT_LT(outside.GetError(r, 500), 0.1);
}

// Smooth data: path integrals through a Gaussian are known. Second order in the voxel's size.
TEST(OccludedAngleTruth, GaussianConvergesInSecondOrder)
{
  const auto getError = [](int scale, bool flat)
  {
    const int n = 16 * scale + 1;
    const double sigma = 2.0 * scale;
    AttenuationField field({ n, n, flat ? 1 : n }, { 1, 1, 1 });
    const double middle = 8.0 * scale;
    FillField(field,
      [&](std::int64_t i, std::int64_t j, std::int64_t k)
      {
        const double x = static_cast<double>(i) - middle;
        const double y = static_cast<double>(j) - middle;
        const double z = flat ? 0 : static_cast<double>(k) - middle;
        return std::exp(-0.5 * (x * x + y * y + z * z) / (sigma * sigma)) / sigma;
      });
    const auto angle = GetAngle(field, { false, flat ? 200 : 1000, 0 });
    double squares = 0;
    for (int r = 0; r <= 6; ++r) // along the x axis
    {
      const double u = 0.5 * r; // in sigmas
      double hidden = 0;
      const int steps = 2000;
      for (int s = 0; s < steps; ++s)
      {
        const double turn = Pi * (s + 0.5) / steps;
        const double along = flat ? std::cos(turn) : 2 * (s + 0.5) / steps - 1;
        const double path = std::exp(-0.5 * u * u * (1 - along * along)) * std::sqrt(0.5 * Pi) *
          std::erfc(u * along * std::sqrt(0.5));
        hidden += (1 - std::exp(-path)) / steps;
      }
      const std::size_t at = ((flat ? 0 : 8 * scale) * n + 8 * scale) * n + (8 + r) * scale;
      const double error = angle[at] / GetFullAngle(field) - hidden;
      squares += error * error / 7;
    }
    return std::sqrt(squares);
  };
  for (bool flat : { true, false })
  {
    const double coarse = getError(1, flat);
    const double fine = getError(2, flat);
    EXPECT_LT(fine, 0.004) << flat;
    EXPECT_NEAR(coarse / fine, 4, 1.2) << flat;
  }
}

TEST(OccludedAngleTruth, Sphere)
{
  double errors[2];
  for (int level : { 0, 1 })
  {
    const int r = level == 0 ? 8 : 16;
    const int n = 4 * r + 1;
    AttenuationField field({ n, n, n }, { 1, 1, 1 });
    const auto radius = [=](std::int64_t i, std::int64_t j, std::int64_t k)
    {
      const double x = static_cast<double>(i - 2 * r);
      const double y = static_cast<double>(j - 2 * r);
      const double z = static_cast<double>(k - 2 * r);
      return std::sqrt(x * x + y * y + z * z) / r;
    };
    FillField(field,
      [=](std::int64_t i, std::int64_t j, std::int64_t k)
      { return std::abs(radius(i, j, k) - 1) * r <= 0.75 ? 1 : 0; });
    const auto angle = GetAngle(field, { true, 400, 0 }, 0);
    double sum = 0;
    int count = 0;
    for (int k = 0; k < n; ++k)
    {
      for (int j = 0; j < n; ++j)
      {
        for (int i = 0; i < n; ++i)
        {
          const double distance = radius(i, j, k);
          const float value = angle[(k * n + j) * n + i];
          if ((1 - distance) * r > 4) // nearer, some of the rays around pass the surface
          {
            ASSERT_NEAR(value, 4 * Pi, 0.02);
          }
          else if (distance > 1.3 && distance < 1.8)
          {
            sum += std::abs(value - 2 * Pi * (1 - std::sqrt(1 - 1 / (distance * distance))));
            ++count;
          }
        }
      }
    }
    errors[level] = sum / count;
  }
  EXPECT_LT(errors[1], 0.35);
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.35);
}
}
