// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tools, rough surfaces and what every path must keep to, for tests of paths.
#ifndef lacunaToolPathScene_h
#define lacunaToolPathScene_h

#include "lacunaExecution.h"
#include "lacunaMillScene.h"
#include "lacunaToolPath.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace lacunaMill
{
constexpr lacuna::MillTool Ball{ lacuna::ToolShape::Ball, 4 };
constexpr lacuna::MillTool Flat{ lacuna::ToolShape::Flat, 3 };

/// Cliffs, spikes and pits beside level ground.
inline double Rough(double x, double y)
{
  const double cliff = x + 0.3 * y > 14 ? 6 : 0;
  const double spike = std::hypot(x - 5, y - 9) < 0.6 ? 5 : 0;
  const double pit = std::hypot(x - 21, y - 6) < 1.6 ? -4 : 0;
  return cliff + spike + pit;
}

/// A grid whose columns and rows are neither straight nor even.
inline lacuna::MillSurface Bent(const std::function<double(double, double)>& height)
{
  std::vector<Vec3> points;
  for (int j = 0; j < 30; ++j)
  {
    for (int i = 0; i < 40; ++i)
    {
      const double x = 0.7 * i + 0.012 * i * j + 0.2 * std::sin(j);
      const double y = 0.8 * j - 0.1 * i + 0.01 * i * i;
      points.push_back({ x, y, height(x, y) });
    }
  }
  return lacuna::MillSurface({ 40, 30 }, std::move(points));
}

inline double Noise(double x, double y)
{
  return std::sin(2.1 * x + std::cos(1.7 * y)) + 0.8 * std::cos(3.3 * y - 0.9 * x);
}

inline std::string Message(const std::function<void()>& action)
{
  try
  {
    action();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "no error";
}

inline lacuna::ToolPath Path(
  const lacuna::MillSurface& surface, const lacuna::ToolPathOptions& options, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::MakeToolPath(execution, surface, options);
}

/// What every path must keep to.
inline void CheckForm(const lacuna::ToolPath& path)
{
  ASSERT_FALSE(path.Runs.empty());
  EXPECT_EQ(path.Runs.front().Kind, lacuna::Motion::Plunge);
  EXPECT_EQ(path.Points.front()[2], path.SafeZ);
  EXPECT_EQ(path.Runs.back().Kind, lacuna::Motion::Rapid);
  std::int64_t next = 0;
  for (std::size_t r = 0; r < path.Runs.size(); ++r)
  {
    const lacuna::ToolPath::Run& run = path.Runs[r];
    EXPECT_EQ(run.First, next);
    next += run.Count;
    ASSERT_GE(run.Count, 2);
    ASSERT_TRUE(r == 0 || path.Points[run.First] == path.Points[run.First - 1]) << r;
    for (std::int64_t k = run.First; k < run.First + run.Count; ++k)
    {
      for (int c = 0; c < 3; ++c)
      {
        const double units = 1000 * path.Points[k][c];
        ASSERT_NEAR(units, std::round(units), 1e-6);
      }
      if (run.Kind == lacuna::Motion::Rapid && k > run.First)
      {
        const Vec3 d = path.Points[k] - path.Points[k - 1];
        const bool upright = d[0] == 0 && d[1] == 0;
        ASSERT_TRUE(upright ? d[2] >= 0 : d[2] == 0 && path.Points[k][2] == path.SafeZ) << r;
      }
      ASSERT_LE(path.Points[k][2], path.SafeZ);
    }
  }
  EXPECT_EQ(next, static_cast<std::int64_t>(path.Points.size()));
}
}
#endif
