// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationStart.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

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

// Rotations that take directions (r cos(turn), r sin(turn), z) all over a hemisphere to z.
std::vector<Eigen::Matrix3d> GetPlanes(int count)
{
  std::vector<Eigen::Matrix3d> rotations;
  for (int i = 0; i < count; ++i)
  {
    const double z = (i + 0.5) / count;
    const double turn = i * Pi * (3 - std::sqrt(5.0));
    const Eigen::Vector3d axis(std::sin(turn), -std::cos(turn), 0);
    rotations.push_back(Eigen::AngleAxisd(std::acos(z), axis).toRotationMatrix());
  }
  return rotations;
}

// The equations of all picks for one orientation of the phantom. They are linear in the image's axes and
// in all lengths, so that one sum of their products serves all orientations of the image.
class StartEquations
{
public:
  StartEquations(const CalibrationModel& model, const Eigen::Matrix3d& phantom)
  {
    std::vector<Row> rows;
    for (std::size_t pick = 0; pick < model.GetNumberOfPicks(); ++pick)
    {
      const CalibrationModel::Pose& pose = model.GetPose(pick);
      const Vec2& pixel = model.GetPick(pick).Pixel;
      for (int axis = 0; axis < 3; ++axis)
      {
        if (IsZeroAt(model.GetPick(pick).Target, axis))
        {
          const Eigen::RowVector3d direction = phantom.row(axis) * pose.Rotation;
          Row row = Row::Zero();
          row.segment<3>(ImageOrigin) = direction;
          row.segment<3>(ImageX) = pixel[0] * direction;
          row.segment<3>(ImageY) = pixel[1] * direction;
          row[PhantomOrigin + axis] = 1;
          row[One] = phantom.row(axis) * pose.Origin;
          rows.push_back(row);
        }
      }
    }
    this->Rows.resize(static_cast<Eigen::Index>(rows.size()), FactorCount);
    for (std::size_t i = 0; i < rows.size(); ++i)
    {
      this->Rows.row(static_cast<Eigen::Index>(i)) = rows[i];
    }
    this->Products.noalias() = this->Rows.transpose() * this->Rows;
  }

  // Best translations, and spacing if it is sought, for the rotations of state. False when these are
  // not determined or a spacing is not positive.
  bool SolveLengths(CalibrationState& state, bool seeksScale) const
  {
    // of image origin, phantom origin, spacing
    constexpr int Lengths = 8;
    Eigen::Matrix<double, FactorCount, Lengths> factors;
    factors.setZero();
    factors.block<3, 3>(ImageOrigin, 0).setIdentity();
    factors.block<3, 3>(PhantomOrigin, 3).setIdentity();
    if (seeksScale)
    {
      factors.block<3, 1>(ImageX, 6) = state.ImageRotation.col(0);
      factors.block<3, 1>(ImageY, 7) = state.ImageRotation.col(1);
      state.Spacing.setZero();
    }
    state.ImageOrigin.setZero();
    state.PhantomOrigin.setZero();
    const Eigen::Matrix<double, Lengths, FactorCount> products =
      factors.transpose() * this->Products;
    Eigen::Matrix<double, Lengths, Lengths> normal = products * factors;
    for (int length = 0; length < Lengths; ++length)
    {
      // what is not determined is held at zero
      if (normal(length, length) == 0)
      {
        normal(length, length) = 1;
      }
    }
    // A hint of zero decides where the picks do not.
    normal.diagonal() *= 1 + 1e-9;
    const Eigen::Matrix<double, Lengths, 1> solution =
      normal.selfadjointView<Eigen::Lower>().ldlt().solve(-products * GetFactors(state));
    if (!solution.allFinite() || (seeksScale && !(solution.tail<2>().minCoeff() > 0)))
    {
      return false;
    }
    state.ImageOrigin = solution.head<3>();
    state.PhantomOrigin = solution.segment<3>(3);
    if (seeksScale)
    {
      state.Spacing = solution.tail<2>();
    }
    return true;
  }

  // mm
  double GetMeanAbsoluteError(const CalibrationState& state) const
  {
    return (this->Rows * GetFactors(state)).cwiseAbs().mean();
  }

private:
  // What a row is multiplied by.
  enum Factor
  {
    ImageOrigin = 0,
    ImageX = 3, // times the spacing
    ImageY = 6,
    PhantomOrigin = 9,
    One = 12,
    FactorCount = 13
  };
  using Row = Eigen::Matrix<double, 1, FactorCount>;
  using Factors = Eigen::Matrix<double, FactorCount, 1>;

  static Factors GetFactors(const CalibrationState& state)
  {
    Factors factors;
    factors << state.ImageOrigin, state.Spacing[0] * state.ImageRotation.col(0),
      state.Spacing[1] * state.ImageRotation.col(1), state.PhantomOrigin, 1;
    return factors;
  }

  Eigen::Matrix<double, Eigen::Dynamic, FactorCount> Rows;
  Eigen::Matrix<double, FactorCount, FactorCount> Products;
};
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
  for (const Eigen::Matrix3d& phantom : phantoms)
  {
    const StartEquations equations(model, phantom);
    for (const Eigen::Matrix3d& image : images)
    {
      CalibrationState state{ image, Eigen::Vector3d::Zero(), spacing, phantom,
        Eigen::Vector3d::Zero() };
      if (equations.SolveLengths(state, seeks(CalibrationModel::Scale)))
      {
        starts.push_back({ equations.GetMeanAbsoluteError(state), state });
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
