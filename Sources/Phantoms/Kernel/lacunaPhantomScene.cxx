// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPhantomScene.h"

#include "lacunaMatrix4.h"
#include "lacunaSmoothStep.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;

// Outside of its sphere a primitive contributes exactly nothing: a row skips it there.
struct Sphere
{
  Vec3 Center;
  double Radius;
};

// Calls body(j, point) for the points of the row that may lie in the sphere, j counted from first.
template <class Body>
void ForRowInSphere(
  const Sphere& sphere, const Vec3& start, const Vec3& step, int first, int count, Body&& body)
{
  int begin = 0;
  int end = count;
  const Vec3 toCenter = sphere.Center - start;
  const double a = Dot(step, step);
  if (a > 0)
  {
    const double b = Dot(toCenter, step) / a;
    const double discriminant =
      b * b - (Dot(toCenter, toCenter) - sphere.Radius * sphere.Radius) / a;
    if (!(discriminant >= 0))
    {
      return;
    }
    // One point more on either side makes up for rounding.
    const double half = std::sqrt(discriminant);
    begin = static_cast<int>(std::clamp(b - half - first - 1, 0.0, static_cast<double>(count)));
    end = static_cast<int>(std::clamp(b + half - first + 2, 0.0, static_cast<double>(count)));
  }
  for (int j = begin; j < end; ++j)
  {
    body(j, start + static_cast<double>(first + j) * step);
  }
}

// A tilted ellipsoid with a smooth edge.
class Ellipsoid
{
public:
  Ellipsoid(const Vec3& center, const Vec3& radii, const Matrix4& rotation, double width)
    : Center(center)
    , Width(width)
  {
    const double smallest = std::min({ radii[0], radii[1], radii[2] });
    const double largest = std::max({ radii[0], radii[1], radii[2] });
    for (int i = 0; i < 3; ++i)
    {
      this->Rows[i] = (1 / radii[i]) * rotation.Column(i);
      this->InverseSquares[i] = 1 / (radii[i] * radii[i]);
    }
    // |gradient of rho| lies between 1/largest and 1/smallest: beyond these rho the step is over.
    const double lower = std::max(0.0, 1 - 0.5 * width / smallest);
    const double upper = 1 + 0.5 * width / smallest;
    this->LowerSquare = lower * lower;
    this->UpperSquare = upper * upper;
    this->Bounds = { center, largest * upper };
  }

  const Sphere& GetBounds() const { return this->Bounds; }

  // Share of the ellipsoid at a point, 0 to 1.
  double Occupancy(const Vec3& point) const
  {
    const Vec3 p = point - this->Center;
    double square = 0;
    double slope = 0;
    for (int i = 0; i < 3; ++i)
    {
      const double q = Dot(this->Rows[i], p);
      square += q * q;
      slope += q * q * this->InverseSquares[i];
    }
    if (square >= this->UpperSquare)
    {
      return 0;
    }
    if (square <= this->LowerSquare)
    {
      return 1;
    }
    const double rho = std::sqrt(square);
    return SmoothStep((1 - rho) * rho / std::sqrt(slope), this->Width);
  }

private:
  Vec3 Center;
  double Width;
  Vec3 Rows[3];
  double InverseSquares[3];
  double LowerSquare;
  double UpperSquare;
  Sphere Bounds;
};

class EllipsoidScene : public PhantomScene
{
public:
  explicit EllipsoidScene(double width)
  {
    const Matrix4 tilt = Matrix4::Rotation({ 0, 0, 1 }, 20 * Pi / 180) *
      Matrix4::Rotation({ 0, 1, 0 }, -15 * Pi / 180);
    const Matrix4 other = Matrix4::Rotation({ 1, 0, 0 }, 35 * Pi / 180) *
      Matrix4::Rotation({ 0, 0, 1 }, -25 * Pi / 180);
    const Vec3 main{ -3, 2, 1 };
    this->Add(120, main, MainRadii, tilt, width);
    this->Add(60, main + tilt.Vector({ 6, 2, -4 }), { 4, 3, 3.5 }, other, width);
    this->Add(-40, main + tilt.Vector({ -6, -2, 4 }), { 4.5, 3, 4 }, tilt, width);
    this->Add(-40, { 18, -13, 12 }, { 6, 5, 5 }, other, width);
    this->Add(40, { -20, -14, -14 }, { 5, 6, 4 }, tilt, width);
    this->Add(-25, { 17, 14, -13 }, { 7, 4, 4 }, tilt, width);
  }

  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override
  {
    std::fill(values, values + count, Background);
    for (const Part& part : this->Parts)
    {
      ForRowInSphere(part.Shape.GetBounds(), start, step, first, count,
        [&](int j, const Vec3& p) { values[j] += part.Contrast * part.Shape.Occupancy(p); });
    }
  }

  double IsoValue() const override { return Background + 60; }
  double TrueVolume() const override
  {
    return 4 * Pi / 3 * MainRadii[0] * MainRadii[1] * MainRadii[2];
  }

private:
  static constexpr double Background = 60;
  static constexpr Vec3 MainRadii{ { 17, 12, 15 } };

