// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIncompleteShape.h"

#include "lacunaCounterNoise.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
const double Pi = 3.14159265358979323846;
constexpr int SmallestShape = 4;

// The kumara in units of its half length: 80 x 28 x 24 for a half length of 40, bent so that the
// side towards +y is 8 deep.
constexpr double KumaraY = 0.35;
constexpr double KumaraZ = 0.30;
constexpr double KumaraBend = 0.53;
constexpr double KumaraShift = -0.22;
constexpr double KumaraTaper = 0.25;
constexpr double KumaraBoxY = 0.62;
constexpr double KumaraBoxZ = 0.36;

double Blob(double angle)
{
  return 1 + 0.13 * std::cos(2 * angle + 0.4) + 0.09 * std::sin(3 * angle) +
    0.04 * std::cos(5 * angle + 1);
}
constexpr double LargestBlob = 1.2;

// The cavity: a disc of radius 1 less a round-ended bay of half width 0.22 from x = 0 outwards.
constexpr double BayHalfWidth = 0.22;

}

void IncompleteShape::Parameters::Describe(Properties& properties) const
{
  const std::vector<int> used(
    this->Dimensions.begin(), this->Dimensions.end() - (this->IsFlat() ? 1 : 0));
  properties.Add("Shape", static_cast<int>(this->Shape), KindNames)
    .Add("Dimensions", used, ValueRange::AtLeast(2 * Margin + SmallestShape, "voxels"))
    .Add("PresentFraction", this->PresentFraction, ValueRange::Above(0).UpTo(1))
    .Add("Patches", this->Patches)
    .Add("PatchRadii", this->PatchRadii, ValueRange::AtLeast(0, "mm"))
    .Add("GapAngle", this->GapAngle, ValueRange::Between(0, 360, "degrees"))
    .Add("TissueFraction", this->TissueFraction, ValueRange::Between(0, 1))
    .Add("OutlierFraction", this->OutlierFraction, ValueRange::Between(0, 10))
    .Add("Seed", static_cast<std::int64_t>(this->Seed)); // as given: below 0, too
}

IncompleteShape::IncompleteShape(const Parameters& parameters)
  : Values(parameters)
  , Dimensions(parameters.Dimensions)
  , Half{}
{
  Properties properties;
  this->Values.Describe(properties);
  properties.Check();
  if (parameters.GapAngle == 360)
  {
    throw std::invalid_argument("GapAngle is 360 degrees; nothing would be seen: give less");
  }
  const std::array<double, 2>& radii = parameters.PatchRadii;
  if (radii[0] > radii[1])
  {
    throw std::invalid_argument("PatchRadii are " + FormatNumber(radii[0]) + " and " +
      FormatNumber(radii[1]) + " mm; give the smaller one first");
  }
  if (this->IsFlat())
  {
    this->Dimensions[2] = 1;
  }
  for (int axis = 0; axis < (this->IsFlat() ? 2 : 3); ++axis)
  {
    this->Half[axis] = 0.5 * (this->Dimensions[axis] - 1) - Margin;
  }
}

