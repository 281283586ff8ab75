// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the solution of a probe's calibration may lie, without any idea of it.
#ifndef lacunaCalibrationStart_h
#define lacunaCalibrationStart_h

#include "lacunaCalibrationModel.h"

#include <vector>

namespace lacuna
{
/// Orientations of image and phantom all over their ranges, each with the lengths that suit it best;
/// the count best of them by the mean absolute error, the best first. The spacing of a state is
/// spacing unless the model seeks it.
std::vector<CalibrationState> FindCalibrationStarts(
  const CalibrationModel& model, const Eigen::Vector2d& spacing, std::size_t count);
}
#endif
