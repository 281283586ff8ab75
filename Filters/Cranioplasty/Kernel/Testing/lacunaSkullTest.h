// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An analytic skull: rough, thicker here and there, and not quite symmetric.
#ifndef lacunaSkullTest_h
#define lacunaSkullTest_h

#include "lacunaMatrix4.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSkullShape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace lacunaSkullTest
{
using lacuna::Vec3;

constexpr double Pi = 3.14159265358979323846;

/// Waves in space in random directions, of lengths in a range, mm.
class Waves
{
public:
  Waves(unsigned seed, double shortest, double longest, int count = 10)
  {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    for (int i = 0; i < count; ++i)
    {
      const Vec3 direction =
        lacuna::Normalized({ uniform() - 0.5, uniform() - 0.5, uniform() - 0.5 });
      this->Vectors.push_back((2 * Pi / (shortest + (longest - shortest) * uniform())) * direction);
      this->Phases.push_back(2 * Pi * uniform());
    }
  }
  /// With variance 1.
  double operator()(const Vec3& x) const
  {
    double sum = 0;
    for (std::size_t i = 0; i < this->Vectors.size(); ++i)
    {
      sum += std::cos(Dot(this->Vectors[i], x) + this->Phases[i]);
    }
    return sum * std::sqrt(2.0 / static_cast<double>(this->Vectors.size()));
  }
  /// Of the values at two places, over all phases.
  double GetCorrelation(const Vec3& difference) const
  {
    double sum = 0;
    for (const Vec3& vector : this->Vectors)
    {
      sum += std::cos(Dot(vector, difference)) / static_cast<double>(this->Vectors.size());
    }
    return sum;
  }

private:
  std::vector<Vec3> Vectors;
  std::vector<double> Phases;
};

/// In its own frame: x to the left, y to the back, z to the crown; symmetric about x = 0 but for a bump on the
/// left temple and some roughness.
class Skull
{
public:
  double GetOuter(const Vec3& d) const
  {
    const double ellipsoid =
      1 / std::sqrt(d[0] * d[0] / (72 * 72) + d[1] * d[1] / (90 * 90) + d[2] * d[2] / (80 * 80));
    const Vec3 x = 80 * d;
    const Vec3 mirrored{ -x[0], x[1], x[2] };
    const double bump = Dot(d, lacuna::Normalized({ 1, -0.3, 0.4 }));
    return ellipsoid + 0.7 * (this->Common(x) + this->Common(mirrored)) + 0.4 * this->Own(x) +
      1.5 * std::exp(-(1 - bump) / 0.06);
  }
  double GetThickness(const Vec3& d) const
  {
    const Vec3 x = 80 * d;
    const Vec3 mirrored{ -x[0], x[1], x[2] };
    return 6 - 1.5 * d[0] * d[0] + 0.5 * (this->Thick(x) + this->Thick(mirrored)) +
      0.2 * this->Own(mirrored);
  }

private:
  Waves Common{ 1, 25, 70 };
  Waves Own{ 2, 50, 150 };
  Waves Thick{ 3, 30, 90 };
};

/// Directions over the sphere, about so many mm apart at 80 mm.
inline std::vector<Vec3> Spread(double spacing)
{
  const int count = static_cast<int>(4 * Pi * 80 * 80 / (0.866 * spacing * spacing));
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i)
  {
    const double z = 1 - 2 * (i + 0.5) / count;
    const double r = std::sqrt(1 - z * z);
    const double turn = Pi * (3 - std::sqrt(5.0)) * i;
    directions.push_back({ r * std::cos(turn), r * std::sin(turn), z });
  }
  return directions;
}

/// The vault of the skull with a round hole: own frame turned and shifted into the world.
struct Patient
{
  /// hole: middle, own frame; radius of the hole, radians. lowest: where the vault ends (z of directions).
  Patient(const Vec3& hole, double radius, const lacuna::Matrix4& ownToWorld = {},
    double spacing = 3.5, double lowest = -0.3)
    : OwnToWorld(ownToWorld)
  {
    const Skull skull;
    this->Bone.Center = ownToWorld.Column(3);
    for (const Vec3& d : Spread(spacing))
    {
      if (d[2] < lowest)
      {
        continue;
      }
      const Vec3 world = ownToWorld.Vector(d);
      if (Dot(d, lacuna::Normalized(hole)) > std::cos(radius))
      {
        this->Defect.push_back(world);
        this->Outer.push_back(skull.GetOuter(d));
        this->Thickness.push_back(skull.GetThickness(d));
        continue;
      }
      this->Bone.Directions.push_back(world);
      this->Bone.Outer.push_back(skull.GetOuter(d));
      this->Bone.Thickness.push_back(skull.GetThickness(d));
    }
    this->Plane.Normal = ownToWorld.Vector({ 1, 0, 0 });
    this->Plane.Offset = Dot(this->Plane.Normal, this->Bone.Center);
  }

  lacuna::Matrix4 OwnToWorld;
  lacuna::SoundBone Bone;
  lacuna::MirrorPlane Plane; ///< true
  std::vector<Vec3> Defect;  ///< and what is missing in each direction
  std::vector<double> Outer;
  std::vector<double> Thickness;
};

struct Score
{
  double RMS = 0;
  double Largest = 0;
  double Predicted = 0; ///< RMS of the standard errors
  double Inside = 0;    ///< part of the errors within 1.96 standard errors
};

template <class Error>
Score Rate(const std::vector<lacuna::SkullEstimate>& estimates, const Error& error)
{
  Score score;
  const auto n = static_cast<double>(estimates.size());
  for (std::size_t i = 0; i < estimates.size(); ++i)
  {
    const auto [e, predicted] = error(estimates[i], i);
    score.RMS += e * e / n;
    score.Largest = std::max(score.Largest, std::abs(e));
    score.Predicted += predicted * predicted / n;
    score.Inside += (std::abs(e) < 1.96 * predicted) / n;
  }
  score.RMS = std::sqrt(score.RMS);
  score.Predicted = std::sqrt(score.Predicted);
  return score;
}

inline Score RateOuter(const Patient& patient, const std::vector<lacuna::SkullEstimate>& estimates)
{
  return Rate(estimates,
    [&](const lacuna::SkullEstimate& e, std::size_t i) {
      return std::array<double, 2>{ e.Outer - patient.Outer[i], e.OuterError };
    });
}

inline Score RateThickness(
  const Patient& patient, const std::vector<lacuna::SkullEstimate>& estimates)
{
  return Rate(estimates,
    [&](const lacuna::SkullEstimate& e, std::size_t i) {
      return std::array<double, 2>{ e.Thickness - patient.Thickness[i], e.ThicknessError };
    });
}
}
#endif
