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

enum class Phantom
{
  Wires,
  Wall,
  Points,
  All
};

// Picks beside what they are of, so that no start fits them exactly.
Scene MakeScene(Phantom phantom)
{
  Scene scene(41 + static_cast<unsigned>(phantom), { 0.12, 0.2 });
  for (int i = 0; i < 24; ++i)
  {
    if (phantom == Phantom::Wires || phantom == Phantom::All)
    {
      scene.PickWire(i % 3, { 0.5, -0.3 });
    }
    if (phantom == Phantom::Wall || phantom == Phantom::All)
    {
      scene.PickWall(0.5);
    }
    if (phantom == Phantom::Points || phantom == Phantom::All)
    {
      scene.Pick(Target::Point, { 0, 0, 0 }, scene.Turn(180), { -0.4, 0.6 });
    }
  }
  return scene;
}
}

TEST(CalibrationStart, LengthsAreTheBestForTheRotations)
{
  for (const Phantom phantom : { Phantom::Wires, Phantom::Wall, Phantom::Points, Phantom::All })
  {
    const Scene scene = MakeScene(phantom);
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
  const Scene scene = MakeScene(Phantom::Wires);
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

TEST(CalibrationStart, ATipHasNoSpacing)
{
  std::vector<CalibrationPick> picks = MakeScene(Phantom::Points).Picks;
  for (CalibrationPick& pick : picks)
  {
    pick.Target = Target::Tip;
    pick.Pixel = { 0, 0 };
  }
  const CalibrationModel model(picks, true);
  const auto starts = FindCalibrationStarts(model, { 1, 1 }, 5);
  ASSERT_FALSE(starts.empty());
  EXPECT_EQ(starts[0].Spacing, Eigen::Vector2d(1, 1));
}
