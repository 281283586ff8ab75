// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationStart.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
// Within about 35 degrees of any orientation; Levenberg-Marquardt converges from further off.
constexpr int ImageOrientations = 120;
// As close, since a phantom of wires looks the same after half a turn about each of them.
constexpr int PhantomOrientations = 60;
constexpr int Normals = 30; // the same for planes

// Evenly spread over all rotations: a super-Fibonacci spiral (Alexa 2022).
std::vector<Eigen::Matrix3d> GetRotations(int count)
{
  constexpr double psi = 1.533751168755204288118041;
  std::vector<Eigen::Matrix3d> rotations;
  for (int i = 0; i < count; ++i)
  {
    const double s = i + 0.5;
    const double first = std::sqrt(s / count), second = std::sqrt(1 - s / count);
    const double alpha = 2 * Pi * s / std::sqrt(2.0), beta = 2 * Pi * s / psi;
    rotations.push_back(Eigen::Quaterniond(second * std::cos(beta), first * std::sin(alpha),
      first * std::cos(alpha), second * std::sin(beta))
                          .normalized()
                          .toRotationMatrix());
  }
  return rotations;
}

// Rotations that take directions all over a hemisphere to z.
std::vector<Eigen::Matrix3d> GetPlanes(int count)
{
  std::vector<Eigen::Matrix3d> rotations;
  for (int i = 0; i < count; ++i)
  {
    const double z = (i + 0.5) / count;
    const double r = std::sqrt(1 - z * z);
    const double turn = i * Pi * (3 - std::sqrt(5.0));
    rotations.push_back(Eigen::Quaterniond::FromTwoVectors(
      Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z), Eigen::Vector3d::UnitZ())
                          .toRotationMatrix());
  }
  return rotations;
}

double GetMeanAbsoluteError(const CalibrationModel& model, const CalibrationState& state)
{
  double sum = 0;
  int count = 0;
  for (std::size_t pick = 0; pick < model.GetNumberOfPicks(); ++pick)
  {
    double errors[3];
    model.GetErrors(state, pick, errors);
    for (int e = 0; e < model.GetNumberOfEquations(pick); ++e, ++count)
    {
      sum += std::abs(errors[e]);
    }
  }
  return sum / count;
}
}

std::vector<CalibrationState> FindCalibrationStarts(
  const CalibrationModel& model, const Eigen::Vector2d& spacing, std::size_t count)
{
  const std::vector<int>& unknowns = model.GetUnknowns();
  const auto seeks = [&unknowns](int unknown)
  { return std::find(unknowns.begin(), unknowns.end(), unknown) != unknowns.end(); };
  std::vector<Eigen::Matrix3d> phantoms{ Eigen::Matrix3d::Identity() };
  if (seeks(CalibrationModel::PhantomTurn + 2))
  {
    phantoms = GetRotations(PhantomOrientations);
  }
  else if (seeks(CalibrationModel::PhantomTurn))
  {
    phantoms = GetPlanes(Normals);
  }
  const std::vector<Eigen::Matrix3d> images = seeks(CalibrationModel::ImageTurn)
    ? GetRotations(ImageOrientations)
    : std::vector<Eigen::Matrix3d>{ Eigen::Matrix3d::Identity() };
  struct Start
  {
    double Error;
    CalibrationState State;
  };
  std::vector<Start> starts;
  for (const Eigen::Matrix3d& image : images)
  {
    for (const Eigen::Matrix3d& phantom : phantoms)
    {
      CalibrationState state{ image, Eigen::Vector3d::Zero(), spacing, phantom,
        Eigen::Vector3d::Zero() };
      if (model.SolveLengths(state))
      {
        starts.push_back({ GetMeanAbsoluteError(model, state), state });
      }
    }
  }
  const std::size_t kept = std::min(count, starts.size());
  std::partial_sort(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(kept),
    starts.end(), [](const Start& a, const Start& b) { return a.Error < b.Error; });
  std::vector<CalibrationState> best;
  for (std::size_t i = 0; i < kept; ++i)
  {
    best.push_back(starts[i].State);
  }
  return best;
}
}
