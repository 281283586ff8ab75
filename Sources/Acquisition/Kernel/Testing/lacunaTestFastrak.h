// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Records and damage for the tests of the FASTRAK.
#ifndef lacunaTestFastrak_h
#define lacunaTestFastrak_h

#include "lacunaFastrakRecord.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace lacunaTest
{
constexpr double Pi = 3.14159265358979323846;

/// A record with every item, turned about all axes by different angles.
inline lacuna::FastrakRecord MakeRecord(
  const lacuna::Vec3& position, const lacuna::Vec3& angles, int station = 1)
{
  lacuna::FastrakRecord record;
  const lacuna::Matrix4 rotation = lacuna::FastrakRotation(angles);
  record.Station = station;
  record.Position = position;
  record.RelativePosition = lacuna::Vec3{ 1.27, -2.54, 0 };
  record.Angles = angles;
  record.Axes = { rotation.Column(0), rotation.Column(1), rotation.Column(2) };
  record.Quaternion = lacuna::FastrakQuaternion(rotation);
  record.Button = true;
  return record;
}

/// The largest difference of two matrices' elements.
inline double Distance(const lacuna::Matrix4& a, const lacuna::Matrix4& b)
{
  double largest = 0;
  for (int i = 0; i < 16; ++i)
  {
    largest = std::max(largest, std::abs(a.Data()[i] - b.Data()[i]));
  }
  return largest;
}

/// Changes, drops, adds or repeats bytes, at up to maximum places. What is repeated was not changed: a changed value
/// that comes twice would be one.
inline std::string Mutate(const std::string& clean, unsigned int maximum, std::mt19937& random)
{
  std::string bytes = clean;
  const unsigned int changes = 1 + random() % maximum;
  for (unsigned int i = 0; i < changes && !bytes.empty(); ++i)
  {
    const std::size_t at = random() % bytes.size();
    switch (random() % 5)
    {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
        break;
      case 2:
        bytes.erase(at, 1 + random() % 40);
        break;
      case 3:
        bytes.insert(at, 1 + random() % 5, static_cast<char>(random()));
        break;
      default:
        bytes.insert(at, clean.substr(random() % clean.size(), random() % 60));
    }
  }
  return bytes;
}
}
#endif
