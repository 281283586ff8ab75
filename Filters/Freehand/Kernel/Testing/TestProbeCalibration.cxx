// SPDX-License-Identifier: BSD-3-Clause
/// Probes of known position are found again, as exactly as the picks allow, and what the result says
/// about its own error is true.
#include "lacunaProbeCalibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
using Target = CalibrationTarget;
const Target Wires[3] = { Target::WireX, Target::WireY, Target::WireZ };

// An image of 90 x 72 mm on a probe, before a phantom, all of them anywhere.
class Scene
{
public:
  static constexpr double Width = 600, Height = 480;
  Vec2 Spacing{ 0.15, 0.15 };
  Matrix4 ImageToProbe;
  std::vector<CalibrationPick> Picks;

  explicit Scene(unsigned seed, Vec2 spacing = { 0.15, 0.15 })
    : Spacing(spacing)
    , Random(seed)
  {
    this->ScanToProbe = Matrix4::Translation(this->Vector(100)) * this->Turn(180);
    this->ImageToProbe = this->ScanToProbe * Matrix4::Scaling({ spacing[0], spacing[1], 1 });
    this->PhantomToTracker = Matrix4::Translation(this->Vector(300)) * this->Turn(180);
  }

  double Uniform(double a, double b)
  {
    return std::uniform_real_distribution<double>(a, b)(this->Random);
  }
  double Normal(double spread) { return std::normal_distribution<double>(0, spread)(this->Random); }
  Vec3 Vector(double size)
  {
    return { this->Uniform(-size, size), this->Uniform(-size, size), this->Uniform(-size, size) };
  }
  Matrix4 Turn(double degrees)
  {
    Vec3 axis = this->Vector(1);
    while (Norm(axis) < 0.1 || Norm(axis) > 1)
    {
      axis = this->Vector(1);
    }
    return Matrix4::Rotation(axis, this->Uniform(-degrees, degrees) * Degree);
  }
  // A turn for which accept holds.
  Matrix4 TurnThat(const std::function<bool(const Matrix4&)>& accept)
  {
    Matrix4 turn = this->Turn(180);
    while (!accept(turn))
    {
      turn = this->Turn(180);
    }
    return turn;
  }

  // A slice, turned so in the phantom, in which a point of it is seen at a pixel, picked beside it.
  void Pick(Target target, const Vec3& point, const Matrix4& turn, const Vec2& error)
  {
    const Vec2 pixel{ this->Uniform(0, Width), this->Uniform(0, Height) };
    const Vec3 arm = turn.Vector({ this->Spacing[0] * pixel[0], this->Spacing[1] * pixel[1], 0 });
    const Matrix4 scanToPhantom = Matrix4::Translation(point - arm) * turn;
    this->Picks.push_back({ this->PhantomToTracker * scanToPhantom * this->ScanToProbe.Inverse(),
      { pixel[0] + error[0] / this->Spacing[0], pixel[1] + error[1] / this->Spacing[1] }, target });
  }

  // The slice within so many degrees of a right angle to the wire.
  void PickWire(int wire, const Vec2& error, double tilt = 50)
  {
    Vec3 point{ 0, 0, 0 };
    point[wire] = this->Uniform(-60, 60);
    const Matrix4 turn = this->TurnThat(
      [&](const Matrix4& m) { return std::abs(m(wire, 2)) > std::cos(tilt * Degree); });
    this->Pick(Wires[wire], point, turn, error);
  }

  // Two points of the line that a wall is in a slice, looking down on it within so many degrees;
  // picked off the wall by errors of that standard deviation.
  void PickWall(double spread, double tilt = 60)
  {
    const Matrix4 turn =
      this->TurnThat([&](const Matrix4& m) { return m(2, 1) < -std::cos(tilt * Degree); });
    const Matrix4 scanToPhantom = Matrix4::Translation({ this->Uniform(-50, 50),
                                    this->Uniform(-50, 50), this->Uniform(20, 60) }) *
      turn;
    for (const double column : { 0.1 * Width, 0.9 * Width })
    {
      const double height = scanToPhantom.Point({ column * this->Spacing[0], 0, 0 })[2];
      const double row = (this->Normal(spread) - height) / (this->Spacing[1] * turn(2, 1));
      this->Picks.push_back({ this->PhantomToTracker * scanToPhantom * this->ScanToProbe.Inverse(),
        { column, row }, Target::Wall });
    }
  }

  ProbeCalibrationOptions Options() const { return { this->Spacing, false, 4 }; }

