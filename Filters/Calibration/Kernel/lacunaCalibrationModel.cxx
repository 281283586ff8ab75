// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationModel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

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

//------------------------------------------------------------------------------
namespace
{
constexpr double SmallestPart = 0.01; // of a direction that is held by more than one cluster

// The receiver and the image's corners, where they are in the tracker's coordinate system.
using Places = std::array<Vec3, 5>;

Places GetPlaces(const CalibrationPick& pick, const CalibrationState& state, const Vec2& farPixel)
{
  Places places;
  places[0] = pick.ProbeToTracker.Column(3);
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    const Eigen::Vector3d place = state.ImageOrigin +
      state.ImageRotation *
        Eigen::Vector3d((corner & 1) ? state.Spacing[0] * farPixel[0] : 0.0,
          (corner & 2) ? state.Spacing[1] * farPixel[1] : 0.0, 0);
    places[corner + 1] = pick.ProbeToTracker.Point({ place[0], place[1], place[2] });
  }
  return places;
}

double GetLargestDistance(const Places& a, const Places& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, Norm(a[i] - b[i]));
  }
  return largest;
}
}

std::vector<std::size_t> FindCalibrationClusters(const std::vector<CalibrationPick>& picks,
  const CalibrationState& state, const Vec2& farPixel, double rest)
{
  std::vector<std::size_t> order(picks.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&picks](std::size_t a, std::size_t b) { return picks[a].Slice < picks[b].Slice; });
  std::vector<std::size_t> clusters(picks.size());
  std::size_t count = 0;
  std::int64_t slice = -1;
  Places first{};
  for (const std::size_t pick : order)
  {
    const std::int64_t own = picks[pick].Slice;
    if (own < 0 || own != slice)
    {
      const Places places = GetPlaces(picks[pick], state, farPixel);
      if (own < 0 || slice < 0 || GetLargestDistance(places, first) > rest)
      {
        first = places;
        ++count;
      }
      slice = own;
    }
    clusters[pick] = count - 1;
  }
  return clusters;
}

ClusteredCovariance GetClusteredCovariance(const CalibrationModel& model,
  const CalibrationState& state, const std::vector<double>& weights,
  const std::vector<std::size_t>& clusters, const Eigen::MatrixXd& root, double spread)
{
  // In coordinates of the unknowns in which the normal matrix is the unit matrix.
  struct Sums
  {
    Eigen::MatrixXd Normal;
    Eigen::VectorXd Gradient;
    double Equations = 0;
  };
  const Eigen::Index unknowns = root.cols();
  std::vector<Sums> sums(*std::max_element(clusters.begin(), clusters.end()) + 1,
    Sums{ Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns) });
  Eigen::MatrixXd derivatives;
  for (std::size_t pick = 0; pick < clusters.size(); ++pick)
  {
    if (weights[pick] > 0)
    {
      double errors[3];
      model.GetErrors(state, pick, errors);
      model.GetDerivatives(state, pick, derivatives);
      const Eigen::MatrixXd scaled = root.transpose() * derivatives;
      Sums& own = sums[clusters[pick]];
      own.Normal.noalias() += scaled * scaled.transpose();
      own.Gradient.noalias() += scaled * Eigen::Map<Eigen::VectorXd>(errors, scaled.cols());
      own.Equations += static_cast<double>(scaled.cols());
    }
  }
  ClusteredCovariance result;
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const Sums& own : sums)
  {
    if (own.Equations == 0)
    {
      continue;
    }
    ++result.Clusters;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(own.Normal);
    Eigen::VectorXd part = eigen.eigenvectors().transpose() * own.Gradient;
    for (Eigen::Index u = 0; u < unknowns; ++u)
    {
      const double others = 1 - eigen.eigenvalues()[u]; // their part in what holds this direction
      if (others > SmallestPart)
      {
        part[u] /= others;
      }
      else
      {
        part[u] = 0;
        const Eigen::VectorXd direction = eigen.eigenvectors().col(u);
        middle.noalias() += spread * spread * own.Equations * direction * direction.transpose();
      }
    }
    const Eigen::VectorXd step = eigen.eigenvectors() * part;
    middle.noalias() += step * step.transpose();
  }
  const auto count = static_cast<double>(result.Clusters);
  result.Covariance = std::max(1.0, count - 1) / count * root * middle * root.transpose();
  return result;
}

