// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkull.h"

#include "lacunaCounterNoise.h"
#include "lacunaSmoothStep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr Vec3 InverseSquares{ { 1 / (71.5 * 71.5), 1 / (90.0 * 90.0), 1 / (66.0 * 66.0) } };
// The bump: height in mm, sharpness (squared ratio of skull radius to bump radius), direction.
constexpr double BumpHeight = 2.5;
constexpr double BumpSharpness = 180;
const Vec3 BumpDirection = Normalized({ 0.42, -0.80, 0.43 });
// Below this radius the direction means nothing; it is far from any surface.
constexpr double TinyRadius = 1e-9;

// R at a unit vector n and, where gradient is not null, the gradient of its extension off the
// sphere (the caller projects it onto the tangent plane).
double RadiusAndGradient(const Vec3& n, Vec3* gradient)
{
  const double x = n[0];
  const double y = n[1];
  const double z = n[2];
  const double square =
    x * x * InverseSquares[0] + y * y * InverseSquares[1] + z * z * InverseSquares[2];
  const double ellipsoid = 1 / std::sqrt(square);
  const double shape = 1 + 0.09 * y * x * x - 0.05 * y * z + 0.05 * z * z * z +
    0.04 * x * x * z * z + 0.012 * x * y + 0.006 * x;
  const double bump = BumpHeight * std::exp(BumpSharpness * (Dot(n, BumpDirection) - 1));
  if (gradient)
  {
    const double e = -ellipsoid * ellipsoid * ellipsoid * shape;
    const double b = BumpSharpness * bump;
    *gradient = { e * x * InverseSquares[0] + b * BumpDirection[0] +
        ellipsoid * (0.18 * x * y + 0.08 * x * z * z + 0.012 * y + 0.006),
      e * y * InverseSquares[1] + b * BumpDirection[1] +
        ellipsoid * (0.09 * x * x - 0.05 * z + 0.012 * x),
      e * z * InverseSquares[2] + b * BumpDirection[2] +
        ellipsoid * (-0.05 * y + 0.15 * z * z + 0.08 * x * x * z) };
  }
  return ellipsoid * shape + bump;
}
}

double SkullSurface::Radius(const Vec3& direction)
{
  return RadiusAndGradient(direction, nullptr);
}

double SkullSurface::Implicit(const Vec3& point, Vec3* gradient)
{
  const double r = Norm(point);
  if (r < TinyRadius)
  {
    if (gradient)
    {
      *gradient = { 0, 0, 0 };
    }
    return -MinimumRadius;
  }
  const Vec3 n = (1 / r) * point;
  if (!gradient)
  {
    return r - RadiusAndGradient(n, nullptr);
  }
  Vec3 g;
  const double radius = RadiusAndGradient(n, &g);
  *gradient = n - (1 / r) * (g - Dot(g, n) * n);
  return r - radius;
}

double SkullSurface::SignedDistance(const Vec3& point, Vec3& foot, Vec3& normal)
{
  constexpr double Tolerance = 1e-7;
  constexpr int MaximumIterations = 200;
  const double side = Implicit(point) < 0 ? -1 : 1;
  const auto project = [](const Vec3& p)
  {
    const Vec3 n = Normalized(p);
    return RadiusAndGradient(n, nullptr) * n;
  };
  foot = project(point);
  for (int i = 0; i < MaximumIterations; ++i)
  {
    Vec3 gradient;
    Implicit(foot, &gradient);
    normal = Normalized(gradient);
    const Vec3 offset = point - foot;
    const Vec3 tangential = offset - Dot(offset, normal) * normal;
    if (Norm(tangential) < Tolerance)
    {
      break;
    }
    foot = project(foot + tangential);
  }
  return side * Norm(point - foot);
}

