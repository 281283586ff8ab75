// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestFrames.h"
#include "lacunaCTGeometry.h"
#include "lacunaMatrix4.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
std::string ErrorOf(const std::vector<CTFrame>& frames, const CTGeometryOptions& options = {})
{
  try
  {
    FindCTGeometry(frames, options);
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "no error";
}

bool Has(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

double Determinant(const CTGeometry& geometry)
{
  return Dot(Cross(geometry.Axes[0], geometry.Axes[1]), geometry.Axes[2]);
}
}

TEST(CTGeometry, SortsAlongTheNormal)
{
  std::vector<CTFrame> frames = MakeFrames({ { 1, 2, 9 }, { 1, 2, 3 }, { 1, 2, 6 } });
  const CTGeometry up = FindCTGeometry(frames, {});
  EXPECT_EQ(up.Origin, (Vec3{ 1, 2, 3 }));
  EXPECT_EQ(up.Spacing, (Vec3{ 0.8, 0.5, 3 }));
  EXPECT_EQ(up.Slices[0].Frame.GetName(), "IM1");
  EXPECT_EQ(up.Axes[2], (Vec3{ 0, 0, 1 }));
  // the same images with rows to the right: the normal points down, and so does the sorting
  for (CTFrame& frame : frames)
  {
    frame.Axes = { -1, 0, 0, 0, 1, 0 };
  }
  const CTGeometry down = FindCTGeometry(frames, {});
  EXPECT_EQ(down.Origin, (Vec3{ 1, 2, 9 }));
  EXPECT_EQ(down.Axes[2], (Vec3{ 0, 0, -1 }));
  EXPECT_EQ(Determinant(down), 1);
}

// Directions rounded to six digits, in any orientation: axes are orthonormal, never mirrored.
TEST(CTGeometry, AnyOrientation)
{
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial)
  {
    const Matrix4 turn =
      Matrix4::Rotation({ normal(random), normal(random), normal(random) }, 3 * normal(random));
    const Vec3 row = turn.Column(0);
    const Vec3 column = turn.Column(1);
    const Vec3 third = turn.Column(2);
    const Vec3 first = { 50 * normal(random), 50 * normal(random), 50 * normal(random) };
    std::vector<CTFrame> frames =
      MakeFrames({ first + 2.5 * third, first, first + 5 * third, first + 7.5 * third });
    const auto rounded = [](double x) { return std::round(1e6 * x) / 1e6; };
    for (CTFrame& frame : frames)
    {
      frame.Axes = { rounded(row[0]), rounded(row[1]), rounded(row[2]), rounded(column[0]),
        rounded(column[1]), rounded(column[2]) };
    }
    const CTGeometry found = FindCTGeometry(frames, {});
    EXPECT_NEAR(Determinant(found), 1, 1e-14);
    EXPECT_NEAR(Dot(found.Axes[0], found.Axes[1]), 0, 1e-14);
    EXPECT_NEAR(Norm(found.Axes[0] - row), 0, 2e-6);
    EXPECT_NEAR(Norm(found.Axes[2] - third), 0, 2e-6);
    EXPECT_NEAR(Norm(found.Origin - first), 0, 1e-4);
    EXPECT_NEAR(found.Spacing[2], 2.5, 1e-9);
    EXPECT_EQ(found.TiltDegrees, 0);
    EXPECT_EQ(found.Slices[0].Frame.GetName(), "IM1");
  }
}