//------------------------------------------------------------------------------
namespace
{
constexpr int Rounds = 3;
constexpr int Samples = 2000;        // in each
constexpr double Freedom = 6;        // of the distributions sampled
constexpr double FewestSamples = 30; // that count, in effect; of fewer nothing is concluded
constexpr double TestStep = 2;       // standard deviations
constexpr double SmallBend = 0.1; // relative deviation of the squares there from those of a plane

class Posterior
{
public:
  Posterior(const CalibrationModel& model, const CalibrationState& state,
    const std::vector<double>& weights, const Eigen::MatrixXd& root, double tempering)
    : Model(model)
    , State(state)
    , Weights(weights)
    , Root(root)
    , Tempering(tempering)
    , Least(model.GetCost(state, weights))
  {
    for (std::size_t pick = 0; pick < weights.size(); ++pick)
    {
      this->Equations += weights[pick] > 0 ? model.GetNumberOfEquations(pick) : 0;
    }
  }

  double GetRelativeCost(const Eigen::VectorXd& step) const
  {
    return this->Model.GetCost(this->Model.Move(this->State, this->Root * step), this->Weights) /
      this->Least;
  }

  bool IsLinear() const
  {
    const Eigen::Index unknowns = this->Root.cols();
    const double freedom = this->Equations - static_cast<double>(unknowns);
    const double length = TestStep * std::sqrt(this->Tempering);
    for (Eigen::Index u = 0; u < 2 * unknowns; ++u)
    {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(unknowns);
      step[u / 2] = u % 2 == 0 ? length : -length;
      const double rise = (this->GetRelativeCost(step) - 1) * freedom / (length * length);
      if (!(std::abs(rise - 1) < SmallBend))
      {
        return false;
      }
    }
    return true;
  }

  // Second moments about the solution; empty: too few samples count.
  Eigen::MatrixXd GetMoments() const
  {
    const Eigen::Index unknowns = this->Root.cols();
    const auto count = static_cast<double>(unknowns);
    std::mt19937 random(1); // the same for the same picks
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> chiSquare(Freedom);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(unknowns);
    Eigen::MatrixXd spread =
      std::sqrt(this->Tempering) * Eigen::MatrixXd::Identity(unknowns, unknowns);
    Eigen::MatrixXd moments;
    Eigen::MatrixXd steps(unknowns, Samples);
    Eigen::VectorXd logarithms(Samples);
    for (int round = 0; round < Rounds; ++round)
    {
      for (int i = 0; i < Samples; ++i)
      {
        Eigen::VectorXd step(unknowns);
        for (double& value : step)
        {
          value = normal(random);
        }
        step /= std::sqrt(chiSquare(random) / Freedom);
        steps.col(i) = mean + spread * step;
        const double cost = this->GetRelativeCost(steps.col(i));
        logarithms[i] = -0.5 * this->Equations / this->Tempering * std::log(cost) +
          0.5 * (Freedom + count) * std::log1p(step.squaredNorm() / Freedom);
      }
      const Eigen::VectorXd weights = (logarithms.array() - logarithms.maxCoeff()).exp();
      const double sum = weights.sum();
      if (!(sum * sum / weights.squaredNorm() >= (round + 1 < Rounds ? 1 : FewestSamples)))
      {
        return {};
      }
      moments = steps * weights.asDiagonal() * steps.transpose() / sum;
      mean = steps * weights / sum;
      Eigen::MatrixXd covariance = moments - mean * mean.transpose();
      covariance.diagonal().array() += 1e-3; // of few samples it may be flat
      spread = covariance.llt().matrixL();
    }
    // Of linear equations it would be a t distribution with this freedom. Its squares stay larger than
    // the unit matrix's, since the spread is known no better.
    const double freedom = this->Equations / this->Tempering - count;
    if (!(freedom > 2))
    {
      return {};
    }
    return moments * (freedom / (this->Equations - count));
  }

private:
  const CalibrationModel& Model;
  const CalibrationState& State;
  const std::vector<double>& Weights;
  const Eigen::MatrixXd& Root;
  const double Tempering;
  const double Least; // weighted mean square
  double Equations = 0;
};
}

Eigen::MatrixXd GetPosteriorRoot(const CalibrationModel& model, const CalibrationState& state,
  const std::vector<double>& weights, const Eigen::MatrixXd& root, double tempering)
{
  const Posterior posterior(model, state, weights, root, tempering);
  Eigen::MatrixXd linear = Eigen::MatrixXd::Identity(root.rows(), root.cols());
  if (!(model.GetCost(state, weights) > std::numeric_limits<double>::min()) || posterior.IsLinear())
  {
    return linear;
  }
  const Eigen::MatrixXd moments = posterior.GetMoments();
  return moments.size() == 0
    ? linear
    : Eigen::MatrixXd(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(moments).operatorSqrt());
}
}
