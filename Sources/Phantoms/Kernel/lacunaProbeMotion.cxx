// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProbeMotion.h"

#include "lacunaCounterNoise.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double Radians = Pi / 180;
constexpr std::uint64_t PoseStream = 1;
}

void ProbeMotion::Parameters::Describe(Properties& properties) const
{
  properties.Add("NumberOfSlices", this->NumberOfSlices, ValueRange::AtLeast(1))
    .Add("Motion", static_cast<int>(this->Motion), KindNames)
    .Add("NumberOfSweeps", this->NumberOfSweeps, ValueRange::AtLeast(1))
    .Add("Travel", this->Travel, ValueRange::Between(0, 1e5, "mm"))
    .Add("SweepAngle", this->SweepAngle, ValueRange::Between(0, 360, "degrees"))
    .Add("TwistAngle", this->TwistAngle, ValueRange::Between(0, 180, "degrees"))
    .Add("FanAngle", this->FanAngle, ValueRange::Between(0, 180, "degrees"))
    .Add("Wander", this->Wander, ValueRange::Between(0, 1e5, "mm"))
    .Add("Center", this->Center.Elements, ValueRange::Between(-1e6, 1e6, "mm"));
}

ProbeMotion::ProbeMotion(const Parameters& parameters)
  : P(parameters)
{
  Properties properties;
  this->P.Describe(properties);
  properties.Check();
  ValueRange::Between(0, 1e5, "mm").Check("PoseNoise[0]", this->P.PositionNoise);
  ValueRange::Between(0, 180, "degrees").Check("PoseNoise[1]", this->P.AngleNoise);
  if (this->P.NumberOfSweeps > this->P.NumberOfSlices)
  {
    throw std::invalid_argument("NumberOfSweeps is " + std::to_string(this->P.NumberOfSweeps) +
      "; it must be from 1 to NumberOfSlices (" + std::to_string(this->P.NumberOfSlices) +
      "), which counts the slices of all sweeps");
  }
}

Matrix4 ProbeMotion::TrueProbeToReference(std::int64_t slice) const
{
  // The first (slices % sweeps) sweeps have one slice more than the others.
  const std::int64_t least = this->P.NumberOfSlices / this->P.NumberOfSweeps;
  const std::int64_t longer = this->P.NumberOfSlices % this->P.NumberOfSweeps;
  const std::int64_t inLonger = longer * (least + 1);
  const bool isLonger = slice < inLonger;
  const std::int64_t count = isLonger ? least + 1 : least;
  const std::int64_t within = isLonger ? slice : slice - inLonger;
  const std::int64_t sweep = (isLonger ? 0 : longer) + within / count;
  const double u =
    count > 1 ? 2 * static_cast<double>(within % count) / static_cast<double>(count - 1) - 1 : 0;

  Vec3 shift{ 0, 0, 0 };
  double twist = 0;
  double fan = 0;
  switch (this->P.Motion)
  {
    case Kind::Sweep:
      shift[2] = 0.5 * this->P.Travel * u;
      break;
    case Kind::Fan:
      fan = 0.5 * this->P.SweepAngle * u;
      break;
    case Kind::Twist:
      twist = 0.5 * this->P.SweepAngle * u;
      break;
    case Kind::Arbitrary:
      shift = { this->P.Wander * std::cos(1.3 * Pi * u + 0.4),
        0.5 * this->P.Wander * std::cos(2.1 * Pi * u - 0.9), 0.5 * this->P.Travel * u };
      twist = this->P.TwistAngle * std::sin(Pi * u);
      fan = this->P.FanAngle * std::sin(1.5 * Pi * u + 0.6);
      break;
  }
  const double turn = Pi * static_cast<double>(sweep) / static_cast<double>(this->P.NumberOfSweeps);
  const Vec3 face{ shift[0], shift[1] - 0.5 * this->P.ImageDepth, shift[2] };
  return Matrix4::Translation(this->P.Center) * Matrix4::Rotation({ 0, 1, 0 }, turn) *
    Matrix4::Translation(face) * Matrix4::Rotation({ 0, 1, 0 }, twist * Radians) *
    Matrix4::Rotation({ 1, 0, 0 }, fan * Radians);
}

Matrix4 ProbeMotion::RecordedProbeToReference(std::int64_t slice) const
{
  const Matrix4 pose = this->TrueProbeToReference(slice);
  if (this->P.PositionNoise == 0 && this->P.AngleNoise == 0)
  {
    return pose;
  }
  const CounterNoise noise(this->P.Seed, PoseStream);
  double n[6];
  for (int i = 0; i < 6; ++i)
  {
    n[i] = noise.Normal(6 * static_cast<std::uint64_t>(slice) + i);
  }
  const double a = this->P.AngleNoise * Radians;
  return Matrix4::Translation(this->P.PositionNoise * Vec3{ n[0], n[1], n[2] }) * pose *
    Matrix4::Rotation({ 0, 0, 1 }, a * n[5]) * Matrix4::Rotation({ 0, 1, 0 }, a * n[4]) *
    Matrix4::Rotation({ 1, 0, 0 }, a * n[3]);
}

Matrix4 MakeImageToProbe(std::int64_t columns, double spacing)
{
  return Matrix4::Translation({ -0.5 * spacing * static_cast<double>(columns - 1), 0, 0 }) *
    Matrix4::Scaling({ spacing, spacing, spacing });
}
}
