// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationPosterior.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace lacuna
{
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
