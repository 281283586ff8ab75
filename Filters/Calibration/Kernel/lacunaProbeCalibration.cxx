// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProbeCalibration.h"

#include "lacunaCalibrationModel.h"
#include "lacunaCalibrationStart.h"
#include "lacunaGeometryGate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace lacuna
{
// Words for what a probe's calibration leaves open.

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr double EnoughTurn = 25; // degrees RMS, as of turns of up to 45 to either side

const char* const AxisNames[3] = { "column", "row", "normal" };

std::string Format(const char* format, double a, double b = 0)
{
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// How far the probe was turned about each axis of the image while it saw one target, degrees RMS
// about the mean; of the targets the largest. Going from wire to wire turns it, too, but tells
// nothing.
Vec3 GetTurns(const std::vector<CalibrationPick>& picks, const CalibrationState& state)
{
  const auto orientation = [&](const CalibrationPick& pick)
  {
    Eigen::Matrix3d rotation;
    for (int i = 0; i < 9; ++i)
    {
      rotation(i / 3, i % 3) = pick.ProbeToTracker(i / 3, i % 3);
    }
    return Eigen::Matrix3d(rotation * state.ImageRotation);
  };
  Vec3 turns{ 0, 0, 0 };
  for (int target = 0; target <= static_cast<int>(CalibrationTarget::Tip); ++target)
  {
    std::optional<Eigen::Matrix3d> first;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = sum;
    int count = 0;
    for (const CalibrationPick& pick : picks)
    {
      if (static_cast<int>(pick.Target) == target)
      {
        const Eigen::Matrix3d own = orientation(pick);
        first = first.value_or(own);
        const Eigen::AngleAxisd turn(first->transpose() * own);
        const Eigen::Vector3d vector = turn.angle() / Degree * turn.axis();
        sum += vector;
        squares += vector.cwiseAbs2();
        ++count;
      }
    }
    for (int axis = 0; axis < 3 && count > 0; ++axis)
    {
      const double mean = sum[axis] / count;
      turns[axis] =
        std::max(turns[axis], std::sqrt(std::max(0.0, squares[axis] / count - mean * mean)));
    }
  }
  return turns;
}

// The receiver's own axes, which the turns are about.
std::string DescribeTipWeakness(const Eigen::Vector3d& direction, const Vec3& turns)
{
  const Eigen::Vector3d unit = direction.normalized();
  char text[240];
  std::snprintf(text, sizeof text,
    "where the tip lies along the direction (%.2f %.2f %.2f) of the receiver: tilt the stylus "
    "more, "
    "to all sides (so far by %.0f, %.0f and %.0f degrees RMS about its x, y and z axes; better "
    "%.0f "
    "and more about two of them)",
    unit[0], unit[1], unit[2], turns[0], turns[1], turns[2], EnoughTurn);
  return text;
}
}

// What is not known, and which motion of the probe would tell. direction: of the unknowns, in mm, in
// which the equations hold the solution least.
std::string DescribeCalibrationWeakness(const std::vector<int>& unknowns,
  const Eigen::VectorXd& direction, const std::vector<CalibrationPick>& picks,
  const CalibrationState& state)
{
  constexpr int imageUnknowns = CalibrationModel::PhantomTurn;
  Eigen::Matrix<double, imageUnknowns, 1> part = Eigen::Matrix<double, imageUnknowns, 1>::Zero();
  for (std::size_t u = 0; u < unknowns.size(); ++u)
  {
    if (unknowns[u] < imageUnknowns)
    {
      part[unknowns[u]] = direction[static_cast<Eigen::Index>(u)];
    }
  }
  const Vec3 turns = GetTurns(picks, state);
  if (std::find(unknowns.begin(), unknowns.end(), 0) == unknowns.end())
  {
    return DescribeTipWeakness(part.segment<3>(CalibrationModel::ImageShift), turns);
  }
  // along the image's own axes
  part.segment<3>(CalibrationModel::ImageTurn) =
    (state.ImageRotation.transpose() * part.segment<3>(CalibrationModel::ImageTurn)).eval();
  part.segment<3>(CalibrationModel::ImageShift) =
    (state.ImageRotation.transpose() * part.segment<3>(CalibrationModel::ImageShift)).eval();
  Eigen::Index largest;
  part.cwiseAbs().maxCoeff(&largest);
  const int axis = static_cast<int>(largest % 3);
  const int across[2] = { (axis + 1) % 3, (axis + 2) % 3 };
  if (largest >= CalibrationModel::Scale)
  {
    return std::string("the pixel spacing along the ") +
      (largest == CalibrationModel::Scale ? "columns" : "rows") +
      ": give PixelSpacing, or pick targets that lie further apart in the image and at more depths";
  }
  if (largest >= CalibrationModel::ImageShift)
  {
    const double least = std::min(turns[across[0]], turns[across[1]]);
    return std::string("where the image lies along its ") + AxisNames[axis] +
      " direction: turn the probe more about its " + AxisNames[across[0]] + " and " +
      AxisNames[across[1]] + " directions" +
      Format(" (so far by %.0f and %.0f degrees RMS", turns[across[0]], turns[across[1]]) +
      (least < EnoughTurn ? Format(", better %.0f and more)", EnoughTurn)
                          : std::string("; in more slices, or more still)"));
  }
  return std::string("how the image is turned about its ") + AxisNames[axis] +
    " direction: let the targets appear all over the image, near and far, left and right" +
    Format(
      ", and turn the probe about that direction, too (so far by %.0f degrees RMS)", turns[axis]);
}

//------------------------------------------------------------------------------
namespace
{
constexpr std::size_t Starts = 24;
constexpr int SpareEquations = 3;
constexpr int OutlierRounds = 20;
// Standard deviation of a normal distribution over the median of its absolute values.
constexpr double SpreadPerMedian = 1.4826;
constexpr double OtherSolution = 5;     // mm at a corner
constexpr double SingularRatio = 1e-10; // of the normal matrix's eigenvalues
constexpr double WeakError = 1;         // mm
constexpr double WeakRatio = 3;
// In standard deviations of an equation. Of two poses that each err so much along each axis, the
// places differ by less than 4.8 of them in 99 %.
constexpr double RestSpreads = 5;

void Check(const std::vector<CalibrationPick>& picks, const ProbeCalibrationOptions& options)
{
  for (std::size_t pick = 0; pick < picks.size(); ++pick)
  {
    if (const GeometryFinding finding = CheckPose(picks[pick].ProbeToTracker);
        GetAction(GeometryOrigin::Picks, finding.Fault) == GeometryAction::Refuse)
    {
      throw std::invalid_argument("pick " + std::to_string(pick) + ": ProbeToTracker " +
        finding.Text + "; " + finding.Advice);
    }
    if (!std::isfinite(picks[pick].Pixel[0]) || !std::isfinite(picks[pick].Pixel[1]))
    {
      throw std::invalid_argument("pick " + std::to_string(pick) + ": its pixel is not finite");
    }
  }
  const auto isTip = [](const CalibrationPick& pick)
  { return pick.Target == CalibrationTarget::Tip; };
  const auto tips = std::count_if(picks.begin(), picks.end(), isTip);
  if (tips != 0 && static_cast<std::size_t>(tips) != picks.size())
  {
    throw std::invalid_argument(
      "tips of a stylus and picks in images go in calibrations of their own");
  }
  for (const double spacing : options.PixelSpacing)
  {
    if (!options.EstimateScale)
    {
      ValueRange::Above(0, "mm").Check("PixelSpacing", spacing);
    }
  }
  ProbeCalibrationOptions::OutlierLimitRange.Check("OutlierLimit", options.OutlierLimit);
}

Matrix4 ToMatrix4(
  const Eigen::Matrix3d& rotation, const Eigen::Vector2d& scale, const Eigen::Vector3d& origin)
{
  const auto column = [&](int c, double s) {
    return Vec3{ s * rotation(0, c), s * rotation(1, c), s * rotation(2, c) };
  };
  return Matrix4::FromColumns(
    column(0, scale[0]), column(1, scale[1]), column(2, 1), { origin[0], origin[1], origin[2] });
}

// Wires, walls and picks are the same after half a turn of the phantom about any of its axes: of the four, the
// one whose axes lie nearest to the tracker's, so that rounding does not decide.
void FaceTracker(CalibrationState& state)
{
  const Eigen::Vector3d cosines = state.PhantomRotation.diagonal();
  Eigen::Vector3d best = Eigen::Vector3d::Ones();
  for (int axis = 0; axis < 3; ++axis)
  {
    Eigen::Vector3d turn = -Eigen::Vector3d::Ones();
    turn[axis] = 1;
    if (turn.dot(cosines) > best.dot(cosines))
    {
      best = turn;
    }
  }
  state.PhantomRotation = best.asDiagonal() * state.PhantomRotation;
  state.PhantomOrigin = best.asDiagonal() * state.PhantomOrigin;
}

// The solution that is being found, with what the steps towards it share.
class Solver
{
public:
  Solver(const std::vector<CalibrationPick>& picks, const ProbeCalibrationOptions& options)
    : Options(options)
    , Model(picks, options.EstimateScale)
    , Unknowns(static_cast<int>(this->Model.GetUnknowns().size()))
    , OfTip(!picks.empty() && picks.front().Target == CalibrationTarget::Tip)
  {
    int equations = 0;
    for (std::size_t pick = 0; pick < picks.size(); ++pick)
    {
      equations += this->Model.GetNumberOfEquations(pick);
      this->FarPixel[0] = std::max(this->FarPixel[0], std::abs(picks[pick].Pixel[0]));
      this->FarPixel[1] = std::max(this->FarPixel[1], std::abs(picks[pick].Pixel[1]));
    }
    if (equations < this->Unknowns + SpareEquations)
    {
      throw std::invalid_argument(std::to_string(picks.size()) + " picks give " +
        std::to_string(equations) + " equations for " + std::to_string(this->Unknowns) +
        " unknowns; pick in more slices until there are at least " +
        std::to_string(this->Unknowns + SpareEquations) + ", better three times the unknowns");
    }
  }

  struct Solution
  {
    CalibrationState State;
    std::vector<double> Weights; // 1: used, 0: outlier
    double Square = 0;           // sum of the squared errors used
    int Equations = 0;
    double GetRms() const { return std::sqrt(this->Square / this->Equations); }
  };

  // From a start to the end, outliers left out.
  Solution Finish(CalibrationState state) const
  {
    FaceTracker(state);
    Solution solution{ std::move(state), std::vector<double>(this->Model.GetNumberOfPicks(), 1.0) };
    if (this->Options.OutlierLimit > 0)
    {
      double spread = this->GetRobustSpread(solution.State);
      for (int round = 0; round < OutlierRounds; ++round)
      {
        const std::vector<double> before = solution.Weights;
        this->MarkOutliers(solution, spread);
        this->CheckEnough(solution);
        this->Model.Refine(solution.State, &solution.Weights);
        this->Sum(solution);
        spread = std::sqrt(solution.Square / (solution.Equations - this->Unknowns));
        if (round > 0 && solution.Weights == before)
        {
          break;
        }
      }
    }
    else
    {
      this->Model.Refine(solution.State, &solution.Weights);
      this->Sum(solution);
    }
    return solution;
  }

  // Solutions that differ, the best first. At least one.
  std::vector<Solution> Solve() const
  {
    const Eigen::Vector2d spacing = this->Options.EstimateScale
      ? Eigen::Vector2d::Ones()
      : Eigen::Vector2d(this->Options.PixelSpacing[0], this->Options.PixelSpacing[1]);
    std::vector<std::pair<double, CalibrationState>> minima;
    const std::vector<double> all(this->Model.GetNumberOfPicks(), 1.0);
    for (CalibrationState state : FindCalibrationStarts(this->Model, spacing, Starts))
    {
      this->Model.Refine(state, this->Options.OutlierLimit > 0 ? nullptr : &all);
      const double error = this->GetRobustSpread(state);
      const auto same = std::find_if(minima.begin(), minima.end(),
        [&](const auto& other) { return this->GetDistance(other.second, state) < OtherSolution; });
      if (same == minima.end())
      {
        minima.emplace_back(error, state);
      }
      else if (error < same->first)
      {
        *same = { error, state };
      }
    }
    std::sort(
      minima.begin(), minima.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (minima.empty())
    {
      throw std::invalid_argument("no position of the image fits the picks at all: are the poses "
                                  "ProbeToTracker, and the columns and rows not exchanged?");
    }
    std::vector<Solution> solutions{ this->Finish(minima[0].second) };
    if (minima.size() > 1)
    {
      try
      {
        solutions.push_back(this->Finish(minima[1].second));
      }
      catch (const std::invalid_argument&)
      {
        // It fits so few picks that it is no rival.
      }
    }
    return solutions;
  }

  // Furthest that a corner of the picked part of the image moves, mm.
  double GetDistance(const CalibrationState& a, const CalibrationState& b) const
  {
    double largest = 0;
    for (const Vec2& pixel : { Vec2{ 0, 0 }, Vec2{ this->FarPixel[0], 0.0 },
           Vec2{ 0.0, this->FarPixel[1] }, this->FarPixel })
    {
      const auto place = [&pixel](const CalibrationState& s) -> Eigen::Vector3d
      {
        return s.ImageRotation *
          Eigen::Vector3d(s.Spacing[0] * pixel[0], s.Spacing[1] * pixel[1], 0) +
          s.ImageOrigin;
      };
      largest = std::max(largest, (place(a) - place(b)).norm());
    }
    return largest;
  }

  const CalibrationModel& GetModel() const { return this->Model; }
  int GetNumberOfUnknowns() const { return this->Unknowns; }
  const Vec2& GetFarPixel() const { return this->FarPixel; }

private:
  // Standard deviation of an equation's error that a few wild ones do not spoil.
  double GetRobustSpread(const CalibrationState& state) const
  {
    std::vector<double> absolute;
    for (std::size_t pick = 0; pick < this->Model.GetNumberOfPicks(); ++pick)
    {
      double errors[3];
      this->Model.GetErrors(state, pick, errors);
      for (int e = 0; e < this->Model.GetNumberOfEquations(pick); ++e)
      {
        absolute.push_back(std::abs(errors[e]));
      }
    }
    const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
    std::nth_element(absolute.begin(), middle, absolute.end());
    const double equations = static_cast<double>(absolute.size());
    return SpreadPerMedian * *middle * std::sqrt(equations / (equations - this->Unknowns));
  }

  void MarkOutliers(Solution& solution, double spread) const
  {
    // Exact picks have no spread to speak of.
    const double limit = std::max(1e-6, this->Options.OutlierLimit * spread);
    for (std::size_t pick = 0; pick < solution.Weights.size(); ++pick)
    {
      double errors[3];
      this->Model.GetErrors(solution.State, pick, errors);
      solution.Weights[pick] = 1;
      for (int e = 0; e < this->Model.GetNumberOfEquations(pick); ++e)
      {
        if (std::abs(errors[e]) > limit)
        {
          solution.Weights[pick] = 0;
        }
      }
    }
  }

  void CheckEnough(const Solution& solution) const
  {
    int equations = 0, outliers = 0;
    for (std::size_t pick = 0; pick < solution.Weights.size(); ++pick)
    {
      (solution.Weights[pick] > 0 ? equations : outliers) +=
        solution.Weights[pick] > 0 ? this->Model.GetNumberOfEquations(pick) : 1;
    }
    if (equations < this->Unknowns + SpareEquations)
    {
      throw std::invalid_argument(std::to_string(outliers) + " of " +
        std::to_string(solution.Weights.size()) +
        (this->OfTip
            ? " poses do not agree with the others, which are too few then: the tip slipped in its "
              "hole, or metal is near; record them again, or raise OutlierLimit"
            : " picks do not agree with the others, which are too few then; pick again (of wires, "
              "check which is which), or raise OutlierLimit"));
    }
  }

  void Sum(Solution& solution) const
  {
    solution.Square = 0;
    solution.Equations = 0;
    for (std::size_t pick = 0; pick < solution.Weights.size(); ++pick)
    {
      if (solution.Weights[pick] > 0)
      {
        double errors[3];
        this->Model.GetErrors(solution.State, pick, errors);
        for (int e = 0; e < this->Model.GetNumberOfEquations(pick); ++e)
        {
          solution.Square += errors[e] * errors[e];
          ++solution.Equations;
        }
      }
    }
  }

  const ProbeCalibrationOptions& Options;
  CalibrationModel Model;
  int Unknowns;
  bool OfTip;
  Vec2 FarPixel{ 0, 0 };
};

// The normal matrix in units that compare: mm, and rotations by what they move at mean distance.
struct Conditioning
{
  // Of the inverse of the normal matrix; symmetric except for units, so that it does not depend on the
  // signs of eigenvectors.
  Eigen::MatrixXd GetRoot() const
  {
    return this->Lengths.cwiseInverse().asDiagonal() * this->Vectors *
      this->Values.cwiseSqrt().cwiseInverse().asDiagonal() * this->Vectors.transpose();
  }
  Eigen::MatrixXd GetInverseRoot() const
  {
    return this->Vectors * this->Values.cwiseSqrt().asDiagonal() * this->Vectors.transpose() *
      this->Lengths.asDiagonal();
  }

  Eigen::VectorXd Lengths; // mm moved per unit of each unknown
  Eigen::VectorXd Values;  // eigenvalues of the scaled normal matrix, ascending
  Eigen::MatrixXd Vectors; // scaled unknowns
};

Conditioning GetConditioning(const Solver& solver, const Solver::Solution& solution)
{
  const CalibrationModel& model = solver.GetModel();
  const std::vector<int>& unknowns = model.GetUnknowns();
  double image = 0, phantom = 0;
  for (std::size_t pick = 0; pick < model.GetNumberOfPicks(); ++pick)
  {
    const Eigen::Vector3d point = model.GetPhantomPoint(solution.State, pick);
    phantom += point.norm() / static_cast<double>(model.GetNumberOfPicks());
  }
  image = 0.5 *
    std::hypot(solution.State.Spacing[0] * solver.GetFarPixel()[0],
      solution.State.Spacing[1] * solver.GetFarPixel()[1]);
  Conditioning conditioning;
  conditioning.Lengths.resize(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t u = 0; u < unknowns.size(); ++u)
  {
    const int unknown = unknowns[u];
    const bool shift =
      (unknown >= CalibrationModel::ImageShift && unknown < CalibrationModel::Scale) ||
      unknown >= CalibrationModel::PhantomShift;
    const double length = shift ? 1 : (unknown < CalibrationModel::PhantomTurn ? image : phantom);
    conditioning.Lengths[static_cast<Eigen::Index>(u)] = std::max(length, 1e-6);
  }
  const Eigen::VectorXd inverse = conditioning.Lengths.cwiseInverse();
  const Eigen::MatrixXd scaled = inverse.asDiagonal() *
    model.GetNormalMatrix(solution.State, solution.Weights) * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  conditioning.Values = eigen.eigenvalues();
  conditioning.Vectors = eigen.eigenvectors();
  return conditioning;
}

// What the solution says of the image, without its errors.
ProbeCalibration MakeResult(
  const CalibrationModel& model, const std::vector<Solver::Solution>& solutions)
{
  const Solver::Solution& best = solutions.front();
  const CalibrationState& state = best.State;
  ProbeCalibration result;
  result.PixelSpacing = { state.Spacing[0], state.Spacing[1] };
  result.ImageToProbe = ToMatrix4(state.ImageRotation, state.Spacing, state.ImageOrigin);
  result.TrackerToPhantom =
    ToMatrix4(state.PhantomRotation, Eigen::Vector2d::Ones(), state.PhantomOrigin);
  for (std::size_t pick = 0; pick < model.GetNumberOfPicks(); ++pick)
  {
    const Eigen::Vector3d point = model.GetPhantomPoint(state, pick);
    result.PhantomPoints.push_back({ point[0], point[1], point[2] });
    result.Used.push_back(best.Weights[pick] > 0);
  }
  const std::vector<int>& unknowns = model.GetUnknowns();
  result.Equations = static_cast<std::size_t>(best.Equations);
  result.Unknowns = unknowns.size();
  result.Rms = best.GetRms();
  result.Spread = std::sqrt(best.Square / (best.Equations - static_cast<int>(unknowns.size())));
  result.RunnerUpRms =
    solutions.size() > 1 ? solutions[1].GetRms() : std::numeric_limits<double>::infinity();
  return result;
}

// Of all unknowns; the result is told how many views there are.
Eigen::MatrixXd FindCovariance(const CalibrationModel& model, const Solver::Solution& best,
  const Conditioning& conditioning, const std::vector<std::size_t>& clusters,
  ProbeCalibration& result)
{
  const Eigen::MatrixXd root = conditioning.GetRoot();
  const ClusteredCovariance clustered =
    GetClusteredCovariance(model, best.State, best.Weights, clusters, root, result.Spread);
  result.Views = clustered.Clusters;
  // In units of the root: what linear equations give with errors as they are in common, and what
  // they leave out.
  const Eigen::MatrixXd inverse = conditioning.GetInverseRoot();
  const Eigen::MatrixXd linear = inverse * clustered.Covariance * inverse.transpose();
  const double count = static_cast<double>(conditioning.Values.size());
  const double tempering = std::max(1.0, linear.trace() / (count * result.Spread * result.Spread));
  const Eigen::MatrixXd bend =
    root * GetPosteriorRoot(model, best.State, best.Weights, root * result.Spread, tempering);
  return bend * linear * bend.transpose();
}

// Those whose error is large for itself and beside the others; the worst first.
std::vector<CalibrationWeakness> KeepWeak(std::vector<CalibrationWeakness> directions)
{
  std::sort(directions.begin(), directions.end(),
    [](const CalibrationWeakness& a, const CalibrationWeakness& b) { return a.Error > b.Error; });
  const double median = directions[directions.size() / 2].Error;
  std::vector<CalibrationWeakness> weak;
  for (const CalibrationWeakness& direction : directions)
  {
    if (direction.Error > WeakError && direction.Error > WeakRatio * median)
    {
      weak.push_back(direction);
    }
  }
  return weak;
}
}

bool IsZeroAt(CalibrationTarget target, int axis)
{
  switch (target)
  {
    case CalibrationTarget::Wall:
      return axis == 2;
    case CalibrationTarget::Point:
    case CalibrationTarget::Tip:
      return true;
    default:
      return axis != static_cast<int>(target);
  }
}

ProbeCalibration ProbeCalibration::Solve(
  const std::vector<CalibrationPick>& picks, const ProbeCalibrationOptions& options)
{
  Check(picks, options);
  const Solver solver(picks, options);
  const CalibrationModel& model = solver.GetModel();
  const std::vector<Solver::Solution> solutions = solver.Solve();
  const Solver::Solution& best = solutions.front();
  const std::vector<int>& unknowns = model.GetUnknowns();
  ProbeCalibration result = MakeResult(model, solutions);

  const Conditioning conditioning = GetConditioning(solver, best);
  const Eigen::Index count = conditioning.Values.size();
  const double largest = conditioning.Values[count - 1];
  if (!(conditioning.Values[0] > SingularRatio * largest))
  {
    throw std::invalid_argument("the picks leave open " +
      DescribeCalibrationWeakness(unknowns, conditioning.Vectors.col(0), picks, best.State));
  }
  result.Condition = std::sqrt(largest / conditioning.Values[0]);

  const std::vector<std::size_t> clusters =
    FindCalibrationClusters(picks, best.State, solver.GetFarPixel(), RestSpreads * result.Spread);
  const Eigen::MatrixXd covariance = FindCovariance(model, best, conditioning, clusters, result);
  for (std::size_t a = 0; a < unknowns.size(); ++a)
  {
    for (std::size_t b = 0; b < unknowns.size(); ++b)
    {
      if (unknowns[a] < ImageUnknowns && unknowns[b] < ImageUnknowns)
      {
        result.Covariance[static_cast<std::size_t>(ImageUnknowns * unknowns[a] + unknowns[b])] =
          covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }

  // The part of each direction that the image has in it. How well it is held follows from the poses
  // and one spread for all, picks of a view counted as one: the covariance is too uncertain for that.
  const double spread = result.Spread *
    std::sqrt(static_cast<double>(std::count(result.Used.begin(), result.Used.end(), true)) /
      static_cast<double>(result.Views));
  std::vector<CalibrationWeakness> directions;
  for (Eigen::Index v = 0; v < count; ++v)
  {
    double square = 0;
    for (std::size_t u = 0; u < unknowns.size(); ++u)
    {
      if (unknowns[u] < ImageUnknowns)
      {
        square += std::pow(conditioning.Vectors(static_cast<Eigen::Index>(u), v), 2);
      }
    }
    directions.push_back({ spread * std::sqrt(square / conditioning.Values[v]),
      DescribeCalibrationWeakness(unknowns, conditioning.Vectors.col(v), picks, best.State) });
  }
  result.Weaknesses = KeepWeak(std::move(directions));
  return result;
}

std::array<Vec3, 3> ProbeCalibration::GetCovariance(const Vec2& pixel) const
{
  const Vec3 x = pixel[0] * this->ImageToProbe.Column(0);
  const Vec3 y = pixel[1] * this->ImageToProbe.Column(1);
  const Vec3 arm = x + y;
  const std::array<Vec3, ImageUnknowns> moves{ Cross({ 1, 0, 0 }, arm), Cross({ 0, 1, 0 }, arm),
    Cross({ 0, 0, 1 }, arm), { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, x, y };
  std::array<Vec3, 3> covariance{};
  for (std::size_t a = 0; a < ImageUnknowns; ++a)
  {
    for (std::size_t b = 0; b < ImageUnknowns; ++b)
    {
      for (int i = 0; i < 3; ++i)
      {
        covariance[static_cast<std::size_t>(i)] = covariance[static_cast<std::size_t>(i)] +
          (this->Covariance[ImageUnknowns * a + b] * moves[a][i]) * moves[b];
      }
    }
  }
  return covariance;
}

double ProbeCalibration::GetExpectedError(const Vec2& pixel) const
{
  const std::array<Vec3, 3> covariance = this->GetCovariance(pixel);
  return std::sqrt(covariance[0][0] + covariance[1][1] + covariance[2][2]);
}

double ProbeCalibration::GetRatioError() const
{
  constexpr std::size_t column = 6, row = 7, count = ImageUnknowns;
  return std::sqrt(std::max(0.0,
    this->Covariance[count * column + column] + this->Covariance[count * row + row] -
      2 * this->Covariance[count * column + row]));
}

Vec3 ProbeCalibration::GetAngles() const
{
  const Vec3 x = Normalized(this->ImageToProbe.Column(0));
  const Vec3 y = Normalized(this->ImageToProbe.Column(1));
  const Vec3 z = Cross(x, y);
  return { std::atan2(x[1], x[0]) / Degree,
    std::asin(std::max(-1.0, std::min(1.0, -x[2]))) / Degree, std::atan2(y[2], z[2]) / Degree };
}
}
