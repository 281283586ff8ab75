// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBSplineCurve.h"

#include "lacunaBSplineSurface.h"
#include "lacunaIGESCurves.h"
#include "lacunaIGESDocument.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace lacuna;

namespace
{
const double Pi = std::acos(-1.0);

// An asymmetric closed curve over 0..length.
Vec3 Bean(double t, double length)
{
  const double a = 2 * Pi * t / length;
  const double r = 20 + 3 * std::cos(a) + 2 * std::sin(2 * a);
  return { 50 + r * std::cos(a), 40 + 0.7 * r * std::sin(a), 5 * std::sin(a + 1) };
}

std::vector<Vec3> BeanPoints(int count)
{
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k)
  {
    points.push_back(Bean(k, count));
  }
  return points;
}
}

TEST(BSplineCurve, ClosedCubicGoesThroughItsPointsAndIsC2AlsoAtItsSeam)
{
  for (const int count : { 3, 4, 9, 100 })
  {
    const double step = 0.5;
    const std::vector<Vec3> points = BeanPoints(count);
    const BSplineCurve curve = InterpolateClosed(points, step);
    ASSERT_EQ(curve.Knots.size(), curve.ControlPoints.size() + 4);
    EXPECT_EQ(curve.ControlPoints.size(), points.size() + 3);
    EXPECT_TRUE(curve.IsClosed());
    for (int k = 0; k <= count; ++k)
    {
      EXPECT_LT(Norm(curve.Evaluate(step * k) - points[k % count]), 1e-12) << count << " " << k;
    }
    // one-sided differences before and after each knot, the seam among them: exact for cubics
    const double h = 0.05;
    const double length = step * count;
    const auto difference = [&](double t, double direction, int order)
    {
      const auto p = [&](int i)
      {
        const double x = t + direction * h * i;
        return curve.Evaluate(x < 0 ? x + length : x);
      };
      const Vec3 first = p(1) - p(0);
      const Vec3 second = p(2) - 2.0 * p(1) + p(0);
      const Vec3 third = p(3) - 3.0 * p(2) + 3.0 * p(1) - p(0);
      return order == 1 ? direction / h * (first - 0.5 * second + (1.0 / 3) * third)
                        : 1 / (h * h) * (second - third);
    };
    for (int k = 0; k < count; ++k)
    {
      const double before = k == 0 ? length : step * k;
      for (const int order : { 1, 2 })
      {
        const Vec3 left = difference(before, -1, order);
        const Vec3 right = difference(step * k, 1, order);
        EXPECT_LT(Norm(left - right), 1e-8 * (1 + Norm(right)))
          << count << " " << k << " " << order;
      }
    }
  }
  EXPECT_THROW(InterpolateClosed(BeanPoints(2), 1), std::invalid_argument);
}

TEST(BSplineCurve, ClosedFitKeepsItsTolerance)
{
  const double length = 7;
  const auto bean = [&](double t) { return Bean(t, length); };
  const auto grow = [](std::int64_t count) { return count + 1; };
  std::size_t before = 0;
  for (const double tolerance : { 1.0, 1e-2, 1e-4, 1e-6 })
  {
    for (const bool unit : { false, true })
    {
      const BSplineCurve curve = FitClosedCurve(bean, length, tolerance, 4, grow, unit);
      const double last = curve.GetLast();
      EXPECT_DOUBLE_EQ(last, unit ? static_cast<double>(curve.ControlPoints.size() - 3) : length);
      double largest = 0;
      for (int k = 0; k <= 5000; ++k)
      {
        const double t = k / 5000.0;
        largest = std::max(largest, Norm(curve.Evaluate(t * last) - bean(t * length)));
      }
      EXPECT_LE(largest, tolerance);
      EXPECT_GE(curve.ControlPoints.size(), before);
      before = curve.ControlPoints.size();
    }
  }
  EXPECT_LT(before, 250u);
  EXPECT_THROW(FitClosedCurve(
                 [](double t) {
                   return Vec3{ t, 0, 0 };
                 },
                 1, 1e-9, 4, [](std::int64_t count) { return 2 * count; }, false),
    std::runtime_error); // not closed
}

TEST(BSplineCurve, RoundsItsPoints)
{
  BSplineCurve curve;
  curve.ControlPoints = { { -0.00001, 1.23456, 2 }, { 1.0 / 3, 0, 0 } };
  curve.Round(3);
  EXPECT_EQ(curve.ControlPoints[0], (Vec3{ 0, 1.235, 2 }));
  EXPECT_FALSE(std::signbit(curve.ControlPoints[0][0]));
  EXPECT_EQ(curve.ControlPoints[1], (Vec3{ 0.333, 0, 0 }));
}

