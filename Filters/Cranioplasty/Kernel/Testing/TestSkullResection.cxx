// SPDX-License-Identifier: BSD-3-Clause
// Cuts through a spherical shell, where wall, piece and guide are known exactly.
#include "lacunaSkullResection.h"

#include "lacunaShellTest.h"
#include "lacunaVoxelSampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

using namespace lacunaShellTest;
using lacuna::ResectionOptions;
using lacuna::SkullResection;
using lacunaSkullTest::Pi;

namespace
{
constexpr double Angle = 0.4; // radians, of the outline from its axis

// A circle on the sphere, seen from outside an ellipse: its radius is stretched by 1 + 0.2 cos(2 turn). above: mm.
std::vector<Vec3> MakeOutline(const Shell& shell, double above, double stretch = 0.2)
{
  const Vec3 u = lacuna::Normalized(Cross(shell.Axis, { 1, 0, 0 }));
  const Vec3 v = Cross(shell.Axis, u);
  std::vector<Vec3> curve;
  for (int k = 0; k < 72; ++k)
  {
    const double turn = 2 * Pi * k / 72;
    const double radius = Outer * std::sin(Angle) * (1 + stretch * std::cos(2 * turn));
    const double height = std::sqrt(Outer * Outer - radius * radius);
    curve.push_back(shell.World.Point(
      (height + above) * shell.Axis + radius * (std::cos(turn) * u + std::sin(turn) * v)));
  }
  return curve;
}

struct Cuts
{
  Cuts(const Shell& shell, const ResectionOptions& options, const std::vector<Vec3>& outline)
    : Resection(shell.Volume, outline, shell.World.Column(3), options, this->Run)
    , Kept(shell.Voxels.size())
    , Piece(shell.Voxels.size())
  {
    this->Resection.Cut(this->Kept.data(), this->Piece.data(), this->Run);
  }

  lacuna::ThreadExecution Run{ 2 };
  SkullResection Resection;
  std::vector<std::int16_t> Kept;
  std::vector<std::int16_t> Piece;
};

// mm across the wall in the shell's own coordinates, positive in the piece. For the round outline.
double GetRoundInside(const Shell& shell, const Vec3& x, double bevel)
{
  const double along = Dot(x, shell.Axis);
  const double across = Norm(x - along * shell.Axis);
  const double below = Outer * std::cos(Angle) - along;
  return (Outer * std::sin(Angle) - across - std::tan(bevel) * below) * std::cos(bevel);
}
}