double SkullSurface::Intersect(const Vec3& origin, const Vec3& direction)
{
  constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();
  constexpr double SmallestStep = 1e-4;
  const double length = Norm(direction);
  if (!IsFinite(origin) || !std::isfinite(length) || !(length > 0))
  {
    return Nothing;
  }
  const Vec3 unit = (1 / length) * direction;
  // The part of the ray within the circumscribed sphere.
  const double b = -Dot(origin, unit);
  const Vec3 nearest = origin + b * unit;
  const double half = MaximumRadius * MaximumRadius - Dot(nearest, nearest);
  if (!(half > 0) || b + std::sqrt(half) < 0)
  {
    return Nothing;
  }
  const double last = b + std::sqrt(half);
  double t = std::max(0.0, b - std::sqrt(half));
  const auto implicit = [&](double s) { return Implicit(origin + s * unit); };
  double value = implicit(t);
  // Outside, a distance is at least value / MaximumSlope; inside, the sphere of MinimumRadius is
  // free, and between it and the surface the slope is below 2 MaximumSlope.
  const auto safeStep = [&](double s, double v)
  {
    if (v > 0)
    {
      return std::max(SmallestStep, v / MaximumSlope);
    }
    const double free = MinimumRadius - Norm(origin + s * unit);
    return std::max({ SmallestStep, free, -v / (2 * MaximumSlope) });
  };
  if (value == 0)
  {
    return t;
  }
  const bool inside = value < 0;
  double next = t;
  double nextValue = value;
  do
  {
    t = next;
    value = nextValue;
    if (t > last)
    {
      return Nothing;
    }
    next = t + safeStep(t, value);
    nextValue = implicit(next);
  } while ((nextValue < 0) == inside);

  // The crossing lies between t and next: bisection cannot fail, and 60 halvings reach rounding.
  for (int i = 0; i < 60 && next - t > 1e-13 * std::max(1.0, next); ++i)
  {
    const double middle = 0.5 * (t + next);
    if ((implicit(middle) < 0) == inside)
    {
      t = middle;
    }
    else
    {
      next = middle;
    }
  }
  return 0.5 * (t + next);
}

//------------------------------------------------------------------------------
namespace
{
// Hounsfield units of the tissues. Scalp and outer table lie evenly about 500.
constexpr double Air = -1000;
constexpr double Scalp = 0;
constexpr double Cortical = 1000;
constexpr double Diploe = 600;
constexpr double DiploeTexture = 80;
constexpr double Brain = 35;

constexpr double ScalpThickness = 6;
constexpr double OuterTable = 2;
constexpr double InnerTable = 1.5;
constexpr double DeepestBone = OuterTable + 4.4 + InnerTable;

// The box of the head with its scalp and 3 mm of air, relative to the centre.
constexpr Vec3 Lowest{ { -83, -101, -71 } };
constexpr Vec3 Highest{ { 85, 102, 80 } };

double DiploeThickness(const Vec3& direction)
{
  return 3.4 + 0.6 * direction[1] + 0.4 * direction[2];
}

// A jagged line: a triangle wave of height 1 and period 1.
double Jagged(double x)
{
  return 4 * std::abs(x - std::floor(x + 0.5)) - 1;
}

// Distance (mm, first order) of a point of the calvarium from the nearest suture, relative to the centre.
double SutureDistance(const Vec3& p)
{
  constexpr double Bregma = -28, Lambda = 58; // y of the sagittal suture's ends
  constexpr double Teeth = 1.6, Period = 9;
  if (p[2] < 0)
  {
    return std::numeric_limits<double>::infinity();
  }
  const double side = std::abs(p[0]);
  const double coronal = std::abs(
    p[1] - (Bregma - 0.12 * side) - Teeth * Jagged(p[0] / Period + 0.3)); // from ear to ear
  double distance = coronal;
  if (p[1] > Bregma && p[1] < Lambda)
  {
    distance = std::min(distance, std::abs(p[0] - Teeth * Jagged(p[1] / Period)));
  }
  const double lambdoid = Lambda - 0.35 * side + Teeth * Jagged(p[0] / Period + 0.6);
  distance = std::min(distance, std::abs(p[1] - lambdoid));
  return distance;
}

// A spongy look with a period of about 9 mm.
double DiploeLevel(const Vec3& p)
{
  return Diploe +
    DiploeTexture * std::sin(0.71 * p[0]) * std::sin(0.63 * p[1] + 1) * std::sin(0.67 * p[2] + 2);
}
}

// What is at a point, as jumps at the boundaries that have been crossed so far, 0 to 1 each.
struct Skull::Layers
{
  double Scalp;
  double Bone;
  double Diploe;
  double Inner;
  double Brain;
  double DiploeLevel;
  double Suture; ///< distance from the nearest one along the surface, mm

