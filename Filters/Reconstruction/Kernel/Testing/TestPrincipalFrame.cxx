// SPDX-License-Identifier: BSD-3-Clause
/// The frame that lies along a sweep: right-handed, tight, not mirrored.
#include "lacunaPrincipalFrame.h"
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr double Degree = 0.017453292519943295;

// An image of 40 x 30 mm.
SliceImage At(const Matrix4& pose)
{
  SliceImage slice;
  slice.Width = 401;
  slice.Height = 301;
  slice.PixelToReference = pose * Matrix4::Scaling({ 0.1, 0.1, 1 });
  return slice;
}

void ExpectRotation(const Matrix4& frame)
{
  EXPECT_NEAR(frame.Determinant3(), 1, 1e-12);
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      EXPECT_NEAR(Dot(frame.Column(a), frame.Column(b)), a == b ? 1 : 0, 1e-12);
    }
  }
  EXPECT_EQ(frame.Column(3), (Vec3{ 0, 0, 0 }));
}

void ExpectAxes(const Matrix4& frame, const Matrix4& expected)
{
  for (int a = 0; a < 3; ++a)
  {
    EXPECT_NEAR(Norm(frame.Column(a) - Normalized(expected.Column(a))), 0, 1e-9) << "axis " << a;
  }
}

// Volume of the box of all corners in a frame.
double GetBoxVolume(const std::vector<SliceImage>& slices, const Matrix4& frameToReference)
{
  std::vector<SliceImage> moved = slices;
  for (SliceImage& slice : moved)
  {
    slice.PixelToReference = frameToReference.Inverse() * slice.PixelToReference;
  }
  const VolumeGrid grid = MakeGrid(moved, { 0.1, 0.1, 0.1 });
  return 1e-3 * grid.Dimensions[0] * grid.Dimensions[1] * grid.Dimensions[2];
}

const Matrix4 Probe = Matrix4::Translation({ 30, -200, 70 }) * Matrix4::Rotation({ 1, 2, 3 }, 1.1);
}

TEST(PrincipalFrame, StraightSweepLiesAlongItsSlices)
{
  for (const double direction : { 1.0, -1.0 })
  {
    std::vector<SliceImage> slices;
    for (int n = 0; n < 60; ++n)
    {
      slices.push_back(At(Probe * Matrix4::Translation({ 0, 0, direction * n })));
    }
    const Matrix4 frame = GetPrincipalFrame(slices);
    ExpectRotation(frame);
    ExpectAxes(frame, Probe); // whichever way the probe moves
    EXPECT_NEAR(GetBoxVolume(slices, frame), 40.1 * 30.1 * 59.1, 1);
    EXPECT_GT(GetBoxVolume(slices, Matrix4()), 3 * 40 * 30 * 59);
  }
}

TEST(PrincipalFrame, FanKeepsItsAxisOfRotation)
{
  std::vector<SliceImage> slices;
  for (int n = -30; n <= 30; ++n)
  {
    slices.push_back(At(Probe * Matrix4::Rotation({ 1, 0, 0 }, n * Degree)));
  }
  const Matrix4 frame = GetPrincipalFrame(slices);
  ExpectRotation(frame);
  ExpectAxes(frame, Probe);
  EXPECT_LT(GetBoxVolume(slices, frame), 0.5 * GetBoxVolume(slices, Matrix4()));
}

TEST(PrincipalFrame, HalfATurnKeepsItsAxis)
{
  std::vector<SliceImage> slices;
  for (int n = 0; n < 180; n += 3)
  {
    slices.push_back(
      At(Probe * Matrix4::Rotation({ 0, 1, 0 }, n * Degree) * Matrix4::Translation({ -20, 0, 0 })));
  }
  const Matrix4 frame = GetPrincipalFrame(slices);
  ExpectRotation(frame);
  EXPECT_NEAR(Norm(frame.Column(1) - Normalized(Probe.Column(1))), 0, 1e-9);
  EXPECT_GT(Dot(frame.Column(0), slices[0].PixelToReference.Column(0)), -1e-9);
  // a cylinder: every frame along its axis is as tight
  EXPECT_NEAR(GetBoxVolume(slices, frame), 40.1 * 40.1 * 30.1, 1e-6);
}

TEST(PrincipalFrame, SweepsThereAndBack)
{
  // the second sweep with the probe turned round: columns and normals point the other way
  std::vector<SliceImage> slices;
  for (int n = 0; n < 40; ++n)
  {
    slices.push_back(At(Probe * Matrix4::Translation({ 0, 0, double(n) })));
  }
  for (int n = 0; n < 60; ++n)
  {
    slices.push_back(At(Probe * Matrix4::Translation({ 40, 0, double(n) }) *
      Matrix4::Rotation({ 0, 1, 0 }, 180 * Degree)));
  }
  ExpectAxes(GetPrincipalFrame(slices), Probe);
}

TEST(PrincipalFrame, RandomSweepsGiveRotations)
{
  for (unsigned int seed = 0; seed < 200; ++seed)
  {
    std::vector<SliceImage> slices;
    for (const Matrix4& pose : MakeRandomPoses(1 + static_cast<int>(seed % 12), seed, 3.2))
    {
      slices.push_back(At(pose)); // sheared pixels of unequal size, any turn
    }
    const Matrix4 frame = GetPrincipalFrame(slices);
    ExpectRotation(frame);
    // turning the reference frame turns the frame with it
    const Matrix4 turn = Matrix4::Rotation({ 3, -1, 2 }, 0.1 * seed);
    std::vector<SliceImage> turned = slices;
    for (SliceImage& slice : turned)
    {
      slice.PixelToReference = turn * slice.PixelToReference;
    }
    ExpectAxes(GetPrincipalFrame(turned), turn * frame);
  }
}

TEST(PrincipalFrame, AxesThatCancel)
{
  // the normal of one slice is the row of the next
  const std::vector<SliceImage> slices{ At(Matrix4()),
    At(Matrix4::Rotation({ 1, 0, 0 }, 90 * Degree)),
    At(Matrix4::Rotation({ 0, 1, 0 }, 90 * Degree)),
    At(Matrix4::Rotation({ 0, 0, 1 }, 90 * Degree)) };
  ExpectRotation(GetPrincipalFrame(slices));
  EXPECT_THROW(GetPrincipalFrame({}), std::invalid_argument);
}