  struct Part
  {
    double Contrast;
    Ellipsoid Shape;
  };

  void Add(
    double contrast, const Vec3& center, const Vec3& radii, const Matrix4& rotation, double width)
  {
    this->Parts.push_back({ contrast, Ellipsoid(center, radii, rotation, width) });
  }

  std::vector<Part> Parts;
};

// ((x - bend_x)/(a t))^2 + ((y - bend_y)/(b t))^2 + zeta^2 = 1 with zeta = z / length, taper
// t = 1 + 0.2 zeta: the bend is a space curve, so no plane of symmetry is left.
class KumaraScene : public PhantomScene
{
public:
  explicit KumaraScene(double width)
    : Width(width)
  {
  }

  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override
  {
    std::fill(values, values + count, Water);
    ForRowInSphere({ { 0, 0, 0 }, 115 }, start, step, first, count,
      [&](int j, const Vec3& p)
      {
        const double d = this->Depth(p);
        values[j] += (Skin - Water) * SmoothStep(d, this->Width) -
          (Skin - Flesh) * SmoothStep(d - SkinThickness, this->Width);
      });
  }

  double IsoValue() const override { return 0.5 * (Water + Skin); }
  double TrueVolume() const override
  {
    // Sections are ellipses of area pi a b t^2 (1 - zeta^2); bending moves them and no more.
    return Pi * RadiusX * RadiusY * HalfLength * (4.0 / 3 + Taper * Taper * 4 / 15);
  }

private:
  static constexpr double Water = 20;
  static constexpr double Skin = 200;
  static constexpr double Flesh = 150;
  static constexpr double SkinThickness = 4;
  static constexpr double HalfLength = 95;
  static constexpr double RadiusX = 38.75;
  static constexpr double RadiusY = 43;
  static constexpr double Taper = 0.2;
  static constexpr double BendX = 16;
  static constexpr double BendY = 9;

  // First-order distance below the surface, mm; positive inside.
  double Depth(const Vec3& p) const
  {
    constexpr double Far = 1000;
    const double zeta = p[2] / HalfLength;
    if (std::abs(zeta) > 1.2)
    {
      return -Far;
    }
    const double t = 1 + Taper * zeta;
    const double x = p[0] - BendX * (zeta * zeta - 0.06);
    const double y = p[1] - BendY * zeta * (1 - zeta * zeta);
    const double u = x / (RadiusX * t);
    const double v = y / (RadiusY * t);
    const double square = u * u + v * v + zeta * zeta;
    if (square < 0.25)
    {
      return Far;
    }
    const double rho = std::sqrt(square);
    const double gx = u / (RadiusX * t);
    const double gy = v / (RadiusY * t);
    const double gz = (zeta - gx * 2 * BendX * zeta - gy * BendY * (1 - 3 * zeta * zeta) -
                        (u * u + v * v) * Taper / t) /
      HalfLength;
    return (1 - rho) * rho / std::sqrt(gx * gx + gy * gy + gz * gz);
  }

  double Width;
};

// A tube around a circular arc, tapered evenly along it, with round ends.
class Tube
{
public:
  struct Shape
  {
    Vec3 Bend;        // towards the centre of curvature
    double Curvature; // radius of curvature, mm
    double Length;    // mm
    double Radius;    // at the end, mm
  };

  Tube(const Vec3& start, const Vec3& tangent, double startRadius, const Shape& shape, double width)
    : Curvature(shape.Curvature)
    , StartRadius(startRadius)
    , EndRadius(shape.Radius)
    , Width(width)
    , HalfAngle(0.5 * shape.Length / shape.Curvature)
    , CosHalf(std::cos(this->HalfAngle))
    , SinHalf(std::sin(this->HalfAngle))
  {
    const Vec3 normal = Normalized(shape.Bend - Dot(shape.Bend, tangent) * tangent);
    this->Center = start + this->Curvature * normal;
    this->Middle = this->SinHalf * tangent - this->CosHalf * normal;
    this->Across = this->CosHalf * tangent + this->SinHalf * normal;
    this->Binormal = Cross(this->Middle, this->Across);
    const double angle = 2 * this->HalfAngle;
    this->End =
      this->Center + this->Curvature * (std::sin(angle) * tangent - std::cos(angle) * normal);
    this->EndTangent = std::cos(angle) * tangent + std::sin(angle) * normal;
    const double sagitta = this->Curvature * (1 - this->CosHalf);
    this->Bounds.Center = this->Center + (this->Curvature - 0.5 * sagitta) * this->Middle;
    this->Bounds.Radius = std::hypot(this->Curvature * this->SinHalf, 0.5 * sagitta) +
      std::max(this->StartRadius, this->EndRadius) + 0.5 * width;
  }

  // The next one starts here.
  Tube Continue(const Shape& shape) const
  {
    return Tube(this->End, this->EndTangent, this->EndRadius, shape, this->Width);
  }