TEST(CTGeometry, Tilt)
{
  const std::vector<CTFrame> frames =
    MakeFrames({ { 0, 0, 0 }, { 0, 0.75, 3 }, { 0, 1.5, 6 }, { 0, 2.25, 9 } });
  const CTGeometry found = FindCTGeometry(frames, {});
  EXPECT_NEAR(found.TiltDegrees, std::atan(0.25) * 180 / 3.14159265358979323846, 1e-12);
  EXPECT_EQ(found.Columns, 7);
  EXPECT_EQ(found.Rows, 5 + 5); // 2.25 mm are 4.5 rows
  EXPECT_EQ(found.Origin, (Vec3{ 0, 0, 0 }));
  EXPECT_DOUBLE_EQ(found.Slices[3].RowShift, 4.5);
  EXPECT_EQ(found.Slices[3].ColumnShift, 0);
  CTGeometryOptions refuse;
  refuse.CorrectTilt = false;
  EXPECT_TRUE(Has(ErrorOf(frames, refuse), "sheared by 14.0362 degrees"));
  // to the other side: the grid begins at the last slice's rows
  const CTGeometry other =
    FindCTGeometry(MakeFrames({ { 0, 0, 0 }, { -0.4, 0, 3 }, { -0.8, 0, 6 } }), {});
  EXPECT_EQ(other.Columns, 8);
  EXPECT_NEAR(other.Origin[0], -0.8, 1e-12);
  EXPECT_NEAR(other.Slices[0].ColumnShift, 1, 1e-12);
  EXPECT_NEAR(other.Slices[2].ColumnShift, 0, 1e-12);
}

TEST(CTGeometry, SaysWhere)
{
  EXPECT_EQ(ErrorOf(MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 0, 0, 4 }, { 0, 0, 8 } })),
    "1 slice is missing at 6 mm along the slice normal; find the missing images, or set "
    "MissingSlices to Interpolate");
  EXPECT_TRUE(Has(ErrorOf(MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 1, 0, 4 }, { 0, 0, 6 } })),
    "displaced sideways, not along a straight line: IM2 at 4 mm lies beside IM1 at 2 mm"));
  EXPECT_TRUE(Has(ErrorOf(MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 0, 0, 2.01 }, { 0, 0, 4 } })),
    "1 slices are there twice with different images: IM2 at 2.01 mm and IM1"));
}

TEST(CTGeometry, DropsCopies)
{
  CTGeometryOptions options;
  options.SameImage = [](const CTFrame&, const CTFrame&) { return true; };
  const CTGeometry found =
    FindCTGeometry(MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 0, 0, 2 }, { 0, 0, 4 } }), options);
  EXPECT_EQ(found.Planes.size(), 3U);
  ASSERT_EQ(found.Warnings.size(), 1U);
  EXPECT_TRUE(Has(found.Warnings[0], "IM2 at 2 mm"));
}

// A generous tolerance does not make copies of neighbours that look the same.
TEST(CTGeometry, ToleranceBeyondSpacing)
{
  CTGeometryOptions options;
  options.SameImage = [](const CTFrame&, const CTFrame&) { return true; };
  options.PositionTolerance = 3;
  std::vector<Vec3> positions;
  for (int k = 0; k < 17; ++k)
  {
    positions.push_back({ 0, 0, 2.0 * k });
  }
  const CTGeometry found = FindCTGeometry(MakeFrames(positions), options);
  EXPECT_EQ(found.Planes.size(), 17U);
  EXPECT_TRUE(found.Warnings.empty());
  // copies are found where every image has one, also with other digits
  for (int k = 0; k < 17; ++k)
  {
    positions.push_back({ 0, 0, 2.0 * k + 0.01 });
  }
  EXPECT_EQ(FindCTGeometry(MakeFrames(positions), options).Planes.size(), 17U);
  // and where one position has many, told apart by rounding alone
  positions.clear();
  for (int k = 0; k < 17 * 9; ++k)
  {
    positions.push_back({ 0, 0, 2.0 * (k / 9) + 1e-12 * (k % 9) });
  }
  EXPECT_EQ(FindCTGeometry(MakeFrames(positions), options).Planes.size(), 17U);
  positions.resize(17);
  for (const double bad : { 0.0, -1.0, 1e-7, 11.0, HUGE_VAL, std::nan("") })
  {
    options.PositionTolerance = bad;
    EXPECT_TRUE(Has(ErrorOf(MakeFrames(positions), options), "it must be from 1e-06 to 10 mm"));
  }
}

TEST(CTGeometry, SingleSlice)
{
  std::vector<CTFrame> frames = MakeFrames({ { 1, 2, 3 } });
  frames[0].Thickness = 4.5;
  const CTGeometry found = FindCTGeometry(frames, {});
  EXPECT_EQ(found.Spacing[2], 4.5);
  EXPECT_EQ(found.Planes.size(), 1U);
  EXPECT_EQ(found.Warnings.size(), 1U);
}
