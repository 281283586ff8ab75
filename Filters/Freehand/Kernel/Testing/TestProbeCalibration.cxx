// SPDX-License-Identifier: BSD-3-Clause
/// Probes of known position are found again, as exactly as the picks allow, and what the result says
/// about its own error is true.
#include "lacunaCalibrationStudy.h"
#include "lacunaProbeCalibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

using namespace lacunaCalibrationStudy;

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
  const Study study = StudyWires(200, 0);
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
  const Study study = StudyWires(200, 0.05);
  EXPECT_GE(study.Converged, 199);
  EXPECT_LT(Median(study.Errors), 0.5);
  EXPECT_NEAR(study.GetCoverage(), 0.95, 0.03);
}

TEST(ProbeCalibration, WallSeenFromAboveInFortySlices)
{
  const Study study = StudyWall(200);
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

TEST(ProbeCalibration, TurnsFromWireToWireAreNoTurns)
{
  // Each wire is seen from one side only, the sides being at right angles.
  Scene scene(14);
  const Matrix4 sides[3] = { Matrix4::Rotation({ 0, 1, 0 }, 90 * Degree),
    Matrix4::Rotation({ 1, 0, 0 }, 90 * Degree), Matrix4() };
  for (int i = 0; i < 30; ++i)
  {
    Vec3 point{ 0, 0, 0 };
    point[i % 3] = scene.Uniform(-60, 60);
    scene.Pick(Wires[i % 3], point, scene.Turn(3) * sides[i % 3],
      { scene.Uniform(-1, 1), scene.Uniform(-1, 1) });
  }
  const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
  ASSERT_FALSE(found.Weaknesses.empty());
  EXPECT_NE(found.Weaknesses[0].Motion.find("turn the probe more"), std::string::npos);
  const std::size_t so = found.Weaknesses[0].Motion.find("(so far by ");
  ASSERT_NE(so, std::string::npos) << found.Weaknesses[0].Motion;
  EXPECT_LT(std::stod(found.Weaknesses[0].Motion.substr(so + 11)), 10);
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
