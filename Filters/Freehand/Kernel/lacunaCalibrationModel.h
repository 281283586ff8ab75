// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The equations of a probe's calibration, their derivatives and their solution from a start.
#ifndef lacunaCalibrationModel_h
#define lacunaCalibrationModel_h

#include "lacunaProbeCalibration.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

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
}
#endif
