// SPDX-License-Identifier: BSD-3-Clause
/// Starts of a probe's calibration, against the errors of the model itself.
#include "lacunaCalibrationStart.h"
#include "lacunaCalibrationStudy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace lacunaCalibrationStudy;

namespace
{
std::vector<double> GetAllErrors(const CalibrationModel& model, const CalibrationState& state)
{
  std::vector<double> all;
  for (std::size_t pick = 0; pick < model.GetNumberOfPicks(); ++pick)
  {
    double errors[3];
    model.GetErrors(state, pick, errors);
    all.insert(all.end(), errors, errors + model.GetNumberOfEquations(pick));
  }
  return all;
}

double GetSquare(const CalibrationModel& model, const CalibrationState& state)
{
  double square = 0;
  for (const double error : GetAllErrors(model, state))
  {
    square += error * error;
  }
  return square;
}

double GetMeanAbsolute(const CalibrationModel& model, const CalibrationState& state)
{
  const std::vector<double> errors = GetAllErrors(model, state);
  double sum = 0;
  for (const double error : errors)
  {
    sum += std::abs(error);
  }
  return sum / static_cast<double>(errors.size());
}

std::vector<double*> GetLengths(CalibrationState& state, bool scale)
{
  std::vector<double*> lengths;
  for (int axis = 0; axis < 3; ++axis)
  {
    lengths.push_back(&state.ImageOrigin[axis]);
    lengths.push_back(&state.PhantomOrigin[axis]);
  }
  if (scale)
  {
    lengths.push_back(&state.Spacing[0]);
    lengths.push_back(&state.Spacing[1]);
  }
  return lengths;
}

Scene MakeScene(bool wires)
{
  Scene scene(wires ? 41 : 42, { 0.12, 0.2 });
  for (int i = 0; i < 24; ++i)
  {
    wires ? scene.PickWire(i % 3, { 0.5, -0.3 }) : scene.PickWall(0.5);
  }
  return scene;
}
}

TEST(CalibrationStart, LengthsAreTheBestForTheRotations)
{
  for (const bool wires : { true, false })
  {
    const Scene scene = MakeScene(wires);
    for (const bool scale : { true, false })
    {
      const CalibrationModel model(scene.Picks, scale);
      const auto starts = FindCalibrationStarts(model, { 0.12, 0.2 }, 20);
      ASSERT_EQ(starts.size(), 20u);
      for (const CalibrationState& start : starts)
      {
        const double best = GetSquare(model, start);
        CalibrationState other = start;
        for (double* length : GetLengths(other, scale))
        {
          const double before = *length;
          const double step = 0.01 * (1 + std::abs(before));
          *length = before + step;
          const double more = GetSquare(model, other);
          *length = before - step;
          const double less = GetSquare(model, other);
          *length = before;
          // a parabola's, whose least is here
          EXPECT_NEAR(more - less, 0, 1e-4 * (more + less - 2 * best) + 1e-9 * best);
          EXPECT_GE(more + less, 2 * best * (1 - 1e-12));
        }
        if (!scale)
        {
          EXPECT_EQ(start.Spacing, Eigen::Vector2d(0.12, 0.2));
        }
      }
    }
  }
}

TEST(CalibrationStart, TheFewestErrorsComeFirst)
{
  const Scene scene = MakeScene(true);
  const CalibrationModel model(scene.Picks, true);
  const auto few = FindCalibrationStarts(model, { 1, 1 }, 5);
  const auto many = FindCalibrationStarts(model, { 1, 1 }, 1000000);
  ASSERT_GT(many.size(), 1000u);
  std::vector<double> errors;
  for (const CalibrationState& start : many)
  {
    errors.push_back(GetMeanAbsolute(model, start));
    EXPECT_GT(start.Spacing.minCoeff(), 0);
  }
  for (std::size_t i = 1; i < errors.size(); ++i)
  {
    EXPECT_LE(errors[i - 1], errors[i] * (1 + 1e-9)) << i;
  }
  for (std::size_t i = 0; i < few.size(); ++i)
  {
    EXPECT_NEAR(GetMeanAbsolute(model, few[i]), errors[i], 1e-9 * errors[i]);
  }
}
