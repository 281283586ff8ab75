// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which picks of a calibration err alike, and how well picks that do hold the solution.
#ifndef lacunaCalibrationClusters_h
#define lacunaCalibrationClusters_h

#include "lacunaCalibrationModel.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
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
}
#endif