TEST(IGESDocument, StrictParserReadsCurvesBack)
{
  const BSplineCurve curve = InterpolateClosed(BeanPoints(9), 1);
  IGESDocument document;
  const std::int64_t name = document.AddName("A curve");
  const std::int64_t pointer = document.AddCurve(curve, {}, { name });
  const IGESParser file(document.GetText({}));
  const IGESCurve read(file.Entities.at(pointer));
  EXPECT_EQ(read.Properties, std::vector<long>{ name });
  EXPECT_EQ(read.Degree, 3u);
  EXPECT_EQ(read.Knots, curve.Knots);
  EXPECT_TRUE(read.Closed);
  for (int k = 0; k <= 100; ++k)
  {
    const double t = k * 0.01 * curve.GetLast();
    const std::array<double, 3> p = read.At(t);
    EXPECT_LT(Norm(Vec3{ p[0], p[1], p[2] } - curve.Evaluate(t)), 1e-11);
  }
}

TEST(IGESDocument, StrictParserReadsPointsLinesAndPolygonsBack)
{
  IGESDocument document;
  IGESDocument::Attributes attributes;
  attributes.Level = 3;
  attributes.Label = "POINT";
  const std::int64_t point = document.AddPoint({ 1, -2.5, 1e-7 }, attributes);
  const std::int64_t line = document.AddLine({ 0, 0, -777.25 }, { 1, 2, 3 }, attributes);
  const std::int64_t polygon =
    document.AddPolygon({ { 1, 2, 3 }, { 4, 5, 6 }, { 7, 8, 9.5 } }, attributes);
  const IGESParser file(document.GetText({}));
  const IGESPolygon read(file, file.Entities.at(polygon));
  EXPECT_EQ(
    read.Corners, (std::vector<std::array<double, 3>>{ { 1, 2, 3 }, { 4, 5, 6 }, { 7, 8, 9.5 } }));
  EXPECT_EQ(file.Entities.at(polygon).Level, 3);
  EXPECT_EQ(file.Entities.at(point).Type, 116);
  EXPECT_EQ(file.Entities.at(point).Level, 3);
  EXPECT_EQ(
    file.Entities.at(point).Parameters, (std::vector<std::string>{ "1.", "-2.5", "1.E-07", "0" }));
  EXPECT_EQ(file.Entities.at(line).Type, 110);
  EXPECT_EQ(file.Entities.at(line).Parameters,
    (std::vector<std::string>{ "0.", "0.", "-777.25", "1.", "2.", "3." }));
  EXPECT_EQ(IGESParser::Real(file.Global[19]), 778);
}

TEST(IGESDocument, StrictParserReadsTrimmedSurfacesBack)
{
  BSplineSurface surface; // one bent patch over the unit square
  for (int k = 0; k < 16; ++k)
  {
    surface.ControlPoints.push_back({ 30.0 * (k % 4), 20.0 * (k / 4), 3.0 * (k % 4) * (k / 4) });
  }
  const auto loop = [](double radius, bool reverse)
  {
    return InterpolateClosed(
      {
        { 0.5 + radius, 0.5, 0 },
        { 0.5, reverse ? 0.5 - radius : 0.5 + radius, 0 },
        { 0.5 - radius, 0.5, 0 },
        { 0.5, reverse ? 0.5 + radius : 0.5 - radius, 0 },
      },
      1);
  };
  const BSplineCurve flat[] = { loop(0.3, false), loop(0.1, true) };
  BSplineCurve space[2];
  for (int k = 0; k < 2; ++k)
  {
    const auto on = [&](double t)
    {
      const Vec3 uv = flat[k].Evaluate(t);
      return surface.Evaluate(uv[0], uv[1]);
    };
    space[k] = FitClosedCurve(
      on, 4, 1e-4, 4, [](std::int64_t count) { return 2 * count; }, false);
  }
  IGESDocument document;
  IGESDocument::Attributes part;
  part.Subordinate = 1;
  const std::int64_t name = document.AddName("Part");
  const std::int64_t whole = document.AddSurface(surface, part);
  const std::int64_t pointer = document.AddTrimmedSurface(
    whole, { { &flat[0], &space[0] }, { &flat[1], &space[1] } }, {}, { name });
  const IGESParser file(document.GetText({}));
  const IGESTrimmedSurface read(file, file.Entities.at(pointer));
  EXPECT_EQ(read.Properties, std::vector<long>{ name });
  ASSERT_EQ(read.Boundaries.size(), 2u);
  for (const IGESTrimmedSurface::Boundary& boundary : read.Boundaries)
  {
    for (int k = 0; k <= 400; ++k)
    {
      const double t = k * 0.01;
      const std::array<double, 3> uv = boundary.Parameters.At(t);
      const std::array<double, 3> p = IGESPoint(read.Surface, uv[0], uv[1]);
      const std::array<double, 3> q = boundary.Space.At(t);
      EXPECT_LT(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 1e-4);
    }
  }
}

TEST(IGESDocument, RefusesCurvesThatAreNotFinite)
{
  IGESDocument document;
  BSplineCurve curve = InterpolateClosed(BeanPoints(5), 1);
  curve.ControlPoints[1][2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(document.AddCurve(curve, {}), std::invalid_argument);
  EXPECT_THROW(
    document.AddPolygon({ { 0, std::nan(""), 0 }, { 1, 1, 1 } }, {}), std::invalid_argument);
  EXPECT_THROW(document.AddPoint({ 0, std::nan(""), 0 }, {}), std::invalid_argument);
}