  double Intact() const
  {
    return Air + (lacuna::Scalp - Air) * this->Scalp + (Cortical - lacuna::Scalp) * this->Bone +
      (this->DiploeLevel - Cortical) * (this->Diploe - this->Inner) +
      (lacuna::Brain - Cortical) * this->Brain;
  }
  double WithoutBone() const
  {
    return Air + (lacuna::Scalp - Air) * this->Scalp +
      (lacuna::Brain - lacuna::Scalp) * this->Brain;
  }
};

void Skull::Parameters::Describe(Properties& properties) const
{
  properties.Add("Spacing", this->Spacing.Elements, ValueRange::Above(0, "mm").UpTo(5))
    .Add("DefectRadius", this->DefectRadius,
      ValueRange::Above(0, "mm").UpTo(MaximumDefectRadius).OrZero("intact skull"))
    .Add("DefectDirection", this->DefectDirection.Elements, ValueRange::Any())
    .Add("NoiseLevel", this->NoiseLevel, ValueRange::Between(0, 1e4, "HU"))
    .Add("Seed", static_cast<std::int64_t>(this->Seed)) // as given: below 0, too
    .Add("Sutures", this->Sutures)
    .Add("Center", this->Center.Elements, ValueRange::Between(-1e6, 1e6, "mm"));
}

Skull::Skull(const Parameters& parameters)
  : P(parameters)
{
  Properties properties;
  this->P.Describe(properties);
  properties.Check();
  const double length = Norm(this->P.DefectDirection);
  if (!std::isfinite(length) || !(length > 0))
  {
    throw std::invalid_argument("DefectDirection is " +
      FormatValue(this->P.DefectDirection.Elements) +
      "; its length must be above 0, for example 0,0,1 for the vertex");
  }
  this->Axis = (1 / length) * this->P.DefectDirection;
  // psi is counted from the patient's left (from anterior when the axis itself points sideways).
  const Vec3 from = std::abs(this->Axis[0]) < 0.9 ? Vec3{ 1, 0, 0 } : Vec3{ 0, -1, 0 };
  this->Side1 = Normalized(from - Dot(from, this->Axis) * this->Axis);
  this->Side2 = Cross(this->Axis, this->Side1);
}

Vec3 Skull::GetOrigin() const
{
  return this->P.Center + Lowest;
}

std::array<int, 3> Skull::GetDimensions() const
{
  std::array<int, 3> dimensions;
  for (int i = 0; i < 3; ++i)
  {
    const double intervals = (Highest[i] - Lowest[i]) / this->P.Spacing[i];
    // Beyond this no memory suffices, and the number of voxels must stay a number.
    dimensions[i] = static_cast<int>(std::min(std::ceil(intervals - 1e-9), 1e9)) + 1;
  }
  return dimensions;
}

double Skull::BlurWidth(const Vec3& normal) const
{
  double square = 0;
  for (int i = 0; i < 3; ++i)
  {
    const double shadow = normal[i] * this->P.Spacing[i];
    square += shadow * shadow;
  }
  return std::sqrt(28.0 / 12 * square);
}

Skull::Layers Skull::Resolve(const Vec3& point) const
{
  const Vec3 p = point - this->P.Center;
  const double widest =
    this->BlurWidth({ 1, 1, 1 }); // no unit normal gives more than all axes together
  const double value = SkullSurface::Implicit(p);
  constexpr double none = std::numeric_limits<double>::infinity();
  if (value > SkullSurface::MaximumSlope * (ScalpThickness + 0.5 * widest))
  {
    return { 0, 0, 0, 0, 0, Diploe, none };
  }
  if (value < -1.5 * (DeepestBone + 0.5 * widest))
  {
    return { 1, 1, 1, 1, 1, Diploe, none };
  }
  Vec3 foot;
  Vec3 normal;
  const double d = SkullSurface::SignedDistance(p, foot, normal);
  const double width = this->BlurWidth(normal);
  const double diploe = DiploeThickness(Normalized(foot));
  const auto crossed = [&](double depth) { return SmoothStep(-d - depth, width); };
  const double inner = OuterTable + diploe;
  return { crossed(-ScalpThickness), crossed(0), crossed(OuterTable), crossed(inner),
    crossed(inner + InnerTable), DiploeLevel(p), this->P.Sutures ? SutureDistance(foot) : none };
}