  const Sphere& GetBounds() const { return this->Bounds; }

  // Share of the tube at a point, 0 to 1, from the exact distance to the arc.
  double Occupancy(const Vec3& point) const
  {
    const Vec3 p = point - this->Center;
    const double u = Dot(p, this->Middle);
    const double v = Dot(p, this->Across);
    const double w = Dot(p, this->Binormal);
    const double outwards = std::abs(v);
    double inPlane;
    double along;
    if (outwards * this->CosHalf <= u * this->SinHalf)
    {
      const double d = std::sqrt(u * u + v * v) - this->Curvature;
      inPlane = d * d;
      along = std::atan2(v, u) / this->HalfAngle;
    }
    else
    {
      const double du = u - this->Curvature * this->CosHalf;
      const double dv = outwards - this->Curvature * this->SinHalf;
      inPlane = du * du + dv * dv;
      along = v < 0 ? -1 : 1;
    }
    const double radius =
      this->StartRadius + 0.5 * (1 + along) * (this->EndRadius - this->StartRadius);
    return SmoothStep(radius - std::sqrt(inPlane + w * w), this->Width);
  }

private:
  double Curvature;
  double StartRadius;
  double EndRadius;
  double Width;
  double HalfAngle;
  double CosHalf;
  double SinHalf;
  Vec3 Center;
  Vec3 Middle;
  Vec3 Across;
  Vec3 Binormal;
  Vec3 End;
  Vec3 EndTangent;
  Sphere Bounds;
};

class VesselScene : public PhantomScene
{
public:
  explicit VesselScene(double width)
  {
    this->Tubes.emplace_back(Vec3{ -10, 9, -18 }, Normalized({ 0.25, -0.3, 1 }), 4.2,
      Tube::Shape{ { 0.3, -1, 0 }, 70, 13, 4.0 }, width);
    // At every fork r0^3 = r1^3 + r2^3; both branches leave along the parent and bend away.
    this->Fork(0, { { 1, 0.15, 0 }, 20, 16, 3.3 }, { { -1, -0.5, 0.1 }, 24, 15, 3.035 });
    this->Fork(1, { { 0.4, 1, 0.1 }, 18, 12, 2.7 }, { { 0.3, -1, 0.4 }, 16, 13, 2.536 });
    this->Fork(2, { { -0.2, -1, 0.2 }, 18, 12, 2.45 }, { { -0.3, 1, 0.5 }, 22, 13, 2.365 });
    this->Fork(3, { { -1, 0.2, 0.6 }, 15, 11, 2.25 }, { { 1, 0.3, -0.2 }, 18, 8, 2.022 });
  }

  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override
  {
    // The union: what the fullest tube takes of a point. So the surface of the tree does not depend
    // on the width of the edges.
    std::fill(values, values + count, 0.0);
    for (const Tube& tube : this->Tubes)
    {
      ForRowInSphere(tube.GetBounds(), start, step, first, count,
        [&](int j, const Vec3& p) { values[j] = std::max(values[j], tube.Occupancy(p)); });
    }
    for (int j = 0; j < count; ++j)
    {
      values[j] = Tissue + (Fluid - Tissue) * values[j];
    }
  }

  double IsoValue() const override { return 0.5 * (Fluid + Tissue); }

private:
  static constexpr double Fluid = 25;
  static constexpr double Tissue = 150;

  void Fork(std::size_t parent, const Tube::Shape& shape1, const Tube::Shape& shape2)
  {
    const Tube from = this->Tubes[parent];
    this->Tubes.push_back(from.Continue(shape1));
    this->Tubes.push_back(from.Continue(shape2));
  }

  std::vector<Tube> Tubes;
};

class LinearScene : public PhantomScene
{
public:
  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override
  {
    for (int j = 0; j < count; ++j)
    {
      const Vec3 p = start + static_cast<double>(first + j) * step;
      values[j] = 130 + 1.25 * p[0] + 1.5 * p[1] - p[2];
    }
  }
};
}

double PhantomScene::IsoValue() const
{
  return std::numeric_limits<double>::quiet_NaN();
}

double PhantomScene::TrueVolume() const
{
  return std::numeric_limits<double>::quiet_NaN();
}

std::unique_ptr<PhantomScene> MakePhantomScene(Anatomy anatomy, double edgeWidth)
{
  EdgeWidths.Check("EdgeWidth", edgeWidth);
  switch (anatomy)
  {
    case Anatomy::Ellipsoids:
      return std::make_unique<EllipsoidScene>(edgeWidth);
    case Anatomy::Kumara:
      return std::make_unique<KumaraScene>(edgeWidth);
    case Anatomy::Vessels:
      return std::make_unique<VesselScene>(edgeWidth);
    case Anatomy::Linear:
      return std::make_unique<LinearScene>();
  }
  Choices(AnatomyNames).Check("Anatomy", static_cast<int>(anatomy)); // throws
  return nullptr;
}
}