  // mm between where a pixel is and where it is said to be
  Vec3 Error(const ProbeCalibration& found, const Vec2& pixel) const
  {
    return found.ImageToProbe.Point({ pixel[0], pixel[1], 0 }) -
      this->ImageToProbe.Point({ pixel[0], pixel[1], 0 });
  }
  std::vector<double> CornerErrors(const ProbeCalibration& found) const
  {
    std::vector<double> errors;
    for (const Vec2& pixel : Corners())
    {
      errors.push_back(Norm(this->Error(found, pixel)));
    }
    return errors;
  }
  static std::vector<Vec2> Corners()
  {
    return { { 0, 0 }, { Width, 0 }, { 0, Height }, { Width, Height } };
  }

private:
  std::mt19937 Random;
  Matrix4 ScanToProbe, PhantomToTracker;
};

double Largest(const std::vector<double>& values)
{
  return *std::max_element(values.begin(), values.end());
}

double Median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// e^T C^-1 e
double MahalanobisSquare(const std::array<Vec3, 3>& c, const Vec3& e)
{
  const double determinant = Dot(c[0], Cross(c[1], c[2]));
  const Vec3 rows[3] = { (1 / determinant) * Cross(c[1], c[2]),
    (1 / determinant) * Cross(c[2], c[0]), (1 / determinant) * Cross(c[0], c[1]) };
  double sum = 0;
  for (int i = 0; i < 3; ++i)
  {
    sum += e[i] * Dot(rows[i], e); // the inverse is symmetric
  }
  return sum;
}

// What many calibrations came to.
struct Study
{
  int Count = 0, Converged = 0, Covered = 0, InChiSquare = 0;
  std::vector<double> Errors, Rms;

  // F: 95 % of the F distribution with 3 and the equations less unknowns degrees of freedom
  void Add(const Scene& scene, const ProbeCalibration& found, double f)
  {
    ++this->Count;
    const std::vector<double> errors = scene.CornerErrors(found);
    this->Converged += Largest(errors) < 5;
    this->Errors.insert(this->Errors.end(), errors.begin(), errors.end());
    this->Rms.push_back(found.Rms);
    for (const Vec2& pixel : Scene::Corners())
    {
      this->Covered +=
        MahalanobisSquare(found.GetCovariance(pixel), scene.Error(found, pixel)) < 3 * f;
    }
  }
  double GetCoverage() const { return this->Covered / (4.0 * this->Count); }
};

Study StudyWires(double outliers)
{
  Study study;
  for (unsigned seed = 0; seed < 200; ++seed)
  {
    Scene scene(seed);
    for (int i = 0; i < 30; ++i)
    {
      const double error = scene.Uniform(0, 1) < outliers ? 25 : 1;
      const Vec2 offset{ scene.Uniform(-error, error), scene.Uniform(-error, error) };
      scene.PickWire(i % 3, offset);
    }
    const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
    study.Add(scene, found, 2.80);
    // 2.5 % and 97.5 % of the chi-square distribution with 48 degrees of freedom
    const double chiSquare = found.Rms * found.Rms * double(found.Equations) / (1.0 / 3);
    study.InChiSquare += found.Equations == 60 && chiSquare > 30.75 && chiSquare < 69.02;
  }
  return study;
}
}

TEST(ProbeCalibration, ExactPicksAreExact)
{
  Scene wires(1), wall(2), point(3);
  for (int i = 0; i < 12; ++i)
  {
    wires.PickWire(i % 3, { 0, 0 });
    wall.PickWall(0);
    point.Pick(Target::Point, { 0, 0, 0 }, point.Turn(180), { 0, 0 });
  }
  for (Scene* scene : { &wires, &wall, &point })
  {
    const ProbeCalibration found = ProbeCalibration::Solve(scene->Picks, scene->Options());
    EXPECT_LT(Largest(scene->CornerErrors(found)), 1e-6);
    EXPECT_LT(found.Rms, 1e-7);
    EXPECT_GT(found.ImageToProbe.Determinant3(), 0);
    EXPECT_NEAR(found.TrackerToPhantom.Determinant3(), 1, 1e-12);
    EXPECT_EQ(
      std::count(found.Used.begin(), found.Used.end(), true), std::ptrdiff_t(scene->Picks.size()));
  }
  EXPECT_EQ(ProbeCalibration::Solve(wires.Picks, wires.Options()).Unknowns, 12u); // appendix A
  EXPECT_EQ(ProbeCalibration::Solve(wall.Picks, wall.Options()).Unknowns, 9u);
  EXPECT_EQ(ProbeCalibration::Solve(point.Picks, point.Options()).Unknowns, 9u);
}