double IncompleteShape::GetDistance(double x, double y, double z) const
{
  const std::array<double, 3>& h = this->Half;
  switch (this->Values.Shape)
  {
    case Circle:
      return std::hypot(x, y) - std::min(h[0], h[1]);
    case Sphere:
      return std::sqrt(x * x + y * y + z * z) - std::min({ h[0], h[1], h[2] });
    case Cube:
    {
      const double a = std::min({ h[0], h[1], h[2] });
      const double q[3] = { std::abs(x) - a, std::abs(y) - a, std::abs(z) - a };
      double outside = 0;
      for (double c : q)
      {
        outside += std::max(c, 0.0) * std::max(c, 0.0);
      }
      return std::sqrt(outside) + std::min(0.0, std::max({ q[0], q[1], q[2] }));
    }
    case Cavity:
    {
      const double a = std::min(h[0], h[1]);
      const double disc = std::hypot(x, y) - a;
      const double along = std::max(0.0, -x);
      const double bay = std::hypot(along, y) - BayHalfWidth * a;
      return std::max(disc, -bay);
    }
    case Blob:
    {
      const double a = std::min(h[0], h[1]) / LargestBlob;
      const double r = std::hypot(x, y);
      const double angle = std::atan2(y, x);
      const double step = 1e-4;
      const double slope = a * (lacuna::Blob(angle + step) - lacuna::Blob(angle - step)) /
        (2 * step) / std::max(r, 1e-9);
      return (r - a * lacuna::Blob(angle)) / std::sqrt(1 + slope * slope);
    }
    case Kumara:
      break;
  }
  const double a = std::min({ h[0], h[1] / KumaraBoxY, h[2] / KumaraBoxZ });
  const double u = x / a;
  const double taper = std::max(0.1, 1 - KumaraTaper * u);
  const double v = (y / a - KumaraBend * u * u - KumaraShift) / (KumaraY * taper);
  const double w = z / a / (KumaraZ * taper);
  const double f = std::max(1e-9, std::sqrt(u * u + v * v + w * w));
  const double tapering = taper > 0.1 ? KumaraTaper / taper : 0;
  const double dx =
    (u + v * (-2 * KumaraBend * u / (KumaraY * taper) + v * tapering) + w * w * tapering) / f;
  const double dy = v / (KumaraY * taper) / f;
  const double dz = w / (KumaraZ * taper) / f;
  return a * (f - 1) / std::max(1e-9, std::sqrt(dx * dx + dy * dy + dz * dz));
}

double IncompleteShape::GetContent() const
{
  const std::array<double, 3>& h = this->Half;
  const double a = std::min({ h[0], h[1], this->IsFlat() ? h[0] : h[2] });
  switch (this->Values.Shape)
  {
    case Circle:
      return Pi * a * a;
    case Sphere:
      return 4 * Pi / 3 * a * a * a;
    case Cube:
      return 8 * a * a * a;
    default:
      break;
  }
  // by sampling: each sample counts with the part of its cell that lies inside
  const int finer = this->IsFlat() ? 8 : 2;
  const double cell = 1.0 / finer;
  double content = 0;
  const int nz = this->IsFlat() ? 1 : this->Dimensions[2] * finer;
  for (int k = 0; k < nz; ++k)
  {
    const double z = this->IsFlat() ? 0 : (k - 0.5 * (nz - 1)) * cell;
    for (int j = 0; j < this->Dimensions[1] * finer; ++j)
    {
      const double y = (j - 0.5 * (this->Dimensions[1] * finer - 1)) * cell;
      for (int i = 0; i < this->Dimensions[0] * finer; ++i)
      {
        const double x = (i - 0.5 * (this->Dimensions[0] * finer - 1)) * cell;
        content += std::clamp(0.5 - this->GetDistance(x, y, z) / cell, 0.0, 1.0);
      }
    }
  }
  return content * std::pow(cell, this->IsFlat() ? 2 : 3);
}

// Random numbers, one after the other.
class IncompleteShape::Draws
{
public:
  explicit Draws(std::uint64_t seed)
    : Noise(seed, 0)
  {
  }
  double Uniform() { return this->Noise.Uniform(this->Drawn++); }
  std::int64_t Below(std::int64_t end)
  {
    return static_cast<std::int64_t>(this->Uniform() * static_cast<double>(end));
  }

private:
  CounterNoise Noise;
  std::uint64_t Drawn = 0;
};

std::array<double, 3> IncompleteShape::GetPosition(std::int64_t voxel) const
{
  const std::array<int, 3>& n = this->Dimensions;
  return { static_cast<double>(voxel % n[0]) - 0.5 * (n[0] - 1),
    static_cast<double>(voxel / n[0] % n[1]) - 0.5 * (n[1] - 1),
    static_cast<double>(voxel / (static_cast<std::int64_t>(n[0]) * n[1])) - 0.5 * (n[2] - 1) };
}

