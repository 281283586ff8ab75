// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationModel.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr int MaximumIterations = 100;
constexpr double LargestDamping = 1e10;
constexpr double SmallestStep = 1e-10; // radians, and mm a metre
// Of a pick whose error is the median one; a pick at this distance counts half.
constexpr double CauchyMedians = 3;

Eigen::Matrix3d GetCross(const Eigen::Vector3d& v)
{
  Eigen::Matrix3d cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return cross;
}

Eigen::Matrix3d GetTurn(const Eigen::Vector3d& vector)
{
  const double angle = vector.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix()
                   : Eigen::Matrix3d::Identity();
}

// Whether the target looks the same when it is turned about an axis of the phantom, or moved along it.
bool IsSameTurned(CalibrationTarget target, int axis)
{
  return target == CalibrationTarget::Point || target == CalibrationTarget::Tip ||
    (target == CalibrationTarget::Wall ? axis == 2 : static_cast<int>(target) == axis);
}

bool IsSameMoved(CalibrationTarget target, int axis)
{
  return !IsZeroAt(target, axis);
}
}

CalibrationModel::CalibrationModel(const std::vector<CalibrationPick>& picks, bool estimateScale)
  : Picks(picks)
{
  for (const CalibrationPick& pick : picks)
  {
    Pose pose;
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        pose.Rotation(row, column) = pick.ProbeToTracker(row, column);
      }
      pose.Origin[row] = pick.ProbeToTracker(row, 3);
    }
    this->Poses.push_back(pose);
  }
  const bool hasImage = std::any_of(picks.begin(), picks.end(),
    [](const CalibrationPick& pick) { return pick.Target != CalibrationTarget::Tip; });
  const int first = hasImage ? ImageTurn : ImageShift;
  const int end = hasImage && estimateScale ? PhantomTurn : Scale;
  for (int unknown = first; unknown < end; ++unknown)
  {
    this->Unknowns.push_back(unknown);
  }
  const auto tells = [&picks](bool (*isSame)(CalibrationTarget, int), int axis)
  {
    return std::any_of(picks.begin(), picks.end(),
      [&](const CalibrationPick& pick) { return !isSame(pick.Target, axis); });
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    if (tells(IsSameTurned, axis))
    {
      this->Unknowns.push_back(PhantomTurn + axis);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    if (tells(IsSameMoved, axis))
    {
      this->Unknowns.push_back(PhantomShift + axis);
    }
  }
}

int CalibrationModel::GetNumberOfEquations(std::size_t pick) const
{
  const CalibrationTarget target = this->Picks[pick].Target;
  return IsZeroAt(target, 0) + IsZeroAt(target, 1) + IsZeroAt(target, 2);
}

Eigen::Vector3d CalibrationModel::GetPhantomPoint(
  const CalibrationState& state, std::size_t pick) const
{
  const Vec2& pixel = this->Picks[pick].Pixel;
  const Eigen::Vector3d image(state.Spacing[0] * pixel[0], state.Spacing[1] * pixel[1], 0);
  const Eigen::Vector3d probe = state.ImageRotation * image + state.ImageOrigin;
  const Eigen::Vector3d tracker = this->Poses[pick].Rotation * probe + this->Poses[pick].Origin;
  return state.PhantomRotation * tracker + state.PhantomOrigin;
}

void CalibrationModel::GetErrors(
  const CalibrationState& state, std::size_t pick, double errors[3]) const
{
  const Eigen::Vector3d point = this->GetPhantomPoint(state, pick);
  for (int axis = 0, e = 0; axis < 3; ++axis)
  {
    if (IsZeroAt(this->Picks[pick].Target, axis))
    {
      errors[e++] = point[axis];
    }
  }
}

void CalibrationModel::GetDerivatives(
  const CalibrationState& state, std::size_t pick, Eigen::MatrixXd& derivatives) const
{
  const Vec2& pixel = this->Picks[pick].Pixel;
  const Eigen::Matrix3d toPhantom = state.PhantomRotation * this->Poses[pick].Rotation;
  const Eigen::Vector3d x = state.Spacing[0] * pixel[0] * state.ImageRotation.col(0);
  const Eigen::Vector3d y = state.Spacing[1] * pixel[1] * state.ImageRotation.col(1);
  Eigen::Matrix<double, 3, UnknownCount> all;
  all.block<3, 3>(0, ImageTurn) = -toPhantom * GetCross(x + y);
  all.block<3, 3>(0, ImageShift) = toPhantom;
  all.col(Scale) = toPhantom * x;
  all.col(Scale + 1) = toPhantom * y;
  all.block<3, 3>(0, PhantomTurn) = -GetCross(this->GetPhantomPoint(state, pick));
  all.block<3, 3>(0, PhantomShift) = Eigen::Matrix3d::Identity();

  derivatives.resize(
    static_cast<Eigen::Index>(this->Unknowns.size()), this->GetNumberOfEquations(pick));
  for (int axis = 0, e = 0; axis < 3; ++axis)
  {
    if (IsZeroAt(this->Picks[pick].Target, axis))
    {
      for (std::size_t u = 0; u < this->Unknowns.size(); ++u)
      {
        derivatives(static_cast<Eigen::Index>(u), e) = all(axis, this->Unknowns[u]);
      }
      ++e;
    }
  }
}

