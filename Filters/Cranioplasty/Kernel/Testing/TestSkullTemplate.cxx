// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullTemplate.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace lacunaSkullTest;
using lacuna::Matrix4;
using lacuna::RayRadii;
using lacuna::SkullEstimate;
using lacuna::SkullRays;
using lacuna::SkullShape;
using lacuna::TemplateFit;

namespace
{
constexpr std::size_t FewNodes = 300; // of the likelihood
const Vec3 Bump = lacuna::Normalized({ 1, -0.3, 0.4 });

using Radius = std::function<double(const Vec3& direction)>;

// A vault whose outer table is a function of the direction, turned, shifted and scaled.
class Shell : public lacuna::SkullShell
{
public:
  Shell(Radius outer, const Matrix4& ownToShell, double lowest = -0.35)
    : Outer(std::move(outer))
    , ShellToOwn(ownToShell.Inverse())
    , Middle(ownToShell.Column(3))
    , Lowest(lowest)
  {
  }
  RayRadii Trace(
    const Vec3& center, const std::vector<Vec3>& directions, lacuna::Execution&) const override
  {
    RayRadii radii;
    radii.Inner.assign(directions.size(), std::numeric_limits<double>::quiet_NaN());
    for (const Vec3& d : directions)
    {
      // towards where a point is on the surface, seen from the shell's own middle
      const Vec3 way = this->ShellToOwn.Vector(d);
      double radius = 90;
      Vec3 seen{};
      for (int step = 0; step < 12; ++step)
      {
        const Vec3 x = this->ShellToOwn.Point(center + radius * d);
        seen = lacuna::Normalized(x);
        radius += (this->Outer(seen) - Norm(x)) / Dot(way, seen);
      }
      radii.Outer.push_back(seen[2] < this->Lowest || !(radius > 0)
          ? std::numeric_limits<double>::quiet_NaN()
          : radius);
    }
    return radii;
  }
  Vec3 GetMiddle(lacuna::Execution&) const override { return this->Middle + Vec3{ 5, -4, 3 }; }

private:
  Radius Outer;
  Matrix4 ShellToOwn;
  Vec3 Middle;
  double Lowest;
};

Matrix4 Elsewhere(double scale)
{
  return Matrix4::Translation({ 40, -300, 70 }) * Matrix4::Rotation({ 1, -2, 0.5 }, 2.3) *
    Matrix4::Scaling({ scale, scale, scale });
}

SkullRays RaysOf(const Patient& patient)
{
  SkullRays rays;
  rays.Center = patient.Bone.Center;
  rays.Spacing = 3.5 / 80;
  for (const Vec3& d : Spread(3.5))
  {
    rays.Directions.push_back(patient.OwnToWorld.Vector(d));
  }
  return rays;
}

double OuterOf(const Vec3& d)
{
  static const Skull skull;
  return skull.GetOuter(d);
}

// What is predicted of the missing part; factor gets how far the template counts.
std::vector<SkullEstimate> Fill(
  const Patient& patient, const lacuna::SkullShell* shell, double* factor = nullptr)
{
  lacuna::ThreadExecution execution(2);
  SkullRays placed;
  if (shell)
  {
    const TemplateFit fit = FitTemplate(*shell, patient.Bone, execution);
    placed = PlaceTemplate(*shell, fit, RaysOf(patient), execution);
  }
  const SkullShape shape(
    patient.Bone, patient.Defect, patient.Plane, execution, shell ? &placed : nullptr, FewNodes);
  if (factor)
  {
    *factor = shape.GetOuterFactor();
  }
  return shape.Predict(patient.Defect, execution);
}
}

TEST(SkullTemplate, LiesWhereItBelongs)
{
  const Patient patient({ 0.2, 0.1, 0.9 }, 0.5,
    Matrix4::Translation({ 5, 20, -90 }) * Matrix4::Rotation({ 0.3, 1, 0.2 }, 0.8));
  const Shell shell(OuterOf, Elsewhere(0.9));
  lacuna::ThreadExecution execution(2);
  const TemplateFit fit = FitTemplate(shell, patient.Bone, execution);
  EXPECT_NEAR(fit.Scale, 1 / 0.9, 1e-4);
  EXPECT_LT(fit.RMS, 0.01);
  EXPECT_GT(fit.Covered, 0.99);
  const SkullRays rays = RaysOf(patient);
  const SkullRays placed = PlaceTemplate(shell, fit, rays, execution);
  const Matrix4 toOwn = patient.OwnToWorld.Inverse();
  int sound = 0;
  double largest = 0;
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    if (placed.Kinds[i] == lacuna::SkullRayKind::Sound)
    {
      ++sound;
      const double truth = OuterOf(toOwn.Vector(rays.Directions[i]));
      largest = std::max(largest, std::abs(placed.Outer[i] - truth));
    }
  }
  EXPECT_GT(sound, 0.5 * rays.Directions.size());
  EXPECT_LT(largest, 0.02);
}