void IncompleteShape::AddSurface(std::vector<unsigned char>& voxels, Execution& execution) const
{
  const double open = std::cos(this->Values.GapAngle * Pi / 360);
  execution.For(static_cast<std::int64_t>(voxels.size()), 1 << 14,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const auto p = this->GetPosition(i);
        const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        const bool inGap = this->Values.GapAngle > 0 && p[0] > length * open;
        voxels[i] = !inGap && std::abs(this->GetDistance(p[0], p[1], p[2])) <= 0.5;
      }
    });
}

std::int64_t IncompleteShape::RemovePatches(const std::vector<std::int64_t>& object,
  std::int64_t kept, Draws& draws, std::vector<unsigned char>& voxels, Execution& execution) const
{
  const std::array<double, 2>& radii = this->Values.PatchRadii;
  auto present = static_cast<std::int64_t>(object.size());
  const auto removed = static_cast<double>(present - kept);
  while (present > kept)
  {
    execution.Report(1 - static_cast<double>(present - kept) / removed);
    const auto centre =
      this->GetPosition(object[draws.Below(static_cast<std::int64_t>(object.size()))]);
    const double radius = radii[0] + (radii[1] - radii[0]) * draws.Uniform();
    for (const std::int64_t i : object)
    {
      const auto p = this->GetPosition(i);
      const double distance =
        std::hypot(std::hypot(p[0] - centre[0], p[1] - centre[1]), p[2] - centre[2]);
      if (voxels[i] && distance <= radius)
      {
        voxels[i] = 0;
        --present;
      }
    }
  }
  return present;
}

void IncompleteShape::AddTissue(std::vector<unsigned char>& voxels, Execution& execution) const
{
  const CounterNoise echo(this->Values.Seed, 1);
  execution.For(static_cast<std::int64_t>(voxels.size()), 1 << 14,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const auto p = this->GetPosition(i);
        const bool inside = this->GetDistance(p[0], p[1], p[2]) < -0.5;
        if (inside && echo.Uniform(i) < this->Values.TissueFraction)
        {
          voxels[i] = 1;
        }
      }
    });
}

std::vector<unsigned char> IncompleteShape::Sample(Execution& execution) const
{
  const std::array<int, 3>& n = this->Dimensions;
  const std::int64_t count = static_cast<std::int64_t>(n[0]) * n[1] * n[2];
  std::vector<unsigned char> voxels(count, 0);
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.2);
  this->AddSurface(voxels, execution);

  std::vector<std::int64_t> object;
  for (std::int64_t i = 0; i < count; ++i)
  {
    if (voxels[i])
    {
      object.push_back(i);
    }
  }
  Draws draws(this->Values.Seed);
  auto present = static_cast<std::int64_t>(object.size());
  const auto kept = std::llround(this->Values.PresentFraction * static_cast<double>(present));
  execution.SetStage(0.2, 0.9);
  if (this->Values.Patches && this->Values.PatchRadii[1] >= 1) // smaller ones are single voxels
  {
    present = this->RemovePatches(object, kept, draws, voxels, execution);
  }
  else
  {
    // the first of a random permutation stay
    for (std::int64_t a = 0; a < present; ++a)
    {
      std::swap(object[a], object[a + draws.Below(present - a)]);
      voxels[object[a]] = a < kept;
    }
    present = kept;
  }
  if (this->Values.TissueFraction > 0)
  {
    execution.SetStage(0.9, 1);
    this->AddTissue(voxels, execution);
  }
  const auto outliers = std::llround(this->Values.OutlierFraction * static_cast<double>(present));
  for (std::int64_t o = 0; o < outliers; ++o)
  {
    voxels[draws.Below(count)] = 1;
  }
  return voxels;
}
}