TEST(SkullResection, CutsAlongABevelThroughTheOutline)
{
  const Matrix4 turn = Matrix4::Translation({ 40, -25, 30 }) * Matrix4::Rotation({ 1, 2, -1 }, 1.1);
  for (const double bevel : { 0.0, 20.0 })
  {
    const Shell shell(turn, -100, -10, Hole::None);
    ResectionOptions options;
    options.Bevel = bevel;
    const Cuts cuts(shell, options, MakeOutline(shell, 6, 0)); // 6 mm above the bone
    EXPECT_LT(Norm(cuts.Resection.GetDirection() + turn.Vector(shell.Axis)), 1e-6);
    for (const Vec3& x : cuts.Resection.GetOutline())
    {
      const Vec3 own = turn.Inverse().Point(x);
      EXPECT_NEAR(Norm(own), Outer, 0.06);
      EXPECT_NEAR(Norm(own - Dot(own, shell.Axis) * shell.Axis), Outer * std::sin(Angle), 0.06);
    }
    lacuna::VoxelSampler kept(shell.Volume, cuts.Kept.data());
    lacuna::VoxelSampler piece(shell.Volume, cuts.Piece.data());
    std::mt19937 random(5);
    int inBoth = 0;
    double farthest = 0;
    for (int k = 0; k < 20000; ++k)
    {
      const auto next = [&] { return 120 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
      const Vec3 own{ next(), next(), next() };
      const Vec3 x = turn.Point(own);
      const double depth = shell.GetDepth(own);
      const double inside = GetRoundInside(shell, own, bevel * Pi / 180);
      if (std::abs(depth) < 1 || std::abs(inside) < 0.5)
      {
        continue;
      }
      // the far side of the shell is not cut
      const bool isCut = inside > 0 && Dot(own, shell.Axis) > 0;
      EXPECT_EQ(kept(x) >= 300, depth > 0 && !isCut) << depth << " " << inside;
      EXPECT_EQ(piece(x) >= 300, depth > 0 && isCut) << depth << " " << inside;
      inBoth += kept(x) >= 300 && piece(x) >= 300;
      // unchanged beside the cut
      farthest = std::max(farthest, depth > 1.5 && inside < -4 ? std::abs(kept(x) - 300) : 0);
    }
    EXPECT_EQ(inBoth, 0);
    EXPECT_GT(farthest, 300); // bone is as bright as before
  }
}

// Where the grey levels cross the level is the wall, between voxels. Metal elsewhere in the head does not matter.
TEST(SkullResection, HasItsWallBetweenVoxels)
{
  Shell shell({}, -100, -10, Hole::None);
  shell.Voxels[shell.Voxels.size() / 2] = 20000;
  ResectionOptions options;
  options.Bevel = 20;
  const Cuts cuts(shell, options, MakeOutline(shell, 0, 0));
  for (const auto* values : { &cuts.Kept, &cuts.Piece })
  {
    lacuna::VoxelSampler sample(shell.Volume, values->data());
    const Vec3 u = lacuna::Normalized(Cross(shell.Axis, { 1, 0, 0 }));
    const Vec3 v = Cross(shell.Axis, u);
    for (double turn = 0; turn < 6.28; turn += 0.1)
    {
      const Vec3 beside = std::cos(turn) * u + std::sin(turn) * v;
      const double height = Outer * std::cos(Angle) - 3;
      const auto at = [&](double across) { return sample(height * shell.Axis + across * beside); };
      double low = Outer * std::sin(Angle) - 3;
      double high = low + 4;
      const bool isPiece = values == &cuts.Piece;
      ASSERT_EQ(at(low) >= 300, isPiece);
      ASSERT_EQ(at(high) >= 300, !isPiece);
      for (int step = 0; step < 30; ++step)
      {
        const double middle = 0.5 * (low + high);
        ((at(middle) >= 300) == isPiece ? low : high) = middle;
      }
      const double wall = Outer * std::sin(Angle) - 3 * std::tan(options.Bevel * Pi / 180);
      EXPECT_NEAR(low, wall, 0.15);
    }
  }
}

TEST(SkullResection, HasAGuideThatLiesOnBone)
{
  const Shell shell({}, -100, -10, Hole::None);
  ResectionOptions options;
  options.Bevel = 15;
  options.GuideClearance = 0.3;
  Cuts cuts(shell, options, MakeOutline(shell, 2));
  const SkullImplant guide = cuts.Resection.MakeGuide(cuts.Run);
  EXPECT_TRUE(guide.Warnings.empty());
  EXPECT_TRUE(IsClosed(guide));
  EXPECT_EQ(guide.Holes, 4);
  double lowest = 100;
  double area = 0;
  double leastInside = 100;
  double mostInside = -100;
  for (std::size_t t = 0; t < guide.Triangles.size(); ++t)
  {
    const auto& c = guide.Triangles[t];
    for (const int corner : c)
    {
      lowest = std::min(lowest, Norm(guide.Points[corner]) - Outer);
      mostInside = std::max(mostInside, cuts.Resection.GetInside(guide.Points[corner]));
    }
    if (guide.Faces[t] == SkullImplantFace::Inner)
    {
      area += 0.5 *
        std::abs(Dot(shell.Axis,
          Cross(guide.Points[c[1]] - guide.Points[c[0]], guide.Points[c[2]] - guide.Points[c[0]])));
    }
  }
  leastInside = mostInside;
  // Above bone everywhere, by the clearance along the cut, which is the cosine of 40 degrees across the surface.
  EXPECT_GT(lowest, 0.3 * std::cos(0.75) - 0.05);
  EXPECT_LT(lowest, 0.45);
  // its inner wall goes on with the cut's
  EXPECT_NEAR(leastInside, 0, 0.1);
  // a ring of 10 mm around an ellipse of 28 and 18.7 mm, without its holes
  double length = 0;
  const std::vector<Vec3>& outline = cuts.Resection.GetOutline();
  for (std::size_t k = 0; k < outline.size(); ++k)
  {
    Vec3 way = outline[(k + 1) % outline.size()] - outline[k];
    way = way - Dot(way, shell.Axis) * shell.Axis;
    length += Norm(way);
  }
  EXPECT_NEAR(area, length * 10 + Pi * 100, 0.04 * length * 10);
}

// A high guide on a steep part of the skull: holes along its normal stay within it, or are told to be missing.
TEST(SkullResection, HasHolesWithinItsGuide)
{
  const Shell shell({}, -100, -10, Hole::None);
  for (const double height : { 5.0, 12.0 })
  {
    ResectionOptions options;
    options.GuideHeight = height;
    options.GuideWidth = 8;
    options.GuideHole = 3;
    Cuts cuts(shell, options, MakeOutline(shell, 2, 0.3));
    const SkullImplant guide = cuts.Resection.MakeGuide(cuts.Run);
    EXPECT_TRUE(IsClosed(guide));
    EXPECT_EQ(guide.Warnings.empty(), guide.Holes == 4);
    const std::vector<std::vector<int>> walls = FindWalls(guide);
    ASSERT_EQ(walls.size(), 2u + guide.Holes);
    for (std::size_t hole = 2; hole < walls.size(); ++hole)
    {
      for (std::size_t rim = 0; rim < 2; ++rim)
      {
        double least = 100;
        for (const int k : walls[hole])
        {
          for (const int m : walls[rim])
          {
            least = std::min(least, Norm(guide.Points[k] - guide.Points[m]));
          }
        }
        EXPECT_GT(least, 0.8);
      }
    }
  }
}

TEST(SkullResection, GoesAroundATumour)
{
  // a ball under the bone: the outline is a circle, margin around it
  const Shell shell({}, -100, -10, Hole::None);
  std::vector<Vec3> points;
  std::mt19937 random(3);
  for (int k = 0; k < 4000; ++k)
  {
    const auto next = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
    points.push_back(40 * shell.Axis + 12 * lacuna::Normalized({ next(), next(), next() }));
  }
  const std::vector<Vec3> outline = lacuna::FindOutlineAround(points, 7, { 0, 0, 0 });
  for (const Vec3& x : outline)
  {
    EXPECT_NEAR(Norm(x - Dot(x, shell.Axis) * shell.Axis), 12 + 7, 0.4);
  }
  const Cuts cuts(shell, {}, outline);
  for (const Vec3& x : cuts.Resection.GetOutline())
  {
    EXPECT_NEAR(Norm(x), Outer, 0.06);
  }
}

TEST(SkullResection, RefusesWhatCannotBeCut)
{
  const Shell shell({}, -100, -10, Hole::None);
  const auto refused = [&](const std::vector<Vec3>& outline, const char* text)
  {
    try
    {
      const Cuts cuts(shell, {}, outline);
      ADD_FAILURE() << text;
    }
    catch (const std::exception& error)
    {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  std::vector<Vec3> outline = MakeOutline(shell, 0);
  refused({ outline[0], outline[1] }, "fewer than three points");
  std::vector<Vec3> eight = outline;
  std::reverse(eight.begin() + 10, eight.begin() + 40);
  refused(eight, "crosses itself");
  for (Vec3& x : outline)
  {
    x = 3 * x;
  }
  refused(outline, "no bone");
  ResectionOptions options;
  options.Bevel = 50;
  EXPECT_THROW(Cuts(shell, options, MakeOutline(shell, 0)), std::invalid_argument);
  // guides of which nothing would be left above, or beside a hole
  const auto guide = [](double bevel, double width, double height, double hole)
  {
    ResectionOptions options;
    options.Bevel = bevel;
    options.GuideWidth = width;
    options.GuideHeight = height;
    options.GuideHole = hole;
    CheckResectionOptions(options);
  };
  EXPECT_THROW(guide(45, 10, 12, 0), std::invalid_argument);
  EXPECT_THROW(guide(10, 5, 5, 5), std::invalid_argument);
  EXPECT_THROW(guide(0, 0, 5, 0), std::invalid_argument); // no guide at all
  EXPECT_NO_THROW(guide(45, 15, 12, 0));
  EXPECT_THROW(lacuna::FindOutlineAround({}, 5, {}), std::invalid_argument);
  EXPECT_THROW(
    lacuna::FindOutlineAround({ { 1, 0, 0 }, { -1, 0, 0 } }, 5, {}), std::invalid_argument);
}