TEST(SkullTemplate, IsNeverMirrored)
{
  const Patient patient({ 0.2, 0.1, 0.9 }, 0.5);
  const Shell mirrored([](const Vec3& d) { return OuterOf({ -d[0], d[1], d[2] }); }, Elsewhere(1));
  lacuna::ThreadExecution execution(2);
  const TemplateFit fit = FitTemplate(mirrored, patient.Bone, execution);
  EXPECT_GT(fit.TemplateToSkull.Determinant3(), 0);
  SkullRays rays = RaysOf(patient);
  const SkullRays placed = PlaceTemplate(mirrored, fit, rays, execution);
  // the bump of the left temple is on the template's right
  double sides[] = { 0, 0 };
  double counts[] = { 0, 0 };
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    const Vec3& d = rays.Directions[i];
    const Vec3 opposite{ -d[0], d[1], d[2] };
    for (int side = 0; side < 2; ++side)
    {
      if (Dot(side == 0 ? d : opposite, Bump) > 0.985)
      {
        sides[side] += placed.Outer[i];
        counts[side] += 1;
      }
    }
  }
  EXPECT_GT(sides[1] / counts[1] - sides[0] / counts[0], 0.7);
  // and the patient's stays where it is, of which the sound bone shows a part
  const Patient temple(Bump, 0.35);
  const Score with = RateOuter(temple, Fill(temple, &mirrored));
  EXPECT_LT(with.RMS, 0.2);
}

TEST(SkullTemplate, FillsWhatHasNoOtherSide)
{
  const Patient patient({ 0, 0.3, 0.95 }, 0.6);
  const Shell shell(OuterOf, Elsewhere(1.1));
  double factor = 0;
  const Score without = RateOuter(patient, Fill(patient, nullptr));
  const Score with = RateOuter(patient, Fill(patient, &shell, &factor));
  EXPECT_GT(factor, 0.5);
  EXPECT_LT(factor, 2); // what is made smooth is smaller
  EXPECT_LT(with.RMS, 0.6 * without.RMS);
  EXPECT_LT(with.Predicted, 0.8 * without.Predicted);
  EXPECT_GT(with.Inside, without.Inside - 0.1);
}

TEST(SkullTemplate, DoesNoHarm)
{
  const Patient patient({ 0, 0.3, 0.95 }, 0.6);
  const std::vector<SkullEstimate> without = Fill(patient, nullptr);
  double factor = 1;
  const Shell ball([](const Vec3&) { return 85; }, Elsewhere(1), -0.9);
  const std::vector<SkullEstimate> same = Fill(patient, &ball, &factor);
  EXPECT_EQ(factor, 0);
  for (std::size_t i = 0; i < same.size(); ++i)
  {
    EXPECT_EQ(same[i].Outer, without[i].Outer);
    EXPECT_EQ(same[i].Thickness, without[i].Thickness);
  }
  // another shape, with a step
  const Waves waves(7, 25, 70);
  const Shell other(
    [&](const Vec3& d) {
      return 1.15 * OuterOf({ d[1], -d[0], d[2] }) + 2 * waves(80 * d) + (d[1] > 0.3 ? 3 : 0);
    },
    Elsewhere(1));
  const Score before = RateOuter(patient, without);
  const Score after = RateOuter(patient, Fill(patient, &other));
  EXPECT_LT(after.RMS, 1.05 * before.RMS);
  EXPECT_GT(after.Inside, before.Inside - 0.02);
}

TEST(SkullTemplate, HasToHaveAVault)
{
  const Patient patient({ 0, 0.3, 0.95 }, 0.6);
  lacuna::ThreadExecution execution(1);
  EXPECT_THROW(FitTemplate(Shell(OuterOf, Elsewhere(1), 0.999), patient.Bone, execution),
    std::invalid_argument);
  EXPECT_THROW(
    FitTemplate(Shell(OuterOf, Elsewhere(0.001)), patient.Bone, execution), std::invalid_argument);
}
