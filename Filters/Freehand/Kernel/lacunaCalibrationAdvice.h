// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Words for what a probe's calibration leaves open.
#ifndef lacunaCalibrationAdvice_h
#define lacunaCalibrationAdvice_h

#include "lacunaCalibrationModel.h"

#include <string>
#include <vector>

namespace lacuna
{
/// What is not known, and which motion of the probe would tell. direction: of the unknowns, in mm, in
/// which the equations hold the solution least.
std::string DescribeCalibrationWeakness(const std::vector<int>& unknowns,
  const Eigen::VectorXd& direction, const std::vector<CalibrationPick>& picks,
  const CalibrationState& state);
}
#endif