TEST(ProbeCalibration, PixelSpacingIsFound)
{
  // unequal, so that an exchange would be seen
  Scene wires(4, { 0.12, 0.2 }), wall(5, { 0.12, 0.2 });
  for (int i = 0; i < 12; ++i)
  {
    wires.PickWire(i % 3, { 0, 0 });
    wall.PickWall(0);
  }
  for (const Scene* scene : { &wires, &wall })
  {
    const ProbeCalibration found = ProbeCalibration::Solve(scene->Picks, { { 1, 1 }, true, 4 });
    EXPECT_NEAR(found.PixelSpacing[0], 0.12, 1e-9);
    EXPECT_NEAR(found.PixelSpacing[1], 0.2, 1e-9);
    EXPECT_LT(Largest(scene->CornerErrors(found)), 1e-6);
  }
  // A wrong one that is not to be found shows in the residuals.
  EXPECT_GT(ProbeCalibration::Solve(wires.Picks, { { 0.15, 0.15 }, false, 0 }).Rms, 1);
}

TEST(ProbeCalibration, ThreeWiresWithNoiseOfOneMillimetre)
{
  const Study study = StudyWires(0);
  EXPECT_EQ(study.Converged, 200);
  // 0.577 mm in each direction of the picks, 48 of 60 degrees of freedom; a little less where wires
  // are seen at an angle
  EXPECT_NEAR(Median(study.Rms), 0.5, 0.03);
  EXPECT_GE(study.InChiSquare, 190);
  EXPECT_LT(Median(study.Errors), 0.5);
  EXPECT_NEAR(study.GetCoverage(), 0.95, 0.03);
}

TEST(ProbeCalibration, ThreeWiresWithOutliers)
{
  const Study study = StudyWires(0.05);
  EXPECT_GE(study.Converged, 199);
  EXPECT_LT(Median(study.Errors), 0.5);
  EXPECT_NEAR(study.GetCoverage(), 0.95, 0.03);
}

TEST(ProbeCalibration, WallSeenFromAboveInFortySlices)
{
  Study study;
  for (unsigned seed = 0; seed < 200; ++seed)
  {
    Scene scene(1000 + seed);
    for (int i = 0; i < 40; ++i)
    {
      scene.PickWall(0.5);
    }
    study.Add(scene, ProbeCalibration::Solve(scene.Picks, scene.Options()), 2.73);
  }
  EXPECT_EQ(study.Converged, 200);
  EXPECT_LT(Median(study.Errors), 0.7);
  EXPECT_NEAR(study.GetCoverage(), 0.95, 0.03);
}

TEST(ProbeCalibration, OutliersAreNamedAndOthersKept)
{
  Scene scene(6);
  for (int i = 0; i < 30; ++i)
  {
    scene.PickWire(i % 3, { scene.Uniform(-0.5, 0.5), scene.Uniform(-0.5, 0.5) });
  }
  // Taken for another wire, and slipped.
  scene.Picks[7].Target = Target::WireX;
  scene.Picks[11].Pixel[1] += 60;
  const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
  for (std::size_t pick = 0; pick < 30; ++pick)
  {
    EXPECT_EQ(found.Used[pick], pick != 7 && pick != 11) << pick;
  }
  EXPECT_EQ(found.Equations, 56u);
  EXPECT_LT(Largest(scene.CornerErrors(found)), 1);
  // The phantom coordinates of the one show by how much it is off.
  EXPECT_GT(Norm(found.PhantomPoints[11]), 5);
  ProbeCalibrationOptions all = scene.Options();
  all.OutlierLimit = 0;
  const ProbeCalibration spoilt = ProbeCalibration::Solve(scene.Picks, all);
  EXPECT_EQ(spoilt.Equations, 60u);
  EXPECT_GT(spoilt.Rms, 3 * found.Rms);
}

TEST(ProbeCalibration, TargetsOfOnePhantomTogether)
{
  Scene scene(7);
  for (int i = 0; i < 6; ++i)
  {
    scene.PickWire(i % 3, { 0, 0 });
    scene.PickWall(0);
    scene.Pick(Target::Point, { 0, 0, 0 }, scene.Turn(180), { 0, 0 });
  }
  const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
  EXPECT_LT(Largest(scene.CornerErrors(found)), 1e-6);
  EXPECT_EQ(found.Unknowns, 12u);
}

TEST(ProbeCalibration, OrderOfPicksDoesNotMatter)
{
  Scene scene(8);
  for (int i = 0; i < 30; ++i)
  {
    scene.PickWire(i % 3, { scene.Uniform(-1, 1), scene.Uniform(-1, 1) });
  }
  const ProbeCalibration forwards = ProbeCalibration::Solve(scene.Picks, scene.Options());
  std::reverse(scene.Picks.begin(), scene.Picks.end());
  const ProbeCalibration backwards = ProbeCalibration::Solve(scene.Picks, scene.Options());
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_NEAR(forwards.ImageToProbe.Data()[i], backwards.ImageToProbe.Data()[i], 1e-6);
  }
}

