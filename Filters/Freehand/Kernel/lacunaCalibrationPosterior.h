// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What picks say of a calibration where its equations are far from linear.
#ifndef lacunaCalibrationPosterior_h
#define lacunaCalibrationPosterior_h

#include "lacunaCalibrationModel.h"

#include <vector>

namespace lacuna
{
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
