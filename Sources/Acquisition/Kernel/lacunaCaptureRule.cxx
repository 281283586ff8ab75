// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCaptureRule.h"

#include <algorithm>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double ArmLength = 100;  // mm
constexpr double LongestGap = 0.5; // s

double LargestDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, Norm(a[i] - b[i]));
  }
  return largest;
}
}

std::vector<Vec3> GetViewCorners(const Matrix4& imageToProbe, const std::array<int, 4>& window)
{
  std::vector<Vec3> corners;
  for (const int right : { 0, 1 })
  {
    for (const int bottom : { 0, 1 })
    {
      corners.push_back(imageToProbe.Point(
        { window[0] - 0.5 + right * window[2], window[1] - 0.5 + bottom * window[3], 0 }));
    }
  }
  return corners;
}

std::vector<Vec3> GetReceiverPoints()
{
  std::vector<Vec3> points;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (const double length : { -ArmLength, ArmLength })
    {
      Vec3 point{ 0, 0, 0 };
      point[axis] = length;
      points.push_back(point);
    }
  }
  return points;
}

CaptureRule::CaptureRule(
  CaptureMode mode, double threshold, double speedLimit, std::vector<Vec3> points)
  : Mode(mode)
  , Threshold(threshold)
  , SpeedLimit(speedLimit)
  , Points(std::move(points))
{
}

std::vector<Vec3> CaptureRule::Place(const Matrix4& pose) const
{
  std::vector<Vec3> places;
  places.reserve(this->Points.size());
  for (const Vec3& point : this->Points)
  {
    places.push_back(pose.Point(point));
  }
  return places;
}

CaptureRule::Verdict CaptureRule::Judge(const Matrix4& receiverToTransmitter, double instant)
{
  const std::vector<Vec3> places = this->Place(receiverToTransmitter);
  Verdict verdict;
  const double gap = instant - this->BeforeInstant;
  if (this->Before && gap > 0 && gap <= LongestGap)
  {
    verdict.Speed = LargestDistance(places, this->Place(*this->Before)) / gap;
    verdict.TooFast = this->SpeedLimit > 0 && *verdict.Speed > this->SpeedLimit;
  }
  verdict.Take = this->Mode == CaptureMode::EveryFrame || !this->LastTaken ||
    LargestDistance(places, this->Place(*this->LastTaken)) > this->Threshold;
  this->Before = receiverToTransmitter;
  this->BeforeInstant = instant;
  return verdict;
}

void CaptureRule::Continue(const CaptureRule& other)
{
  this->LastTaken = other.LastTaken;
  this->Before = other.Before;
  this->BeforeInstant = other.BeforeInstant;
}
}
