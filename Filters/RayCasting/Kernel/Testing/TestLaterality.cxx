// SPDX-License-Identifier: BSD-3-Clause
/// Axes and handedness: a letter F, seen from all sides, in volumes stored in all ways.
#include "lacunaIsoRayCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

struct Box
{
  Vec3 First;
  Vec3 Last;

  double Distance(const Vec3& p) const
  {
    Vec3 outside{ 0, 0, 0 };
    double inside = -std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a)
    {
      const double d = std::max(this->First[a] - p[a], p[a] - this->Last[a]);
      outside[a] = std::max(d, 0.0);
      inside = std::max(inside, d);
    }
    return Norm(outside) + std::min(inside, 0.0);
  }
};

/// An F for someone at -y who looks along +y with z up, x to the right. Its foot sticks out by 8 mm
/// towards him.
const std::vector<Box> Letter = { { { -20, -4, -25 }, { -12, 4, 25 } },
  { { -20, -4, 17 }, { 18, 4, 25 } }, { { -20, -4, -3 }, { 4, 4, 5 } },
  { { -20, -12, -25 }, { -12, 4, -17 } } };

/// Signed distance from the letter's surface, positive outside.
double Distance(const Vec3& p)
{
  double distance = std::numeric_limits<double>::infinity();
  for (const Box& box : Letter)
  {
    distance = std::min(distance, box.Distance(p));
  }
  return distance;
}

/// Volumes that hold the letter: upright, turned, and with an index frame of the other hand.
std::vector<Matrix4> Frames()
{
  const Vec3 spacing{ 1, 1.2, 0.9 };
  const auto centred = [&](const Matrix4& axes) {
    return axes * Matrix4::Scaling(spacing) * Matrix4::Translation({ -30, -25, -33 });
  };
  const Matrix4 mirror = Matrix4::FromColumns({ -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 });
  const Matrix4 turn = Matrix4::Rotation({ 1, 2, 3 }, 0.4);
  return { centred(Matrix4()), centred(mirror), centred(turn), centred(turn * mirror) };
}

struct Picture
{
  Vec3 Direction;
  Vec3 Up;
  std::vector<std::string> Rows; ///< 8 mm apart, centred on the world's origin
};

const std::vector<Picture> Pictures = {
  // what the viewer sees; digits: depth behind the nearest point in units of 8 mm
  { { 0, 1, 0 }, { 0, 0, 1 },
    {
      "..11111..", //
      "..1......", //
      "..1......", //
      "..111....", //
      "..1......", //
      "..1......", //
      "..0......", //
    } },
  // from behind the letter is mirrored and the foot does not stick out
  { { 0, -1, 0 }, { 0, 0, 1 },
    {
      "..00000..", //
      "......0..", //
      "......0..", //
      "....000..", //
      "......0..", //
      "......0..", //
      "......0..", //
    } },
  // upside down
  { { 0, 1, 0 }, { 0, 0, -1 },
    {
      "......0..", //
      "......1..", //
      "......1..", //
      "....111..", //
      "......1..", //
      "......1..", //
      "..11111..", //
    } },
};
}

TEST(Laterality, TheLetterReadsRightFromEverySide)
{
  ThreadExecution execution(1);
  for (const Matrix4& frame : Frames())
  {
    const TestField field({ 61, 51, 67 }, frame, [](const Vec3& p) { return -Distance(p); });
    const IsoRayCaster caster(
      field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution);
    for (const Picture& picture : Pictures)
    {
      ViewSettings view;
      view.Direction = picture.Direction;
      view.Up = picture.Up;
      view.HasPlaneOrigin = true;
      view.PlaneOrigin = -60 * picture.Direction;
      view.PixelSpacing = 0.5;
      const ImagePlane plane = MakeImagePlane(frame, field.Size, view);
      // the pixel that shows a world point is found from the plane alone
      const auto pixelOf = [&](const Vec3& p, const Vec3& axis)
      { return static_cast<int>(std::lround(Dot(p - plane.Origin, axis) / plane.PixelSpacing)); };
      const int centreColumn = pixelOf({ 0, 0, 0 }, plane.Right);
      const int centreRow = pixelOf({ 0, 0, 0 }, plane.Down);
      std::vector<double> depth(static_cast<std::size_t>(plane.Size[0]) * plane.Size[1]);
      caster.Cast(plane, 0,
        { { 0, plane.Size[0] - 1, 0, plane.Size[1] - 1 }, depth.data(), nullptr, nullptr },
        execution);
      double nearest = std::numeric_limits<double>::infinity();
      for (const double d : depth)
      {
        nearest = std::fmin(nearest, d);
      }
      std::vector<std::string> seen;
      for (std::size_t r = 0; r < picture.Rows.size(); ++r)
      {
        std::string line;
        for (std::size_t c = 0; c < picture.Rows[r].size(); ++c)
        {
          const int column = centreColumn + 16 * (static_cast<int>(c) - 4);
          const int row = centreRow + 16 * (static_cast<int>(r) - 3);
          const double d = depth[column + static_cast<std::size_t>(plane.Size[0]) * row];
          line += std::isnan(d)
            ? '.'
            : static_cast<char>('0' + static_cast<int>(std::lround((d - nearest) / 8)));
        }
        seen.push_back(line);
      }
      EXPECT_EQ(seen, picture.Rows);
    }
  }
}

TEST(Laterality, EveryHitLiesOnTheLetter)
{
  ThreadExecution execution(2);
  std::mt19937 random(30);
  for (const Matrix4& frame : Frames())
  {
    const TestField field({ 61, 51, 67 }, frame, [](const Vec3& p) { return -Distance(p); });
    const IsoRayCaster caster(
      field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution);
    for (int trial = 0; trial < 6; ++trial)
    {
      ViewSettings view;
      view.Direction = RandomUnit(random);
      view.Up = RandomUnit(random);
      const ImagePlane plane = MakeImagePlane(frame, field.Size, view);
      int hits = 0;
      for (int row = 0; row < plane.Size[1]; ++row)
      {
        for (int column = 0; column < plane.Size[0]; ++column)
        {
          const Vec3 origin = plane.PixelPosition(column, row);
          // how near the ray comes to the letter
          double clearance = std::numeric_limits<double>::infinity();
          for (double t = 0; t < 160; t += 0.5)
          {
            clearance = std::min(clearance, Distance(origin + t * plane.View));
          }
          RayHit hit;
          const bool found = caster.CastRay(origin, plane.View, 0, hit);
          if (clearance > 0.5)
          {
            ASSERT_FALSE(found);
          }
          else if (clearance < -1.5)
          {
            ASSERT_TRUE(found);
          }
          if (found)
          {
            ++hits;
            ASSERT_GT(hit.Distance, 0);
            // the spline rounds edges and corners by less than a voxel
            ASSERT_LT(std::abs(Distance(origin + hit.Distance * plane.View)), 1);
          }
        }
      }
      EXPECT_GT(hits, 300);
    }
  }
}