std::vector<double> CalibrationModel::GetCauchyWeights(const CalibrationState& state) const
{
  std::vector<double> squares(this->Picks.size());
  for (std::size_t pick = 0; pick < squares.size(); ++pick)
  {
    double errors[3];
    this->GetErrors(state, pick, errors);
    const int equations = this->GetNumberOfEquations(pick);
    for (int e = 0; e < equations; ++e)
    {
      squares[pick] += errors[e] * errors[e] / equations;
    }
  }
  std::vector<double> sorted = squares;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double scale = CauchyMedians * CauchyMedians * std::max(*middle, 1e-24);
  for (double& square : squares)
  {
    square = 1 / (1 + square / scale);
  }
  return squares;
}

double CalibrationModel::GetCost(
  const CalibrationState& state, const std::vector<double>& weights) const
{
  double cost = 0, sum = 0;
  for (std::size_t pick = 0; pick < this->Picks.size(); ++pick)
  {
    double errors[3];
    this->GetErrors(state, pick, errors);
    for (int e = 0; e < this->GetNumberOfEquations(pick); ++e)
    {
      cost += weights[pick] * errors[e] * errors[e];
      sum += weights[pick];
    }
  }
  return sum > 0 ? cost / sum : 0;
}

CalibrationState CalibrationModel::Move(
  const CalibrationState& state, const Eigen::VectorXd& step) const
{
  Eigen::Matrix<double, UnknownCount, 1> all = Eigen::Matrix<double, UnknownCount, 1>::Zero();
  for (std::size_t u = 0; u < this->Unknowns.size(); ++u)
  {
    all[this->Unknowns[u]] = step[static_cast<Eigen::Index>(u)];
  }
  CalibrationState moved;
  // Products of many turns stay rotations only if they are made so.
  const auto turn = [](const Eigen::Vector3d& vector, const Eigen::Matrix3d& rotation)
  { return Eigen::Quaterniond(GetTurn(vector) * rotation).normalized().toRotationMatrix(); };
  moved.ImageRotation = turn(all.segment<3>(ImageTurn), state.ImageRotation);
  moved.ImageOrigin = state.ImageOrigin + all.segment<3>(ImageShift);
  moved.Spacing = state.Spacing.cwiseProduct(all.segment<2>(Scale).array().exp().matrix());
  moved.PhantomRotation = turn(all.segment<3>(PhantomTurn), state.PhantomRotation);
  moved.PhantomOrigin =
    GetTurn(all.segment<3>(PhantomTurn)) * state.PhantomOrigin + all.segment<3>(PhantomShift);
  return moved;
}

double CalibrationModel::Refine(CalibrationState& state, const std::vector<double>* weights) const
{
  const Eigen::Index unknowns = static_cast<Eigen::Index>(this->Unknowns.size());
  double damping = 1e-3;
  double cost = 0;
  for (int iteration = 0; iteration < MaximumIterations; ++iteration)
  {
    const std::vector<double> weight = weights ? *weights : this->GetCauchyWeights(state);
    cost = this->GetCost(state, weight);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns);
    Eigen::MatrixXd derivatives;
    for (std::size_t pick = 0; pick < this->Picks.size(); ++pick)
    {
      if (weight[pick] > 0)
      {
        double errors[3];
        this->GetErrors(state, pick, errors);
        this->GetDerivatives(state, pick, derivatives);
        normal.noalias() += weight[pick] * derivatives * derivatives.transpose();
        gradient.noalias() +=
          weight[pick] * derivatives * Eigen::Map<Eigen::VectorXd>(errors, derivatives.cols());
      }
    }
    const double largest = normal.diagonal().maxCoeff();
    bool moved = false;
    double size = 0;
    while (!moved && damping < LargestDamping)
    {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * normal.diagonal().cwiseMax(1e-12 * largest);
      const Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      const CalibrationState next = this->Move(state, step);
      const double nextCost = this->GetCost(next, weight);
      size = step.norm();
      if (step.allFinite() && nextCost <= cost)
      {
        moved = true;
        cost = nextCost;
        state = next;
        damping = std::max(1e-12, 0.1 * damping);
      }
      else
      {
        damping *= 10;
      }
    }
    if (!moved || size < SmallestStep * (1 + state.ImageOrigin.norm()))
    {
      break;
    }
  }
  return cost;
}

Eigen::MatrixXd CalibrationModel::GetNormalMatrix(
  const CalibrationState& state, const std::vector<double>& weights) const
{
  const Eigen::Index unknowns = static_cast<Eigen::Index>(this->Unknowns.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::MatrixXd derivatives;
  for (std::size_t pick = 0; pick < this->Picks.size(); ++pick)
  {
    if (weights[pick] > 0)
    {
      this->GetDerivatives(state, pick, derivatives);
      normal.noalias() += derivatives * derivatives.transpose();
    }
  }
  return normal;
}
}
