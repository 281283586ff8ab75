// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The equations of a probe's calibration, their derivatives and their solution from a start.
#ifndef lacunaCalibrationModel_h
#define lacunaCalibrationModel_h

#include "lacunaProbeCalibration.h"

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace lacuna
{
/// Everything that is sought.
struct CalibrationState
{
  Eigen::Matrix3d ImageRotation;   ///< image axes in the probe's coordinate system
  Eigen::Vector3d ImageOrigin;     ///< mm
  Eigen::Vector2d Spacing;         ///< mm a column, a row
  Eigen::Matrix3d PhantomRotation; ///< tracker to phantom
  Eigen::Vector3d PhantomOrigin;   ///< mm, tracker's origin in the phantom
};

class CalibrationModel
{
public:
  /// A small change of a state: rotation vectors (radians; of the image in the probe's, of the phantom
  /// in its own coordinate system), translations, logarithms of the spacing.
  enum Unknown
  {
    ImageTurn = 0,
    ImageShift = 3,
    Scale = 6,
    PhantomTurn = 8,
    PhantomShift = 11,
    UnknownCount = 14
  };

  /// Of the receiver in the tracker's coordinate system, when a pick was made.
  struct Pose
  {
    Eigen::Matrix3d Rotation;
    Eigen::Vector3d Origin; ///< mm
  };

  /// Keeps a reference to the picks.
  CalibrationModel(const std::vector<CalibrationPick>& picks, bool estimateScale);

  std::size_t GetNumberOfPicks() const { return this->Picks.size(); }
  const CalibrationPick& GetPick(std::size_t pick) const { return this->Picks[pick]; }
  const Pose& GetPose(std::size_t pick) const { return this->Poses[pick]; }
  /// Those of Unknown that the picks' targets can tell: a wall says nothing about its own axes.
  const std::vector<int>& GetUnknowns() const { return this->Unknowns; }
  int GetNumberOfEquations(std::size_t pick) const;

  Eigen::Vector3d GetPhantomPoint(const CalibrationState& state, std::size_t pick) const;
  /// Errors of a pick's equations in mm, as many as it has.
  void GetErrors(const CalibrationState& state, std::size_t pick, double errors[3]) const;
  /// Their derivatives with respect to GetUnknowns(), one column of derivatives an equation.
  void GetDerivatives(
    const CalibrationState& state, std::size_t pick, Eigen::MatrixXd& derivatives) const;

  /// Levenberg-Marquardt from state. Weights are of each pick; without them, a pick counts the less
  /// the further it is off (Cauchy), by the scale of all errors. Returns the weighted mean square.
  double Refine(CalibrationState& state, const std::vector<double>* weights) const;

  /// Sum of J^T J over picks with weight above 0, for GetUnknowns().
  Eigen::MatrixXd GetNormalMatrix(
    const CalibrationState& state, const std::vector<double>& weights) const;

  /// Weighted mean square of the errors.
  double GetCost(const CalibrationState& state, const std::vector<double>& weights) const;
  /// state after a step of GetUnknowns().
  CalibrationState Move(const CalibrationState& state, const Eigen::VectorXd& step) const;

private:
  std::vector<double> GetCauchyWeights(const CalibrationState& state) const;

  const std::vector<CalibrationPick>& Picks;
  std::vector<Pose> Poses;
  std::vector<int> Unknowns;
};

/// Picks that may have a part of their error in common, as numbers from 0: those of one slice, and of
/// slices that follow one another while the probe rests, which is when neither its receiver nor a
/// corner of the image (up to farPixel) moves by more than rest (mm) from the first of them. Picks
/// without a slice are on their own.
std::vector<std::size_t> FindCalibrationClusters(const std::vector<CalibrationPick>& picks,
  const CalibrationState& state, const Vec2& farPixel, double rest);

struct ClusteredCovariance
{
  Eigen::MatrixXd Covariance; ///< of the model's unknowns
  std::size_t Clusters = 0;   ///< that have picks with a weight
};

/// Errors may be of any kind within a cluster and are independent from one to the other: the sandwich
/// estimator with the clusters' residuals as they would be without them (the jackknife: CR3 of
/// MacKinnon and White 1985), which is not too small with few clusters either. What a single cluster
/// holds, its residuals cannot tell; there errors of spread (mm, of an equation) that all its
/// equations share are assumed. root: times its transpose, the inverse of the normal matrix.
ClusteredCovariance GetClusteredCovariance(const CalibrationModel& model,
  const CalibrationState& state, const std::vector<double>& weights,
  const std::vector<std::size_t>& clusters, const Eigen::MatrixXd& root, double spread);

/// How much further than by linear equations the truth may lie from the solution. A probe that was
/// hardly turned leaves the solution open by so much that the equations bend: near the solution they
/// then promise more than they hold. Returns the symmetric square root of the second moments about
/// the solution, in units in which linear equations give the unit matrix, which it is where the
/// equations are as good as linear.
///
/// The moments are those of the posterior with a flat prior and normal errors of a spread that is not
/// known (a t distribution if the equations were linear), by importance sampling: three rounds, from
/// t distributions with 6 degrees of freedom that take over mean and covariance. root: symmetric,
/// the square root of the covariance by linear equations. tempering: how much larger the covariance
/// is by errors that equations have in common, 1 or more.
Eigen::MatrixXd GetPosteriorRoot(const CalibrationModel& model, const CalibrationState& state,
  const std::vector<double>& weights, const Eigen::MatrixXd& root, double tempering);
}
#endif