TEST(ProbeCalibration, AnglesAreThoseOfThe3Space)
{
  // azimuth about z, then elevation about the new y, then roll about the new x
  Scene scene(9);
  for (int i = 0; i < 12; ++i)
  {
    scene.PickWire(i % 3, { 0, 0 });
  }
  const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
  const Vec3 angles = found.GetAngles();
  const Matrix4 turn = Matrix4::Rotation({ 0, 0, 1 }, angles[0] * Degree) *
    Matrix4::Rotation({ 0, 1, 0 }, angles[1] * Degree) *
    Matrix4::Rotation({ 1, 0, 0 }, angles[2] * Degree);
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_LT(Norm(turn.Column(axis) - Normalized(scene.ImageToProbe.Column(axis))), 1e-9);
  }
}

TEST(ProbeCalibration, SaysWhichMotionIsMissing)
{
  // A sweep over a wall without turning the probe tells nothing about where the receiver is.
  Scene still(10);
  const Matrix4 looking = Matrix4::Rotation({ 1, 0, 0 }, -90 * Degree);
  for (int i = 0; i < 40; ++i)
  {
    still.Pick(Target::Wall, { still.Uniform(-50, 50), still.Uniform(-50, 50), 0 }, looking,
      { still.Normal(0.5), still.Normal(0.5) });
  }
  try
  {
    ProbeCalibration::Solve(still.Picks, still.Options());
    ADD_FAILURE() << "was solved";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("the picks leave open"), std::string::npos)
      << error.what();
  }
  // Turned by some degrees it is solvable, badly, and the result says so.
  Scene slight(11);
  for (int i = 0; i < 40; ++i)
  {
    slight.PickWall(0.5, 4);
  }
  const ProbeCalibration found = ProbeCalibration::Solve(slight.Picks, slight.Options());
  ASSERT_FALSE(found.Weaknesses.empty());
  EXPECT_GT(found.GetExpectedError({ 0, 0 }), 2);
  EXPECT_NE(found.Weaknesses[0].Motion.find("turn the probe"), std::string::npos)
    << found.Weaknesses[0].Motion;
  // Turned well, there is nothing to say.
  Scene well(12);
  for (int i = 0; i < 40; ++i)
  {
    well.PickWall(0.5);
  }
  EXPECT_TRUE(ProbeCalibration::Solve(well.Picks, well.Options()).Weaknesses.empty());
}

TEST(ProbeCalibration, RefusesWhatCannotBe)
{
  Scene scene(13);
  for (int i = 0; i < 12; ++i)
  {
    scene.PickWire(i % 3, { 0, 0 });
  }
  const auto refused = [&scene](const char* part, const auto& spoil)
  {
    std::vector<CalibrationPick> picks = scene.Picks;
    ProbeCalibrationOptions options = scene.Options();
    spoil(picks, options);
    try
    {
      ProbeCalibration::Solve(picks, options);
      ADD_FAILURE() << "taken: " << part;
    }
    catch (const std::invalid_argument& error)
    {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  using Picks = std::vector<CalibrationPick>;
  using Options = ProbeCalibrationOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("0 picks give 0 equations", [](Picks& picks, Options&) { picks.clear(); });
  refused("14 equations for 12 unknowns", [](Picks& picks, Options&) { picks.resize(7); });
  refused("pick 3: ProbeToTracker has numbers that are not finite",
    [&](Picks& picks, Options&) { picks[3].ProbeToTracker(0, 3) = nan; });
  refused("pick 3: ProbeToTracker is not a rotation",
    [](Picks& picks, Options&) {
      picks[3].ProbeToTracker = picks[3].ProbeToTracker * Matrix4::Scaling({ 10, 10, 10 });
    });
  refused("pick 3: ProbeToTracker mirrors",
    [](Picks& picks, Options&) {
      picks[3].ProbeToTracker = picks[3].ProbeToTracker * Matrix4::Scaling({ 1, 1, -1 });
    });
  refused("pick 3: its pixel", [&](Picks& picks, Options&) { picks[3].Pixel[1] = nan; });
  refused("PixelSpacing", [](Picks&, Options& options) { options.PixelSpacing[0] = 0; });
  refused("PixelSpacing", [&](Picks&, Options& options) { options.PixelSpacing[1] = nan; });
  refused("OutlierLimit", [](Picks&, Options& options) { options.OutlierLimit = 1; });
  refused("leave open", [](Picks& picks, Options&) { picks.assign(40, picks[0]); });
}