double Skull::DefectDepth(const Vec3& point, Vec3& normal) const
{
  const Vec3 p = point - this->P.Center;
  if (!(this->P.DefectRadius > 0) || !(Dot(p, this->Axis) > 0))
  {
    return -std::numeric_limits<double>::infinity();
  }
  const double x = Dot(p, this->Side1);
  const double y = Dot(p, this->Side2);
  const double rho = std::max(std::hypot(x, y), 1e-9);
  const double psi = std::atan2(y, x);
  const double outline = this->P.DefectRadius *
    (1 + 0.12 * std::cos(2 * psi + 0.5) + 0.08 * std::cos(3 * psi - 1.1) +
      0.04 * std::cos(5 * psi + 2.0));
  const double slope = -this->P.DefectRadius *
    (0.24 * std::sin(2 * psi + 0.5) + 0.24 * std::sin(3 * psi - 1.1) +
      0.20 * std::sin(5 * psi + 2.0));
  // Gradient of rho - outline(psi): radial part 1, tangential part -slope / rho; near the axis the
  // latter says nothing about the far outline.
  const double tangential = -slope / std::max(rho, 0.5 * this->P.DefectRadius);
  const double length = std::hypot(1, tangential);
  const double cosine = x / rho;
  const double sine = y / rho;
  normal = (1 / length) *
    ((cosine - tangential * sine) * this->Side1 + (sine + tangential * cosine) * this->Side2);
  return (outline - rho) / length;
}

bool Skull::IsInDefect(const Vec3& point) const
{
  Vec3 normal;
  return this->DefectDepth(point, normal) > 0;
}

double Skull::WithSutures(const Layers& layers) const
{
  constexpr double HalfWidth = 0.7, Share = 0.9;
  const double intact = layers.Intact();
  const double outer = layers.Bone - layers.Inner;
  if (!(outer > 0) || !std::isfinite(layers.Suture))
  {
    return intact;
  }
  const double inside =
    SmoothStep(HalfWidth - layers.Suture, this->BlurWidth(Normalized({ 1, 1, 1 })));
  return intact + Share * inside * outer * (layers.WithoutBone() - intact);
}

double Skull::IntactValue(const Vec3& point) const
{
  return this->WithSutures(this->Resolve(point));
}

double Skull::Value(const Vec3& point) const
{
  const Layers layers = this->Resolve(point);
  const double intact = this->WithSutures(layers);
  if (layers.Bone == 0 || layers.Brain == 1)
  {
    return intact; // no bone here
  }
  Vec3 normal;
  const double depth = this->DefectDepth(point, normal);
  if (!std::isfinite(depth))
  {
    return intact;
  }
  const double removed = SmoothStep(depth, this->BlurWidth(normal));
  return intact + removed * (layers.WithoutBone() - intact);
}

double Skull::IntersectOuterSurface(const Vec3& origin, const Vec3& direction) const
{
  return SkullSurface::Intersect(origin - this->P.Center, direction);
}

void Skull::Sample(Execution& execution, const Extent& extent, short* voxels) const
{
  const std::array<int, 3> dimensions = this->GetDimensions();
  const Vec3 origin = this->GetOrigin();
  const std::int64_t columns = extent[1] - extent[0] + 1;
  const std::int64_t rows = extent[3] - extent[2] + 1;
  const std::int64_t slices = extent[5] - extent[4] + 1;
  const CounterNoise noise(this->P.Seed, 0);
  constexpr std::int64_t RowsPerTask = 16;
  execution.For(rows * slices, RowsPerTask,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        const std::int64_t j = extent[2] + r % rows;
        const std::int64_t k = extent[4] + r / rows;
        for (std::int64_t i = 0; i < columns; ++i)
        {
          const std::int64_t column = extent[0] + i;
          double value = this->Value({ origin[0] + this->P.Spacing[0] * static_cast<double>(column),
            origin[1] + this->P.Spacing[1] * static_cast<double>(j),
            origin[2] + this->P.Spacing[2] * static_cast<double>(k) });
          if (this->P.NoiseLevel > 0)
          {
            value +=
              this->P.NoiseLevel * noise.Normal((k * dimensions[1] + j) * dimensions[0] + column);
          }
          voxels[r * columns + i] =
            static_cast<short>(std::clamp(std::floor(value + 0.5), -32768.0, 32767.0));
        }
      }
    });
}
}
