// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Closed shapes of about 80 mm with points uniform by area, for tests of surfaces.
#ifndef lacunaTestShapes_h
#define lacunaTestShapes_h

#include "lacunaExecution.h"
#include "lacunaSurfaceFollower.h"
#include "lacunaSurfaceSpline.h"
#include "lacunaVector.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace lacuna
{
class TestShape
{
public:
  enum Kind
  {
    Sphere,
    Torus,
    Ellipsoid,
    Kumara, // bent and tapered, one concave side
    Cup     // with sharp edges and a wall of 8 mm
  };
  static const char* GetName(Kind kind)
  {
    static const char* const names[] = { "sphere", "torus", "ellipsoid", "kumara", "cup" };
    return names[kind];
  }

  explicit TestShape(Kind kind)
    : Which(kind)
  {
  }

  // 0 on the surface, negative inside.
  double GetValue(const Vec3& x) const
  {
    switch (this->Which)
    {
      case Sphere:
        return Norm(x) - 40;
      case Torus:
        return std::hypot(std::hypot(x[0], x[1]) - 28, x[2]) - 12;
      case Ellipsoid:
        return 28 * (Norm({ x[0] / 40, x[1] / 28, x[2] / 20 }) - 1);
      case Kumara:
      {
        const double u = x[0] / 40;
        const double taper = std::max(0.1, 1 - 0.25 * u);
        const double v = (x[1] / 40 - 0.53 * u * u + 0.22) / (0.35 * taper);
        const double w = x[2] / 40 / (0.30 * taper);
        return 14 * (std::sqrt(u * u + v * v + w * w) - 1);
      }
      case Cup:
        break;
    }
    const double r = std::hypot(x[0], x[1]);
    const auto cylinder = [&](double radius, double bottom, double top)
    {
      const double across = r - radius;
      const double along = std::max(bottom - x[2], x[2] - top);
      return std::min(std::max(across, along), 0.0) +
        std::hypot(std::max(across, 0.0), std::max(along, 0.0));
    };
    return std::max(cylinder(36, -40, 40), -cylinder(28, -32, 60));
  }

  Vec3 GetGradient(const Vec3& x) const
  {
    constexpr double step = 1e-4;
    Vec3 gradient{};
    for (int c = 0; c < 3; ++c)
    {
      Vec3 before = x;
      Vec3 after = x;
      before[c] -= step;
      after[c] += step;
      gradient[c] = (this->GetValue(after) - this->GetValue(before)) / (2 * step);
    }
    return gradient;
  }

  // Uniform by area. Thin shells around the surface, moved onto it.
  OrientedPoints Sample(std::size_t count, unsigned seed) const
  {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> coordinate(-42, 42);
    OrientedPoints result;
    while (result.Points.size() < count)
    {
      Vec3 x{ coordinate(random), coordinate(random), coordinate(random) };
      Vec3 gradient = this->GetGradient(x);
      double slope = Norm(gradient);
      if (!(std::abs(this->GetValue(x)) < 0.3 * slope))
      {
        continue;
      }
      for (int step = 0; step < 6 && slope > 0; ++step)
      {
        x = x - (this->GetValue(x) / (slope * slope)) * gradient;
        gradient = this->GetGradient(x);
        slope = Norm(gradient);
      }
      if (slope > 0.1)
      {
        result.Points.push_back(x);
        result.Normals.push_back((1 / slope) * gradient);
      }
    }
    return result;
  }

  // Points off by sigma (mm, each axis), normals by 5 degrees RMS; with patches, points within 7 to
  // 19 mm of 12 of them, seen from their side, are missing: about 30 %.
  OrientedPoints SampleNoisy(
    std::size_t count, double sigma, bool patches, unsigned seed, double normalError = 5) const
  {
    OrientedPoints exact = this->Sample(count, seed);
    std::mt19937_64 random(seed + 1000);
    if (patches)
    {
      std::uniform_real_distribution<double> uniform(7, 19);
      std::vector<Vec3> centers(exact.Points.begin(), exact.Points.begin() + 12);
      std::vector<Vec3> normals(exact.Normals.begin(), exact.Normals.begin() + 12);
      std::vector<double> radii(12);
      for (double& radius : radii)
      {
        radius = uniform(random);
      }
      const auto isMissing = [&](std::size_t i, double factor)
      {
        for (std::size_t k = 0; k < centers.size(); ++k)
        {
          if (Norm(exact.Points[i] - centers[k]) < std::clamp(factor * radii[k], 7.0, 19.0) &&
            Dot(exact.Normals[i], normals[k]) > 0)
          {
            return true;
          }
        }
        return false;
      };
      double low = 0.3;
      double high = 3;
      for (int step = 0; step < 20; ++step)
      {
        const double factor = 0.5 * (low + high);
        std::size_t missing = 0;
        for (std::size_t i = 0; i < count; ++i)
        {
          missing += isMissing(i, factor);
        }
        (missing > 3 * count / 10 ? high : low) = factor;
      }
      OrientedPoints rest;
      for (std::size_t i = 0; i < count; ++i)
      {
        if (!isMissing(i, low))
        {
          rest.Points.push_back(exact.Points[i]);
          rest.Normals.push_back(exact.Normals[i]);
        }
      }
      exact = std::move(rest);
    }
    std::normal_distribution<double> normal(0, 1);
    for (std::size_t i = 0; i < exact.Points.size(); ++i)
    {
      Vec3 tilt;
      for (int c = 0; c < 3; ++c)
      {
        exact.Points[i][c] += sigma * normal(random);
        tilt[c] = normalError * std::atan(1.0) / 45 / std::sqrt(2.0) * normal(random);
      }
      const Vec3& n = exact.Normals[i];
      exact.Normals[i] = Normalized(n + tilt - Dot(tilt, n) * n);
    }
    return exact;
  }

private:
  Kind Which;
};

// RMS distance of points of the true surface from the zeros of a function, to first order.
inline double GetSurfaceError(const ImplicitFunction& function, const OrientedPoints& truth)
{
  ThreadExecution execution(2);
  std::vector<double> values(truth.Points.size());
  std::vector<Vec3> gradients(truth.Points.size());
  function.Evaluate(execution, truth.Points, values, &gradients);
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double d = values[i] / Norm(gradients[i]);
    sum += d * d / static_cast<double>(values.size());
  }
  return std::sqrt(sum);
}
}
#endif
