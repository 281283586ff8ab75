// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaReceiverPlaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

namespace lacuna
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr std::size_t None = static_cast<std::size_t>(-1);

double GetDistance(const Matrix4& a, const Matrix4& b)
{
  return Norm(a.Column(3) - b.Column(3));
}

using Cell = std::array<std::int64_t, 3>;

Cell GetCell(const Matrix4& pose, double size)
{
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
  {
    cell[static_cast<std::size_t>(axis)] =
      static_cast<std::int64_t>(std::floor(pose(axis, 3) / size));
  }
  return cell;
}
}

double GetTurn(const Matrix4& a, const Matrix4& b)
{
  // From sine and cosine, so that small angles are exact.
  double twiceCosine = -1;
  Vec3 twiceSine{ 0, 0, 0 };
  for (int axis = 0; axis < 3; ++axis)
  {
    twiceCosine += Dot(a.Column(axis), b.Column(axis));
    twiceSine = twiceSine + Cross(a.Column(axis), b.Column(axis));
  }
  return std::atan2(Norm(twiceSine), twiceCosine) / Degree;
}

ReceiverPlaces::ReceiverPlaces(const std::vector<Matrix4>& poses, double distance, double angle)
{
  std::map<Cell, std::vector<std::size_t>> placesOfCells;
  std::vector<std::size_t> lastPose, lastVisit; // of each place
  const auto findNearest = [&](const Matrix4& pose)
  {
    const Cell cell = GetCell(pose, distance);
    std::size_t nearest = None;
    double smallest = distance;
    for (int n = 0; n < 27; ++n)
    {
      const auto found =
        placesOfCells.find({ cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1 });
      if (found == placesOfCells.end())
      {
        continue;
      }
      for (const std::size_t place : found->second)
      {
        const Matrix4& middle = poses[this->Middles[place]];
        const double away = GetDistance(pose, middle);
        if (away <= smallest && GetTurn(pose, middle) <= angle &&
          (away < smallest || place < nearest))
        {
          nearest = place;
          smallest = away;
        }
      }
    }
    return nearest;
  };
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    std::size_t place = findNearest(poses[i]);
    bool another = place == None;
    if (another)
    {
      place = this->Middles.size();
      this->Middles.push_back(i);
      lastPose.push_back(i);
      lastVisit.push_back(0);
      placesOfCells[GetCell(poses[i], distance)].push_back(place);
    }
    const Matrix4& middle = poses[this->Middles[place]];
    for (std::size_t k = lastPose[place] + 1; k < i && !another; ++k)
    {
      another =
        GetDistance(poses[k], middle) > 2 * distance || GetTurn(poses[k], middle) > 2 * angle;
    }
    if (another)
    {
      lastVisit[place] = this->Visited.size();
      this->Visited.push_back(place);
    }
    lastPose[place] = i;
    this->Place.push_back(place);
    this->Visit.push_back(lastVisit[place]);
  }
}
}
