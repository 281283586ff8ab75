// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationAdvice.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace lacuna
{
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
}
